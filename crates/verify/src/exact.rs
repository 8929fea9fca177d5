//! Exact solutions of one-noise systems by a random change of time.
//!
//! Undamped, dz = f(z)(dt + c∘dW) has the solution z(t) = φ_{t + cW(t)}(z₀), where φ is the flow of
//! f. With damping and f homogeneous of degree r, z = e^{Γ}y with Γ = ∫γ solves dz = e^{−(r−1)Γ}
//! f(z)(dt + c∘dW), hence
//!
//! y(T) = e^{−Γ(T)} φ_S(y₀),  S = ∫₀ᵀ g(t)(dt + c dW(t)),  g = e^{−(r−1)Γ}.
//!
//! On one finest step, ∫g dW = ḡΔW + √v ξ with the mean ḡ of g there, v = ∫(g − ḡ)² and a standard
//! normal ξ independent of ΔW. Hence S along a path has no error of time-stepping.

use std::{array::from_fn, f64::consts::PI};

use dgrad::Rule;
use mc::TimeChange;
use systems::vector_field;

use crate::*;

/// The random time S of the exact solution, along a path or in law.
pub struct RandomTime<'a, G> {
    damping: &'a G,
    /// Degree r of homogeneity of f = B∇H.
    degree: f64,
    /// Size c of the noise.
    noise: f64,
    /// The finest step.
    tau: f64,
    rule: Rule,
}

/// Nodes on one finest step: g is smooth and a step short, so the mean of g is exact to round-off.
const NODES: usize = 4;

impl<'a, G: Damping> RandomTime<'a, G> {
    /// Creates S for a damping, a degree r, a noise c and a finest step.
    pub fn new(damping: &'a G, degree: f64, noise: f64, tau: f64) -> Self {
        Self { damping, degree, noise, tau, rule: valid(Rule::new(NODES)) }
    }

    /// Mean ḡ and variance v of finest step n.
    fn step(&self, n: u64) -> (f64, f64) {
        let start = n as f64 * self.tau;
        let before = self.damping.integral(0.0, start);
        let weight = |eta: f64| {
            let gamma = before + self.damping.integral(start, start + eta * self.tau);
            elementary::exp(-(self.degree - 1.0) * gamma)
        };
        let (nodes, weights) = (self.rule.nodes(), self.rule.weights());
        let values: [f64; NODES] = from_fn(|i| weight(nodes[i]));
        let average = |values: [f64; NODES]| values.iter().zip(weights).map(|(g, w)| g * w).sum();
        let mean: f64 = average(values);
        (mean, average(values.map(|g| (g - mean) * (g - mean))) * self.tau)
    }

    /// Mean and variance of the Gaussian variable S over `steps` finest steps.
    pub fn law(&self, steps: u64) -> (f64, f64) {
        (0..steps).map(|n| self.step(n)).fold((0.0, 0.0), |(mean, variance), (g, v)| {
            (mean + g * self.tau, variance + self.noise * self.noise * (g * g * self.tau + v))
        })
    }
}

impl<G: Damping> TimeChange for RandomTime<'_, G> {
    fn advance(&self, n: u64, dw: &[Row], normals: &Row, random_time: &mut Row) {
        let (mean, spread) = self.step(n);
        let (drift, residual) = (mean * self.tau, self.noise * spread.sqrt());
        for p in 0..WIDTH {
            random_time[p] += drift + self.noise * mean * dw[0][p] + residual * normals[p];
        }
    }
}

/// Solution e^{−Γ(T)} φ_S(y₀) at the final time for the random time S = s.
pub fn solution<S: PoissonSystem<D, 1>, G: Damping, const D: usize>(
    problem: &Problem<S, G, D>,
    s: f64,
) -> [f64; D] {
    let decay = elementary::exp(-problem.damping().integral(0.0, problem.t_end()));
    flow(problem.system(), problem.y0(), s).map(|component| decay * component)
}

/// Number of steps per unit of time, each of order ten: with Lipschitz constants up to five the
/// error is 1e-16.
const STEPS_PER_UNIT: f64 = 32.0;
/// Midpoint steps of the columns that are extrapolated.
const COLUMNS: [u32; 5] = [2, 4, 6, 8, 10];

/// Flow φ_s(y) of f = B∇H₀ over time s, to round-off, by extrapolation of the modified midpoint
/// rule (Gragg 1965; Bulirsch and Stoer 1966).
fn flow<S: PoissonSystem<D, 1>, const D: usize>(system: &S, mut y: [f64; D], s: f64) -> [f64; D] {
    let steps = (s.abs() * STEPS_PER_UNIT).ceil().max(1.0);
    for _ in 0..steps as u32 {
        // The error of each column is a series in the square of its step.
        let mut columns = COLUMNS.map(|n| modified_midpoint(system, y, s / steps, n));
        for k in 1..COLUMNS.len() {
            for j in (k..COLUMNS.len()).rev() {
                let ratio = f64::from(COLUMNS[j]) / f64::from(COLUMNS[j - k]);
                let weight = 1.0 / (ratio * ratio - 1.0);
                for i in 0..D {
                    columns[j][i] += (columns[j][i] - columns[j - 1][i]) * weight;
                }
            }
        }
        y = columns[COLUMNS.len() - 1];
    }
    y
}

