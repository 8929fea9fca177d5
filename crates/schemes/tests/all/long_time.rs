//! The oscillator with additive noise over 10⁵ steps: state (q, p), H₀ = ½p² + ½ω²q², H₁ = σq. For
//! the solution E[H₀] grows by ½σ² in a unit of time. With s = (τω)²/4 the schemes have
//!
//! - `sexp` and `midpoint`: ½σ²/(1 + s), from every state and in every step;
//! - `split` with the parts ½p², then ½ω²q² and the noise: ½σ²(1 − ½s)/(1 − s) in the long run,
//!   since ½ω²q² + ½(1 − s)p² grows by ½σ² exactly and oscillates about equal shares;
//! - `nv` of the same parts: ½σ²(1 − ⅛s), for the same reason with half of the step;
//! - `heun` and `sexp-li`, which is explicit here, grow by the factor 1 + 4s² in a step.

use kernels::Tuned;
use noise::Noise;
use nonlin::{Method, Solver};
use real::Real;
use schemes::{
    BuiltIn, EulerMaruyama, Heun, Midpoint, Nv, Scheme, SchemeError, Sexp, SexpLi, Split, Step,
    WithSolver,
};
use systems::{Constant, Flows, PoissonSystem};

const TAU: f64 = 0.01;
const SIGMA: f64 = 0.5;
const STEPS: u64 = 100_000;
/// τω.
const FREQUENCIES: [f64; 3] = [0.1, 0.5, 1.0];
/// ½σ².
const EXACT: f64 = 0.5 * SIGMA * SIGMA;

pub struct Oscillator {
    square: f64,
}

impl PoissonSystem<2, 1> for Oscillator {
    fn name(&self) -> &'static str {
        "oscillator"
    }
    #[inline(always)]
    fn structure<R: Real>(&self, _y: [R; 2], v: [R; 2]) -> [R; 2] {
        [v[1], -v[0]]
    }
    #[inline(always)]
    fn energy<R: Real>(&self, y: [R; 2], dt: f64, dw: [f64; 1]) -> R {
        (y[1] * y[1] + y[0] * y[0] * self.square) * (0.5 * dt) + y[0] * (SIGMA * dw[0])
    }
    #[inline(always)]
    fn gradient<R: Real>(&self, y: [R; 2], dt: f64, dw: [f64; 1]) -> [R; 2] {
        [y[0] * (self.square * dt) + SIGMA * dw[0], y[1] * dt]
    }
}

impl Flows<2, 1> for Oscillator {
    const PARTS: usize = 2;
    const EXACT: bool = true;
    const NOISE_PARTS: [Option<usize>; 1] = [Some(1)];

    #[inline(always)]
    fn flow<R: Real>(&self, part: usize, y: [R; 2], dt: R, dw: [R; 1]) -> [R; 2] {
        match part {
            0 => [y[0] + dt * y[1], y[1]],
            _ => [y[0], y[1] - dt * self.square * y[0] - dw[0] * SIGMA],
        }
    }
}

impl Tuned<2, 1> for Oscillator {
    fn scheme(
        scheme: BuiltIn,
        system: &Self,
        y0: [f64; 2],
    ) -> Result<Box<dyn Scheme<Self, 2, 1>>, SchemeError> {
        scheme.by_parts(system, y0)
    }
}

impl Oscillator {
    pub fn new(tau_omega: f64) -> Self {
        Self { square: (tau_omega / TAU).powi(2) }
    }
}

/// E[H₀] after 10⁵ steps and after half of them, without sampling: z = My + gΔW is read off, and
/// P = E[yyᵀ] becomes MPMᵀ + τggᵀ.
fn mean_energies(
    oscillator: &Oscillator,
    scheme: &dyn Scheme<Oscillator, 2, 1>,
    y0: [f64; 2],
) -> [f64; 2] {
    let step = Step::new(&Constant::new(0.0).unwrap(), 0, TAU).unwrap();
    let advance = |y, dw| scheme.step(oscillator, &step, &Noise::increments([dw]), y).z;
    let columns = [advance([1.0, 0.0], 0.0), advance([0.0, 1.0], 0.0)];
    let g = advance([0.0, 0.0], 1.0);
    let m = |i: usize, k: usize| columns[k][i];
    let mut p = [[0, 1].map(|k| y0[0] * y0[k]), [0, 1].map(|k| y0[1] * y0[k])];
    let mut half = 0.0;
    for n in 1..=STEPS {
        let mut next = [[0.0; 2]; 2];
        for (i, k) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            next[i][k] = TAU * g[i] * g[k];
            for (a, b) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                next[i][k] += m(i, a) * p[a][b] * m(k, b);
            }
        }
        p = next;
        if n == STEPS / 2 {
            half = 0.5 * (p[1][1] + oscillator.square * p[0][0]);
        }
    }
    [half, 0.5 * (p[1][1] + oscillator.square * p[0][0])]
}

fn start(tau_omega: f64) -> [f64; 2] {
    [0.3 * TAU / tau_omega, 0.4]
}

#[test]
fn exact_slopes_over_a_hundred_thousand_steps() {
    for tau_omega in FREQUENCIES {
        let (oscillator, y0) = (Oscillator::new(tau_omega), start(tau_omega));
        let s = tau_omega * tau_omega / 4.0;
        let nv = Nv::default();
        let slope = |scheme| {
            let [half, end] = mean_energies(&oscillator, scheme, y0);
            (end - half) / (TAU * EXACT * (STEPS / 2) as f64)
        };
        // Energies oscillate by less than the start's, 0.125 of 125 and more.
        let close = |slope: f64, expected: f64, error: f64| {
            assert!((slope / expected - 1.0).abs() < error, "{tau_omega}: {slope} {expected}");
        };
        // What the solver leaves of M counts 10⁵ times: Newton's method, which solves linear
        // equations.
        let solver = Solver::new(Method::Newton);
        let sexp = WithSolver { formula: Sexp, solver };
        let midpoint = WithSolver { formula: Midpoint, solver };
        close(slope(&sexp), 1.0 / (1.0 + s), 1e-8);
        close(slope(&midpoint), 1.0 / (1.0 + s), 1e-8);
        close(slope(&Split), (1.0 - s / 2.0) / (1.0 - s), 2e-3);
        close(slope(&nv), 1.0 - s / 8.0, 2e-3);
        // Twins: linear growth refuted.
        let grows = |slope: f64| slope.is_nan() || slope > 2.0;
        for twin in [&Heun as &dyn Scheme<Oscillator, 2, 1>, &EulerMaruyama] {
            assert!(grows(slope(twin)), "{tau_omega}");
        }
        let li = SexpLi::new(&oscillator, y0).unwrap();
        assert!(grows(slope(&li)), "{tau_omega}");
    }
}
