//! A Hamiltonian whose frequencies are far above 1/τ.

use systems::{Damping, RigidBodyEnergy};

use super::{
    Claim, Context, INERTIA, Measured, Words, body_start, defect, grid, half_cosine,
    residual_share, valid,
};
use crate::path::{Path, truncated_noise};
use crate::results::{Case, Row};
use crate::rounding::law_bound;

const FREQUENCIES: [f64; 5] = [1.0, 10.0, 100.0, 1e3, 1e4];
const TAU: f64 = 1.0 / 64.0;
const STEPS: u64 = 256;
/// From here on ωτ is above 6 and explicit schemes multiply the fast components by about as much in
/// every step.
const EXPLICIT_FAILS: f64 = 1e3;

pub(super) fn case(context: &Context) -> Case {
    let rows = grid(&FREQUENCIES, 1, |&omega, method| {
        let system = valid(RigidBodyEnergy::new(INERTIA.map(|i| i / omega), 1.0));
        let damping = half_cosine();
        let path =
            Path { system: &system, damping: &damping, y0: body_start(), tau: TAU, steps: STEPS };
        let (mut worst, mut total, mut robust) = (0.0f64, 0.0, 0.0);
        let mut by_newton = 0u64;
        let end = path.run(
            method,
            &mut truncated_noise::<1>(context.key(), 0, TAU),
            &mut |n, step, y, outcome| {
                total += step.damping_integral().abs();
                robust += residual_share(outcome, y);
                by_newton += u64::from(matches!(outcome, nonlin::Outcome::Robust { .. }));
                let law = damping.integral(0.0, n as f64 * TAU);
                for invariant in 0..2 {
                    worst = worst.max(defect(&system, invariant, 2.0, (path.y0, y), law));
                }
            },
        );
        let measured = Measured { figure: worst, stop: end.err() };
        // H₀ is a quadratic form whose largest coefficient is three times its smallest, so that
        // rounding in it is at most three times that in ½|y|².
        let claim = if method.conformal() {
            Claim::AtMostOrStops(3.0 * (law_bound(STEPS, total) + robust))
        } else if omega >= EXPLICIT_FAILS && method.id() != "midpoint" {
            Claim::Exceeds(1.0)
        } else {
            Claim::Nothing
        };
        let row = claim.row(&format!("{omega}"), Some(omega), method.id(), measured);
        let taken_over = (by_newton > 0).then(|| format!("{by_newton} steps by continuation"));
        Row { error: row.error.clone().or(taken_over), ..row }
    });
    Words {
        title: "Stiff Hamiltonian",
        setup: "Rigid body with noise H₀, moments of inertia (2, 1, 2/3)/ω, γ = ½cos 2t, 256 steps of τ = 1/64, truncated increments.",
        mathematics: "The body turns with frequencies of order ω; |y|² and H₀ decay as e^(−2∫γ) whatever ω is.",
        quantity: "largest relative distance of |y|² and H₀ from their laws",
        guarantee: "`sexp`: on both laws to rounding for every ωτ, or a typed error; nothing is said about the phase. Past ωτ ≈ 1 the fixed point does not contract and the Newton method with \
                    continuation takes over. `em` and `heun` must leave the law by more than one.",
        varied: "ω",
    }
    .with(context, rows)
}
