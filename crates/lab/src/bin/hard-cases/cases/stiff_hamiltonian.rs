//! A Hamiltonian whose frequencies are far above 1/τ.

use anyhow::Result;
use systems::RigidBodyEnergy;
use systems::paper::{INERTIA, half_cosine, rigid_body_start};

use super::{Case, Context, Plot, Words, each};
use crate::paths::{CASIMIR, Experiment, Law};
use crate::results::Row;
use crate::schemes::Family;

pub const CASE: Case = Case {
    words: Words {
        id: "stiff-hamiltonian",
        title: "Stiff Hamiltonian",
        setup: "Rigid body with noise H₀, moments of inertia (2, 1, 2/3)/ω, γ = ½cos 2t, 256 steps \
                of τ = 1/64, truncated increments.",
        mathematics: "The body turns with frequencies of order ω; |y|² and H₀ decay as e^(−2∫γ) \
                      whatever ω is.",
        quantity: "largest relative distance of |y|² and H₀ from their laws",
        guarantee: "`sexp`: on both laws to rounding for every ωτ, or a typed error; nothing is \
                    said about the phase. Past ωτ ≈ 1 the fixed point does not contract and the \
                    Newton method with continuation takes over. `em` and `heun` must leave the law \
                    by more than one.",
        varied: "ω",
        plot: Some(Plot { x_title: "frequency ω (τ = 1/64)", range: (1e-16, 1e8) }),
    },
    rows,
};

const FREQUENCIES: [f64; 5] = [1.0, 10.0, 100.0, 1e3, 1e4];
const TAU: f64 = 1.0 / 64.0;
/// From here on ωτ is above 6 and explicit schemes multiply the fast components by about as much in
/// every step.
const EXPLICIT_FAILS: f64 = 1e3;

/// H₀ is a quadratic form whose largest coefficient is three times its smallest, so that rounding
/// in it is at most three times that in ½|y|².
const LAWS: Law = Law { invariants: &[0, 1], weight: 3.0, counts_continuation: true, ..CASIMIR };

fn rows(context: &Context) -> Result<Vec<Row>> {
    each(FREQUENCIES, |omega| {
        let system = (RigidBodyEnergy::new(INERTIA.map(|i| i / omega), 1.0)?, half_cosine());
        let fails = |family| omega >= EXPLICIT_FAILS && family == Family::Explicit;
        Experiment::new(context, system, rigid_body_start(), (256, TAU))?.law_rows(
            omega,
            &LAWS,
            |family| fails(family).then_some(1.0),
        )
    })
}
