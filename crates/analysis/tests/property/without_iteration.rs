//! z = y + B((y+z)/2)v keeps quadratic Casimirs for every v, and has a solution for every v where
//! one of them is definite; `split` keeps the Casimirs of the paper's systems for every increment.
//!
//! Tolerances of the linear equation are those of [`Bounded`] numbers in the same formula.

use noise::Noise;
use proptest::array::uniform;
use proptest::prelude::*;
use proptest::test_runner::TestCaseResult;
use real::Real;
use schemes::{Scheme, SexpLi, Split, Step};
use systems::{
    Flows, InvariantKind, Linearity, MaxwellBloch, PoissonSystem, RigidBody, always_solvable,
    linearity,
};

use crate::affine::{Affine, Algebra, affine};
use crate::damping::{Rate, any_rate};
use crate::law::Conserved;
use crate::random::{Largest, for_all, share, state};
use crate::rounding::Bounded;
use crate::structure::{Base, Casimir, Scale, Structure, symmetric_matrix, vector};

const CASES: u32 = 500;
/// Bounds are worst cases.
const SHARP: f64 = 0.01;
/// A mistake is visible where the defect is this many times its bound.
const VISIBLE: f64 = 1000.0;
/// The share of draws in which a mistake must be visible; in the others v is close to zero or to
/// what the mistake does not change.
const MOST: f64 = 0.8;

/// v of sizes from 0.01 to 100.
fn any_v<const D: usize>() -> impl Strategy<Value = [f64; D]> {
    (vector::<D>(1.0), -2.0..2.0f64).prop_map(|(v, size)| v.map(|x| x * 10f64.powf(size)))
}

fn bounded<const D: usize>(x: [f64; D]) -> [Bounded; D] {
    x.map(Bounded::exact)
}

/// C(z) − C(y).
fn change<const D: usize>(
    system: &Affine<D>,
    index: usize,
    y: [Bounded; D],
    z: [Bounded; D],
) -> Bounded {
    system.casimir(index, z) - system.casimir(index, y)
}

fn casimirs_are_kept<const D: usize>(algebra: Algebra) {
    let largest = Largest::default();
    for_all(CASES, (affine(algebra), state(), any_v()), |(system, y, v): (Affine<D>, _, _)| {
        prop_assert_eq!(linearity(&system, y), Linearity::Affine);
        let (y, v) = (bounded(y), bounded(v));
        let z = system.cayley(y, v);
        // An indefinite Casimir may have a singular equation, next to which nothing is bounded.
        prop_assume!(z.iter().all(|x| x.error < 1e-3 * (1.0 + x.value.abs())));
        for index in 0..system.casimirs() {
            let defect = change(&system, index, y, z);
            largest.check(defect.value.abs(), defect.error)?;
        }
        Ok(())
    });
    largest.report(&format!("linear equation, {algebra:?}, D = {D}"), SHARP);
}

#[test]
fn the_linear_equation_keeps_quadratic_casimirs_for_every_v() {
    casimirs_are_kept::<3>(Algebra::Rotations);
    casimirs_are_kept::<5>(Algebra::Rotations);
    casimirs_are_kept::<6>(Algebra::Rotations);
    casimirs_are_kept::<6>(Algebra::Motions);
}

/// det(I − ½A(v)) by elimination without pivoting.
fn determinant<const D: usize>(system: &Affine<D>, v: [f64; D]) -> Bounded {
    let v = bounded(v);
    let constant = system.structure(bounded([0.0; D]), v);
    let mut columns: [[Bounded; D]; D] = std::array::from_fn(|j| {
        let unit = std::array::from_fn(|i| Bounded::exact(f64::from(u8::from(i == j))));
        let column = system.structure(unit, v);
        std::array::from_fn(|i| unit[i] - (column[i] - constant[i]) * 0.5)
    });
    let mut determinant = Bounded::exact(1.0);
    for k in 0..D {
        let pivot = columns[k];
        determinant = determinant * pivot[k];
        for column in &mut columns[k + 1..] {
            let factor = column[k] / pivot[k];
            for i in k..D {
                column[i] = column[i] - factor * pivot[i];
            }
        }
    }
    determinant
}

fn every_step_is_solvable<const D: usize>() {
    for_all(CASES, (affine(Algebra::Rotations), any_v()), |(system, v): (Affine<D>, _)| {
        let determinant = determinant(&system, v);
        prop_assert!(determinant.value >= 1.0 - determinant.error, "{determinant:?}");
        prop_assert!(always_solvable(&system, [1.0; D]));
        Ok(())
    });
}

#[test]
fn a_definite_casimir_makes_every_step_solvable() {
    every_step_is_solvable::<3>();
    every_step_is_solvable::<5>();
    every_step_is_solvable::<6>();
}

/// y, v ↦ z.
type Map<const D: usize> = fn(&Affine<D>, [Bounded; D], [Bounded; D]) -> [Bounded; D];

/// The share of draws in which a Casimir visibly changes.
fn changes<const D: usize>(map: Map<D>, spoilt: f64) -> f64 {
    share(CASES, (affine(Algebra::Rotations), state(), any_v()), |(system, y, v)| {
        let (mut system, y, v) = (system, bounded(y), bounded(v));
        system.spoilt = spoilt;
        let defect = change(&system, 0, y, map(&system, y, v));
        defect.value.abs() > VISIBLE * defect.error
    })
}

