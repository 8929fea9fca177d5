//! What the solver must not change: Newton = fixed point, and scaling.

use std::cell::Cell;

use noise::Noise;
use nonlin::{Method, Solver};
use proptest::prelude::*;
use schemes::{Scheme, Sexp, Step, WithSolver};

use crate::damping::{Rate, any_rate};
use crate::hamiltonian::MAX_DEGREE;
use crate::law::{SexpMap, columns, norm, residual, solver_leaves};
use crate::random::{
    Increments, Largest, OneNoise, Several, any_noise, for_all, one_noise, several, state,
};
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
    for_all(CASES, draws, |(system, noise, before): (Several<D, 2>, Increments<2, 1>, _)| {
        let [dw] = noise.dw;
        let step = Step::new(Rate::Constant(0.0).damping().as_ref(), 0, noise.tau).unwrap();
        let map = SexpMap { system: &system, tau: noise.tau, dw, before };
        let mut allowed = 0.0;
        let solutions = METHODS.map(|method| {
            let z = WithSolver { formula: Sexp, solver: Solver::new(method) }
                .step(&system, &step, &Noise::increments(dw), before)
                .z;
            let contraction = columns(&map, z).map(norm).into_iter().fold(0.0, f64::max);
            // z − z* = (I − ψ′)⁻¹r up to second order, which the factor 2 has room for.
            let (_, residual) = residual(&map, before, z, solver_leaves(method));
            allowed += if contraction < CONTRACTION {
                2.0 * residual / (1.0 - contraction)
            } else {
                f64::NAN
            };
            z
        });
        if allowed.is_nan() {
            return Ok(());
        }
        compared.set(compared.get() + 1);
        let [one, other] = solutions;
        largest.check(norm::<D>(std::array::from_fn(|i| one[i] - other[i])), allowed)
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

/// With B of degree b and h of degree p, 2ᵏz solves the equation for 2ᵏẑ and increments times
/// 2^{−k(b+p−2)}. A power of two changes no digit, so the bits agree, whichever way the equation
/// goes.
fn scaling<const D: usize>() {
    let draws =
        (one_noise(homogeneous(), 1..=MAX_DEGREE), any_rate(), any_noise(), state(), -40..40i32);
    for_all(
        CASES,
        draws,
        |(system, rate, noise, y0, k): (OneNoise<D>, _, Increments<1, 1>, _, _)| {
            let [[dw]] = noise.dw;
            let step = Step::new(rate.damping().as_ref(), 3, noise.tau).unwrap();
            let degree = system.structure.base.degree() + system.hamiltonian.degree as i32;
            let (size, increment) = (2f64.powi(k), 2f64.powi(-k * (degree - 2)));
            let mut scaled = step;
            scaled.tau *= increment;
            for solver in METHODS.map(Solver::new) {
                let sexp = WithSolver { formula: Sexp, solver };
                let one = sexp.step(&system, &step, &Noise::increments([dw]), y0);
                let other = sexp.step(
                    &system,
                    &scaled,
                    &Noise::increments([increment * dw]),
                    y0.map(|x| size * x),
                );
                prop_assert_eq!(one.z.map(|x| size * x), other.z, "{:?} {:?}", one, other);
            }
            Ok(())
        },
    );
}

#[test]
fn steps_scale_with_homogeneous_systems() {
    scaling::<2>();
    scaling::<3>();
    scaling::<4>();
    scaling::<5>();
}
