//! The twin of `tests/vectorised.rs`: a kernel that cannot be vectorised, to see that the count
//! shows it.
//!
//! In a binary of its own, since kernels cannot be told apart by their symbols.

#![cfg(target_arch = "x86_64")]

mod disassembly;

use disassembly::versions;
use noise::BlockNoise;
use nonlin::BlockStatus;
use real::{Block, Real, Simd};
use schemes::{Scheme, Sexp, Step};
use systems::{Constant, PoissonSystem};

/// An oscillator whose frequency is found by a loop that each path leaves when it is done.
struct Impatient;

impl PoissonSystem<2, 1> for Impatient {
    fn name(&self) -> &'static str {
        "impatient"
    }

    #[inline(always)]
    fn structure<R: Real>(&self, _y: [R; 2], v: [R; 2]) -> [R; 2] {
        [-v[1], v[0]]
    }

    #[inline(always)]
    fn energy<R: Real>(&self, y: [R; 2], dt: f64, dw: [f64; 1]) -> R {
        (y[0] * y[0] + y[1] * y[1]) * (0.5 * dt + 0.5 * dw[0])
    }

    #[inline(always)]
    fn averaged_gradient<R: Real>(&self, a: [R; 2], b: [R; 2], dt: f64, dw: [f64; 1]) -> [R; 2] {
        let mut frequency = dt + dw[0];
        while frequency > 1e-3 {
            frequency *= 0.7;
        }
        [(b[0] + a[0]) * frequency, (a[1] + b[1]) * (0.5 * (dt + dw[0]))]
    }
}

#[test]
fn a_loop_that_paths_leave_is_seen_in_the_count() {
    let step = Step::new(&Constant::new(0.1).unwrap(), 0, 1.0 / 256.0).unwrap();
    let (mut y, mut status) = (Block::splat([0.5, 0.8]), BlockStatus::explicit());
    let dw = Block::splat([0.1]);
    let noise = BlockNoise::increments(&dw.0);
    Sexp.step_block(&Impatient, &step, &noise, &mut y, &mut status);
    assert!(y.0[0][31] != 0.5);
    let sets = [(Simd::Avx2, "_avx2_version", 1), (Simd::Avx512, "up_to_avx512_avx512", 2)];
    let built = sets.into_iter().filter(|(level, ..)| Simd::BUILT.contains(level));
    for (_, instruction_set, vector) in built {
        let Some(versions) = versions(instruction_set) else {
            println!("skipped: this binary has no symbols to find its kernels by");
            return;
        };
        assert!(!versions.is_empty(), "no kernel for {instruction_set} in this binary");
        for version in &versions {
            let share = version.whole.share(vector);
            println!("{instruction_set}: {share:.2} on full vectors of {version:?}");
            // Far from the 198 that `tests/vectorised.rs` asks for: what is left on vectors is the
            // damping after the solver.
            assert!(
                version.heaviest_loops[vector].packed[vector] < 80,
                "{instruction_set}: {version:?}"
            );
        }
    }
}
