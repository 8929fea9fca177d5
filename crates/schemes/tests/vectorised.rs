//! The loop over the paths of a block is still turned into vector instructions: counted in this
//! binary and not timed.
//!
//! Autovectorisation is lost without a word. Counted are the additions, multiplications and
//! divisions of doubles in the compiled step of `sexp` on the rigid body with three noises. Nearly
//! every block is done after the first sweep of eleven evaluations, so that loop has to be there
//! with vectors as wide as the machine has, for all of its arithmetic. The rest of the code is
//! checked as a whole: the compiler keeps a narrow copy of most loops for arrays that might
//! overlap, which they never do, so that half of all arithmetic may be narrow, and not more.
//! `tests/not_vectorised.rs` is the twin: a system that cannot be vectorised, and does not pass.

#![cfg(target_arch = "x86_64")]

mod disassembly;

use disassembly::versions;
use noise::BlockNoise;
use nonlin::BlockStatus;
use real::{Block, Simd};
use schemes::{Scheme, Sexp, Step};
use systems::{Cosine, RigidBody};

/// The arithmetic of the first sweep: eleven evaluations of nine operations on two paths in turn.
const FIRST_SWEEP: usize = 11 * 9 * 2;
/// Its least share of full vectors. What all paths share is computed before the loop or costs an
/// instruction or two.
const MIN_SHARE_OF_THE_LOOP: f64 = 0.95;
/// The least share of full vectors in all arithmetic, were every loop compiled twice.
const MIN_SHARE: f64 = 0.5;

/// Makes the compiler put the kernel into this binary; that it also works is not the question here.
fn use_the_kernel() {
    let body = RigidBody::three_noises([2.0, 1.0, 2.0 / 3.0], [1.0, 2.0, 3.0]).unwrap();
    let step = Step::new(&Cosine::new(0.5, 2.0).unwrap(), 0, 1.0 / 256.0).unwrap();
    let (mut y, mut status) = (Block::splat([0.45, 0.0, 0.89]), BlockStatus::explicit());
    let dw = Block::splat([0.1, -0.05, 0.02]);
    let noise = BlockNoise::increments(&dw.0);
    Sexp.step_block(&body, &step, &noise, &mut y, &mut status);
    assert!(status.failed.is_empty() && y.0[1][31] != 0.0);
}

fn packed(level: Simd, instruction_set: &str, vector: usize) {
    use_the_kernel();
    if !Simd::BUILT.contains(&level) {
        println!("skipped: this build has no kernels for it");
        return;
    }
    let Some(versions) = versions(instruction_set) else {
        println!("skipped: this binary has no symbols to find its kernels by");
        return;
    };
    assert!(!versions.is_empty(), "no kernel for {instruction_set} in this binary");
    for version in &versions {
        println!("{instruction_set}: {version:?}");
        let heaviest = &version.heaviest_loops[vector];
        assert!(
            heaviest.packed[vector] >= FIRST_SWEEP,
            "{instruction_set}: no first sweep on full vectors: {version:?}"
        );
        assert!(
            heaviest.share(vector) >= MIN_SHARE_OF_THE_LOOP,
            "{instruction_set}: scalar left over: {version:?}"
        );
        assert!(
            version.whole.share(vector) >= MIN_SHARE,
            "{instruction_set}: mostly narrow: {version:?}"
        );
    }
}

#[test]
fn avx512_works_on_eight_paths_at_a_time_and_avx2_on_four() {
    packed(Simd::Avx512, "up_to_avx512_avx512", 2);
    packed(Simd::Avx2, "_avx2_version", 1);
}
