//! A Hamiltonian that varies faster than the nodes of the quadrature resolve.

use anyhow::Result;
use real::Real;
use systems::paper::{INERTIA, rigid_body_start};
use systems::{Constant, Invariant, PoissonSystem, RigidBodyEnergy};

use super::{Case, Context, Words, each};
use crate::paths::{CASIMIR, Experiment};
use crate::results::{Row, Setting};
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

/// The rigid body with a rippled energy, whose discrete gradient is the default of the trait.
#[derive(Clone, Copy)]
struct Rippled {
    body: RigidBodyEnergy,
    kappa: f64,
}

impl PoissonSystem<3, 1> for Rippled {
    fn name(&self) -> &'static str {
        "rippled-body"
    }
    #[inline(always)]
    fn structure<R: Real>(&self, y: [R; 3], v: [R; 3]) -> [R; 3] {
        self.body.structure(y, v)
    }
    #[inline(always)]
    fn energy<R: Real>(&self, y: [R; 3], dt: f64, dw: [f64; 1]) -> R {
        let ripple = (y[0] * self.kappa).sin() / self.kappa;
        self.body.energy(y, dt, dw) + ripple * (dt + dw[0])
    }
    #[inline(always)]
    fn gradient<R: Real>(&self, y: [R; 3], dt: f64, dw: [f64; 1]) -> [R; 3] {
        let [first, second, third] = self.body.gradient(y, dt, dw);
        [first + (y[0] * self.kappa).cos() * (dt + dw[0]), second, third]
    }
    fn invariants(&self) -> Vec<Invariant> {
        self.body.invariants()
    }
    /// The Casimir is that of the body.
    #[inline(always)]
    fn invariant<R: Real>(&self, index: usize, y: [R; 3]) -> R {
        self.body.invariant(index, y)
    }
}

const KAPPAS: [f64; 5] = [1.0, 10.0, 100.0, 1e3, 1e4];
const STEPS: (u64, f64) = (64, 1.0 / 16.0);

/// The largest error of eight nodes for the mean of cos(κy₁) over a step of length `d` in y₁: its
/// 16th derivative is at most (κd)¹⁶, and no mean is off by more than two. The constant of eight
/// Gauss–Legendre nodes on [0, 1] is (8!)⁴/(17·(16!)³).
fn quadrature_error(kappa: f64, d: f64) -> f64 {
    let factorial = |n: u32| (1..=n).map(f64::from).product::<f64>();
    let constant = factorial(8).powi(4) / (17.0 * factorial(16).powi(3));
    (constant * (kappa * d).abs().powi(16)).min(2.0)
}

fn rows(context: &Context) -> Result<Vec<Row>> {
    let experiment = |kappa| {
        let system = Rippled { body: RigidBodyEnergy::new(INERTIA, 1.0)?, kappa };
        Experiment::new(context, (system, Constant::new(0.0)?), rigid_body_start(), STEPS)
    };
    let setting =
        |what: &str, kappa| Setting { words: format!("{what}, κ = {kappa}"), x: Some(kappa) };
    let casimir = each(KAPPAS, |kappa| {
        experiment(kappa)?.law_rows(setting("Casimir", kappa), &CASIMIR, |_| None)
    })?;
    let energy = each(KAPPAS, |kappa| {
        let experiment = experiment(kappa)?;
        experiment.rows(setting("energy", kappa), |row, scheme, paths| {
            let states = &paths[0].states;
            let value = |y: &[f64; 3]| experiment.problem.system.energy(*y, 1.0, [0.0]);
            let distances = states.iter().map(|y| (value(y) - value(&states[0])).abs());
            let worst = distances.fold(0.0, f64::max);
            let steps = states.windows(2).map(|pair| pair[1][0] - pair[0][0]);
            let quadrature: f64 = steps.map(|d| quadrature_error(kappa, d) * d.abs()).sum();
            // H and |∇H| are at most about two, so that rounding in H is no more than four times
            // that in ½|y|². The argument κy₁ has a rounding of its own, ε κ/κ.
            let rounding = experiment.distance(paths, &CASIMIR, false).bound;
            let bound = quadrature + 4.0 * rounding;
            Ok(match scheme.family {
                Family::Conformal => row.with_figure(worst).guaranteed(worst <= bound, bound),
                _ => row.with_figure(worst),
            })
        })
    })?;
    Ok([casimir, energy].concat())
}
