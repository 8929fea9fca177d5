//! `sexp-levy` beyond three dimensions and over long paths.

use mc::trajectory;
use schemes::{Sexp, SexpLevy};
use systems::paper::{INERTIA, NOISE_INERTIA, half_cosine, rigid_body_start, valid};
use systems::{Cosine, Damping, Problem, RigidBody, SpinChain};
use verify::results::Claim;
use verify::{claim, decide, order_verdict, worse};

use crate::experiment::{Context, Yield, truncation};
use crate::kernels::Compiled;
use crate::panels::rate_evidence;
use crate::strong::{Curve, StrongSetup, strong_curves};

/// Two spins with exchange and anisotropy in a field that fluctuates about all three axes: D = 6.
fn spins() -> Problem<SpinChain<6>, Cosine, 6> {
    let chain = valid(SpinChain::new(1.0, 0.5, 0.8));
    valid(Problem::new(chain, half_cosine(), [1.0, 0.0, 0.0, 0.0, 0.6, 0.8], 1.0))
}

pub(super) fn spin_pair(context: &Context<'_>) -> Yield {
    let problem = spins();
    let (last, reference) = context.choose((11, 13), (9, 11));
    let setup = StrongSetup {
        id: "spin-pair-levy",
        title: "Two spins in a fluctuating field: strong convergence with and without Lévy areas",
        paper: "Not in the paper, whose scheme has strong order 1/2 for noises that do not commute.",
        setup: format!(
            "Heisenberg pair, J = 1, K = 0.5, σ = 0.8, D = 6, three noises, {}, T = 1, τ = 2^-5 … 2^-{last}",
            problem.damping.describe()
        ),
        first: 5,
        last,
        reference,
        samples: context.choose(500, 256),
    };
    let levy = SpinChain::sexp_levy(SexpLevy::new(&problem.system, problem.y0));
    let schemes = [SpinChain::sexp(Sexp::default()), levy];
    let curves =
        [0, 1].map(|s| Curve { name: schemes[s].id().to_owned(), scheme: schemes[s].as_ref() });
    let panel =
        strong_curves(context, &setup, &problem, truncation(), schemes[1].as_ref(), &curves);
    let mut claims: Vec<Claim> =
        panel.series.iter().map(|series| order_claim(&panel.id, series)).collect();
    claims.push(keeps_law(context, "spin-pair-levy", &spins()));
    let body = valid(RigidBody::three_noises(INERTIA, NOISE_INERTIA));
    let body = valid(Problem::new(body, half_cosine(), rigid_body_start(), 1.0));
    claims.push(keeps_law(context, "rigid-body-strong-3", &body));
    Yield { panels: vec![panel], claims }
}

/// What a curve of a panel with Lévy areas claims.
pub(crate) fn order_claim(panel: &str, series: &verify::results::Series) -> Claim {
    let (id, order) =
        if series.scheme == "sexp-levy" { ("strong-one-levy", 1.0) } else { ("strong-half", 0.5) };
    let at = if series.quantity == "y(T)" {
        "at the final time"
    } else {
        "largest over the common time grid"
    };
    Claim {
        panel: panel.to_owned(),
        scheme: series.scheme.clone(),
        proven: false,
        ..claim(
            id,
            &format!(
                "{} has strong order {order} for noises that do not commute ({at})",
                series.scheme
            ),
            order_verdict(series.rate.as_ref(), order),
            rate_evidence(series.rate.as_ref()),
        )
    }
}

/// Largest relative defect of a Casimir that counts as round-off on a path of 1000 steps of 2⁻¹⁰:
/// sixteen ε a step, of random sign, are √1000·16 ε = 1.1e-13.
const ROUND_OFF: f64 = 1e-13;
const STEPS: u64 = 1024;
const PATHS: u64 = 32;

/// Every Casimir on its conformal law, at every step of many paths.
fn keeps_law<S, G, const D: usize>(
    context: &Context<'_>,
    panel: &str,
    problem: &Problem<S, G, D>,
) -> Claim
where
    S: Compiled<D, 3>,
    G: Damping,
{
    let levy = S::sexp_levy(SexpLevy::new(&problem.system, problem.y0));
    let invariants = problem.system.invariants();
    let mut largest = 0.0;
    for path in 0..PATHS {
        let path = trajectory(problem, levy.as_ref(), STEPS, truncation(), context.key(3), path)
            .unwrap_or_else(|error| unreachable!("the set-up is valid: {error}"));
        for (index, invariant) in invariants.iter().enumerate() {
            let initial = problem.system.invariant(index, problem.y0);
            for (&t, &y) in path.times.iter().zip(&path.states) {
                let exact = (-invariant.degree * problem.damping.integral(0.0, t)).exp() * initial;
                largest = worse(largest, (problem.system.invariant(index, y) / exact - 1.0).abs());
            }
        }
        if path.failure.is_some() {
            largest = f64::NAN;
        }
    }
    Claim {
        panel: panel.to_owned(),
        scheme: "sexp-levy".to_owned(),
        proven: false,
        ..claim(
            "conformal-casimir",
            "every Casimir obeys the conformal law at every step, Lévy areas included",
            decide(largest <= ROUND_OFF),
            format!("largest relative defect over {PATHS} paths of {STEPS} steps: {largest:.1e}"),
        )
    }
}
