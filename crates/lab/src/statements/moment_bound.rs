//! `moment-bound`: ‖y_n‖ ≤ (F(y₀)/m(F))^{1/p} e^{∫|γ|} almost surely when m(F) = min over the unit
//! sphere of F > 0 (paper, `cor:num`).

use mc::trajectory;
use schemes::{Scheme, Sexp};
use systems::paper::{INERTIA, NOISE_INERTIA, half_cosine, rigid_body_start, valid};
use systems::{
    Constant, Damping, DampingFunction, PoissonSystem, Problem, RigidBody, RigidBodyEnergy, Sine,
};
use verify::results::{Claim, Verdict};
use verify::{claim, decide, worse};

use crate::experiment::{Context, truncation};
use crate::kernels::Compiled;

pub(super) fn measure(context: &Context<'_>) -> Vec<Claim> {
    context.progress.begin("moment-bound", 3);
    let body = valid(RigidBody::three_noises(INERTIA, NOISE_INERTIA));
    let casimir = valid(Problem::new(body, half_cosine(), rigid_body_start(), 10.0));
    let energy = valid(RigidBodyEnergy::new(INERTIA, 1.0));
    let energy = valid(Problem::new(energy, valid(Sine::new(1.0, 1.0)), rigid_body_start(), 10.0));
    // ½|y|² is ½ everywhere on the sphere; H₀ is smallest along the axis of the largest moment of
    // inertia.
    let largest_inertia = INERTIA.iter().copied().fold(0.0, f64::max);
    let claims = vec![
        bound(context, 0, &casimir, RigidBody::<3>::sexp(Sexp::default()).as_ref(), "C", 0.5),
        bound(
            context,
            1,
            &energy,
            RigidBodyEnergy::sexp(Sexp::default()).as_ref(),
            "H",
            0.5 / largest_inertia,
        ),
        bound(context, 2, &undamped(), RigidBody::<3>::sexp(Sexp::default()).as_ref(), "C", 0.5),
    ];
    context.progress.end();
    claims
}

/// The rigid body without damping, where the bound is an equality for every n.
pub(crate) fn undamped() -> Problem<RigidBody<3>, Constant, 3> {
    let body = valid(RigidBody::three_noises(INERTIA, NOISE_INERTIA));
    valid(Problem::new(body, valid(Constant::new(0.0)), rigid_body_start(), 10.0))
}

/// Where the bound is an equality it is missed by the round-off of 1000 steps, 16 ε each if none
/// cancelled.
const ROUND_OFF: f64 = 16_000.0 * f64::EPSILON;

/// Steps on [0, 10]: τ = 0.5, 0.1 and 0.01.
const STEPS: [u64; 3] = [20, 100, 1000];

/// The largest ‖y_n‖ over the bound at t_n, over many paths and all n ≥ 1, for a quadratic F with
/// minimum m.
pub(crate) fn bound<S, G, const M: usize>(
    context: &Context<'_>,
    part: u64,
    problem: &Problem<S, G, 3>,
    scheme: &dyn Scheme<S, 3, M>,
    invariant: &str,
    minimum: f64,
) -> Claim
where
    S: PoissonSystem<3, M>,
    G: Damping,
{
    let index =
        problem.system.invariants().iter().position(|known| known.name == invariant).unwrap_or(0);
    let paths = context.choose(400, 40);
    // |γ| has kinks, so each step of the finest grid is integrated on its own.
    let absolute = valid(DampingFunction::new(|t| problem.damping.rate(t).abs(), 8));
    let start = (problem.system.invariant(index, problem.y0) / minimum).sqrt();
    let (mut largest, mut failed) = (0.0, 0);
    for steps in STEPS {
        let tau = problem.t_end / steps as f64;
        let mut total = 0.0;
        let bounds: Vec<f64> = (0..steps)
            .map(|n| {
                total += absolute.integral(n as f64 * tau, (n + 1) as f64 * tau);
                start * f64::exp(total)
            })
            .collect();
        for path in 0..paths {
            let Ok(followed) =
                trajectory(problem, scheme, steps, truncation(), context.key(part), path)
            else {
                failed += 1;
                continue;
            };
            failed += u64::from(followed.failure.is_some());
            for (y, bound) in followed.states[1..].iter().zip(&bounds) {
                let norm = y.iter().map(|component| component * component).sum::<f64>().sqrt();
                largest = worse(largest, norm / bound);
            }
        }
    }
    claim(
        "moment-bound",
        &format!(
            "{}, {}: ‖y_n‖ ≤ (F(y₀)/m(F))^(1/p) exp ∫|γ| with F = {invariant}",
            problem.system.name(),
            problem.damping.describe()
        ),
        match decide(largest <= 1.0 + ROUND_OFF) {
            // Paths that failed prove nothing about the rest.
            Verdict::Holds if failed > 0 => Verdict::Undecided,
            verdict => verdict,
        },
        format!(
            "largest ‖y_n‖ over its bound: {largest:.4} on {paths} paths with τ = 0.5, 0.1 and 0.01; {failed} paths failed"
        ),
    )
}
