//! `truncation-orders`: what the truncation order k does to the strong error.

use noise::Truncation;
use schemes::Sexp;
use systems::paper::{INERTIA, NOISE_INERTIA, half_cosine, rigid_body_start, valid};
use systems::{Problem, RigidBody};

use crate::experiment::{Context, Yield, truncation};
use crate::kernels::Compiled;
use crate::strong::{Curve, StrongSetup, strong_curves};

/// Strong errors of `sexp` with k = 1, 2, 4 and without truncation, on the same noise.
pub(super) fn run(context: &Context<'_>) -> Yield {
    let body = valid(RigidBody::one_noise(INERTIA, NOISE_INERTIA[0]));
    let problem = valid(Problem::new(body, half_cosine(), rigid_body_start(), 1.0));
    let (last, reference) = context.choose((12, 14), (10, 12));
    let setup = StrongSetup {
        id: "truncation-orders",
        title: "What the truncation order k does: sexp on the rigid body, only W₁",
        paper: "The theorems ask k ≥ 2 for order 1; the k of the experiments is not stated. With k = 1 clipped increments \
                spoil the order, with k = 2 a handful of them dominates the mean-square error of coarse steps.",
        setup: format!(
            "rigid body, only W₁, I = (2, 1, 2/3), Î₁ = 1, γ = 0.5 cos 2 t, y₀ = (cos 1.1, 0, sin 1.1), T = 1, \
             τ = 2^-5 … 2^-{last}, increments truncated with k = 1, 2, 4 and not at all, those of the reference by the same rule"
        ),
        first: 5,
        last,
        reference,
        samples: context.choose(1000, 512),
    };
    let sexp = RigidBody::<1>::sexp(Sexp::default());
    let rules = [
        ("sexp, k = 1", Truncation::new(1)),
        ("sexp, k = 2", Truncation::new(2)),
        ("sexp, k = 4", Ok(truncation())),
        ("sexp, not truncated", Ok(Truncation::none())),
    ];
    let mut panels = rules.into_iter().map(|(name, rule)| {
        let rule = rule.unwrap_or_else(|error| unreachable!("the orders are positive: {error}"));
        strong_curves(
            context,
            &setup,
            &problem,
            rule,
            sexp.as_ref(),
            &[Curve { name: name.to_owned(), scheme: sexp.as_ref() }],
        )
    });
    let mut all = panels.next().unwrap_or_else(|| unreachable!("there are four rules"));
    for panel in panels {
        all.series.extend(panel.series);
        all.failures.extend(panel.failures);
        all.clipped.extend(panel.clipped);
    }
    Yield { panels: vec![all], claims: Vec::new() }
}
