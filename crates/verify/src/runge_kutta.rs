//! The classical Runge–Kutta method along piecewise linear noise: a reference that uses nothing of
//! the structure.

use systems::{Damping, PoissonSystem, vector_field};

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
        std::array::from_fn(|i| field[i] - rate * y[i])
    };
    for n in 0..substeps {
        let t = t + f64::from(n) * step;
        let shifted = |k: [f64; D], weight: f64| std::array::from_fn(|i| y[i] + weight * k[i]);
        let k1 = change(t, y);
        let k2 = change(t + 0.5 * step, shifted(k1, 0.5));
        let k3 = change(t + 0.5 * step, shifted(k2, 0.5));
        let k4 = change(t + step, shifted(k3, 1.0));
        y = std::array::from_fn(|i| y[i] + (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]) / 6.0);
    }
    y
}

#[cfg(test)]
mod tests {
    use super::*;
    use real::Real;
    use systems::{Linear, paper::valid};

    /// A plane that turns by dt and by both noises.
    struct Plane;

    impl PoissonSystem<2, 2> for Plane {
        fn name(&self) -> &'static str {
            "plane"
        }
        fn structure<R: Real>(&self, _y: [R; 2], v: [R; 2]) -> [R; 2] {
            [-v[1], v[0]]
        }
        fn energy<R: Real>(&self, y: [R; 2], dt: f64, dw: [f64; 2]) -> R {
            (y[0] * y[0] + y[1] * y[1]) * (0.5 * (dt + dw[0] - 2.0 * dw[1]))
        }
    }

    #[test]
    fn a_damped_rotation_is_solved_with_order_four() {
        // γ = 0.6t from t = 2 on: y is turned by τ + w₁ − 2w₂ and shrinks by ∫γ.
        let (damping, t, tau, dw) = (valid(Linear::new(0.6)), 2.0, 0.5, [0.7, -0.4]);
        let angle: f64 = tau + 0.7 + 0.8;
        let size = (-0.3 * ((t + tau) * (t + tau) - t * t)).exp();
        let exact =
            [size * (angle.cos() - 2.0 * angle.sin()), size * (angle.sin() + 2.0 * angle.cos())];
        let error = |substeps: u32| {
            let y = runge_kutta(&Plane, &damping, t, tau, dw, substeps, [1.0, 2.0]);
            (y[0] - exact[0]).hypot(y[1] - exact[1])
        };
        assert!(error(64) < 1e-7, "{}", error(64));
        for substeps in [8, 16, 32] {
            let ratio = error(substeps) / error(2 * substeps);
            assert!((14.0..18.5).contains(&ratio), "{substeps}: {ratio}");
        }
    }
}
