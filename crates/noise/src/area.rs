//! Lévy areas of a block of paths: their truncation, and Chen's relation.

use real::Row;

use crate::{NoiseError, Truncation};

impl Truncation {
    /// The largest |Â_ij| at step `tau`: (k/π) τ|log τ|, which is 1/(2π) times the square of
    /// [`Truncation::bound`]. Infinite for [`Truncation::none`].
    ///
    /// A_ij has the density sech(πx/τ)/τ, so E[(A − Â)²] ≤ (8/π³) τ^{2+k}. A method of strong order
    /// one tolerates an error of order τ³ in a step, so k ≥ 1 suffices.
    ///
    /// # Errors
    /// [`NoiseError`] unless 0 < τ < 1.
    pub fn area_bound(self, tau: f64) -> Result<f64, NoiseError> {
        let bound = self.bound(tau)?;
        Ok(bound * bound / (2.0 * std::f64::consts::PI))
    }
}

/// Chen's relation (Chen 1957) for two consecutive steps with areas A′, A″ and increments W′, W″:
/// the areas over both are A = A′ + A″ + ½(W′W″ᵀ − W″W′ᵀ). `areas` is A′ before and A after.
///
/// Increments have a row for each noise, areas one for each pair as in
/// [`StepNoise`](crate::StepNoise).
pub fn join(areas: &mut [Row], first: &[Row], second_areas: &[Row], second: &[Row]) {
    let noises = first.len();
    for i in 0..noises {
        for j in i + 1..noises {
            let (area, second_area) = (&mut areas[i * noises + j], &second_areas[i * noises + j]);
            let ((first_i, first_j), (second_i, second_j)) =
                ((&first[i], &first[j]), (&second[i], &second[j]));
            for (p, area) in area.iter_mut().enumerate() {
                let wedge = first_i[p] * second_j[p] - second_i[p] * first_j[p];
                *area = (*area + second_area[p]) + 0.5 * wedge;
            }
        }
    }
}
