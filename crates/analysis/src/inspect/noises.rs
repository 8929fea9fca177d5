//! Whether the noises commute, which decides the strong orders.

use serde::Serialize;

use super::{
    algebra::{moved, norm},
    finding::{CLUSTER, Finding, Term, combined, products},
    probe::Local,
    random::{Purpose, Random},
    sight::Sight,
};

/// Commutators and products of the noise fields fₘ = B∇Hₘ.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Noises {
    /// [fₘ, f_l] = 0: strong order one needs no Lévy areas. Holds for one noise.
    pub commute: Finding,
    /// fₘ′f_l = 0: the Itô correction vanishes and Euler–Maruyama has strong order one.
    pub no_correction: Finding,
    /// fₘ = 0 for every m: there is no noise.
    pub silent: Finding,
    /// `commute` and `no_correction` at y₀ and on pilot paths, which may stay where they hold.
    #[serde(skip)]
    pub(super) on_paths: [Finding; 2],
}

impl Noises {
    pub(super) fn of(sight: &mut Sight<'_>) -> Self {
        let mut found = Self {
            commute: Finding::strict(),
            no_correction: Finding::strict(),
            silent: Finding::strict(),
            on_paths: [Finding::strict(), Finding::strict()],
        };
        let noises = sight.probe.noises();
        if noises == 0 {
            return found;
        }
        if sight.locals.is_empty() {
            found.along_directions(sight);
            return found;
        }
        let extent = sight.points.extent();
        for (n, cluster) in sight.locals.chunks(CLUSTER).enumerate() {
            let at = &sight.points.for_identities[n];
            // ‖B‖‖∇Hₘ‖: a field may vanish to round-off.
            let b = norm(&cluster[0].b.concat());
            let length = |m: usize| b * norm(&cluster[0].gradients[m]);
            let fields: Vec<Vec<Field>> = cluster.iter().map(fields).collect();
            let of = |terms: &dyn Fn(&[Field]) -> Vec<Term>| -> Vec<Vec<Term>> {
                fields.iter().map(|fields| terms(fields)).collect()
            };
            for l in 0..noises {
                found.silent.record(at, &of(&|fields| fields[l].terms.clone()), length(l + 1));
                for m in 0..noises {
                    // The size of a derivative of fields that are not nearly constant.
                    let typical = length(l + 1) * length(m + 1) / extent;
                    let record = |[all, on_paths]: [&mut Finding; 2], terms: Vec<Vec<Term>>| {
                        all.record(at, &terms, typical);
                        if sight.points.on_path(n) {
                            on_paths.record(at, &terms, typical);
                        }
                    };
                    let [commute, correction] = &mut found.on_paths;
                    let product = of(&|fields| fields[l].along(&fields[m]));
                    record([&mut found.no_correction, correction], product);
                    if m < l {
                        let commutator = of(&|fields| {
                            let other = fields[m].along(&fields[l]);
                            combined(&fields[l].along(&fields[m]), -1.0, &other)
                        });
                        record([&mut found.commute, commute], commutator);
                    }
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
        let mut product = |l: usize, m: usize| {
            let bent = probe.structure_along(states, &fields[m], &slopes[l]);
            let curved = probe.hessian(states, &fields[m], &weights[l]);
            let curved = probe.structure(states, &curved);
            bent.iter().zip(&curved).map(|(a, b)| moved(a, 1.0, b)).collect::<Vec<_>>()
        };
        let (own, one, other) = (product(0, 0), product(0, 1), product(1, 0));
        let sized = |f: &Vec<f64>, size: &dyn Fn(f64) -> f64| -> Vec<Term> {
            f.iter().map(|x| (*x, size(*x))).collect()
        };
        let silent = fields[0].iter().zip(&slopes[0]).map(|(f, v)| sized(f, &|_| norm(v)));
        sight.record(&mut self.silent, silent);
        sight.record(&mut self.no_correction, own.iter().map(|x| sized(x, &f64::abs)));
        if weights[0].len() > 2 {
            let commutator = one.iter().zip(&other).map(|(a, b)| {
                let size = norm(a) + norm(b);
                sized(&moved(a, -1.0, b), &|_| size)
            });
            sight.record(&mut self.commute, commutator);
        }
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
