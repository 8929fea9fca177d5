//! The Hamiltonians, and whether the methods that a system overrides agree with its energy.

use serde::Serialize;

use super::{
    algebra::{dot, largest, norm, times},
    erased::System,
    finding::Finding,
    function::Shape,
    points::{Points, Random},
};

/// The Hamiltonians H₀, …, H_M and the methods that follow from them.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Hamiltonians {
    /// h(y; dt, dw) is linear in (dt, dw).
    pub linear: Finding,
    /// H₀, H₁, …, H_M.
    pub shapes: Vec<Shape>,
    /// c, if there is one noise and H₁ = cH₀ up to a constant: such a system has an energy law.
    pub noise_size: Option<f64>,
    /// `gradient` is ∇h.
    pub gradient: Finding,
    /// `averaged_gradient(y, y)` is ∇h(y).
    pub averaged_gradient: Finding,
    /// ∇̄h(a, b)·(b − a) = h(b) − h(a), for points a tenth of the region apart. Where it does not
    /// hold, the defect is the relative error of the quadrature.
    pub discrete_gradient: Finding,
    /// `averaged_field(a, b)` is B((a+b)/2)∇̄h(a, b).
    pub averaged_field: Finding,
    /// The residual ‖b − a − `averaged_field(a, b)`‖₁ of the predicted end b of an implicit step is
    /// at most the bound given with it, where that is finite.
    pub prediction: Finding,
}

/// Distance of the two points of a discrete gradient, relative to that of two random points.
const APART: f64 = 0.1;

/// Step sizes of the predictions, from very short steps to ones that contract badly.
const PREDICTED_STEPS: [f64; 4] = [1e-3, 0.01, 0.1, 0.5];

impl Hamiltonians {
    pub(super) fn of(system: &dyn System, points: &Points) -> Self {
        let shape = |m| Shape::of(&*system.hamiltonian(m), system, points);
        let shapes = (0..=system.noises()).map(shape).collect();
        let noise_size = noise_size(system, points);
        let mut found = Self { shapes, noise_size, ..Self::default() };
        let mut random = Random::new();
        let points = &points.for_identities;
        for (n, y) in points.iter().enumerate() {
            let weights: Vec<f64> = (0..=system.noises()).map(|_| random.uniform()).collect();
            found.check_energy(system, &weights, y);
            let other = &points[(n + 1) % points.len()];
            let b: Vec<f64> = y.iter().zip(other).map(|(a, b)| a + APART * (b - a)).collect();
            if system.in_domain(&b) {
                found.check_averages(system, &weights, y, &b);
                let size = PREDICTED_STEPS[n % PREDICTED_STEPS.len()];
                let weights: Vec<f64> = weights.iter().map(|w| w * size).collect();
                found.check_prediction(system, &weights, y);
            }
        }
        found
    }

    fn check_energy(&mut self, system: &dyn System, weights: &[f64], y: &[f64]) {
        let (mut sum, mut size) = (0.0, 0.0);
        for (m, weight) in weights.iter().enumerate() {
            let hamiltonian = system.hamiltonian(m);
            let value = hamiltonian.value(y);
            sum += weight * value;
            size += value.abs() + norm(&hamiltonian.gradient(y)) * norm(y);
        }
        let energy = system.energy(weights);
        self.linear.record(energy.value(y) - sum, size, y);
        let exact = energy.gradient(y);
        let size = norm(&exact);
        self.gradient.compare(&system.gradient(y, weights), &exact, size, y);
        let [averaged, _] = system.averages(y, y, weights);
        self.averaged_gradient.compare(&averaged, &exact, size, y);
    }

    fn check_averages(&mut self, system: &dyn System, weights: &[f64], a: &[f64], b: &[f64]) {
        let [mean, field] = system.averages(a, b, weights);
        let step: Vec<f64> = b.iter().zip(a).map(|(b, a)| b - a).collect();
        let energy = system.energy(weights);
        let (start, end) = (energy.value(a), energy.value(b));
        let size = start.abs() + end.abs() + norm(&mean) * norm(&step);
        self.discrete_gradient.record(dot(&mean, &step) - (end - start), size, a);

        let middle: Vec<f64> = b.iter().zip(a).map(|(b, a)| 0.5 * (a + b)).collect();
        let structure = system.matrix(&middle);
        let size = largest(structure.iter().flatten()) * norm(&mean) * a.len() as f64;
        self.averaged_field.compare(&field, &times(&structure, &mean), size, a);
    }

    fn check_prediction(&mut self, system: &dyn System, weights: &[f64], a: &[f64]) {
        let (b, bound) = system.predict(a, weights);
        if bound < f64::INFINITY {
            let [_, field] = system.averages(a, &b, weights);
            let residual: f64 = (0..a.len()).map(|i| (b[i] - a[i] - field[i]).abs()).sum();
            let excess = if residual <= bound { 0.0 } else { residual - bound };
            self.prediction.record(excess, norm(a) + norm(&b), a);
        }
    }
}

/// c of H₁ = cH₀, up to a constant in H₁.
fn noise_size(system: &dyn System, points: &Points) -> Option<f64> {
    if system.noises() != 1 {
        return None;
    }
    let gradients = |y: &[f64]| [0, 1].map(|m| system.hamiltonian(m).gradient(y));
    let [drift, noise] = gradients(&points.for_identities[0]);
    let c = dot(&drift, &noise) / dot(&drift, &drift);
    let mut proportional = Finding::default();
    for y in &points.for_identities {
        let [drift, noise] = gradients(y);
        let size = norm(&noise) + (c * norm(&drift)).abs();
        let scaled: Vec<f64> = drift.iter().map(|x| c * x).collect();
        proportional.compare(&scaled, &noise, size, y);
    }
    (c.is_finite() && proportional.holds).then_some(c)
}
