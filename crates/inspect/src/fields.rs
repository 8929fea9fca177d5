//! The fields of an equation without B and H.

use serde::Serialize;

use super::Sight;
use crate::facts::{Finding, sum};

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
        let mut found = Self { divergence: Finding::strict(), additive: Finding::default() };
        for m in 0..=sight.probe.noises() {
            let weights = sight.probe.weights(m);
            let field = sight.probe.gradient(&sight.states, &weights);
            let columns = sight.probe.field_columns(&sight.states, &field, &weights);
            let diagonal = |n: usize| columns.iter().enumerate().map(move |(i, of)| of[n][i]);
            sight.record(&mut found.divergence, |n| vec![sum(diagonal(n))], 0.0);
            if m > 0 {
                let entries = |n: usize| columns.iter().flat_map(move |of| &of[n]);
                let change = |n| entries(n).map(|x| (*x, x.abs())).collect();
                sight.record(&mut found.additive, change, 0.0);
            }
        }
        found
    }
}
