//! Whether the noises commute, which decides the strong orders.

use serde::Serialize;

use super::{
    algebra::{moved, norm},
    finding::{CLUSTER, Finding, Term, combined, products},
    probe::Local,
    random::{Purpose, Random},
    sight::Sight,
};

/// Commutators of the noise fields fₘ = B∇Hₘ.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Noises {
    /// [fₘ, f_l] = 0: strong order one needs no Lévy areas. Holds for one noise.
    pub commute: Finding,
    /// The same at y₀: paths may stay where it holds.
    #[serde(skip)]
    pub(super) at_start: Finding,
}

impl Noises {
    pub(super) fn of(sight: &mut Sight<'_>) -> Self {
        let mut found = Self { commute: Finding::strict(), at_start: Finding::strict() };
        let noises = sight.probe.noises();
        if sight.locals.is_empty() && noises > 1 {
            found.along_directions(sight);
        }
        let extent = sight.points.extent();
        for (n, cluster) in sight.locals.chunks(CLUSTER).enumerate() {
            let at = &sight.points.for_identities[n];
            // ‖B‖‖∇Hₘ‖: a field may vanish to round-off.
            let b = norm(&cluster[0].b.concat());
            let length = |m: usize| b * norm(&cluster[0].gradients[m + 1]);
            let fields: Vec<Vec<Field>> = cluster.iter().map(fields).collect();
            for (l, m) in (0..noises).flat_map(|l| (0..l).map(move |m| (l, m))) {
                let commutator = |fields: &Vec<Field>| {
                    let [one, other] = [(l, m), (m, l)].map(|(l, m)| fields[l].along(&fields[m]));
                    combined(&one, -1.0, &other)
                };
                let terms: Vec<Vec<Term>> = fields.iter().map(commutator).collect();
                // The size of a derivative of fields that are not nearly constant.
                let typical = length(l) * length(m) / extent;
                found.commute.record(at, &terms, typical);
                if n == sight.points.random {
                    found.at_start.record(at, &terms, typical);
                }
            }
        }
        found
    }

    /// Random combinations of all noises commute if all do.
    fn along_directions(&mut self, sight: &mut Sight<'_>) {
        let mut random = Random::new(Purpose::Areas);
        let weights = [0, 1].map(|_| {
            let mut weights = sight.weights(&mut random);
            weights[0] = 0.0;
            weights
        });
        let Sight { probe, states, .. } = &mut *sight;
        let slopes = weights.each_ref().map(|weights| probe.gradient(states, weights));
        let fields = slopes.each_ref().map(|slopes| probe.structure(states, slopes));
        let [one, other] = [(0, 1), (1, 0)].map(|(l, m)| {
            let bent = probe.structure_along(states, &fields[m], &slopes[l]);
            let curved = probe.hessian(states, &fields[m], &weights[l]);
            let curved = probe.structure(states, &curved);
            bent.iter().zip(&curved).map(|(a, b)| moved(a, 1.0, b)).collect::<Vec<_>>()
        });
        let commutator = one.iter().zip(&other).map(|(a, b)| {
            let size = norm(a) + norm(b);
            moved(a, -1.0, b).into_iter().map(|x| (x, size)).collect()
        });
        sight.record(&mut self.commute, commutator);
    }
}

/// A noise field at a state, and the columns of its derivative.
struct Field {
    terms: Vec<Term>,
    columns: Vec<Vec<Term>>,
}

/// The fields of all noises.
fn fields(local: &Local) -> Vec<Field> {
    let Local { b, slopes, gradients, hessians, .. } = local;
    let field = |m: usize| {
        let column = |j: usize| {
            let curved: Vec<f64> = hessians[m].iter().map(|row| row[j]).collect();
            combined(&products(&slopes[j], &gradients[m]), 1.0, &products(b, &curved))
        };
        let columns = (0..b.len()).map(column).collect();
        Field { terms: products(b, &gradients[m]), columns }
    };
    (1..gradients.len()).map(field).collect()
}

impl Field {
    /// f′g.
    fn along(&self, g: &Field) -> Vec<Term> {
        let entry = |i: usize| {
            let terms = g.terms.iter().zip(&self.columns);
            terms.fold((0.0, 0.0), |(sum, size), ((x, s), column)| {
                (sum + column[i].0 * x, size + column[i].1 * s)
            })
        };
        (0..g.terms.len()).map(entry).collect()
    }
}
