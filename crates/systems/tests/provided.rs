//! Closed forms agree with what the trait provides from B and h alone.

mod common;

use common::{Check, Numbers, Region, dot, every_system};
use real::Real;
use systems::{Pendulum, PoissonSystem};

/// A system that says only what must be said.
struct Plain<'a, S>(&'a S);

impl<S: PoissonSystem<D, M>, const D: usize, const M: usize> PoissonSystem<D, M> for Plain<'_, S> {
    fn name(&self) -> &'static str {
        self.0.name()
    }
    fn structure<R: Real>(&self, y: [R; D], v: [R; D]) -> [R; D] {
        self.0.structure(y, v)
    }
    fn energy<R: Real>(&self, y: [R; D], dt: f64, dw: [f64; M]) -> R {
        self.0.energy(y, dt, dw)
    }
}

/// Powers up to the ninth by dual numbers and by closed forms, some through e^{p ln y}: a few tens of roundings of
/// terms that are all of the size of the largest component.
const ROUND_OFF: f64 = 64.0 * f64::EPSILON;

struct ClosedForms;

impl Check for ClosedForms {
    fn check<S: PoissonSystem<D, M>, const D: usize, const M: usize>(&mut self, system: &S, region: Region) {
        let mut numbers = Numbers(7);
        for n in 0..400 {
            let a: [f64; D] = region.point(&mut numbers);
            // Every fourth pair coincides; the others are as far apart as one step of a scheme may be. Of 8 nodes the
            // error is ρ⁻¹⁶, where the poles of the powers are at least nine half-intervals off the centre, ρ > 17;
            // sines have no pole, and an interval of 0.5 leaves 0.25¹⁶/16!.
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
            for i in 0..D {
                assert!(
                    (closed[i] - provided[i]).abs() < ROUND_OFF * largest,
                    "{name} at {a:?}: {closed:?} {provided:?}"
                );
            }

            let closed = system.averaged_gradient(a, b, dt, dw);
            let provided: [f64; D] = Plain(system).averaged_gradient(a, b, dt, dw);
            for i in 0..D {
                assert!(
                    (closed[i] - provided[i]).abs() < ROUND_OFF * largest,
                    "{name} from {a:?} to {b:?}: {closed:?} {provided:?}"
                );
            }

            let field = system.averaged_field(a, b, dt, dw);
            let composed: [f64; D] = Plain(system).averaged_field(a, b, dt, dw);
            // |B(y)v| is at most the largest entry of B, found column by column, times D|v|.
            let mut entry = 1.0;
            for j in 0..D {
                let mut unit = [0.0; D];
                unit[j] = 1.0;
                let column = system.structure(dgrad::quadratic(a, b), unit);
                entry = column.iter().fold(entry, |m: f64, x| m.max(x.abs()));
            }
            for i in 0..D {
                assert!(
                    (field[i] - composed[i]).abs() < ROUND_OFF * largest * entry,
                    "{name} from {a:?} to {b:?}: {field:?} {composed:?}"
                );
            }

            let near = system.averaged_field_near(a, b, dt, dw);
            let (value, slopes) = system.averaged_field_jacobian_near(a, b, dt, dw);
            let (plain, columns) = Plain(system).averaged_field_jacobian_near(a, b, dt, dw);
            let largest_slope = columns.iter().flatten().fold(largest * entry, |m: f64, x| m.max(x.abs()));
            for i in 0..D {
                assert!(
                    (value[i] - near[i]).abs() <= 2.0 * f64::EPSILON * largest * entry,
                    "{name}: {value:?} {near:?}"
                );
                assert!((value[i] - plain[i]).abs() < ROUND_OFF * largest * entry, "{name}: {value:?} {plain:?}");
                for j in 0..D {
                    assert!(
                        (slopes[i][j] - columns[i][j]).abs() < ROUND_OFF * largest_slope,
                        "{name} from {a:?} to {b:?}: {slopes:?} {columns:?}"
                    );
                }
            }

            // A small step leads close to the prediction.
            let small = [1e-3, 1e-4];
            let guess = system.predictor(a, small[0], [small[1]; M]);
            let field = system.averaged_field(a, guess, small[0], [small[1]; M]);
            for i in 0..D {
                let change = field.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
                assert!((a[i] + field[i] - guess[i]).abs() <= 1e-4 * change + 1e-15, "{name}: {guess:?}");
            }

            // What a discrete gradient is for: ∇̄h·(b − a) = h(b) − h(a).
            let step = std::array::from_fn(|i| b[i] - a[i]);
            let (h_a, h_b): (f64, f64) = (system.energy(a, dt, dw), system.energy(b, dt, dw));
            assert!(
                (dot(closed, step) - (h_b - h_a)).abs() < ROUND_OFF * (h_a.abs() + h_b.abs() + largest),
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

struct EnergyIsLinear;

impl Check for EnergyIsLinear {
    fn check<S: PoissonSystem<D, M>, const D: usize, const M: usize>(&mut self, system: &S, region: Region) {
        let mut numbers = Numbers(8);
        for _ in 0..100 {
            let y: [f64; D] = region.point(&mut numbers);
            let (dt, dw): (f64, [f64; M]) = (numbers.next(), numbers.vector());
            let mut sum: f64 = system.energy(y, dt, [0.0; M]);
            let mut terms = sum.abs();
            for m in 0..M {
                let term: f64 = system.energy(y, 0.0, systems::unit_noise(m));
                sum += term * dw[m];
                terms += (term * dw[m]).abs();
            }
            let whole: f64 = system.energy(y, dt, dw);
            // Three Hamiltonians of up to four terms.
            assert!((whole - sum).abs() <= 16.0 * f64::EPSILON * terms.max(f64::MIN_POSITIVE));
        }
    }
}

#[test]
fn the_increment_is_linear_in_time_and_noise() {
    every_system(&mut EnergyIsLinear);
}

#[test]
fn a_plain_system_has_no_invariant_and_no_boundary() {
    let pendulum = Pendulum::new(1.0).unwrap();
    let plain = Plain(&pendulum);
    assert!(PoissonSystem::<2, 1>::invariants(&plain).is_empty());
    assert_eq!(plain.check_domain([-5.0, 0.0]), Ok(()));
}

#[test]
#[should_panic(expected = "pendulum has no invariant number 0")]
fn an_invariant_that_is_not_there() {
    let _: f64 = Pendulum::new(1.0).unwrap().invariant(0, [0.0, 0.0]);
}
