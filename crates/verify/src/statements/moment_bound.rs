//! `moment-bound`: ‖y_n‖ ≤ (F(y₀)/m(F))^{1/p} e^{∫|γ|} almost surely when m(F) = min over the unit
//! sphere of F > 0 (Bréhier, Cohen and Komori 2025, §3).

use systems::{Constant, DampingFunction, RigidBody};

use crate::*;

pub(super) fn measure(conditions: &Conditions) -> Findings {
    // Invariant 0 is C, 1 is H. ½|y|² is ½ everywhere on the sphere; H₀ is smallest along the axis
    // of the largest moment of inertia.
    let least_energy = 0.5 / paper::INERTIA.iter().copied().fold(0.0, f64::max);
    Findings::of([
        bound(conditions, 0, &Compiled::of(&rigid_body_three_noises(10.0)).sexp(), 0, 0.5),
        bound(
            conditions,
            1,
            &Compiled::of(&paper::rigid_body_energy(10.0)).sexp(),
            1,
            least_energy,
        ),
        bound(conditions, 2, &Compiled::of(&undamped()).sexp(), 0, 0.5),
    ])
}

/// Rigid body without damping, where the bound is an equality for every n.
pub fn undamped() -> Problem<RigidBody<3>, Constant, 3> {
    let body = rigid_body_three_noises(10.0).into_parts().0;
    valid(Problem::new(body, valid(Constant::new(0.0)), paper::rigid_body_start(), 10.0))
}

/// Round-off by which 1000 steps miss a bound that is an equality: 16 ε each if none cancelled.
const ROUND_OFF: f64 = 16_000.0 * f64::EPSILON;

/// Measures the largest ratio of ‖y_n‖ to the bound at t_n on [0, 10], over many paths and all
/// n ≥ 1, for a quadratic F with minimum m.
pub fn bound(
    conditions: &Conditions,
    part: u64,
    setup: &Setup<'_>,
    index: usize,
    minimum: f64,
) -> Claim {
    let problem = &setup.problem;
    let paths = conditions.choose(400, 40);
    // |γ| has kinks, so each step of the finest grid is integrated on its own.
    let absolute = valid(DampingFunction::new(|t| problem.damping.rate(t).abs(), 8));
    let start = ((problem.laws[index].value)(&problem.y0) / minimum).sqrt();
    let (mut largest, mut failed) = (0.0, 0);
    for steps in [20, 100, 1000] {
        let (tau, mut total) = (problem.t_end / steps as f64, 0.0);
        let mut bounds = vec![start];
        for n in 0..steps {
            total += absolute.integral(n as f64 * tau, (n + 1) as f64 * tau);
            bounds.push(start * elementary::exp(total));
        }
        for path in 0..paths {
            let path = conditions.path(part, setup, steps, path);
            failed += u64::from(path.len() as u64 <= steps);
            for ((_, y), bound) in path.iter().zip(&bounds).skip(1) {
                let square: f64 = y.iter().map(|component| component * component).sum();
                largest = worse(largest, square.sqrt() / bound);
            }
        }
    }
    let words = format!("largest ‖y_n‖ over its bound, {paths} paths with τ = 0.5, 0.1 and 0.01");
    let quantities = vec![Bounded::at_most(words, largest, 1.0 + ROUND_OFF)];
    let statement = format!(
        "{}, {}: ‖y_n‖ ≤ (F(y₀)/m(F))^(1/p) exp ∫|γ| with F = {}",
        problem.name,
        problem.damping.describe(),
        problem.laws[index].name
    );
    Claim::new("moment-bound", statement, Evidence::Bounds { quantities, failed })
}