/// Takes n steps h/n of the midpoint rule, n even, with Gragg's smoothing at the end.
fn modified_midpoint<S: PoissonSystem<D, 1>, const D: usize>(
    system: &S,
    y: [f64; D],
    h: f64,
    n: u32,
) -> [f64; D] {
    let step = h / f64::from(n);
    let change = |y: [f64; D], length: f64| vector_field(system, y, length, [0.0]);
    let plus = |a: [f64; D], b: [f64; D]| from_fn::<f64, D, _>(|i| a[i] + b[i]);
    let (mut before, mut now) = (y, plus(y, change(y, step)));
    for _ in 1..n {
        (before, now) = (now, plus(before, change(now, 2.0 * step)));
    }
    plus(now, plus(before, change(now, step))).map(|sum| 0.5 * sum)
}

/// Expectation E[φ(y(T))] by Gauss–Legendre over ±9 standard deviations of S, on pieces of one
/// standard deviation.
pub fn expectation<S: PoissonSystem<D, 1>, G: Damping, const D: usize>(
    problem: &Problem<S, G, D>,
    time: &RandomTime<'_, G>,
    steps: u64,
    phi: impl Fn([f64; D]) -> f64,
) -> f64 {
    let (mean, variance) = time.law(steps);
    let deviation = variance.sqrt();
    let rule = valid(Rule::new(16));
    let integrand = |x: f64| {
        let density = elementary::exp(-0.5 * x * x) / (2.0 * PI).sqrt();
        density * phi(solution(problem, mean + deviation * x))
    };
    (-9..9).map(|piece| rule.integrate(f64::from(piece), f64::from(piece + 1), integrand)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use systems::paper::{INERTIA, rigid_body_start};
    use systems::{RigidBodyEnergy, Sine};

    #[test]
    fn the_flow_keeps_invariants_and_runs_backwards() {
        let body = valid(RigidBodyEnergy::new(INERTIA, 1.0));
        let start = rigid_body_start();
        for s in [0.3, 1.7, -2.2] {
            let end = flow(&body, start, s);
            for index in 0..2 {
                let (before, after) = (body.invariant(index, start), body.invariant(index, end));
                assert!((after / before - 1.0).abs() < 1e-13, "{s} {index}");
            }
            let back = flow(&body, end, -s);
            assert!((0..3).all(|i| (back[i] - start[i]).abs() < 1e-13), "{s} {back:?}");
        }
    }

    /// At degree two S has the mean ∫g = (1 − e^{−γT})/γ and the variance c²∫g².
    #[test]
    fn the_random_time_has_the_mean_and_the_variance_of_its_integral() {
        let damping = valid(systems::Constant::new(0.8));
        let (mean, variance) = RandomTime::new(&damping, 2.0, 0.7, 0.5).law(4);
        let integral = |rate: f64| (1.0 - (-2.0 * rate).exp()) / rate;
        assert!((mean - integral(0.8)).abs() < 1e-9, "{mean}");
        // Four nodes leave (2γτ)⁸/8! and less.
        assert!((variance - 0.49 * integral(1.6)).abs() < 1e-7, "{variance}");
    }

    /// A plane that turns: H = ½|y|².
    struct Plane;

    impl PoissonSystem<2, 1> for Plane {
        fn name(&self) -> &'static str {
            "plane"
        }
        fn structure<R: real::Real>(&self, _y: [R; 2], v: [R; 2]) -> [R; 2] {
            [-v[1], v[0]]
        }
        fn energy<R: real::Real>(&self, y: [R; 2], dt: f64, dw: [f64; 1]) -> R {
            (y[0] * y[0] + y[1] * y[1]) * (0.5 * (dt + dw[0]))
        }
    }

    #[test]
    fn expectations_of_a_turned_plane_are_known() {
        // S = T + cW(T) at degree one: E[e^{iS}] = e^{iT − c²T/2}, and y decays with ∫γ.
        let damping = valid(Sine::new(0.5, 1.0));
        let problem = valid(Problem::new(Plane, damping, [0.8, 0.6], 2.0));
        let time = RandomTime::new(problem.damping(), 1.0, 0.7, 0.25);
        let size = (-0.5 * (1.0 - 2f64.cos()) - 0.5 * 0.49 * 2.0).exp();
        let (sin, cos) = 2f64.sin_cos();
        for (i, exact) in [0.8 * cos - 0.6 * sin, 0.6 * cos + 0.8 * sin].into_iter().enumerate() {
            let found = expectation(&problem, &time, 8, |y| y[i]);
            assert!((found - size * exact).abs() < 1e-11, "{found} {}", size * exact);
        }
        let squares = expectation(&problem, &time, 8, |y| y[0] * y[0] + y[1] * y[1]);
        assert!((squares - (2f64.cos() - 1.0).exp()).abs() < 1e-11, "{squares}");
    }
}
