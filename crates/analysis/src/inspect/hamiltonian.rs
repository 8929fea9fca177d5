//! The Hamiltonians, and whether the methods that a system overrides agree with its energy.

use real::{Bounded, Degree};
use serde::Serialize;

use super::{
    algebra::{dot, norm, size, times, values},
    erased::System,
    finding::Finding,
    function::Shape,
    points::{Points, Purpose, Random},
};

/// The Hamiltonians H₀, …, H_M and the methods that follow from them.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Hamiltonians {
    /// h(y; dt, dw) is linear in (dt, dw).
    pub linear: Finding,
    /// H₀, H₁, …, H_M.
    pub shapes: Vec<Shape>,
    /// c, if there is one noise and H₁ = cH₀ up to a constant: such a system has an energy law. 0
    /// if there is no noise.
    pub noise_size: Option<f64>,
    /// ∇Hₘ = cₘ∇H₀ for every m.
    pub proportional: Option<Finding>,
    /// `gradient` is ∇h.
    pub gradient: Finding,
    /// `averaged_gradient(y, y)` is ∇h(y).
    pub averaged_gradient: Finding,
    /// ∇̄h(a, b)·(b − a) = h(b) − h(a), for points a tenth of the region apart.
    pub discrete_gradient: Finding,
    /// The largest defect of that relative to ‖∇̄h‖‖b − a‖: the relative error of the quadrature.
    pub quadrature_error: f64,
    /// `averaged_field(a, b)` is B((a+b)/2)∇̄h(a, b).
    pub averaged_field: Finding,
    /// The residual ‖b − a − `averaged_field(a, b)`‖₁ of the predicted end b of an implicit step is
    /// at most the bound given with it, where that is finite.
    pub prediction: Finding,
}

/// Distance of the two points of a discrete gradient, relative to that of two random points.
const APART: f64 = 0.1;
/// Halvings of that distance until both are in the domain.
const HALVINGS: i32 = 40;

/// Step sizes of the predictions, from very short steps to ones that contract badly.
const PREDICTED_STEPS: [f64; 4] = [1e-3, 0.01, 0.1, 0.5];

impl Hamiltonians {
    pub(super) fn of(system: &dyn System, points: &Points) -> Self {
        let shape = |m| Shape::of(&*system.hamiltonian(m), system, points);
        let shapes = (0..=system.noises()).map(shape).collect();
        let (noise_size, proportional) = noise_size(system, points);
        let mut found = Self { shapes, noise_size, proportional, ..Self::default() };
        let mut random = Random::new(Purpose::Weights);
        let points = &points.for_identities;
        for (n, y) in points.iter().enumerate() {
            let weights: Vec<f64> = (0..=system.noises()).map(|_| random.uniform()).collect();
            found.check_energy(system, &weights, y);
            let other = &points[(n + 1) % points.len()];
            let near = |halvings| -> Vec<f64> {
                let share = APART * f64::powi(0.5, halvings);
                y.iter().zip(other).map(|(a, b)| a + share * (b - a)).collect()
            };
            if let Some(b) = (0..HALVINGS).map(near).find(|b| system.in_domain(b)) {
                found.check_averages(system, &weights, y, &b);
            }
            let size = PREDICTED_STEPS[n % PREDICTED_STEPS.len()];
            let weights: Vec<f64> = weights.iter().map(|w| w * size).collect();
            found.check_prediction(system, &weights, y);
        }
        found
    }

    fn check_energy(&mut self, system: &dyn System, weights: &[f64], y: &[f64]) {
        let (mut sum, mut size) = (Bounded::exact(0.0), 0.0);
        for (m, &weight) in weights.iter().enumerate() {
            let term = system.hamiltonian(m).value(y) * Bounded::exact(weight);
            sum = sum + term;
            size += term.value.abs();
        }
        let energy = system.energy(weights);
        let value = energy.value(y);
        self.linear.record(value - sum, size + value.value.abs(), y);
        let exact = energy.gradient(y);
        self.gradient.compare(&system.gradient(y, weights), &exact, y);
        let [averaged, _] = system.averages(y, y, weights);
        self.averaged_gradient.compare(&averaged, &exact, y);
    }

    fn check_averages(&mut self, system: &dyn System, weights: &[f64], a: &[f64], b: &[f64]) {
        let [mean, field] = system.averages(a, b, weights);
        let variable = |x: &f64| Bounded::variable(*x);
        let (from, to): (Vec<_>, Vec<_>) =
            (a.iter().map(variable).collect(), b.iter().map(variable).collect());
        let step: Vec<_> = to.iter().zip(&from).map(|(&b, &a)| b - a).collect();
        let energy = system.energy(weights);
        let defect = dot(&mean, &step) - (energy.value(b) - energy.value(a));
        self.discrete_gradient.record(defect, size(&mean, &step), a);
        let relative = defect.value.abs() / (norm(&values(&mean)) * norm(&values(&step)));
        if relative > self.quadrature_error {
            self.quadrature_error = relative;
        }

        let middle: Vec<f64> = b.iter().zip(a).map(|(b, a)| 0.5 * (a + b)).collect();
        let expected = times(&system.matrix(&middle), &mean);
        self.averaged_field.compare(&field, &expected, a);
    }

