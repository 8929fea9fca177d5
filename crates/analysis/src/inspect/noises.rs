//! Whether the noises commute, which decides the strong orders.

use serde::Serialize;

use super::{
    algebra::{dot, moved, norm, times},
    finding::{CLUSTER, Finding, Term, products},
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
                            let one = fields[l].along(&fields[m]);
                            let other = fields[m].along(&fields[l]);
                            one.iter().zip(other).map(|(a, b)| (a.0 - b.0, a.1 + b.1)).collect()
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
        let terms = |a: &[f64], b: &[f64]| -> Vec<Term> {
            let size = norm(a) + norm(b);
            a.iter().zip(b).map(|(a, b)| (a - b, size)).collect()
        };
        let sized = |f: &Vec<f64>, size: &dyn Fn(f64) -> f64| {
            f.iter().map(|x| (*x, size(*x))).collect::<Vec<Term>>()
        };
        let silent = fields[0].iter().zip(&slopes[0]).map(|(f, v)| sized(f, &|_| norm(v)));
        sight.record(&mut self.silent, silent);
        sight.record(&mut self.no_correction, own.iter().map(|x| sized(x, &f64::abs)));
        if weights[0].len() > 2 {
            sight.record(&mut self.commute, one.iter().zip(&other).map(|(a, b)| terms(a, b)));
        }
    }
}

/// A noise field at a state, and its derivative, with the sizes of their terms.
struct Field {
    terms: Vec<Term>,
    /// The rows of f′, and the sizes of the terms of each entry.
    slope: [Vec<Vec<f64>>; 2],
}

/// The fields of all noises.
fn fields(local: &Local) -> Vec<Field> {
    let Local { b, slopes, gradients, hessians, .. } = local;
    let d = b.len();
    let absolute = |a: &Vec<f64>| a.iter().map(|x| x.abs()).collect::<Vec<_>>();
    let field = |m: usize| {
        let (v, curved) = (&gradients[m], &hessians[m]);
        let size = absolute(v);
        let [mut values, mut sizes] = [0, 1].map(|_| vec![vec![0.0; d]; d]);
        for j in 0..d {
            let column: Vec<f64> = curved.iter().map(|row| row[j]).collect();
            let bent = times(&slopes[j], v);
            let turned = products(b, &column);
            for i in 0..d {
                values[i][j] = bent[i] + turned[i].0;
                sizes[i][j] = dot(&absolute(&slopes[j][i]), &size) + turned[i].1;
            }
        }
        Field { terms: products(b, v), slope: [values, sizes] }
    };
    (1..gradients.len()).map(field).collect()
}

impl Field {
    /// f′g.
    fn along(&self, g: &Field) -> Vec<Term> {
        let [values, sizes] = &self.slope;
        let entry = |(value, size): (&Vec<f64>, &Vec<f64>)| {
            let terms = g.terms.iter().zip(value.iter().zip(size));
            terms.fold((0.0, 0.0), |(sum, total), ((x, s), (a, b))| (sum + a * x, total + b * s))
        };
        values.iter().zip(sizes).map(entry).collect()
    }
}
