//! The fields of an equation without B and H.

use serde::Serialize;

use super::Sight;
use crate::facts::{Finding, Term, axis, sum};

/// Drift f₀ and noise fields fₘ of an equation that has neither B nor H.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Fields {
    /// Finding on ∇·fₘ = 0 for every m, so that without damping volume is kept.
    pub divergence: Finding,
    /// Finding on noise fields that are the same at all points.
    pub additive: Finding,
}

impl Fields {
    pub(super) fn of(sight: &mut Sight<'_>) -> Self {
        let (d, states) = (sight.probe.dimension(), sight.states.clone());
        let mut found = Self { divergence: Finding::strict(), additive: Finding::default() };
        for m in 0..=sight.probe.noises() {
            let weights = sight.probe.weights(m);
            let field = sight.probe.gradient(&states, &weights);
            let column = |i| sight.probe.field_along(&states, &[axis(d, i)], &field, &weights);
            let columns: Vec<_> = (0..d).map(column).collect();
            let trace = |n: usize| vec![sum((0..d).map(|i| columns[i][n][i]))];
            sight.record(&mut found.divergence, (0..states.len()).map(trace), 0.0);
            if m > 0 {
                let change = |n: usize| -> Vec<Term> {
                    columns.iter().flat_map(|of| &of[n]).map(|x| (*x, x.abs())).collect()
                };
                sight.record(&mut found.additive, (0..states.len()).map(change), 0.0);
            }
        }
        found
    }
}
