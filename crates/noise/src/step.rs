//! The noise of one step: increments and Lévy areas.

use real::{Row, Rows, WIDTH, exactly, path};

use crate::join;

/// The noise of one step on one path: M increments and their Lévy areas.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noise<const M: usize> {
    /// ΔW_m over the step, in √time.
    pub increments: [f64; M],
    /// The skew matrix of Lévy areas A_ml = ½∫(W_m dW_l − W_l dW_m), in time; zero if none are
    /// drawn. The iterated Stratonovich integrals ∫∫ ∘dW_m ∘dW_l are ½ΔW_mΔW_l + A_ml.
    pub areas: [[f64; M]; M],
    /// Space-time areas H_m as in [`StepNoise::space_time`]; zero if none are drawn.
    pub space_time: [f64; M],
}

impl<const M: usize> Noise<M> {
    /// Increments with zero areas of all kinds, their means given the increments.
    pub fn increments(increments: [f64; M]) -> Self {
        Self { increments, areas: [[0.0; M]; M], space_time: [0.0; M] }
    }
}

/// The noise of one step on a block of 32 paths, for any number M of noises.
///
/// A_ml of path p, m < l, is `areas[m * M + l][p]`; the other rows are zero.
#[derive(Clone, Debug, Default)]
pub struct StepNoise {
    /// ΔW_m of every path; row m belongs to noise number m.
    pub increments: Rows,
    /// M² rows of Lévy areas; none if no areas are drawn.
    pub areas: Rows,
    /// M rows of space-time areas H_m, in √time; none if none are drawn. With τ(½ΔW_m + H_m) =
    /// ∫W_m ds over the step, W_m = 0 at its beginning, H_m is independent of ΔW_m, of variance
    /// τ/12.
    pub space_time: Rows,
    /// Bits of the parts that clipping took from the increments of each path, without a meaning of
    /// their own; zero for a path with all of its increments, and empty where nothing was clipped.
    pub clipped: Vec<u64>,
}

impl StepNoise {
    /// Zero increments of `noises` Wiener processes, no Lévy areas.
    pub fn zero(noises: usize) -> Self {
        Rows::zero(noises).into()
    }

    /// Zero increments of `noises` Wiener processes, with zero Lévy areas.
    pub fn with_areas(noises: usize) -> Self {
        Self { areas: Rows::zero(noises.saturating_mul(noises)), ..Self::zero(noises) }
    }

    /// Zero increments of `noises` Wiener processes, with zero Lévy areas if `areas` is true.
    pub fn none(noises: usize, areas: bool) -> Self {
        if areas { Self::with_areas(noises) } else { Self::zero(noises) }
    }

    /// Adds rows of zero space-time areas.
    #[must_use]
    pub fn with_space_time(self) -> Self {
        Self { space_time: Rows::zero(self.increments.len()), ..self }
    }

    /// The noise of path `p`.
    ///
    /// # Panics
    /// Unless there are M noises.
    pub fn path<const M: usize>(&self, p: usize) -> Noise<M> {
        BlockNoise::from(self).path(p)
    }

    /// Replaces the noise of path `p`. Areas are left out where there are none; of a matrix only
    /// the entries above the diagonal are read.
    pub fn set_path<const M: usize>(&mut self, p: usize, noise: &Noise<M>) {
        self.increments.iter_mut().zip(noise.increments).for_each(|(row, dw)| row[p] = dw);
        if !self.areas.is_empty() {
            for m in 0..M {
                (m + 1..M).for_each(|l| self.areas[m * M + l][p] = noise.areas[m][l]);
            }
        }
        self.space_time.iter_mut().zip(noise.space_time).for_each(|(row, h)| row[p] = h);
    }

    /// Replaces the noise of all paths by that of `other`, which has equal numbers of rows.
    #[inline]
    pub fn copy_from(&mut self, other: &Self) {
        self.increments.copy_from_slice(&other.increments);
        self.areas.copy_from_slice(&other.areas);
        self.space_time.copy_from_slice(&other.space_time);
    }

