//! Twins of the conformal laws and of the bounds that follow from them.

use ::systems::paper::{
    INERTIA, LOTKA_VOLTERRA_START, NOISE_INERTIA, half_cosine, rigid_body_start, valid,
};
use ::systems::{
    Damping, IntegerExponents, LotkaVolterra, PoissonSystem, Problem, RigidBody, Sine, vector_field,
};
use mc::trajectory;
use schemes::{EulerMaruyama, Scheme, Sexp, Step};
use verify::results::Claim;
use verify::{PathScheme, claim, decide};

use super::systems::{MidpointGradient, SignError};
use crate::approach::{largest_defect, returns_to_law};
use crate::experiment::{Context, truncation};
use crate::invariant::ROUND_OFF_DEFECT;
use crate::statements::{exact_conformal, moment_bound};

fn body() -> RigidBody<3> {
    valid(RigidBody::three_noises(INERTIA, NOISE_INERTIA))
}

/// The paper's set-up of `rigid-body-casimir`.
fn casimir_problem<S: PoissonSystem<3, 3>>(system: S) -> Problem<S, ::systems::Cosine, 3> {
    valid(Problem::new(system, half_cosine(), rigid_body_start(), 10.0))
}

/// The claim of the invariant panels about one scheme: 100 steps of τ = 0.1, first invariant of the
/// system.
fn keeps_law<S, G, const M: usize>(
    context: &Context<'_>,
    id: &str,
    problem: &Problem<S, G, 3>,
    scheme: &dyn Scheme<S, 3, M>,
) -> Claim
where
    S: PoissonSystem<3, M>,
    G: Damping,
{
    let path = trajectory(problem, scheme, 100, truncation(), context.key(0), 0)
        .unwrap_or_else(|error| unreachable!("the set-ups of the paper are valid: {error}"));
    let defect = largest_defect(problem, 0, &path.times, &path.states);
    claim(
        id,
        "the conformal law holds at every step",
        decide(defect <= ROUND_OFF_DEFECT),
        format!("largest relative defect along the path: {defect:.1e}"),
    )
}

pub(super) fn sign_in_exact_flow(context: &Context<'_>) -> Claim {
    let problem = valid(Problem::new(SignError(body()), half_cosine(), rigid_body_start(), 1.0));
    exact_conformal::law(context, 0, &problem).swap_remove(0)
}

pub(super) fn sign_in_structure(context: &Context<'_>) -> Claim {
    keeps_law(context, "conformal-casimir", &casimir_problem(SignError(body())), &Sexp::default())
}

pub(super) fn damping_of_the_wrong_half(context: &Context<'_>) -> Claim {
    let wrong = PathScheme {
        id: "sexp, first half twice",
        advance: |system: &RigidBody<3>, step: &Step, dw: [f64; 3], y: [f64; 3]| {
            let mut wrong = *step;
            wrong.second_decay = step.first_decay;
            Sexp::default().step(system, &wrong, dw, y).z
        },
    };
    keeps_law(context, "conformal-casimir", &casimir_problem(body()), &wrong)
}

/// The drift by `sexp`, the noise added at the old state.
fn drift_then_noise() -> impl Scheme<RigidBody<3>, 3, 3> {
    PathScheme {
        id: "sexp, explicit noise",
        advance: |system: &RigidBody<3>, step: &Step, dw: [f64; 3], y: [f64; 3]| {
            let noise = vector_field(system, y, 0.0, dw);
            let drift = Sexp::default().step(system, step, [0.0; 3], y).z;
            std::array::from_fn(|i| drift[i] + noise[i])
        },
    }
}

pub(super) fn explicit_noise(context: &Context<'_>) -> Claim {
    keeps_law(context, "conformal-casimir", &casimir_problem(body()), &drift_then_noise())
}

pub(super) fn explicit_noise_at_small_steps(context: &Context<'_>) -> Claim {
    // Up to T = 1: the Casimir of the wrong method grows, and much later its paths have no
    // solution.
    let problem = valid(Problem::new(body(), half_cosine(), rigid_body_start(), 1.0));
    let (verdict, evidence) = returns_to_law(context, &problem, &drift_then_noise(), 0, 10);
    claim(
        "conformal-casimir",
        "the Casimir returns to the conformal law as τ → 0",
        verdict,
        evidence,
    )
}

pub(super) fn midpoint_quadrature(context: &Context<'_>) -> Claim {
    let system = MidpointGradient(valid(LotkaVolterra::<IntegerExponents<2, 2>>::integer(1.0)));
    let problem =
        valid(Problem::new(system, valid(Sine::new(1.0, 1.0)), LOTKA_VOLTERRA_START, 10.0));
    keeps_law(context, "energy-balance", &problem, &Sexp::default())
}

pub(super) fn unbounded_scheme(context: &Context<'_>) -> Claim {
    moment_bound::bound(context, 0, &moment_bound::undamped(), &EulerMaruyama, "C", 0.5)
}
