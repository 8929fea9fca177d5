//! A block is its paths bit for bit, on random systems of two kinds: with branches, which no
//! compiler vectorises, and without, which it does.

use std::cell::Cell;

use dgrad::averaged;
use noise::{BlockNoise, Noise};
use nonlin::{BlockStatus, Method, Outcome, Solution, Solver};
use proptest::array::uniform;
use proptest::prelude::*;
use proptest::test_runner::TestCaseResult;
use real::{Block, Real, WIDTH};
use schemes::{EulerMaruyama, Midpoint, Scheme, Sexp, Step, WithSolver};
use systems::{HamiltonianIncrement, PoissonSystem};

use crate::damping::{Rate, any_rate};
use crate::random::{Increments, any_noise, for_all, several, state};
use crate::rounding::dot;
use crate::structure::{Matrix, any_structure, skew, vector};

/// B(y) = Σ yₖCₖ, H₀ = (aᵀy)³, Hₘ = sin(wₘᵀy), as straight-line code.
#[derive(Clone, Copy, Debug)]
struct StraightLine<const D: usize, const M: usize> {
    structure: [Matrix<D>; D],
    drift: [f64; D],
    noise: [[f64; D]; M],
}

impl<const D: usize, const M: usize> PoissonSystem<D, M> for StraightLine<D, M> {
    fn name(&self) -> &'static str {
        "straight line"
    }
    #[inline(always)]
    fn structure<R: Real>(&self, y: [R; D], v: [R; D]) -> [R; D] {
        let mut result = [R::zero(); D];
        for i in 0..D {
            for j in 0..D {
                for k in 0..D {
                    result[i] = result[i] + y[k] * v[j] * self.structure[k][i][j];
                }
            }
        }
        result
    }
    #[inline(always)]
    fn energy<R: Real>(&self, y: [R; D], dt: f64, dw: [f64; M]) -> R {
        let along = dot(self.drift.map(R::constant), y);
        let mut sum = along * along * along * dt;
        for m in 0..M {
            sum = sum + dot(self.noise[m].map(R::constant), y).sin() * dw[m];
        }
        sum
    }
    #[inline(always)]
    fn averaged_gradient<R: Real>(&self, a: [R; D], b: [R; D], dt: f64, dw: [f64; M]) -> [R; D] {
        averaged::<2, R, _, D>(&HamiltonianIncrement { system: self, dt, dw }, a, b)
    }
}

fn straight_line<const D: usize, const M: usize>() -> impl Strategy<Value = StraightLine<D, M>> {
    (uniform(skew()), vector(1.0), uniform(vector(1.5)))
        .prop_map(|(structure, drift, noise)| StraightLine { structure, drift, noise })
}

fn bits<const D: usize>(z: [f64; D]) -> [u64; D] {
    // Sign and payload of a NaN are not specified.
    z.map(|x| if x.is_nan() { f64::NAN } else { x }.to_bits())
}

const BLOCKS: u32 = 16;

/// Paths that were solved at once, by the robust method, and not at all.
#[derive(Default)]
struct Ways([Cell<u32>; 3]);

impl Ways {
    fn same_bits<C: Scheme<S, D, M>, S: PoissonSystem<D, M>, const D: usize, const M: usize>(
        &self,
        scheme: &C,
        system: &S,
        step: &Step,
        dw: &Block<M>,
        y: &Block<D>,
    ) -> TestCaseResult {
        let (mut block, mut status) = (*y, BlockStatus::explicit());
        let noise = BlockNoise::increments(&dw.0);
        scheme.step_block(system, step, &noise, &mut block, &mut status);
        for p in 0..WIDTH {
            let Solution { z, outcome } =
                scheme.step(system, step, &Noise::increments(dw.path(p)), y.path(p));
            prop_assert_eq!(bits(block.path(p)), bits(z), "{} path {}", scheme.id(), p);
            prop_assert_eq!(status.failed.contains(p), !outcome.converged());
            prop_assert_eq!(status.robust.contains(p), matches!(outcome, Outcome::Robust { .. }));
            let way = match outcome {
                Outcome::Fast { .. } => 0,
                Outcome::Robust { .. } => 1,
                Outcome::Failed { .. } => 2,
            };
            self.0[way].set(self.0[way].get() + 1);
        }
        Ok(())
    }

    fn of<S: PoissonSystem<D, M> + std::fmt::Debug, const D: usize, const M: usize>(
        &self,
        systems: impl Strategy<Value = S>,
    ) {
        let draws = (systems, any_rate(), uniform::<_, WIDTH>(state()), any_noise());
        for_all(
            BLOCKS,
            draws,
            |(system, rate, states, noise): (S, Rate, [[f64; D]; WIDTH], Increments<M, WIDTH>)| {
                let step = Step::new(rate.damping().as_ref(), 7, noise.tau).unwrap();
                let (mut y, mut dw) = (Block::zero(), Block::zero());
                for p in 0..WIDTH {
                    // Larger ones on some paths, so that the robust method has work.
                    let factor = if p % 8 == 5 { 8.0 } else { 1.0 };
                    y.set_path(p, states[p]);
                    dw.set_path(p, noise.dw[p].map(|x| factor * x));
                }
                self.same_bits(&EulerMaruyama, &system, &step, &dw, &y)?;
                for solver in [Method::FixedPoint, Method::Newton].map(Solver::new) {
                    self.same_bits(&WithSolver { formula: Sexp, solver }, &system, &step, &dw, &y)?;
                    self.same_bits(
                        &WithSolver { formula: Midpoint, solver },
                        &system,
                        &step,
                        &dw,
                        &y,
                    )?;
                }
                Ok(())
            },
        );
    }
}

#[test]
fn a_block_is_its_paths_for_random_systems() {
    let ways = Ways::default();
    ways.of(several::<2, 1>(any_structure()));
    ways.of(several::<5, 3>(any_structure()));
    ways.of(straight_line::<3, 2>());
    let [fast, robust, failed] = ways.0.map(Cell::into_inner);
    println!("paths: {fast} fast, {robust} robust, {failed} failed");
    assert!(fast > 1000 && robust > 20 && failed > 5, "{fast} {robust} {failed}");
}
