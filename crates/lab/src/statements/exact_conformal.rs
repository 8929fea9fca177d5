//! `exact-conformal`: the exact flow obeys the conformal law (paper, `prop:Casimir`).
//!
//! Along a path with piecewise linear noise the equation is an ordinary differential equation with
//! the same chain rule as the Stratonovich equation, and the law holds exactly. It is integrated by
//! the classical Runge–Kutta method, which knows nothing of the structure: its defect must vanish
//! with the fourth power of its step.
//!
//! What is measured is the variation of the relative defect dₙ = F(yₙ)e^{p∫γ}/F(y₀) − 1 along the
//! path, Σ|dₙ₊₁ − dₙ|. The defect at the end would be a sum of contributions of both signs, and its
//! leading term may cancel; the variation is Σ|cₙ|·h⁴(1 + O(h)), whose leading term cannot.

use noise::WienerPath;
use systems::paper::{INERTIA, NOISE_INERTIA, half_cosine, rigid_body_start, valid};
use systems::{
    Damping, IntegerExponents, Linear, LotkaVolterra, MaxwellBloch, Poisson3, PoissonSystem,
    Problem, RigidBody, RigidBodyEnergy, Sine,
};
use verify::results::Claim;
use verify::runge_kutta::runge_kutta;
use verify::{claim, decide};

use crate::experiment::Context;

pub(super) fn measure(context: &Context<'_>) -> Vec<Claim> {
    context.progress.begin("exact-conformal", 5);
    let body = valid(RigidBody::three_noises(INERTIA, NOISE_INERTIA));
    let energy = valid(RigidBodyEnergy::new(INERTIA, 1.0));
    let lotka_volterra = valid(LotkaVolterra::<IntegerExponents<2, 2>>::integer(1.0));
    let sine = valid(Sine::new(1.0, 1.0));
    let claims = [
        law(context, 0, &valid(Problem::new(body, half_cosine(), rigid_body_start(), 1.0))),
        law(context, 1, &valid(Problem::new(energy, sine, rigid_body_start(), 1.0))),
        law(context, 2, &valid(Problem::new(lotka_volterra, sine, [0.2, 0.4, 0.6], 1.0))),
        law(context, 3, &valid(Problem::new(MaxwellBloch, half_cosine(), [1.0, 2.0, 3.0], 1.0))),
        law(
            context,
            4,
            &valid(Problem::new(
                valid(Poisson3::new(1.0)),
                valid(Linear::new(1.0)),
                [1.0, 2.0, 3.0],
                1.0,
            )),
        ),
    ];
    context.progress.end();
    claims.into_iter().flatten().collect()
}

/// Linear pieces of the noise on [0, 1].
const PIECES: u64 = 64;
/// Runge–Kutta steps on each piece.
const COARSE: u32 = 4;
const FINE: u32 = 32;
/// Eight times more steps reduce a fourth-order defect by 4096; this leaves room for higher orders
/// of the error.
const REDUCTION: f64 = 1000.0;
/// Round-off: a piece of 32 Runge–Kutta steps rounds each some four times, which adds up like a
/// random walk to √32·4 ε, and the invariant at its ends as often; 64 pieces of 30 ε are 4e-13. A
/// variation below this has nothing left to be reduced.
const ROUND_OFF: f64 = 1e-12;

/// A claim for each invariant of the system.
pub(crate) fn law<S, G, const D: usize, const M: usize>(
    context: &Context<'_>,
    part: u64,
    problem: &Problem<S, G, D>,
) -> Vec<Claim>
where
    S: PoissonSystem<D, M>,
    G: Damping,
{
    let system = &problem.system;
    let tau = problem.t_end / PIECES as f64;
    // The states at the ends of the pieces.
    let path = |substeps: u32| -> Vec<[f64; D]> {
        let mut noise = WienerPath::<M>::new(context.key(part), 0);
        let mut y = problem.y0;
        (0..PIECES)
            .map(|n| {
                let dw = noise.increments(tau.sqrt());
                y = runge_kutta(system, &problem.damping, n as f64 * tau, tau, dw, substeps, y);
                y
            })
            .collect()
    };
    let (coarse, fine) = (path(COARSE), path(FINE));
    let describe = |(index, invariant): (usize, &systems::Invariant)| {
        let initial: f64 = system.invariant(index, problem.y0);
        let variation = |path: &[[f64; D]]| {
            let defects = path.iter().enumerate().map(|(n, &y)| {
                let decay =
                    (-invariant.degree * problem.damping.integral(0.0, (n + 1) as f64 * tau)).exp();
                system.invariant(index, y) / (decay * initial) - 1.0
            });
            let (sum, _) =
                defects.fold((0.0, 0.0), |(sum, last): (f64, f64), d| (sum + (d - last).abs(), d));
            sum
        };
        let (before, after) = (variation(&coarse), variation(&fine));
        claim(
            "exact-conformal",
            &format!(
                "{}: {} = {} obeys the conformal law of degree {} on the exact flow",
                system.name(),
                invariant.name,
                invariant.formula,
                invariant.degree
            ),
            decide(after <= f64::max(before / REDUCTION, ROUND_OFF)),
            format!(
                "variation up to T = 1 of the relative defect of Runge–Kutta on piecewise linear noise: {before:.1e} with \
                 {COARSE}, {after:.1e} with {FINE} steps a piece"
            ),
        )
    };
    system.invariants().iter().enumerate().map(describe).collect()
}