    /// Gives path `p` the noise of path `q` of `other`, which has areas if this noise has.
    pub fn copy_path(&mut self, p: usize, other: &Self, q: usize) {
        for (rows, others) in [
            (&mut self.increments, &other.increments),
            (&mut self.areas, &other.areas),
            (&mut self.space_time, &other.space_time),
        ] {
            rows.iter_mut().zip(others.iter()).for_each(|(row, other)| row[p] = other[q]);
        }
    }

    /// Makes this the noise of its step and the `next` one, of the same size, together: sums of
    /// increments, areas by Chen's relation, if this noise has areas, and space-time areas
    /// ½(H + H′) + ¼(ΔW − ΔW′).
    #[inline]
    pub fn join(&mut self, next: &Self) {
        if !self.areas.is_empty() {
            join(&mut self.areas, &self.increments, &next.areas, &next.increments);
        }
        for (m, h) in self.space_time.iter_mut().enumerate() {
            for p in 0..WIDTH {
                let difference = self.increments[m][p] - next.increments[m][p];
                h[p] = 0.5 * (h[p] + next.space_time[m][p]) + 0.25 * difference;
            }
        }
        let next = next.increments.as_flattened();
        self.increments.as_flattened_mut().iter_mut().zip(next).for_each(|(dw, next)| *dw += next);
    }
}

/// Increments, a row for each noise, without areas.
impl From<Rows> for StepNoise {
    fn from(increments: Rows) -> Self {
        Self { increments, ..Self::default() }
    }
}

/// The noise of one step on a block of 32 paths as a compiled kernel with M noises reads it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlockNoise<'a, const M: usize> {
    /// ΔW_m of every path.
    pub increments: &'a [Row; M],
    /// The M² rows of Lévy areas as in [`StepNoise::areas`]; none if no areas are drawn.
    pub areas: &'a [Row],
    /// The M rows of space-time areas; none if none are drawn.
    pub space_time: &'a [Row],
}

impl<'a, const M: usize> BlockNoise<'a, M> {
    /// A row of the matrix of areas where none are drawn.
    pub const NO_AREAS: &'static [Row; M] = &[[0.0; WIDTH]; M];

    /// Increments without areas.
    pub fn increments(increments: &'a [Row; M]) -> Self {
        Self { increments, areas: &[], space_time: &[] }
    }

    /// The areas as a matrix of rows; zeros if none are drawn.
    #[inline(always)]
    pub fn area_rows(&self) -> [&'a [Row; M]; M] {
        let mut matrix = [Self::NO_AREAS; M];
        if !self.areas.is_empty() {
            for (m, rows) in matrix.iter_mut().enumerate() {
                *rows = exactly(&self.areas[m * M..(m + 1) * M]);
            }
        }
        matrix
    }

    /// The noise of path `p`.
    #[inline(always)]
    pub fn path(&self, p: usize) -> Noise<M> {
        let mut space_time = [0.0; M];
        space_time.iter_mut().zip(self.space_time).for_each(|(h, row)| *h = row[p]);
        let areas = skew(&self.area_rows(), p);
        Noise { increments: path(self.increments, p), areas, space_time }
    }
}

/// The skew matrix of path `p`, of which the rows have the part above the diagonal.
#[inline(always)]
pub fn skew<const M: usize, const L: usize>(rows: &[&[[f64; L]; M]; M], p: usize) -> [[f64; M]; M] {
    let mut areas = [[0.0; M]; M];
    for m in 0..M {
        for l in 0..M {
            areas[m][l] = rows[m][l][p] - rows[l][m][p];
        }
    }
    areas
}

/// # Panics
/// Unless there are M noises.
impl<'a, const M: usize> From<&'a StepNoise> for BlockNoise<'a, M> {
    #[inline(always)]
    fn from(noise: &'a StepNoise) -> Self {
        let StepNoise { increments, areas, space_time, .. } = noise;
        Self { increments: exactly(increments), areas, space_time }
    }
}
