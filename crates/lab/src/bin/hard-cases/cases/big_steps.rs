//! Steps up to 0.9, where truncation is still defined.

use anyhow::Result;
use systems::paper::half_cosine;

use super::{Case, Context, Words, body, each};
use crate::paths::{CASIMIR, Experiment};
use crate::results::Row;

pub const CASE: Case = Case {
    words: Words {
        id: "big-steps",
        title: "Big steps",
        setup: "Rigid body with three noises, γ = ½cos 2t, 64 steps, increments truncated with k = \
                4; several paths.",
        mathematics: "The scheme keeps the conformal law for every τ for which its equation has a \
                      solution; the theory of its convergence is about small τ only.",
        quantity: "largest relative distance of |y|² from its law over all paths",
        guarantee: "`sexp` in all forms: on the law to rounding at every τ < 1, or a typed error. \
                    Nothing is guaranteed of the others.",
        varied: "τ",
        plot: None,
    },
    rows,
};

fn rows(context: &Context) -> Result<Vec<Row>> {
    let paths = context.arguments.many(32, 4);
    each([0.1, 0.3, 0.5, 0.7, 0.9], |tau| {
        let experiment = body(context, half_cosine(), (64, tau))?;
        Experiment { paths, ..experiment }.law_rows(tau, &CASIMIR, |_| None)
    })
}
