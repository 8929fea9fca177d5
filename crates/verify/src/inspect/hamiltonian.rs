//! What the Hamiltonians are, and whether what was written by hand agrees with what follows from
//! them.

use serde::Serialize;

use super::algebra::{dot, norm, times};
use super::finding::Finding;
use super::points::{Numbers, Points};
use super::probe::{Probe, matrix, pick};
use super::shape::{Hamiltonian, Shape};

/// What the Hamiltonians are.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Hamiltonians {
    /// h(y; dt, dw) is linear in (dt, dw).
    pub linear: Finding,
    /// H₀, H₁, …, H_M.
    pub shapes: Vec<Shape>,
    /// c, where there is one noise and H₁ = cH₀: the class of systems with an energy law.
    pub noise_size: Option<f64>,
    /// `gradient` is ∇h.
    pub gradient: Finding,
    /// `averaged_gradient(y, y)` is ∇h(y).
    pub averaged_gradient: Finding,
    /// ∇̄h(a, b)·(b − a) = h(b) − h(a), for points a tenth of the region apart: exact where this
    /// holds; where it does not, the defect says how good the quadrature is.
    pub discrete_gradient: Finding,
    /// `averaged_field(a, b)` is B((a+b)/2)∇̄h(a, b).
    pub averaged_field: Finding,
    /// `short_step(a)`, where there is one, lacks no more of b = a + averaged_field(a, b) than its
    /// bound says.
    pub short_step: Finding,
    /// `short_steps` of two paths is, to the bit, `short_step` of each.
    pub short_steps: Finding,
}

/// The distance of the two points of a discrete gradient, beside that of two random points.
const APART: f64 = 0.1;

/// Sizes of the steps that a system is asked to solve itself.
const SHORT: [f64; 4] = [1e-3, 0.01, 0.1, 0.5];

impl Hamiltonians {
    pub(super) fn of(system: &dyn Probe, points: &Points) -> Self {
        let noises = system.noises();
        let d = system.dimension();
        let mut numbers = Numbers::new();
        let (mut linear, mut gradient) = (Finding::new(), Finding::new());
        let (mut averaged, mut discrete, mut field) =
            (Finding::new(), Finding::new(), Finding::new());
        let (mut short, mut in_turn) = (Finding::new(), Finding::new());
        for (n, y) in points.few.iter().enumerate() {
            let weights: Vec<f64> = (0..=noises).map(|_| numbers.uniform()).collect();
            let (mut sum, mut size) = (0.0, 0.0);
            for m in 0..=noises {
                let part = system.energy(y, &pick(system, m));
                sum += weights[m] * part;
                size += part.abs() + norm(&system.dual_gradient(y, &pick(system, m))) * norm(y);
            }
            linear.see(system.energy(y, &weights) - sum, size, y);

            let exact = system.dual_gradient(y, &weights);
            compare(&mut gradient, &system.gradient(y, &weights), &exact, norm(&exact), y);
            compare(
                &mut averaged,
                &system.averaged_gradient(y, y, &weights),
                &exact,
                norm(&exact),
                y,
            );

            let other = &points.few[(n + 1) % points.few.len()];
            let b: Vec<f64> = y.iter().zip(other).map(|(a, b)| a + APART * (b - a)).collect();
            if !system.in_domain(&b) {
                continue;
            }
            let step: Vec<f64> = b.iter().zip(y).map(|(b, a)| b - a).collect();
            let mean = system.averaged_gradient(y, &b, &weights);
            let (start, end) = (system.energy(y, &weights), system.energy(&b, &weights));
            let scale = start.abs() + end.abs() + norm(&mean) * norm(&step);
            discrete.see(dot(&mean, &step) - (end - start), scale, y);
            let middle: Vec<f64> = b.iter().zip(y).map(|(b, a)| 0.5 * (a + b)).collect();
            let structure = matrix(system, &middle);
            let composed = times(&structure, &mean);
            let scale = super::algebra::largest(&structure) * norm(&mean) * d as f64;
            compare(&mut field, &system.averaged_field(y, &b, &weights), &composed, scale, y);

            // From very short steps to ones that contract badly, as the weights come.
            let weights: Vec<f64> = weights.iter().map(|w| w * SHORT[n % SHORT.len()]).collect();
            in_turn.see(if system.short_steps_agree(y, &b, &weights) { 0.0 } else { 1.0 }, 1.0, y);
            if let Some((b, bound)) = system.short_step(y, &weights)
                && bound < f64::INFINITY
            {
                let field = system.averaged_field(y, &b, &weights);
                let left: f64 = (0..d).map(|i| (b[i] - y[i] - field[i]).abs()).sum();
                short.see(if left <= bound { 0.0 } else { left - bound }, norm(y) + norm(&b), y);
            }
        }
        Self {
            linear,
            shapes: (0..=noises)
                .map(|m| Shape::of(&Hamiltonian { system, m }, system, points))
                .collect(),
            noise_size: noise_size(system, points),
            gradient,
            averaged_gradient: averaged,
            discrete_gradient: discrete,
            averaged_field: field,
            short_step: short,
            short_steps: in_turn,
        }
    }
}

fn compare(finding: &mut Finding, given: &[f64], exact: &[f64], scale: f64, y: &[f64]) {
    for (a, b) in given.iter().zip(exact) {
        finding.see(a - b, scale, y);
    }
}

/// c of H₁ = cH₀, up to a constant in H₁.
fn noise_size(system: &dyn Probe, points: &Points) -> Option<f64> {
    if system.noises() != 1 {
        return None;
    }
    let gradients = |y: &Vec<f64>| {
        (system.dual_gradient(y, &pick(system, 0)), system.dual_gradient(y, &pick(system, 1)))
    };
    let (drift, noise) = gradients(&points.few[0]);
    let c = dot(&drift, &noise) / dot(&drift, &drift);
    let mut proportional = Finding::new();
    for y in &points.few {
        let (drift, noise) = gradients(y);
        let size = norm(&noise) + (c * norm(&drift)).abs();
        for (a, b) in drift.iter().zip(&noise) {
            proportional.see(c * a - b, size, y);
        }
    }
    (c.is_finite() && proportional.holds).then_some(c)
}
