//! The classical Runge–Kutta method along piecewise linear noise: a reference that uses nothing of
//! the structure.

use std::array::from_fn;

use systems::vector_field;

use crate::*;

/// Solves dy/dt = B∇H₀ + Σ B∇Hₘ·(dwₘ/τ) − γ(t)y on [t, t + τ] in `substeps` steps: the Stratonovich
/// equation with noise that is linear there.
pub fn runge_kutta<S: PoissonSystem<D, M>, G: Damping, const D: usize, const M: usize>(
    system: &S,
    damping: &G,
    t: f64,
    tau: f64,
    dw: [f64; M],
    substeps: u32,
    mut y: [f64; D],
) -> [f64; D] {
    let fraction = 1.0 / f64::from(substeps);
    let step = tau * fraction;
    let weights = dw.map(|w| w * fraction);
    // The change over one substep at the slope of (t, y).
    let change = |t: f64, y: [f64; D]| -> [f64; D] {
        let field = vector_field(system, y, step, weights);
        let rate = damping.rate(t) * step;
        from_fn(|i| field[i] - rate * y[i])
    };
    for n in 0..substeps {
        let t = t + f64::from(n) * step;
        let shifted = |k: [f64; D], weight: f64| from_fn(|i| y[i] + weight * k[i]);
        let k1 = change(t, y);
        let k2 = change(t + 0.5 * step, shifted(k1, 0.5));
        let k3 = change(t + 0.5 * step, shifted(k2, 0.5));
        let k4 = change(t + step, shifted(k3, 1.0));
        y = from_fn(|i| y[i] + (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]) / 6.0);
    }
    y
}
