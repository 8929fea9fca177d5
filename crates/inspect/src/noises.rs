//! Whether the noises commute, which decides the strong orders.

use serde::Serialize;

use super::Sight;
use crate::facts::{Batch, CLUSTER, Finding, Purpose, Random, Term, norm, sum};

/// Commutators of the noise fields fₘ = B∇Hₘ.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Noises {
    /// Finding on [fₘ, f_l] = 0: strong order one needs no Lévy areas. Holds for one noise.
    pub commute: Finding,
    /// Finding on [fₘ, f_l] = 0 at y₀: paths may stay where it holds.
    #[serde(skip)]
    pub(super) at_start: Finding,
}

/// Largest number of noises that are checked pairwise; more are checked as two random combinations.
const FEW: usize = 32;

impl Noises {
    pub(super) fn of(sight: &mut Sight<'_>) -> Self {
        let mut found = Self { commute: Finding::strict(), at_start: Finding::strict() };
        let noises = sight.probe.noises();
        if noises < 2 {
            return found;
        }
        let few = !sight.matrices.is_empty() && noises <= FEW;
        let mut random = Random::new(Purpose::Areas);
        let weights: Vec<Vec<f64>> = match few {
            true => (1..=noises).map(|m| sight.probe.weights(m)).collect(),
            // Two random combinations of all noises commute if all do.
            false => (0..2).map(|_| sight.weights_of_noises(&mut random)).collect(),
        };
        let Sight { probe, points, states, matrices } = sight;
        let slopes: Vec<Batch> = weights.iter().map(|h| probe.gradient(states, h)).collect();
        let fields: Vec<Batch> = slopes.iter().map(|dh| probe.structure(states, dh)).collect();
        // The columns of f′; of many components f′ along the other field.
        let derivative = |m: usize| match few {
            true => probe.field_columns(states, &slopes[m], &weights[m]),
            false => vec![probe.field_along(states, &fields[1 - m], &slopes[m], &weights[m])],
        };
        let derivatives: Vec<Vec<Batch>> = (0..weights.len()).map(derivative).collect();
        let norms = points.for_identities.iter().map(|y| norm(y));
        let extent = norms.fold(f64::MIN_POSITIVE, f64::max);
        for (l, m) in (0..weights.len()).flat_map(|l| (0..l).map(move |m| (l, m))) {
            let entry = |n: usize, i: usize| {
                let product = |l: usize, m: usize, sign: f64| {
                    let columns = derivatives[l].iter().zip(&fields[m][n]);
                    columns.map(move |(column, f)| sign * column[n][i] * if few { *f } else { 1.0 })
                };
                sum(product(l, m, 1.0).chain(product(m, l, -1.0)))
            };
            let terms = |n: usize| (0..states[n].len()).map(|i| entry(n, i)).collect();
            let terms: Vec<Vec<Term>> = (0..states.len()).map(terms).collect();
            for (n, cluster) in terms.chunks(CLUSTER).enumerate() {
                let at = &points.for_identities[n];
                // ‖B‖‖∇h‖: a field may vanish to round-off.
                let b = matrices.get(n * CLUSTER).filter(|_| !probe.description.plain);
                let length = |m: usize| match b {
                    Some(b) => norm(&b.concat()) * norm(&slopes[m][n * CLUSTER]),
                    None => norm(&fields[m][n * CLUSTER]),
                };
                // The size of a derivative of fields that are not nearly constant.
                let typical = length(l) * length(m) / extent;
                found.commute.record(at, cluster, typical);
                if n == points.random {
                    found.at_start.record(at, cluster, typical);
                }
            }
        }
        found
    }
}