    fn check_prediction(&mut self, system: &dyn System, weights: &[f64], a: &[f64]) {
        let (b, bound) = system.predict(a, weights);
        if bound < f64::INFINITY {
            let [_, field] = system.averages(a, &b, weights);
            let residual = (0..a.len()).fold(Bounded::exact(0.0), |sum, i| {
                sum + (Bounded::variable(b[i]) - Bounded::variable(a[i]) - field[i]).abs()
            });
            let excess = (residual.value - bound).max(0.0);
            // Larger than the bound it may be by its own rounding and by that of the prediction.
            let error = residual.error + f64::EPSILON * norm(a);
            let excess = Bounded { value: excess, error, degree: Degree::NONE };
            self.prediction.record(excess, norm(a) + norm(&b), a);
        }
    }
}

/// c of H₁ = cH₀, up to a constant in H₁, for one noise, 0 for none; and whether Hₘ = cₘH₀ for
/// every m.
fn noise_size(system: &dyn System, points: &Points) -> (Option<f64>, Option<Finding>) {
    let gradient = |m: usize, y: &[f64]| system.hamiltonian(m).gradient(y);
    let mut proportional = Finding::default();
    let mut size = Some(0.0).filter(|_| system.noises() < 2);
    for m in 1..=system.noises() {
        let first = &points.for_identities[0];
        let (drift, noise) = (gradient(0, first), gradient(m, first));
        let mut c = dot(&drift, &noise) / dot(&drift, &drift);
        c.degree = Degree::CONSTANT;
        for y in &points.for_identities {
            let scaled: Vec<_> = gradient(0, y).iter().map(|&x| c * x).collect();
            proportional.compare(&scaled, &gradient(m, y), y);
        }
        size = size.map(|_| c.value);
    }
    (size.filter(|c| c.is_finite() && proportional.holds()), Some(proportional))
}

#[cfg(test)]
mod tests {
    use super::{
        super::{
            finding::Status,
            tests::by_hand::{ByHand, Given, Slope, at, close, exact, within},
        },
        *,
    };

    /// H₀ = 3 and H₁ = −4 with slopes (3, 4) and (6, 8), but for y₂ > 1.
    fn system() -> ByHand {
        let hessian = |_: &[f64]| vec![exact(&[0.0; 2]); 2];
        let value: [fn(&[f64]) -> Bounded; 2] = [|_| Bounded::exact(3.0), |_| Bounded::exact(-4.0)];
        let slope: [Slope; 2] = [
            |_| exact(&[3.0, 4.0]),
            |y| if y[1] > 1.0 { exact(&[6.0, 7.0]) } else { exact(&[6.0, 8.0]) },
        ];
        let given = |m: usize| Given { value: value[m], gradient: slope[m], hessian };
        ByHand {
            hamiltonians: vec![given(0), given(1)],
            structure: |_, v| vec![v[1], -v[0]],
            averages: |_, _, _| [exact(&[3.0, 4.0]), exact(&[4.0, -3.0])],
            predict: |y| (y.to_vec(), f64::INFINITY),
            ..ByHand::default()
        }
    }

    #[test]
    fn identities_of_the_energy_are_compared_with_the_size_of_their_terms() {
        let (system, mut found) = (system(), Hamiltonians::default());
        found.check_energy(&system, &[0.5, 0.25], &[1.0, 1.0]);
        // |½·3| + |¼·(−4)| and |½|.
        assert_eq!((found.linear.scale, found.linear.defect), (3.0, 0.0));
        // ½(3, 4) + ¼(6, 8) = (3, 4).
        assert!(found.gradient.holds() && found.averaged_gradient.holds());
        assert_eq!((found.gradient.scale, found.averaged_gradient.scale), (8.0, 8.0));
        found.check_energy(&system, &[1.0, 0.25], &[1.0, 1.0]);
        assert!(found.gradient.holds() && found.averaged_gradient.defect == 2.0);
    }

