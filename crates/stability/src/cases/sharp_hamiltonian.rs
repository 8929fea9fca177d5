//! A Hamiltonian that varies faster than the nodes of the quadrature can see.

use nonlin::Outcome;
use real::Real;
use systems::{Constant, PoissonSystem};

use super::{Claim, Context, Measured, Words, body_start, defect, grid, residual_share, valid};
use crate::method::Method;
use crate::path::{Path, truncated_noise};
use crate::results::{Case, Row};
use crate::rounding::law_bound;

/// B(y)v = y × v, H = ½(y₁²/2 + y₂² + 3y₃²/2) + sin(κy₁)/κ as drift and as noise: a rigid body with
/// a rippled energy. Its discrete gradient is the default of the trait, eight nodes.
struct Rippled {
    kappa: f64,
}

impl PoissonSystem<3, 1> for Rippled {
    fn name(&self) -> &'static str {
        "rippled body"
    }
    #[inline(always)]
    fn structure<R: Real>(&self, y: [R; 3], v: [R; 3]) -> [R; 3] {
        [y[1] * v[2] - y[2] * v[1], y[2] * v[0] - y[0] * v[2], y[0] * v[1] - y[1] * v[0]]
    }
    #[inline(always)]
    fn energy<R: Real>(&self, y: [R; 3], dt: f64, dw: [f64; 1]) -> R {
        let quadratic = y[0] * y[0] * 0.25 + y[1] * y[1] * 0.5 + y[2] * y[2] * 0.75;
        (quadratic + (y[0] * self.kappa).sin() / self.kappa) * (dt + dw[0])
    }
    #[inline(always)]
    fn gradient<R: Real>(&self, y: [R; 3], dt: f64, dw: [f64; 1]) -> [R; 3] {
        let weight = dt + dw[0];
        [(y[0] * 0.5 + (y[0] * self.kappa).cos()) * weight, y[1] * weight, y[2] * (1.5 * weight)]
    }
    fn invariants(&self) -> Vec<systems::Invariant> {
        Vec::new()
    }
    #[inline(always)]
    fn invariant<R: Real>(&self, index: usize, y: [R; 3]) -> R {
        if index == 0 {
            (y[0] * y[0] + y[1] * y[1] + y[2] * y[2]) * 0.5
        } else {
            self.energy(y, 1.0, [0.0])
        }
    }
}

const KAPPAS: [f64; 5] = [1.0, 10.0, 100.0, 1e3, 1e4];
const TAU: f64 = 1.0 / 16.0;
const STEPS: u64 = 64;
/// (8!)⁴/(17·(16!)³), the constant in the error of eight Gauss–Legendre nodes on [0, 1].
const GAUSS: f64 = {
    let (mut eight, mut sixteen, mut n) = (1.0, 1.0, 1.0);
    while n <= 16.0 {
        if n <= 8.0 {
            eight *= n;
        }
        sixteen *= n;
        n += 1.0;
    }
    eight * eight * eight * eight / (17.0 * sixteen * sixteen * sixteen)
};

/// The largest error of eight nodes for the mean of cos(κy₁) over a step of length `d` in y₁: its
/// 16th derivative is at most (κd)¹⁶, and no mean is off by more than two.
fn quadrature_error(kappa: f64, d: f64) -> f64 {
    (GAUSS * (kappa * d).abs().powi(16)).min(2.0)
}

/// Largest relative distance of the Casimir, of the energy, what the quadrature may do to the
/// energy, and the residuals' share.
struct Run {
    casimir: f64,
    energy: f64,
    quadrature: f64,
    robust: f64,
    stop: Option<crate::path::Stop>,
}

fn run(context: &Context, kappa: f64, method: Method) -> Run {
    let (system, damping) = (Rippled { kappa }, valid(Constant::new(0.0)));
    let path =
        Path { system: &system, damping: &damping, y0: body_start(), tau: TAU, steps: STEPS };
    let (mut casimir, mut energy, mut quadrature, mut robust) = (0.0f64, 0.0f64, 0.0, 0.0);
    let mut before = path.y0;
    let end = path.run(
        method,
        &mut truncated_noise::<1>(context.key(), 0, TAU),
        &mut |_, _, y, outcome: Outcome| {
            quadrature += quadrature_error(kappa, y[0] - before[0]) * (y[0] - before[0]).abs();
            robust += residual_share(outcome, y);
            before = y;
            casimir = casimir.max(defect(&system, 0, 2.0, (path.y0, y), 0.0));
            energy = energy.max((system.invariant(1, y) - system.invariant(1, path.y0)).abs());
        },
    );
    Run { casimir, energy, quadrature, robust, stop: end.err() }
}

pub(super) fn case(context: &Context) -> Case {
    let mut rows = Vec::new();
    for what in ["Casimir", "energy"] {
        rows.extend(grid(&KAPPAS, 1, |&kappa, method| {
            let Run { casimir, energy, quadrature, robust, stop } = run(context, kappa, method);
            let rounding = law_bound(STEPS, 0.0) + robust;
            let row = if what == "Casimir" {
                let measured = Measured { figure: casimir, stop };
                let claim = if method.conformal() {
                    Claim::AtMostOrStops(rounding)
                } else {
                    Claim::Nothing
                };
                claim.row("", Some(kappa), method.id(), measured)
            } else {
                let measured = Measured { figure: energy, stop };
                // H and |∇H| are at most about two, so that rounding in H is no more than four
                // times that in ½|y|². The argument κy₁ has a rounding of its own, ε κ/κ.
                let claim = if method.conformal() {
                    Claim::AtMostOrStops(quadrature + 4.0 * rounding)
                } else {
                    Claim::Nothing
                };
                claim.row("", Some(kappa), method.id(), measured)
            };
            Row { setting: format!("{what}, κ = {kappa}"), ..row }
        }));
    }
    Words {
        title: "Sharply varying Hamiltonian",
        setup: "B(y)v = y × v, H = ½(y₁²/2 + y₂² + 3y₃²/2) + sin(κy₁)/κ as drift and as noise, no damping, 64 steps of τ = 1/16, truncated increments. The discrete gradient is the default of \
                the trait, eight Gauss–Legendre nodes.",
        mathematics: "|y|² and H are constant. The Casimir asks nothing of the discrete gradient; H asks that it is exact.",
        quantity: "largest distance of ½|y|² (relative) and of H (absolute) from their values at the start",
        guarantee: "`sexp`: the Casimir to rounding for every κ. H to the error of eight nodes, at most Σ|Δy₁|·min(2, (8!)⁴/(17·16!³)·(κΔy₁)¹⁶) with the steps Δy₁ that were made, and rounding: kept while a step \
                    is short beside 1/κ, lost beyond. Or a typed error.",
        varied: "κ",
    }
    .with(context, rows)
}
