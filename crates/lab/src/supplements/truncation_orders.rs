//! `truncation-orders`: what the truncation order k does to the strong error.

use noise::Truncation;
use schemes::Sexp;
use systems::RigidBody;
use systems::paper::{rigid_body_one_noise, valid};
use verify::results::{Kind, Panel};

use crate::experiment::{Conditions, Findings, describe};
use crate::kernels::compiled;
use crate::method::Method;
use crate::panels::strong::{Curve, Grid, StrongRuns, reference_words};

/// Strong errors of `sexp` with k = 1, 2, 4 and without truncation, on the same noise.
pub(super) fn measure(conditions: &Conditions<'_>) -> Findings {
    let problem = rigid_body_one_noise();
    let grid = conditions.choose(Grid { last: 12, samples: 1000 }, Grid { last: 10, samples: 512 });
    let steps = format!(
        "{}, increments truncated with k = 1, 2, 4 and not at all, those of the reference by the \
         same rule",
        grid.words()
    );
    let id = "truncation-orders";
    let mut panel = Panel {
        id: id.to_owned(),
        kind: Kind::Strong,
        title: "What the truncation order k does: sexp on the rigid body, only W₁".to_owned(),
        setup: describe("rigid body, only W₁, I = (2, 1, 2/3), Î₁ = 1", &problem, &steps),
        paper: "The theorems ask k ≥ 2 for order 1; the k of the experiments is not stated. With \
                k = 1 clipped increments spoil the order, with k = 2 a handful of them dominates \
                the mean-square error of coarse steps."
            .to_owned(),
        samples: grid.samples,
        reference: reference_words(Method::Sexp.id(), grid),
        ..Panel::default()
    };
    let rules = [
        ("sexp, k = 1", Truncation::new(1)),
        ("sexp, k = 2", Truncation::new(2)),
        ("sexp, k = 4", Truncation::new(4)),
        ("sexp, not truncated", Ok(Truncation::none())),
    ];
    let reference = compiled::<_, RigidBody<1>, 3, 1>(Sexp::default());
    for (name, rule) in rules {
        let curve = Curve { name, method: Method::Sexp, scheme: compiled(Sexp::default()) };
        let runs = StrongRuns {
            id,
            problem: &problem,
            grid,
            truncation: valid(rule),
            reference: reference.as_ref(),
            exact: None,
            curves: &[curve],
        };
        let measured = runs.measure(conditions);
        panel.series.extend(measured.curves.into_iter().map(|curve| curve.series));
        panel.failures.extend(measured.failures);
        panel.clipped.extend(measured.clipped);
    }
    Findings { panels: vec![panel], claims: Vec::new() }
}
