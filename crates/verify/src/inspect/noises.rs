//! Whether the noises commute, which decides the strong orders.

use serde::Serialize;

use super::{
    algebra::{Matrix, norm, times},
    erased::System,
    finding::Finding,
    points::{Points, Random},
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
        let mut found = Self::default();
        let mut random = Random::new();
        for y in &points.for_identities {
            let (fields, derivatives): (Matrix, Vec<Matrix>) =
                (1..=noises).map(|m| system.field(y, &system.weights(m))).unzip();
            // ‖f_l′‖‖fₘ‖: cancellation within f_l′fₘ must not pass for a commutator.
            let size = |l: usize, m: usize| norm(&derivatives[l].concat()) * norm(&fields[m]);
            let mut areas = vec![vec![0.0; noises]; noises];
            let (mut sum, mut sum_size) = (vec![0.0; d], 0.0);
            for l in 0..noises {
                for m in 0..noises {
                    let product = times(&derivatives[l], &fields[m]);
                    found.no_correction.compare(&product, &vec![0.0; d], size(l, m), y);
                    if m < l {
                        let exchanged = times(&derivatives[m], &fields[l]);
                        let size = size(l, m) + size(m, l);
                        found.commute.compare(&product, &exchanged, size, y);
                        areas[m][l] = random.uniform();
                        areas[l][m] = -areas[m][l];
                        sum_size += size;
                        for i in 0..d {
                            sum[i] += areas[m][l] * (product[i] - exchanged[i]);
                        }
                    }
                }
            }
            if noises > 1 {
                found.commutators.compare(&system.commutators(y, &areas), &sum, sum_size, y);
            }
        }
        found
    }
}
