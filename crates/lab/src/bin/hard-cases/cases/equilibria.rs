//! y₀ = 0 and other points where nothing moves.

use anyhow::Result;
use systems::paper::{INERTIA, NOISE_INERTIA};
use systems::{
    Constant, IntegerExponents, LotkaVolterra, Pendulum, PoissonSystem, Problem, RigidBody,
};

use super::{Case, Context, Words};
use crate::paths::{Experiment, stops};
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

const TAU: f64 = 1.0 / 16.0;
const STEPS: u64 = 128;
const T_END: f64 = STEPS as f64 * TAU;

fn rows(context: &Context) -> Result<Vec<Row>> {
    let body = RigidBody::three_noises(INERTIA, NOISE_INERTIA)?;
    let (pendulum, still) = (Pendulum::new(1.0)?, Pendulum::new(0.0)?);
    let lotka_volterra = LotkaVolterra::<IntegerExponents<1, 1>>::integer(1.0)?;
    // The float next to π is no equilibrium: its sine is 1.2e-16, and the distance grows like e^t.
    let upright = ([0.0, std::f64::consts::PI], f64::EPSILON * T_END.exp());
    Ok([
        stay::<_, 3, 3>(context, "rigid body, y₀ = 0, γ = 2", body, 2.0, ([0.0; 3], 0.0))?,
        stay::<_, 3, 3>(
            context,
            "rigid body, y₀ = (0, 1, 0), γ = 0",
            body,
            0.0,
            ([0.0, 1.0, 0.0], 0.0),
        )?,
        stay(context, "pendulum, y₀ = 0, γ = 2", pendulum, 2.0, ([0.0; 2], 0.0))?,
        stay(context, "pendulum upright, γ = 0, no noise", still, 0.0, upright)?,
        stay(
            context,
            "Lotka–Volterra, y₀ = (½, ½, ½), γ = 0",
            lotka_volterra,
            0.0,
            ([0.5; 3], 0.0),
        )?,
    ]
    .concat())
}

/// The largest distance from `y0`, at most `bound`.
fn stay<S: PoissonSystem<D, M>, const D: usize, const M: usize>(
    context: &Context,
    setting: &str,
    system: S,
    rate: f64,
    (y0, bound): ([f64; D], f64),
) -> Result<Vec<Row>> {
    let problem = Problem::new::<M>(system, Constant::new(rate)?, y0, T_END)?;
    Experiment::new(&problem, STEPS, context.key)?.rows(|scheme, paths| {
        let components = paths[0].states.iter().flat_map(|y| (0..D).map(|i| (y[i] - y0[i]).abs()));
        let distance = components.fold(0.0, f64::max);
        Row::observed(setting, None, scheme.name, distance, stops(paths)).at_most(bound)
    })
}
