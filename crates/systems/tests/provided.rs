//! Closed forms agree with what the trait provides from B and h alone.

mod common;

use common::{Check, Numbers, Region, dot, every_system};
use real::Real;
use systems::{IntegerExponents, LotkaVolterra, Pendulum, Poisson3, PoissonSystem};

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

/// Powers up to the ninth by dual numbers and by closed forms, some through e^{p ln y}: a few tens
/// of roundings of terms that are all of the size of the largest component.
const ROUND_OFF: f64 = 64.0 * f64::EPSILON;

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
                let column = system.structure(dgrad::midpoint(a, b), unit);
                entry = column.iter().fold(entry, |m: f64, x| m.max(x.abs()));
            }
            for i in 0..D {
                assert!(
                    (field[i] - composed[i]).abs() < ROUND_OFF * largest * entry,
                    "{name} from {a:?} to {b:?}: {field:?} {composed:?}"
                );
            }

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

/// What a system solves itself is a solution within its bound, from short steps to steps that it
/// declines.
struct ShortSteps {
    solved: usize,
}

impl Check for ShortSteps {
    fn check<S: PoissonSystem<D, M>, const D: usize, const M: usize>(
        &mut self,
        system: &S,
        region: Region,
    ) {
        let mut numbers = Numbers(9);
        for n in 0..4000 {
            let a: [f64; D] = region.point(&mut numbers);
            // Four sizes of steps, the largest beyond what is declined. Populations of the region
            // are larger than those of the paper, and their steps that much longer.
            let scale = if region == Region::Positive { 0.25 } else { 1.0 };
            let size = scale * [1e-3, 0.03, 0.3, 3.0][n % 4];
            let (dt, dw): (f64, [f64; M]) =
                (size * numbers.next().abs(), numbers.vector().map(|w| size * w));
            let (b, bound) = system.short_step(a, dt, dw);
            let (other_a, other_dw) =
                (region.point(&mut numbers), numbers.vector().map(|w| size * w));
            // Two in turn are each of them alone, to the bit; sign and payload of a NaN are not
            // specified.
            let alone = [(b, bound), system.short_step(other_a, dt, other_dw)];
            for (one, of_pair) in
                alone.into_iter().zip(system.short_steps([a, other_a], dt, [dw, other_dw]))
            {
                let bits = |x: f64| if x.is_nan() { f64::NAN } else { x }.to_bits();
                assert_eq!(one.0.map(bits), of_pair.0.map(bits), "{}", system.name());
                assert_eq!(bits(one.1), bits(of_pair.1), "{}", system.name());
            }
            if !S::SOLVES_SHORT_STEPS {
                assert!(b == a && bound == f64::INFINITY, "{}", system.name());
                continue;
            }
            self.solved += 1;
            let sum = |v: [f64; D]| v.iter().map(|x| x.abs()).sum::<f64>();
            if size <= 0.03 {
                assert!(
                    bound <= 2.0 * f64::EPSILON * sum(b),
                    "{}: {bound:e} at {dt} {dw:?}",
                    system.name()
                );
            }
            if bound < f64::INFINITY {
                let field = system.averaged_field(a, b, dt, dw);
                let left = sum(std::array::from_fn(|i| b[i] - a[i] - field[i]));
                // Half an ulp for each of a dozen roundings.
                assert!(
                    left <= bound + 6.0 * f64::EPSILON * (sum(a) + sum(b)),
                    "{}: {left:e} {bound:e}",
                    system.name()
                );
            }
        }
    }
}

#[test]
fn short_steps_are_solved_within_their_bound() {
    let mut check = ShortSteps { solved: 0 };
    every_system(&mut check);
    assert!(check.solved > 0);
}

/// A step whose solution is not unique, or too long for the polynomials, is declined.
#[test]
fn long_steps_are_declined() {
    let declined = |bound: f64| bound == f64::INFINITY || bound.is_nan();
    for dt in [1.0, -1.0, 10.0, 1e300, f64::INFINITY, f64::NAN] {
        assert!(declined(Pendulum::new(1.0).unwrap().short_step([0.5, 1.0], dt, [0.0]).1), "{dt}");
        assert!(
            declined(Poisson3::new(1.0).unwrap().short_step([0.5, 1.0, 2.0], dt, [0.0]).1),
            "{dt}"
        );
    }
    let populations = LotkaVolterra::<IntegerExponents<2, 2>>::integer(1.0).unwrap();
    for dt in [1.0, -1.0, 10.0, 1e300, f64::INFINITY, f64::NAN] {
        assert!(declined(populations.short_step([0.2, 0.4, 0.6], dt, [0.0]).1), "{dt}");
    }
    // A population that becomes more than twice as large, by a weight that is not too long.
    assert!(declined(populations.short_step([0.001, 0.001, 1.0], 0.4, [0.0]).1));
    assert!(populations.short_step([0.001, 0.001, 1.0], 0.2, [0.0]).1 < 1e-12);
    assert!(declined(populations.short_step([0.2, -0.4, 0.6], 0.1, [0.0]).1));
    assert!(declined(Pendulum::new(1.0).unwrap().short_step([100.0, 1.0], 0.1, [0.0]).1));
    assert!(declined(Poisson3::new(1.0).unwrap().short_step([0.5, 1e7, 2.0], 0.1, [0.0]).1));
}

/// The solution that the system finds is the one on the branch that begins at a: followed in 64
/// steps of the weight by the plain iteration, which contracts as long as no step is declined.
#[test]
fn short_steps_of_populations_stay_on_the_branch() {
    const PIECES: u32 = 64;
    let system = LotkaVolterra::<IntegerExponents<2, 2>>::integer(1.3).unwrap();
    let mut numbers = Numbers(10);
    let (mut accepted, mut longest) = (0, 0.0f64);
    for _ in 0..4000 {
        // From 10⁻² to 1, evenly on a logarithmic scale.
        let a: [f64; 3] = numbers.vector().map(|x: f64| 10f64.powf(x - 1.0));
        let weight = 0.7 * numbers.next() / (2.0 * a[0] + a[1] + a[2]);
        let (b, bound) = system.short_step(a, weight, [0.0]);
        if bound == f64::INFINITY {
            continue;
        }
        accepted += 1;
        longest = longest.max(1.3 * weight.abs() * (2.0 * a[0] + a[1] + a[2]));
        let mut followed = a;
        for piece in 1..=PIECES {
            let part = weight * f64::from(piece) / f64::from(PIECES);
            for _ in 0..200 {
                let field = system.averaged_field(a, followed, part, [0.0]);
                followed = std::array::from_fn(|i| a[i] + field[i]);
            }
        }
        let sum = |v: [f64; 3]| v.iter().map(|x| x.abs()).sum::<f64>();
        let apart = sum(std::array::from_fn(|i| b[i] - followed[i]));
        // Residuals of both, times 1/(1 − L) where the plain iteration contracts by L = ¾, which
        // this asserts as well.
        assert!(
            apart <= 4.0 * (bound + 16.0 * f64::EPSILON * (sum(a) + sum(b))),
            "{a:?} {weight}: {b:?} {followed:?}"
        );
    }
    assert!(accepted > 1000 && longest > 0.4, "{accepted} {longest}");
}

struct EnergyIsLinear;

impl Check for EnergyIsLinear {
    fn check<S: PoissonSystem<D, M>, const D: usize, const M: usize>(
        &mut self,
        system: &S,
        region: Region,
    ) {
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
