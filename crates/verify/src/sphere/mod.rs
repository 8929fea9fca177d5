//! Expectations of the damped stochastic rigid body from the Kolmogorov equation on the sphere,
//! without sampling.
//!
//! The Casimir ½|y|² obeys its conformal law on every path. Hence y = r(t)u with r = |y₀|e^{−Γ(t)},
//! Γ = ∫γ, and u stays on the unit sphere: du = r B(u)∇H₀(u)dt + r Σ B(u)∇Hₘ(u) ∘ dWₘ. The moments
//! E[h(u(t))] of the spherical harmonics h obey a linear equation:
//!
//! - `harmonics`: the basis h;
//! - `generator`: the matrix of the generator of u in this basis;
//! - `integration`: the moments at the final time.
//!
//! E[φ(y(T))] is then the integral of φ(r(T)u) with the density Σ q_lm h_lm(u) of u(T).

mod generator;
mod harmonics;
mod integration;
#[cfg(test)]
mod tests;

use dgrad::Rule;
use mc::Observable;
use real::elementary::sin_cos_turn;
use systems::{Damping, Problem, RigidBody, paper::valid};

use harmonics::harmonics;
use integration::{moments, radius, steps};

/// E[φ(y(T))] for every observable φ, with spherical harmonics up to `degree`.
///
/// φ must be smooth: φ(r(T)u) is expanded up to degree 48, or `degree` if that is less. This is
/// exact to round-off for polynomials of no higher degree and, with 48, for sines and cosines of a
/// component if r(T) < 10. For the weak problem of the paper the error is 1e-8 with degree 32,
/// 1e-12 with 64 and round-off with 96. The work grows as the fourth power of the degree.
pub fn rigid_body_expectations<G: Damping, const M: usize>(
    problem: &Problem<RigidBody<M>, G, 3>,
    degree: usize,
    observables: &[Observable<3>],
) -> Vec<f64> {
    let moments = moments(problem, degree, steps(problem, degree));
    means(&moments, degree, radius(problem, problem.t_end()), observables)
}

/// The degree up to which φ(r(T)u) is expanded.
const EXPANSION: usize = 48;

/// Means of φ(ru) for u of the density Σ q_lm h_lm with respect to the uniform law, by
/// Gauss–Legendre in u₃ and equal weights along the circles: exact for polynomials of degree
/// 2·`EXPANSION` + 1.
fn means(moments: &[f64], degree: usize, r: f64, observables: &[Observable<3>]) -> Vec<f64> {
    let rule = valid(Rule::new(EXPANSION + 1));
    let longitudes = 2 * EXPANSION + 2;
    let mut means = vec![0.0; observables.len()];
    for (&eta, &weight) in rule.nodes().iter().zip(rule.weights()) {
        let width = 2.0 * (eta * (1.0 - eta)).sqrt();
        for k in 0..longitudes {
            let (sin, cos) = sin_cos_turn(k as f64 / longitudes as f64);
            let u = [width * cos, width * sin, 2.0 * eta - 1.0];
            let harmonics = harmonics(u, degree.min(EXPANSION));
            let density: f64 = harmonics.iter().zip(moments).map(|(h, q)| h * q).sum();
            let mass = weight * density / longitudes as f64;
            for (mean, observable) in means.iter_mut().zip(observables) {
                *mean += mass * (observable.function)(u.map(|u| r * u));
            }
        }
    }
    means
}
