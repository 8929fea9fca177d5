//! Lévy areas of a block of paths, their truncation, and Chen's relation on a dyadic ladder.

use real::{Row, WIDTH};

use crate::{DyadicLadder, NoiseError, Truncation, truncation::clip_to};

/// Lévy areas of 32 paths over one step h, in units of time.
///
/// A_ij = ½(J_ij − J_ji) with the iterated Stratonovich integrals J_ij = ∫₀ʰ∫₀ˢ ∘dW_i(r) ∘dW_j(s),
/// hence J = ½WWᵀ + A. A is skew, so only i < j is stored: A_ij of path p is `block.0[i][j][p]`.
/// All other entries are zero.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(64))]
pub struct AreaBlock<const M: usize>(pub [[[f64; WIDTH]; M]; M]);

impl<const M: usize> AreaBlock<M> {
    /// All zero.
    #[inline(always)]
    pub fn zero() -> Self {
        Self([[[0.0; WIDTH]; M]; M])
    }

    /// The skew matrix A of path `p`.
    #[inline(always)]
    pub fn path(&self, p: usize) -> [[f64; M]; M] {
        let mut area = [[0.0; M]; M];
        for i in 0..M {
            for j in 0..M {
                area[i][j] = self.0[i][j][p] - self.0[j][i][p];
            }
        }
        area
    }

    /// Replaces the areas of path `p` by those of a skew matrix. Only its entries i < j are read.
    #[inline(always)]
    pub fn set_path(&mut self, p: usize, area: [[f64; M]; M]) {
        for i in 0..M {
            for j in i + 1..M {
                self.0[i][j][p] = area[i][j];
            }
        }
    }

    /// These areas, each clipped to ±`bound`.
    #[inline]
    pub fn clipped(&self, bound: f64) -> Self {
        let mut clipped = Self::zero();
        for i in 0..M {
            for j in i + 1..M {
                for p in 0..WIDTH {
                    clipped.0[i][j][p] = clip_to(self.0[i][j][p], bound);
                }
            }
        }
        clipped
    }
}

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
#[derive(Clone, Debug)]
pub struct AreaLadder<const M: usize> {
    first_half: Vec<AreaBlock<M>>,
    joined: Vec<AreaBlock<M>>,
}

impl<const M: usize> AreaLadder<M> {
    /// A ladder of `levels` levels above the finest, for a [`DyadicLadder`] with the same number.
    pub fn new(levels: usize) -> Self {
        let joined = vec![AreaBlock::zero(); levels + 1];
        Self { first_half: joined.clone(), joined }
    }

    /// Adds the areas of the next finest step. Push its increment to `sums` first and pass the
    /// result of [`DyadicLadder::push`] as `complete`.
    ///
    /// # Panics
    /// Unless `sums` has M noises.
    pub fn push(&mut self, areas: &AreaBlock<M>, sums: &DyadicLadder, complete: usize) {
        self.joined[0] = *areas;
        for level in 1..=complete {
            let (first, second) = (of(sums.first_half(level)), of(sums.increment(level - 1)));
            self.joined[level] =
                join(&self.first_half[level], first, &self.joined[level - 1], second);
        }
        if let Some(first_half) = self.first_half.get_mut(complete + 1) {
            *first_half = self.joined[complete];
        }
    }

    /// The areas over the last complete step of `level`.
    pub fn areas(&self, level: usize) -> &AreaBlock<M> {
        &self.joined[level]
    }

    /// The areas over the first half of the last complete step of `level` ≥ 1. Those of the second
    /// half are [`areas`](Self::areas) of the level below.
    pub fn first_half(&self, level: usize) -> &AreaBlock<M> {
        &self.first_half[level]
    }
}

/// The rows of M noises.
fn of<const M: usize>(rows: &[Row]) -> &[Row; M] {
    rows.try_into().unwrap_or_else(|_| panic!("a ladder of {M} noises, got {}", rows.len()))
}

/// Chen's relation (Chen 1957) for two consecutive steps with areas A′, A″ and increments W′, W″:
/// the areas over both are A = A′ + A″ + ½(W′W″ᵀ − W″W′ᵀ).
#[inline]
pub fn join<const M: usize>(
    first_areas: &AreaBlock<M>,
    first: &[Row; M],
    second_areas: &AreaBlock<M>,
    second: &[Row; M],
) -> AreaBlock<M> {
    let mut joined = AreaBlock::zero();
    for i in 0..M {
        for j in i + 1..M {
            for p in 0..WIDTH {
                let wedge = first[i][p] * second[j][p] - second[i][p] * first[j][p];
                joined.0[i][j][p] =
                    (first_areas.0[i][j][p] + second_areas.0[i][j][p]) + 0.5 * wedge;
            }
        }
    }
    joined
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;
    use real::Block;

    use super::*;

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
        let (mut sums, mut areas) = (DyadicLadder::new(3, 4), AreaLadder::<3>::new(4));
        for (n, piece) in pieces.iter().enumerate() {
            let complete = sums.push(&Block::splat(*piece).0);
            areas.push(&AreaBlock::zero(), &sums, complete);
            for level in 0..=complete {
                let step = &pieces[n + 1 - (1 << level)..=n];
                let halves = step.split_at(step.len() / 2);
                for (i, j) in [(0, 1), (0, 2), (1, 2)] {
                    assert_eq!(
                        areas.areas(level).0[i][j],
                        [area_of(step, i, j); WIDTH],
                        "{n} {level}"
                    );
                    assert_eq!(areas.areas(level).path(5)[j][i], -area_of(step, i, j));
                    if level > 0 {
                        assert_eq!(
                            areas.first_half(level).0[i][j],
                            [area_of(halves.0, i, j); WIDTH]
                        );
                        assert_eq!(
                            areas.areas(level - 1).0[i][j],
                            [area_of(halves.1, i, j); WIDTH]
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn areas_of_the_finest_steps_are_added() {
        let (mut sums, mut areas) = (DyadicLadder::new(2, 1), AreaLadder::<2>::new(1));
        for area in [2.0, -0.5] {
            let mut finest = AreaBlock::zero();
            finest.set_path(3, [[7.0, area], [7.0, 7.0]]);
            let entries =
                [finest.0[0][0][3], finest.0[0][1][3], finest.0[1][0][3], finest.0[1][1][3]];
            assert_eq!(entries, [0.0, area, 0.0, 0.0]);
            let complete = sums.push(&[[0.0; WIDTH]; 2]);
            areas.push(&finest, &sums, complete);
        }
        assert_eq!(areas.areas(1).path(3), [[0.0, 1.5], [-1.5, 0.0]]);
        assert_eq!(areas.areas(1).path(4), [[0.0; 2]; 2]);
    }

    #[test]
    fn clipping_keeps_signs() {
        let mut areas = AreaBlock::<3>::zero();
        areas.set_path(0, [[0.0, 5.0, -7.0], [0.0, 0.0, 0.5], [0.0; 3]]);
        let clipped = [[0.0, 1.0, -1.0], [-1.0, 0.0, 0.5], [1.0, -0.5, 0.0]];
        assert_eq!(areas.clipped(1.0).path(0), clipped);
        assert_eq!(areas.clipped(f64::INFINITY), areas);
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
