//! `truncation-orders`: the effect of the truncation order k on the strong error.

use crate::*;

const WORDS: Words = [
    "What the truncation order k does: sexp on the rigid body, only W₁",
    BODY_1,
    "The theorems ask k ≥ 2 for order 1; the k of the experiments is not stated. With k = 1 \
     clipped increments spoil the order, with k = 2 a handful of them dominates the mean-square \
     error of coarse steps.",
];

/// Strong errors of `sexp` with k = 1, 2, 4 and without truncation, on the same noise.
pub fn measure(conditions: &Conditions) -> Findings {
    let problem = paper::rigid_body_one_noise();
    let rules = [
        ("sexp, k = 1", Truncation::new(1)),
        ("sexp, k = 2", Truncation::new(2)),
        ("sexp, k = 4", Truncation::new(4)),
        ("sexp, not truncated", Ok(Truncation::none())),
    ];
    let panels = rules.into_iter().flat_map(|(name, rule)| {
        let curve = Curve { name, method: BuiltIn::Sexp, setup: Compiled::of(&problem).sexp() };
        let panel = StrongPanel {
            truncation: valid(rule),
            truncated: "increments truncated with k = 1, 2, 4 and not at all, those of the \
                        reference by the same rule",
            ..StrongPanel::new(WORDS, conditions.choose((12, 1000), (10, 512)))
        };
        panel.measure(conditions, &[curve]).panels
    });
    let together = panels.reduce(|mut all, panel| {
        all.series.extend(panel.series);
        all.failures.extend(panel.failures);
        all.clipped.extend(panel.clipped);
        all
    });
    Findings { panels: together.into_iter().collect(), claims: Vec::new() }
}
