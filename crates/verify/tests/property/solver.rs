//! What the solver and the block must not change: Newton = fixed point, block = paths, scaling.

use std::cell::Cell;

use nonlin::{BlockStatus, Method, Outcome, Solution, Solver};
use proptest::array::uniform;
use proptest::prelude::*;
use proptest::test_runner::TestCaseResult;
use real::{Block, WIDTH};
use schemes::{EulerMaruyama, Midpoint, Scheme, Sexp, Step};
use systems::PoissonSystem;

use crate::damping::{Rate, any_rate};
use crate::hamiltonian::MAX_DEGREE;
use crate::law::{SexpMap, columns, norm, residual, solver_leaves};
use crate::random::{Largest, Noise, OneNoise, Several, any_noise, for_all, one_noise, several, state};
use crate::structure::{any_structure, homogeneous};

const METHODS: [Method; 2] = [Method::FixedPoint, Method::Newton];

const CASES: u32 = 500;
/// Two solutions are compared where ‖ψ′‖₁ is below this at both: then they are on one branch.
const CONTRACTION: f64 = 0.5;
/// At least this share of the draws contracts.
const CONTRACTING: f64 = 0.5;
/// The bound is the sum of two worst cases, one of them the rarest of the fixed point.
const SHARP: f64 = 1e-3;

fn newton_is_fixed_point<const D: usize>() {
    let (largest, compared) = (Largest::default(), Cell::new(0));
    let draws = (several(any_structure()), any_noise(), state());
    for_all(CASES, draws, |(system, noise, before): (Several<D, 2>, Noise<2, 1>, _)| {
        let [dw] = noise.dw;
        let step = Step::new(Rate::Constant(0.0).damping().as_ref(), 0, noise.tau).unwrap();
        let map = SexpMap { system: &system, tau: noise.tau, dw, before };
        let mut allowed = 0.0;
        let solutions = METHODS.map(|method| {
            let z = Sexp { solver: Solver::new(method) }.step(&system, &step, dw, before).z;
            let contraction = columns(&map, z).map(norm).into_iter().fold(0.0, f64::max);
            // z − z* = (I − ψ′)⁻¹r up to second order, which the factor 2 has room for.
            let (_, residual) = residual(&map, before, z, solver_leaves(method));
            allowed += if contraction < CONTRACTION { 2.0 * residual / (1.0 - contraction) } else { f64::NAN };
            z
        });
        if allowed.is_nan() {
            return Ok(());
        }
        compared.set(compared.get() + 1);
        let [one, other] = solutions;
        largest.check(norm(std::array::from_fn::<_, D, _>(|i| one[i] - other[i])), allowed)
    });
    println!("Newton and fixed point, D = {D}: {} of {CASES} compared", compared.get());
    assert!(f64::from(compared.get()) >= CONTRACTING * f64::from(CASES));
    largest.report(&format!("Newton and fixed point, D = {D}"), SHARP);
}

#[test]
fn newton_and_the_fixed_point_agree() {
    newton_is_fixed_point::<2>();
    newton_is_fixed_point::<3>();
    newton_is_fixed_point::<4>();
    newton_is_fixed_point::<5>();
}

fn bits<const D: usize>(z: [f64; D]) -> [u64; D] {
    // Sign and payload of a NaN are not specified.
    z.map(|x| if x.is_nan() { f64::NAN } else { x }.to_bits())
}

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
        scheme.step_block(system, step, dw, &mut block, &mut status);
        for p in 0..WIDTH {
            let Solution { z, outcome } = scheme.step(system, step, dw.path(p), y.path(p));
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
}

const BLOCKS: u32 = 12;

fn block_is_its_paths<const D: usize, const M: usize>(ways: &Ways) {
    let paths = (uniform::<_, WIDTH>(state()), any_noise::<M, WIDTH>());
    let draws = (several(any_structure()), any_rate(), paths);
    for_all(BLOCKS, draws, |(system, rate, (states, noise)): (Several<D, M>, _, _)| {
        let step = Step::new(rate.damping().as_ref(), 7, noise.tau).unwrap();
        let (mut y, mut dw) = (Block::zero(), Block::zero());
        for p in 0..WIDTH {
            // Larger ones on some paths, so that the robust method has work.
            let factor = if p % 8 == 5 { 8.0 } else { 1.0 };
            y.set_path(p, states[p]);
            dw.set_path(p, noise.dw[p].map(|x| factor * x));
        }
        ways.same_bits(&EulerMaruyama, &system, &step, &dw, &y)?;
        for solver in METHODS.map(Solver::new) {
            ways.same_bits(&Sexp { solver }, &system, &step, &dw, &y)?;
            ways.same_bits(&Midpoint { solver }, &system, &step, &dw, &y)?;
        }
        Ok(())
    });
}

#[test]
fn a_block_is_its_paths_for_random_systems() {
    let ways = Ways::default();
    block_is_its_paths::<2, 1>(&ways);
    block_is_its_paths::<3, 3>(&ways);
    block_is_its_paths::<5, 2>(&ways);
    let [fast, robust, failed] = ways.0.map(Cell::into_inner);
    println!("paths: {fast} fast, {robust} robust, {failed} failed");
    assert!(fast > 1000 && robust > 20 && failed > 5, "{fast} {robust} {failed}");
}

/// With B of degree b and h of degree p, 2ᵏz solves the equation for 2ᵏẑ and increments times 2^{−k(b+p−2)}. A power of
/// two changes no digit, so the bits agree, whichever way the equation goes.
fn scaling<const D: usize>() {
    let draws = (one_noise(homogeneous(), 1..=MAX_DEGREE), any_rate(), any_noise(), state(), -40..40i32);
    for_all(CASES, draws, |(system, rate, noise, y0, k): (OneNoise<D>, _, Noise<1, 1>, _, _)| {
        let [[dw]] = noise.dw;
        let step = Step::new(rate.damping().as_ref(), 3, noise.tau).unwrap();
        let degree = system.structure.base.degree() + system.hamiltonian.degree as i32;
        let (size, increment) = (2f64.powi(k), 2f64.powi(-k * (degree - 2)));
        let scaled = Step { tau: increment * step.tau, ..step };
        for solver in METHODS.map(Solver::new) {
            let sexp = Sexp { solver };
            let one = sexp.step(&system, &step, [dw], y0);
            let other = sexp.step(&system, &scaled, [increment * dw], y0.map(|x| size * x));
            prop_assert_eq!(bits(one.z.map(|x| size * x)), bits(other.z), "{:?} {:?}", one, other);
        }
        Ok(())
    });
}

#[test]
fn steps_scale_with_homogeneous_systems() {
    scaling::<2>();
    scaling::<3>();
    scaling::<4>();
    scaling::<5>();
}
