//! Lévy areas of a block of paths: their truncation, and Chen's relation.

use real::Row;

use crate::{NoiseError, Truncation, clip};

impl Truncation {
    /// The largest |Â_ij| at step `tau`: (k/π) τ|log τ|, which is 1/(2π) times the square of
    /// [`Truncation::bound`]. Infinite for [`Truncation::none`].
    ///
    /// A_ij has the density sech(πx/τ)/τ, so E[(A − Â)²] ≤ (8/π³) τ^{2+k}. A method of strong order
    /// one tolerates an error of order τ³ in a step, so k ≥ 1 suffices.
    ///
    /// # Errors
    /// [`NoiseError::StepOutsideUnitInterval`] unless 0 < τ < 1.
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

/// Writes the areas of so many noises, clipped to ±`bound`, into `clipped`.
pub fn clip_areas(noises: usize, areas: &[Row], bound: f64, clipped: &mut [Row]) {
    for i in 0..noises {
        let above = i * noises + i + 1..(i + 1) * noises;
        clip(&areas[above.clone()], bound, &mut clipped[above]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Noise, StepNoise};
    use approx::assert_relative_eq;

    #[test]
    fn clipping_keeps_signs() {
        let mut noise = StepNoise::with_areas(3);
        let areas = [[0.0, 5.0, -7.0], [0.0, 0.0, 0.5], [0.0; 3]];
        noise.set_path(0, &Noise { increments: [0.0; 3], areas });
        let mut clipped = StepNoise::with_areas(3);
        clip_areas(3, &noise.areas, 1.0, &mut clipped.areas);
        let expected = [[0.0, 1.0, -1.0], [-1.0, 0.0, 0.5], [1.0, -0.5, 0.0]];
        assert_eq!(clipped.path::<3>(0).areas, expected);
        clip_areas(3, &noise.areas, f64::INFINITY, &mut clipped.areas);
        assert_eq!(clipped.areas[..], noise.areas[..]);
    }

    #[test]
    fn the_bound_is_the_one_of_the_increments_squared() {
        let tau: f64 = 1.0 / 512.0;
        let expected = 2.0 / std::f64::consts::PI * tau * tau.ln().abs();
        let bound = Truncation::new(2).unwrap().area_bound(tau).unwrap();
        assert_relative_eq!(bound, expected, epsilon = 0.0, max_relative = 1e-15);
        assert!(Truncation::new(2).unwrap().area_bound(1.0).is_err());
        assert_eq!(Truncation::none().area_bound(0.5), Ok(f64::INFINITY));
    }
}
