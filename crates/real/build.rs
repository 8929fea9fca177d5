//! Sets the cfg `avx2_alone` for debug builds on a machine that has AVX2: see `src/dispatch.rs`.

use std::env::var;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rustc-check-cfg=cfg(avx2_alone)");
    #[cfg(target_arch = "x86_64")]
    if var("PROFILE").is_ok_and(|profile| profile == "debug")
        && var("HOST") == var("TARGET")
        && is_x86_feature_detected!("avx2")
    {
        println!("cargo::rustc-cfg=avx2_alone");
    }
}
