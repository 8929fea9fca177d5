//! Closed forms agree with what the trait provides from B and h alone.

use crate::common::{Check, Numbers, Plain, Region, dot, every_system, matrix};
use systems::{ImplicitStep, Pendulum, Poisson3, PoissonSystem};

/// Powers up to the ninth by dual numbers and by closed forms, some through e^{p ln y}: a few tens
/// of roundings of terms that are all of the size of the largest component.
const ROUND_OFF: f64 = 64.0 * f64::EPSILON;

fn close<const D: usize>(name: &str, one: [f64; D], other: [f64; D], allowed: f64) {
    for i in 0..D {
        assert!((one[i] - other[i]).abs() < allowed, "{name}: {one:?} {other:?}");
    }
}

struct ClosedForms;

impl Check for ClosedForms {
    fn check<S: PoissonSystem<D, M>, const D: usize, const M: usize>(
        &mut self,
        system: &S,
        region: Region,
    ) {
        let mut numbers = Numbers(7);
        for n in 0..400 {
            let a: [f64; D] = region.point(&mut numbers);
            // Every fourth pair coincides; the others are as far apart as one step of a scheme may
            // be. Of 8 nodes the error is ρ⁻¹⁶, where the poles of the powers are at least nine
            // half-intervals off the centre, ρ > 17; sines have no pole, and an interval of 0.5
            // leaves 0.25¹⁶/16!.
            let distance = match region {
                Region::Box => 0.5,
                Region::Positive => 0.06,
            };
            let mut b = a;
            for i in 0..D {
                b[i] += distance * f64::from(n % 4) / 3.0 * numbers.next();
            }
            let (dt, dw): (f64, [f64; M]) = (numbers.next(), numbers.vector());
            let name = system.name();

            let closed = system.gradient(a, dt, dw);
            let provided: [f64; D] = Plain(system).gradient(a, dt, dw);
            let weights = dt.abs() + dw.iter().map(|w| w.abs()).sum::<f64>();
            let largest = closed.iter().fold(0.0, |m: f64, x| m.max(x.abs())) + weights;
            close(name, closed, provided, ROUND_OFF * largest);

            let closed = system.averaged_gradient(a, b, dt, dw);
            let provided: [f64; D] = Plain(system).averaged_gradient(a, b, dt, dw);
            close(name, closed, provided, ROUND_OFF * largest);

            let field = system.averaged_field(a, b, dt, dw);
            let composed: [f64; D] = Plain(system).averaged_field(a, b, dt, dw);
            // |B(y)v| is at most the largest entry of B, found column by column, times D|v|.
            let matrix = matrix(system, dgrad::midpoint(a, b));
            let entry = matrix.as_flattened().iter().fold(1.0, |m: f64, x| m.max(x.abs()));
            close(name, field, composed, ROUND_OFF * largest * entry);

            // h is linear in time and noise: three Hamiltonians of up to four terms.
            let terms = std::iter::once(system.energy(a, dt, [0.0; M])).chain((0..M).map(|m| {
                let unit: f64 = system.energy(a, 0.0, systems::unit_noise(m));
                unit * dw[m]
            }));
            let (sum, size) =
                terms.fold((0.0, 0.0), |(sum, size), x: f64| (sum + x, size + x.abs()));
            let whole: f64 = system.energy(a, dt, dw);
            assert!((whole - sum).abs() <= 16.0 * f64::EPSILON * size.max(f64::MIN_POSITIVE));

            // What a discrete gradient is for: ∇̄h·(b − a) = h(b) − h(a).
            let step = std::array::from_fn(|i| b[i] - a[i]);
            let (h_a, h_b): (f64, f64) = (system.energy(a, dt, dw), system.energy(b, dt, dw));
            assert!(
                (dot(closed, step) - (h_b - h_a)).abs()
                    < ROUND_OFF * (h_a.abs() + h_b.abs() + largest),
                "{name}: {}",
                dot(closed, step) - (h_b - h_a)
            );
        }
    }
}

#[test]
fn closed_forms_agree_with_the_provided_ones() {
    every_system(&mut ClosedForms);
}

/// A prediction solves its equation within its bound, from short steps to steps without one.
struct Predictions {
    checked: usize,
}

impl Check for Predictions {
    fn check<S: PoissonSystem<D, M>, const D: usize, const M: usize>(
        &mut self,
        system: &S,
        region: Region,
    ) {
        let mut numbers = Numbers(9);
        for n in 0..4000 {
            let a: [f64; D] = region.point(&mut numbers);
            // Four sizes of steps, the largest beyond what is predicted.
            let size = [1e-3, 0.03, 0.3, 3.0][n % 4];
            let (dt, dw): (f64, [f64; M]) =
                (size * numbers.next().abs(), numbers.vector().map(|w| size * w));
            let (b, bound) = system.predict(a, dt, dw);
            if S::IMPLICIT_STEP != ImplicitStep::Predicted {
                assert!(b == a && bound == f64::INFINITY, "{}", system.name());
                continue;
            }
            self.checked += 1;
            let sum = |v: [f64; D]| v.iter().map(|x| x.abs()).sum::<f64>();
            if size <= 0.03 {
                assert!(bound <= 2.0 * f64::EPSILON * sum(b), "{bound:e} at {dt} {dw:?}");
            }
            if bound < f64::INFINITY {
                let field = system.averaged_field(a, b, dt, dw);
                let residual = sum(std::array::from_fn(|i| b[i] - a[i] - field[i]));
                // Half an ulp for each of a dozen roundings.
                let allowed = bound + 6.0 * f64::EPSILON * (sum(a) + sum(b));
                assert!(residual <= allowed, "{}: {residual:e} {bound:e}", system.name());
            }
        }
    }
}

#[test]
fn predictions_solve_their_equation_within_their_bound() {
    let mut check = Predictions { checked: 0 };
    every_system(&mut check);
    // The pendulum and the Poisson system.
    assert_eq!(check.checked, 2 * 4000);
}

/// A step whose solution is not unique, or too long for the polynomials, has no bound.
#[test]
fn long_steps_are_not_predicted() {
    let unbounded = |bound: f64| bound == f64::INFINITY || bound.is_nan();
    let (pendulum, poisson) = (Pendulum::new(1.0).unwrap(), Poisson3::new(1.0).unwrap());
    for dt in [1.0, -1.0, 10.0, 1e300, f64::INFINITY, f64::NAN] {
        assert!(unbounded(pendulum.predict([0.5, 1.0], dt, [0.0]).1), "{dt}");
        assert!(unbounded(poisson.predict([0.5, 1.0, 2.0], dt, [0.0]).1), "{dt}");
    }
    assert!(unbounded(pendulum.predict([100.0, 1.0], 0.1, [0.0]).1));
    assert!(unbounded(poisson.predict([0.5, 1e7, 2.0], 0.1, [0.0]).1));
}