    #[test]
    fn the_error_of_a_quadrature_is_relative_to_the_slope_times_the_step() {
        let (system, mut found) = (system(), Hamiltonians::default());
        // (3, 4)·(½, 0) = 1.5 against no change of the energy: 1.5/(5·½).
        found.check_averages(&system, &[1.0, 0.0], &[1.0, 1.0], &[1.5, 1.0]);
        assert!(found.averaged_field.holds() && found.averaged_field.scale == 8.0, "{found:?}");
        assert_eq!((found.discrete_gradient.defect, found.discrete_gradient.scale), (1.5, 1.5));
        assert_eq!(found.quadrature_error, 0.6);
        // The largest one is kept: (3, 4)·(0, ½) = 2, and (4, −3)·(3, 4) = 0.
        found.check_averages(&system, &[1.0, 0.0], &[1.0, 1.0], &[1.0, 1.5]);
        found.check_averages(&system, &[1.0, 0.0], &[1.0, 1.0], &[5.0, -2.0]);
        assert_eq!((found.quadrature_error, found.discrete_gradient.defect), (0.8, 2.0));
    }

    #[test]
    fn a_prediction_may_exceed_its_bound_by_round_off_only() {
        let check = |bound: f64| {
            let predict: fn(&[f64]) -> (Vec<f64>, f64) = match bound {
                1.0 => |_| (vec![6.0, 8.0], 1.0),
                _ => |_| (vec![6.0, 8.0], 1.5),
            };
            // (6, 8) − (3, 4) less (4, 3.5 ± 0.01): a residual of 1 + ½.
            let averages: fn(&[f64], &[f64], &[f64]) -> _ =
                |_, _, _| [Vec::new(), vec![within(4.0, 0.0), within(3.5, 0.01)]];
            let mut found = Hamiltonians::default();
            let system = ByHand { predict, averages, ..system() };
            found.check_prediction(&system, &[1.0, 0.0], &[3.0, 4.0]);
            found.prediction
        };
        let refuted = check(1.0);
        assert!(refuted.refuted() && close(refuted.defect, 0.5) && refuted.scale == 15.0);
        // The error of the field, of its differences, and ε|a|.
        let error = refuted.round_off - 0.01;
        assert!((5.0..20.0).contains(&(error / f64::EPSILON)), "{error}");
        let holds = check(1.5);
        assert_eq!((holds.defect, holds.status), (0.0, Status::Unknown));
        let mut none = Hamiltonians::default();
        none.check_prediction(&system(), &[1.0, 0.0], &[3.0, 4.0]);
        assert_eq!(none.prediction.points, 0);
    }

    #[test]
    fn the_size_of_the_noise_is_a_quotient_of_slopes() {
        let of = |system: &ByHand, y: &[&[f64]]| noise_size(system, &at(y));
        let (size, proportional) = of(&system(), &[&[1.0, 1.0], &[0.0, 1.0]]);
        assert!(size == Some(2.0) && proportional.unwrap().status == Status::Shown);
        let (size, proportional) = of(&system(), &[&[1.0, 1.0], &[0.0, 2.0]]);
        assert!(size.is_none() && proportional.unwrap().refuted());
        let mut several = system();
        several.hamiltonians.push(several.hamiltonians[1]);
        let (size, proportional) = of(&several, &[&[1.0, 1.0]]);
        assert!(size.is_none() && proportional.unwrap().holds());
        several.hamiltonians.truncate(1);
        assert_eq!(of(&several, &[&[1.0, 1.0]]), (Some(0.0), Some(Finding::default())));
    }

    #[test]
    fn averages_are_asked_a_tenth_apart_and_predictions_at_four_step_sizes() {
        let system = ByHand { inside: |y| y[0] < 7.5, ..system() };
        let points = at(&[&[0.0, 0.0], &[7.0, 1.0], &[17.0, 0.0], &[2.0, 1.0], &[1.0, 1.0]]);
        Hamiltonians::of(&system, &points);
        let (averaged, predicted) = (system.averaged.take(), system.predicted.take());
        // At each point first with itself, and then with one on the way to the next.
        let apart: Vec<_> = averaged.iter().filter(|[a, b, _]| a != b).collect();
        assert_eq!((averaged.len(), apart.len(), predicted.len()), (9, 4, 5));
        // From 7 towards 17 a tenth and a twentieth are outside, from 17 towards 2 all is.
        let ends: Vec<f64> = apart.iter().map(|[_, b, _]| b[0]).collect();
        assert!(ends.iter().zip([0.7, 7.25, 1.9, 0.9]).all(|(b, x)| close(*b, x)), "{ends:?}");
        for (n, size) in [1e-3, 0.01, 0.1, 0.5, 1e-3].into_iter().enumerate() {
            let weights = &averaged.iter().find(|[a, _, _]| *a == predicted[n][0]).unwrap()[2];
            let scaled: Vec<f64> = weights.iter().map(|w| w * size).collect();
            assert_eq!(predicted[n][1], scaled);
            assert!(weights.iter().all(|w| w.abs() > 1e-6 && w.abs() <= 1.0), "{weights:?}");
        }
    }
}
