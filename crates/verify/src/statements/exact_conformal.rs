//! `exact-conformal`: the exact flow obeys the conformal law (paper, `prop:Casimir`).
//!
//! Along a path with piecewise linear noise the equation is an ordinary differential equation with the same chain
//! rule as the Stratonovich equation, and the law holds exactly. It is integrated by the classical Runge–Kutta method,
//! which knows nothing of the structure: its defect must vanish with the fourth power of its step.

use noise::WienerPath;
use systems::{
    Damping, IntegerExponents, Linear, LotkaVolterra, MaxwellBloch, Poisson3, PoissonSystem, Problem, RigidBody,
    RigidBodyEnergy, Sine,
};

use crate::experiment::Context;
use crate::paper::{INERTIA, NOISE_INERTIA, half_cosine, rigid_body_start, valid};
use crate::results::Claim;
use crate::runge_kutta::piece;
use crate::statement::{claim, decide};

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
        law(context, 4, &valid(Problem::new(valid(Poisson3::new(1.0)), valid(Linear::new(1.0)), [1.0, 2.0, 3.0], 1.0))),
    ];
    context.progress.end();
    claims.into_iter().flatten().collect()
}

/// Linear pieces of the noise on [0, 1].
const PIECES: u64 = 64;
/// Runge–Kutta steps on each piece.
const COARSE: u32 = 4;
const FINE: u32 = 32;
/// Eight times more steps reduce a fourth-order defect by 4096; this leaves room for higher orders of the error.
const REDUCTION: f64 = 1000.0;
/// Round-off of 2048 Runge–Kutta steps: a defect below this has nothing left to be reduced.
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
    let end = |substeps: u32| {
        let tau = problem.t_end / PIECES as f64;
        let mut noise = WienerPath::<M>::new(context.key(part), 0);
        (0..PIECES).fold(problem.y0, |y, n| {
            piece(system, &problem.damping, n as f64 * tau, tau, noise.increments(tau.sqrt()), substeps, y)
        })
    };
    let (coarse, fine) = (end(COARSE), end(FINE));
    let describe = |(index, invariant): (usize, &systems::Invariant)| {
        let exact = (-invariant.degree * problem.damping.integral(0.0, problem.t_end)).exp()
            * system.invariant(index, problem.y0);
        let defect = |y: [f64; D]| (system.invariant(index, y) / exact - 1.0).abs();
        let (before, after) = (defect(coarse), defect(fine));
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
                "relative defect at T = 1 of Runge–Kutta on piecewise linear noise: {before:.1e} with {COARSE}, \
                 {after:.1e} with {FINE} steps a piece"
            ),
        )
    };
    system.invariants().iter().enumerate().map(describe).collect()
}
