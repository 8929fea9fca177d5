//! The Hamiltonians, and whether the methods that a system overrides agree with its energy.

use real::Bounded;
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
            let excess = Bounded { value: excess, error, degree: f64::INFINITY };
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
        c.degree = 0.0;
        for y in &points.for_identities {
            let scaled: Vec<_> = gradient(0, y).iter().map(|&x| c * x).collect();
            proportional.compare(&scaled, &gradient(m, y), y);
        }
        size = size.map(|_| c.value);
    }
    (size.filter(|c| c.is_finite() && proportional.holds()), Some(proportional))
}
