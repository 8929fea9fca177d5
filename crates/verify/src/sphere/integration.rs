//! The moments of u at the final time.

use real::elementary::exp;
use systems::{Damping, Problem, RigidBody};

use super::{
    generator::{Generator, norm_bound},
    harmonics::harmonics,
};

/// |y|.
pub fn norm(y: [f64; 3]) -> f64 {
    (y[0] * y[0] + y[1] * y[1] + y[2] * y[2]).sqrt()
}

/// r(t) = |y₀|e^{−Γ(t)}.
pub fn radius<S, G: Damping>(problem: &Problem<S, G, 3>, t: f64) -> f64 {
    norm(problem.y0()) * exp(-problem.damping().integral(0.0, t))
}

/// Least degree for which [`steps`] is accurate and not only stable.
const ACCURATE: usize = 64;
/// Times at which the largest radius is sought.
const SAMPLES: u32 = 256;

/// Steps of the classical Runge–Kutta method, which is stable where Re λ ≤ 0 and |λ|h ≤ 2.6.
pub fn steps<G: Damping, const M: usize>(
    problem: &Problem<RigidBody<M>, G, 3>,
    degree: usize,
) -> u32 {
    let time = |i: u32| problem.t_end() * f64::from(i) / f64::from(SAMPLES);
    let r = (0..=SAMPLES).map(|i| radius(problem, time(i))).fold(0.0, f64::max);
    let rate = norm_bound(problem.system(), degree.max(ACCURATE), r);
    (0.5 * rate * problem.t_end()).ceil().max(1.0) as u32
}

/// The moments q = E[h_lm(u(T))], which solve q′ = L_tᵀq, q(0) = h(u₀), by the classical
/// Runge–Kutta method.
pub fn moments<G: Damping, const M: usize>(
    problem: &Problem<RigidBody<M>, G, 3>,
    degree: usize,
    steps: u32,
) -> Vec<f64> {
    let generator = Generator::new(problem.system(), degree);
    let length = norm(problem.y0());
    // At y₀ = 0 the radius stays zero, and so does L_t, for any u₀.
    let start = if length > 0.0 { problem.y0().map(|y| y / length) } else { [0.0, 0.0, 1.0] };
    let mut q = harmonics(start, degree);
    let h = problem.t_end() / f64::from(steps);
    let shifted = |q: &[f64], k: &[f64], weight: f64| -> Vec<f64> {
        q.iter().zip(k).map(|(q, k)| q + weight * k).collect()
    };
    for n in 0..steps {
        let [r0, r1, r2] = [0.0, 0.5, 1.0].map(|stage| radius(problem, (f64::from(n) + stage) * h));
        let k1 = generator.transposed(r0, &q);
        let k2 = generator.transposed(r1, &shifted(&q, &k1, 0.5 * h));
        let k3 = generator.transposed(r1, &shifted(&q, &k2, 0.5 * h));
        let k4 = generator.transposed(r2, &shifted(&q, &k3, h));
        for i in 0..q.len() {
            q[i] += h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]);
        }
    }
    q
}
