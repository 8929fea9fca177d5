//! Whether the noises commute, which decides the strong orders.

use real::Bounded;
use serde::Serialize;

use super::{
    algebra::{size, times},
    erased::System,
    finding::Finding,
    points::{Points, Purpose, Random},
};

/// Commutators and products of the noise fields fₘ = B∇Hₘ.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Noises {
    /// [fₘ, f_l] = 0: strong order one needs no Lévy areas. Holds for one noise.
    pub commute: Finding,
    /// fₘ′f_l = 0: the Itô correction vanishes and Euler–Maruyama has strong order one.
    pub no_correction: Finding,
    /// `commutators` is Σ A_ml [fₘ, f_l].
    pub commutators: Finding,
}

impl Noises {
    pub(super) fn of(system: &dyn System, points: &Points) -> Self {
        let (noises, d) = (system.noises(), system.dimension());
        let zero = Bounded::exact(0.0);
        let mut found = Self::default();
        let mut random = Random::new(Purpose::Areas);
        for y in &points.for_identities {
            let (fields, derivatives): (Vec<_>, Vec<_>) =
                (1..=noises).map(|m| system.field(y, &system.weights(m))).unzip();
            let mut areas = vec![vec![0.0; noises]; noises];
            let (mut sum, mut sizes) = (vec![zero; d], vec![0.0; d]);
            for l in 0..noises {
                for m in 0..noises {
                    let product = times(&derivatives[l], &fields[m]);
                    for i in 0..d {
                        let terms = size(&derivatives[l][i], &fields[m]);
                        found.no_correction.record(product[i], terms, y);
                    }
                    if m < l {
                        let exchanged = times(&derivatives[m], &fields[l]);
                        areas[m][l] = random.uniform();
                        areas[l][m] = -areas[m][l];
                        for i in 0..d {
                            let commutator = product[i] - exchanged[i];
                            let terms = size(&derivatives[l][i], &fields[m])
                                + size(&derivatives[m][i], &fields[l]);
                            found.commute.record(commutator, terms, y);
                            sizes[i] += terms;
                            sum[i] = sum[i] + commutator * Bounded::exact(areas[m][l]);
                        }
                    }
                }
            }
            if noises > 1 {
                let given = system.commutators(y, &areas);
                for i in 0..d {
                    found.commutators.record(given[i] - sum[i], sizes[i], y);
                }
            }
        }
        found
    }
}
