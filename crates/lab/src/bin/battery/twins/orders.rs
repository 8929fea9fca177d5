//! Twins of the convergence orders.

use ::systems::paper::{INERTIA, NOISE_INERTIA, half_cosine, rigid_body_start, valid};
use ::systems::{Cosine, Damping, PoissonSystem, Problem, RigidBody, ito_correction, vector_field};
use mc::Observable;
use noise::Truncation;
use nonlin::{BlockStatus, Solution};
use real::{Block, WIDTH};
use schemes::{EulerMaruyama, Scheme, Sexp, Step};
use verify::results::Claim;
use verify::{Order, PathScheme, StepSizes, claim, order_verdict, strong_order, weak_order};

use crate::experiment::{Context, truncation};
use crate::panels::rate_evidence;

pub(super) fn three_noises() -> Problem<RigidBody<3>, Cosine, 3> {
    let body = valid(RigidBody::three_noises(INERTIA, NOISE_INERTIA));
    valid(Problem::new(body, half_cosine(), rigid_body_start(), 1.0))
}

fn one_noise() -> Problem<RigidBody<1>, Cosine, 3> {
    let body = valid(RigidBody::one_noise(INERTIA, NOISE_INERTIA[0]));
    valid(Problem::new(body, half_cosine(), rigid_body_start(), 1.0))
}

/// Step sizes 2⁻⁵ … 2⁻¹², reference 2⁻¹⁴: enough levels and paths to tell order ½ from order 1 on
/// every seed.
fn step_sizes(context: &Context<'_>, truncation: Truncation) -> StepSizes {
    StepSizes {
        coarsest_steps: 32,
        levels: 8,
        refinement: 2,
        samples: 512,
        truncation,
        key: context.key(0),
    }
}

pub(super) fn strong<S, G, const M: usize>(
    context: &Context<'_>,
    id: &str,
    problem: &Problem<S, G, 3>,
    scheme: &dyn Scheme<S, 3, M>,
    order: f64,
) -> Claim
where
    S: PoissonSystem<3, M>,
    G: Damping,
{
    // Areas cost more normals the finer the steps: 2⁻⁴ … 2⁻¹¹ and a reference at 2⁻¹³ will do.
    let coarsest_steps = if scheme.needs_areas() { 16 } else { 32 };
    let measured = strong_order(
        scheme,
        problem,
        &StepSizes { coarsest_steps, ..step_sizes(context, truncation()) },
    )
    .unwrap_or_else(|error| unreachable!("the set-ups of the paper are valid: {error}"));
    order_claim(id, &format!("strong order {order}"), &measured, order)
}

fn order_claim(id: &str, statement: &str, measured: &Order, order: f64) -> Claim {
    let rate = measured.rate.as_ref();
    claim(id, statement, order_verdict(rate, order), rate_evidence(rate))
}

/// A step of the rigid body as a function.
trait BodyStep<const M: usize>:
    Fn(&RigidBody<M>, &Step, [f64; M], [f64; 3]) -> [f64; 3] + Send + Sync
{
}

impl<F, const M: usize> BodyStep<M> for F where
    F: Fn(&RigidBody<M>, &Step, [f64; M], [f64; 3]) -> [f64; 3] + Send + Sync
{
}

/// Euler–Maruyama with the Itô correction taken `factor` times.
fn miscorrected<const M: usize>(factor: f64) -> PathScheme<impl BodyStep<M>> {
    PathScheme {
        id: "em, wrong correction",
        advance: move |system: &RigidBody<M>, step: &Step, dw: [f64; M], y: [f64; 3]| {
            let (field, correction) =
                (vector_field(system, y, step.tau, dw), ito_correction(system, y));
            std::array::from_fn(|i| {
                y[i] + field[i] + step.tau * (factor * correction[i] - step.rate_at_start * y[i])
            })
        },
    }
}

pub(super) fn correction_dropped(context: &Context<'_>) -> Claim {
    strong(context, "strong-half", &three_noises(), &miscorrected::<3>(0.0), 0.5)
}

pub(super) fn correction_doubled(context: &Context<'_>) -> Claim {
    strong(context, "strong-half", &three_noises(), &miscorrected::<3>(2.0), 0.5)
}

pub(super) fn shared_stream(context: &Context<'_>) -> Claim {
    let wrong = PathScheme {
        id: "sexp, shared stream",
        advance: |system: &RigidBody<3>, step: &Step, dw: [f64; 3], y: [f64; 3]| {
            Sexp::default().step(system, step, [dw[0], dw[0], dw[2]], y).z
        },
    };
    strong(context, "strong-half", &three_noises(), &wrong, 0.5)
}

/// sexp on the increments of the neighbouring path: the right law, drawn afresh.
struct FreshIncrements;

impl Scheme<RigidBody<3>, 3, 3> for FreshIncrements {
    fn id(&self) -> &'static str {
        "sexp, fresh increments"
    }
    fn step_block(
        &self,
        system: &RigidBody<3>,
        step: &Step,
        dw: &Block<3>,
        y: &mut Block<3>,
        status: &mut BlockStatus,
    ) {
        let mut neighbour = Block::zero();
        for p in 0..WIDTH {
            neighbour.set_path(p, dw.path((p + 1) % WIDTH));
        }
        Sexp::default().step_block(system, step, &neighbour, y, status);
    }
    fn step(&self, system: &RigidBody<3>, step: &Step, dw: [f64; 3], y: [f64; 3]) -> Solution<3> {
        Sexp::default().step(system, step, dw, y)
    }
}

pub(super) fn fresh_increments(context: &Context<'_>) -> Claim {
    strong(context, "strong-half", &three_noises(), &FreshIncrements, 0.5)
}

pub(super) fn explicit(context: &Context<'_>) -> Claim {
    strong(context, "strong-one", &one_noise(), &EulerMaruyama, 1.0)
}

pub(super) fn truncated_too_early(context: &Context<'_>) -> Claim {
    let wrong = PathScheme {
        id: "sexp, truncated too early",
        advance: |system: &RigidBody<1>, step: &Step, dw: [f64; 1], y: [f64; 3]| {
            let bound = 0.5 * step.tau.sqrt();
            Sexp::default().step(system, step, [dw[0].clamp(-bound, bound)], y).z
        },
    };
    strong(context, "strong-one", &one_noise(), &wrong, 1.0)
}

fn weak(context: &Context<'_>, factor: f64) -> Claim {
    let observable = Observable { name: "y3", function: |y: [f64; 3]| y[2] };
    let sizes = StepSizes { levels: 6, samples: 2048, ..step_sizes(context, truncation()) };
    let measured =
        weak_order(&miscorrected::<3>(factor), &three_noises(), observable, &sizes, None)
            .unwrap_or_else(|error| unreachable!("the set-ups of the paper are valid: {error}"));
    order_claim("weak-one", "weak order 1 for φ = y3", &measured, 1.0)
}

pub(super) fn weak_correction_dropped(context: &Context<'_>) -> Claim {
    weak(context, 0.0)
}

pub(super) fn weak_correction_doubled(context: &Context<'_>) -> Claim {
    weak(context, 2.0)
}
