//! Whether the noises commute, which decides the strong orders.

use serde::Serialize;

use super::Sight;
use crate::facts::{Batch, CLUSTER, Finding, Purpose, Random, Term, axis, norm, sum};

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
        // Two random combinations of all noises commute if all do.
        let mut combination = || {
            let mut weights = sight.weights(&mut random);
            weights[0] = 0.0;
            weights
        };
        let weights: Vec<Vec<f64>> = match few {
            true => (1..=noises).map(|m| sight.probe.weights(m)).collect(),
            false => vec![combination(), combination()],
        };
        let Sight { probe, points, states, matrices } = sight;
        let (d, plain) = (probe.dimension(), probe.description().plain);
        let slopes: Vec<Batch> = weights.iter().map(|h| probe.gradient(states, h)).collect();
        let fields: Vec<Batch> = slopes.iter().map(|dh| probe.structure(states, dh)).collect();
        let mut along =
            |m: usize, u: &[Vec<f64>]| probe.field_along(states, u, &slopes[m], &weights[m]);
        // The columns of f′; of many components f′ along the other field.
        let derivatives: Vec<Vec<Batch>> = match few {
            true => {
                (0..noises).map(|m| (0..d).map(|k| along(m, &[axis(d, k)])).collect()).collect()
            }
            false => vec![vec![along(0, &fields[1])], vec![along(1, &fields[0])]],
        };
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
            let terms = |n: usize| (0..d).map(|i| entry(n, i)).collect();
            let terms: Vec<Vec<Term>> = (0..states.len()).map(terms).collect();
            for (n, cluster) in terms.chunks(CLUSTER).enumerate() {
                // ‖B‖‖∇h‖: a field may vanish to round-off.
                let b = matrices.get(n * CLUSTER).filter(|_| !plain);
                let length = |m: usize| match b {
                    Some(b) => norm(&b.concat()) * norm(&slopes[m][n * CLUSTER]),
                    None => norm(&fields[m][n * CLUSTER]),
                };
                // The size of a derivative of fields that are not nearly constant.
                let typical = length(l) * length(m) / extent;
                let record = |to: &mut Finding| {
                    to.record(&points.for_identities[n], cluster, typical);
                };
                record(&mut found.commute);
                if n == points.random {
                    record(&mut found.at_start);
                }
            }
        }
        found
    }
}
