//! A Hamiltonian that varies faster than the nodes of the quadrature resolve.

use anyhow::Result;
use real::Real;
use systems::paper::rigid_body_start;
use systems::{Constant, Form, Invariant, InvariantKind, PoissonSystem, Problem};

use super::{Case, Context, Words};
use crate::paths::{CASIMIR, Experiment, stops};
use crate::results::Row;
use crate::schemes::Family;

pub const CASE: Case = Case {
    words: Words {
        id: "sharp-hamiltonian",
        title: "Sharply varying Hamiltonian",
        setup: "B(y)v = y × v, H = ½(y₁²/2 + y₂² + 3y₃²/2) + sin(κy₁)/κ as drift and as noise, no \
                damping, 64 steps of τ = 1/16, truncated increments. The discrete gradient is the \
                default of the trait, eight Gauss–Legendre nodes.",
        mathematics: "|y|² and H are constant. For the Casimir any discrete gradient will do; for H \
                      it has to be exact.",
        quantity: "largest distance of ½|y|² (relative) and of H (absolute) from their values at \
                   the start",
        guarantee: "`sexp`: the Casimir to rounding for every κ. H to the error of eight nodes, at \
                    most Σ|Δy₁|·min(2, (8!)⁴/(17·16!³)·(κΔy₁)¹⁶) with the steps Δy₁ that were made, \
                    and rounding: kept while a step is short beside 1/κ, lost beyond. Or a typed \
                    error.",
        varied: "κ",
        plot: None,
    },
    rows,
};

/// A rigid body with a rippled energy, whose discrete gradient is the default of the trait.
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
    fn invariants(&self) -> Vec<Invariant> {
        vec![Invariant {
            name: "C",
            formula: "½|y|²",
            kind: InvariantKind::Casimir,
            form: Form::Quadratic,
            degree: 2.0,
        }]
    }
    #[inline(always)]
    fn invariant<R: Real>(&self, _index: usize, y: [R; 3]) -> R {
        (y[0] * y[0] + y[1] * y[1] + y[2] * y[2]) * 0.5
    }
}

const KAPPAS: [f64; 5] = [1.0, 10.0, 100.0, 1e3, 1e4];
const TAU: f64 = 1.0 / 16.0;
const STEPS: u64 = 64;

/// The largest error of eight nodes for the mean of cos(κy₁) over a step of length `d` in y₁: its
/// 16th derivative is at most (κd)¹⁶, and no mean is off by more than two. The constant of eight
/// Gauss–Legendre nodes on [0, 1] is (8!)⁴/(17·(16!)³).
fn quadrature_error(kappa: f64, d: f64) -> f64 {
    let factorial = |n: u32| (1..=n).map(f64::from).product::<f64>();
    let constant = factorial(8).powi(4) / (17.0 * factorial(16).powi(3));
    (constant * (kappa * d).abs().powi(16)).min(2.0)
}

fn rows(context: &Context) -> Result<Vec<Row>> {
    let (mut casimir, mut energy) = (Vec::new(), Vec::new());
    for kappa in KAPPAS {
        let (system, damping) = (Rippled { kappa }, Constant::new(0.0)?);
        let problem = Problem::new(system, damping, rigid_body_start(), STEPS as f64 * TAU)?;
        let experiment = Experiment::new(&problem, STEPS, context.key)?;
        let setting = format!("Casimir, κ = {kappa}");
        casimir.extend(experiment.law_rows(&setting, Some(kappa), &CASIMIR, |_| None)?);
        energy.extend(experiment.rows(|scheme, paths| {
            let states = &paths[0].states;
            let value = |y: [f64; 3]| problem.system.energy(y, 1.0, [0.0]);
            let distances = states.iter().map(|y| (value(*y) - value(problem.y0)).abs());
            let steps = states.windows(2).map(|pair| pair[1][0] - pair[0][0]);
            let quadrature: f64 = steps.map(|d| quadrature_error(kappa, d) * d.abs()).sum();
            let setting = format!("energy, κ = {kappa}");
            let worst = distances.fold(0.0, f64::max);
            let row = Row::observed(&setting, Some(kappa), scheme.name, worst, stops(paths));
            if scheme.family != Family::Conformal {
                return row;
            }
            // H and |∇H| are at most about two, so that rounding in H is no more than four times
            // that in ½|y|². The argument κy₁ has a rounding of its own, ε κ/κ.
            let rounding = experiment.distance(paths, &CASIMIR, false).bound;
            let bound = quadrature + 4.0 * rounding;
            Row { bound: Some(bound), ..row.guaranteed(worst <= bound) }
        })?);
    }
    Ok([casimir, energy].concat())
}
