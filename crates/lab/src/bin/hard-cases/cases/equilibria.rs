//! y₀ = 0 and other points where nothing moves.

use anyhow::Result;
use systems::paper::{INERTIA, NOISE_INERTIA};
use systems::{Constant, IntegerExponents, LotkaVolterra, Pendulum, PoissonSystem, RigidBody};

use super::{Case, Context, Words};
use crate::paths::Experiment;
use crate::results::Row;

pub const CASE: Case = Case {
    words: Words {
        id: "equilibria",
        title: "Zero and equilibria",
        setup: "128 steps of τ = 1/16, truncated increments.",
        mathematics: "Where B∇Hₘ = 0 for all m and γy = 0 the solution stays. At y₀ = (½, ½, ½) all \
                      components of ∇H of the Lotka–Volterra system with a = b = −1 are equal, and \
                      B∇H = 0.",
        quantity: "largest distance of a component from y₀",
        guarantee: "Every scheme stays exactly where products of zeros are zeros. The upright \
                    pendulum starts an ulp from its equilibrium and leaves it like e^t; the bound \
                    is ε e^T. Lotka–Volterra stays exactly, since equal numbers are subtracted from \
                    each other.",
        varied: "system and start",
        plot: None,
    },
    rows,
};

const STEPS: (u64, f64) = (128, 1.0 / 16.0);

fn rows(context: &Context) -> Result<Vec<Row>> {
    let body = RigidBody::three_noises(INERTIA, NOISE_INERTIA)?;
    let (pendulum, still) = (Pendulum::new(1.0)?, Pendulum::new(0.0)?);
    let lotka_volterra = LotkaVolterra::<IntegerExponents<1, 1>>::integer(1.0)?;
    let (none, some) = (Constant::new(0.0)?, Constant::new(2.0)?);
    // The float next to π is no equilibrium: its sine is 1.2e-16, and the distance grows like e^t.
    let (pi, t_end) = ([0.0, std::f64::consts::PI], STEPS.0 as f64 * STEPS.1);
    let moved = |system, y0| Experiment::<_, _, 3, 3>::new(context, system, y0, STEPS);
    let tilted = |system, y0| Experiment::<_, _, 2, 1>::new(context, system, y0, STEPS);
    let half = Experiment::<_, _, 3, 1>::new(context, (lotka_volterra, none), [0.5; 3], STEPS)?;
    let rows = [
        stay("rigid body, y₀ = 0, γ = 2", &moved((body, some), [0.0; 3])?, 0.0)?,
        stay("rigid body, y₀ = (0, 1, 0), γ = 0", &moved((body, none), [0.0, 1.0, 0.0])?, 0.0)?,
        stay("pendulum, y₀ = 0, γ = 2", &tilted((pendulum, some), [0.0; 2])?, 0.0)?,
        stay(
            "pendulum upright, γ = 0, no noise",
            &tilted((still, none), pi)?,
            f64::EPSILON * t_end.exp(),
        )?,
        stay("Lotka–Volterra, y₀ = (½, ½, ½), γ = 0", &half, 0.0)?,
    ];
    Ok(rows.concat())
}

/// The largest distance from y₀, at most `bound`.
fn stay<S: PoissonSystem<D, M>, const D: usize, const M: usize>(
    setting: &str,
    experiment: &Experiment<S, Constant, D, M>,
    bound: f64,
) -> Result<Vec<Row>> {
    experiment.rows(setting.to_owned(), |row, _, paths| {
        let states = &paths[0].states;
        let components = states.iter().flat_map(|y| (0..D).map(|i| (y[i] - states[0][i]).abs()));
        Ok(row.with_figure(components.fold(0.0, f64::max)).at_most(bound))
    })
}
