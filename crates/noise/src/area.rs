//! Lévy areas of a block of paths, their truncation, and Chen's relation on a dyadic ladder.

use real::{Row, Rows};

use crate::{DyadicLadder, NoiseError, Truncation, clip, step::zero_rows};

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

/// Lévy areas over every coarser step of a [`DyadicLadder`], by Chen's relation ([`join`]).
#[derive(Debug)]
pub struct AreaLadder {
    noises: usize,
    /// The M² rows of level 0, of level 1, and so on.
    first_half: Rows,
    joined: Rows,
}

impl AreaLadder {
    /// A ladder of `levels` levels above the finest, for a [`DyadicLadder`] with the same numbers.
    ///
    /// # Panics
    /// If there is no memory for it.
    pub fn new(noises: usize, levels: usize) -> Self {
        let zero = || zero_rows(noises.saturating_mul(noises).saturating_mul(levels + 1));
        Self { noises, first_half: zero(), joined: zero() }
    }

    /// Adds the areas of the next finest step. Push its increment to `sums` first and pass the
    /// result of [`DyadicLadder::push`] as `complete`.
    ///
    /// # Panics
    /// Unless `areas` has a row for each pair of noises.
    pub fn push(&mut self, areas: &[Row], sums: &DyadicLadder, complete: usize) {
        let size = self.noises * self.noises;
        self.joined[..size].copy_from_slice(areas);
        for level in 1..=complete {
            let (below, joined) = self.joined[(level - 1) * size..][..2 * size].split_at_mut(size);
            joined.copy_from_slice(&self.first_half[level * size..][..size]);
            join(joined, sums.first_half(level), below, sums.increment(level - 1));
        }
        if let Some(first_half) = self.first_half.get_mut((complete + 1) * size..) {
            let joined = &self.joined[complete * size..][..size];
            first_half.iter_mut().zip(joined).for_each(|(row, joined)| *row = *joined);
        }
    }

    /// The areas over the last complete step of `level`.
    pub fn areas(&self, level: usize) -> &[Row] {
        let size = self.noises * self.noises;
        &self.joined[level * size..][..size]
    }

    /// The areas over the first half of the last complete step of `level` ≥ 1. Those of the second
    /// half are [`areas`](Self::areas) of the level below.
    pub fn first_half(&self, level: usize) -> &[Row] {
        let size = self.noises * self.noises;
        &self.first_half[level * size..][..size]
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
    use approx::assert_relative_eq;
    use real::{Block, WIDTH};

    use super::*;
    use crate::{Noise, StepNoise};

    /// A piecewise linear path; its areas are sums of triangles.
    fn pieces() -> Vec<[f64; 3]> {
        (0..32)
            .map(|n| {
                [(n * n % 7) as f64 - 3.0, (n * 5 % 11) as f64 - 5.0, (n * 3 % 13) as f64 - 6.0]
            })
            .collect()
    }

    /// ½ Σ (W_i ΔW_j − W_j ΔW_i) over the pieces, exact in floating point: all terms are integers
    /// or halves.
    fn area_of(pieces: &[[f64; 3]], i: usize, j: usize) -> f64 {
        let (mut at, mut area) = ([0.0; 3], 0.0);
        for piece in pieces {
            area += 0.5 * (at[i] * piece[j] - at[j] * piece[i]);
            for m in 0..3 {
                at[m] += piece[m];
            }
        }
        area
    }

    #[test]
    fn the_ladder_joins_the_area_of_the_path() {
        let pieces = pieces();
        let (mut sums, mut areas) = (DyadicLadder::new(3, 4), AreaLadder::new(3, 4));
        for (n, piece) in pieces.iter().enumerate() {
            let complete = sums.push(&Block::splat(*piece).0);
            areas.push(&[[0.0; WIDTH]; 9], &sums, complete);
            for level in 0..=complete {
                let step = &pieces[n + 1 - (1 << level)..=n];
                let halves = step.split_at(step.len() / 2);
                for (i, j) in [(0, 1), (0, 2), (1, 2)] {
                    let of = |pieces: &[[f64; 3]]| [area_of(pieces, i, j); WIDTH];
                    assert_eq!(areas.areas(level)[3 * i + j], of(step), "{n} {level}");
                    if level > 0 {
                        assert_eq!(areas.first_half(level)[3 * i + j], of(halves.0));
                        assert_eq!(areas.areas(level - 1)[3 * i + j], of(halves.1));
                    }
                }
            }
        }
    }

    #[test]
    fn areas_of_the_finest_steps_are_added() {
        let (mut sums, mut areas) = (DyadicLadder::new(2, 1), AreaLadder::new(2, 1));
        for area in [2.0, -0.5] {
            let mut finest = StepNoise::with_areas(2);
            finest.set_path(3, &Noise { increments: [0.0; 2], areas: [[7.0, area], [7.0; 2]] });
            let entries = [0, 1, 2, 3].map(|row: usize| finest.areas[row][3]);
            assert_eq!(entries, [0.0, area, 0.0, 0.0]);
            let complete = sums.push(&[[0.0; WIDTH]; 2]);
            areas.push(&finest.areas, &sums, complete);
        }
        let joined = |p: usize| [0, 1, 2, 3].map(|row: usize| areas.areas(1)[row][p]);
        assert_eq!(joined(3), [0.0, 1.5, 0.0, 0.0]);
        assert_eq!(joined(4), [0.0; 4]);
    }

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