#[test]
fn wrong_linear_equations_are_noticed() {
    const RIGHT: Map<5> = |system, y, v| system.cayley(y, v);
    let sign: Map<5> = |system, y, v| {
        let back = system.cayley(y, v.map(|x| -x));
        std::array::from_fn(|i| y[i] * 2.0 - back[i])
    };
    let old: Map<5> = |system, y, v| {
        let field = system.structure(y, v);
        std::array::from_fn(|i| y[i] + field[i])
    };
    let shares = [changes(sign, 0.0), changes(old, 0.0), changes(RIGHT, 1e-3)];
    println!("sign, old B, B not skew: visible in {shares:?} of the draws");
    assert!(shares.iter().all(|share| *share > MOST), "{shares:?}");
    assert_eq!(changes(RIGHT, 0.0), 0.0);
}

/// v × ∇C with C = ½yᵀQy, and any h: `sexp-li` with damping, for increments of all sizes.
#[derive(Clone, Copy, Debug)]
struct Turned {
    structure: Structure<3>,
    drift: [f64; 3],
    noise: [f64; 3],
}

impl PoissonSystem<3, 1> for Turned {
    fn name(&self) -> &'static str {
        "turned"
    }
    fn structure<R: Real>(&self, y: [R; 3], v: [R; 3]) -> [R; 3] {
        self.structure.apply(y, v)
    }
    fn energy<R: Real>(&self, y: [R; 3], dt: f64, dw: [f64; 1]) -> R {
        let along = |w: [f64; 3]| y[0] * w[0] + y[1] * w[1] + y[2] * w[2];
        along(self.drift).sin() * dt + along(self.noise) * along(self.noise) * (0.5 * dw[0])
    }
}

#[test]
fn sexp_li_keeps_random_casimirs() {
    let largest = Largest::default();
    let systems = (symmetric_matrix(), vector(1.0), vector(1.0)).prop_map(|(q, drift, noise)| {
        let base = Base::Cross(Casimir::Quadratic(q));
        Turned { structure: Structure { scale: Scale::One, base }, drift, noise }
    });
    let draws = (systems, any_rate(), 0..50u64, (-3.0..0.0f64, -3.0..3.0f64), state());
    for_all(CASES, draws, |(system, rate, n, (tau, size), y)| {
        let (tau, dw) = (10f64.powf(tau), [size.powi(3)]);
        let step = Step::new(rate.damping().as_ref(), n, tau).unwrap();
        let scheme = SexpLi::new(&system, y).unwrap();
        let solution = scheme.step(&system, &step, &Noise::increments(dw), y);
        // The same equation with error bounds. v is that of the scheme up to rounding, and the
        // Casimir does not depend on it.
        let start = y.map(|x| x * step.first_decay);
        let field: [f64; 3] = system.structure(start, system.gradient(start, tau, dw));
        let middle: [f64; 3] = std::array::from_fn(|i| start[i] + 0.5 * field[i]);
        let gradient: [f64; 3] = system.gradient(middle, tau, dw);
        let far: [f64; 3] = system.structure(middle, gradient);
        let v =
            system.averaged_gradient(start, std::array::from_fn(|i| start[i] + far[i]), tau, dw);
        let z = system.cayley(bounded(start), bounded(v));
        prop_assume!(z.iter().all(|x| x.error < 1e-3 * (1.0 + x.value.abs())));
        prop_assert!(solution.outcome.converged());
        let casimir = system.structure.base.casimir().unwrap();
        let value = |y: [Bounded; 3]| casimir.value(y);
        let decay = Bounded {
            error: f64::EPSILON * step.second_decay,
            ..Bounded::exact(step.second_decay)
        };
        let end = value(z.map(|x| x * decay));
        let law = value(bounded(start)) * decay * decay;
        let defect = value(bounded(solution.z)) - law;
        largest.check(defect.value.abs(), defect.error + 2.0 * end.error)
    });
    largest.report("sexp-li, random quadratic Casimirs", SHARP);
}

/// Units of ε that a rotation by Cayley's map and the damping of a step change |y|² by at most: see
/// `rounding` of the hard cases of `verify`.
const ROTATION: f64 = 28.0;
const DAMPING: f64 = 6.0;

/// `split` on a random system with any increments: every quadratic Casimir changes by its law.
fn flows_keep<S: Flows<D, M> + std::fmt::Debug, const D: usize, const M: usize>(
    what: &str,
    systems: impl Strategy<Value = S>,
) {
    let largest = Largest::default();
    let draws = (systems, any_rate(), 0..50u64, -3.0..0.0f64, uniform(-3.0..3.0f64), state());
    let check = |(system, rate, n, tau, sizes, y): (S, Rate, _, _, [f64; M], _)| {
        let step = Step::new(rate.damping().as_ref(), n, 10f64.powf(tau)).unwrap();
        // Up to 27.
        let noise = Noise::increments(sizes.map(|size| size.powi(3)));
        let z = Split.step(&system, &step, &noise, y).z;
        let flows = (2 * S::PARTS - 1) as f64;
        let allowed = (flows * ROTATION + DAMPING + 4.0) * f64::EPSILON;
        let mut result: TestCaseResult = Ok(());
        for (index, invariant) in system.invariants().iter().enumerate() {
            if invariant.kind == InvariantKind::Casimir {
                let law = (-invariant.degree * step.damping_integral()).exp();
                let quotient: f64 = system.invariant(index, z) / (law * system.invariant(index, y));
                result = result.and(largest.check((quotient - 1.0).abs(), allowed));
            }
        }
        result
    };
    for_all(CASES, draws, check);
    largest.report(&format!("split, {what}"), SHARP);
}

#[test]
fn split_keeps_the_casimirs_of_random_bodies_for_every_increment() {
    let moments = || uniform(0.2..3.0f64);
    let bodies = (moments(), moments())
        .prop_map(|(drift, noise)| RigidBody::three_noises(drift, noise).unwrap());
    flows_keep::<_, 3, 3>("rigid body", bodies);
    flows_keep::<_, 3, 1>("Maxwell–Bloch", Just(MaxwellBloch));
}
