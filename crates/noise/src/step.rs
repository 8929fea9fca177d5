//! The noise of one step: increments and Lévy areas.

use real::{Block, Row, Rows};

use crate::{
    AreaBlock, AreaLadder, AreaMethod, AreaSampler, DyadicLadder, StreamKey, WienerRows, join,
};

/// The noise of one step on 32 paths: of M noises ([`BlockNoise`]), or of a number that is known at
/// run time only ([`NoiseRows`]).
pub trait StepNoise: Send + Sync + Sized + 'static {
    /// No noise. A type with M noises has M, whatever `noises` is.
    ///
    /// # Panics
    /// If there is no memory for it.
    fn zero(noises: usize) -> Self;

    /// ΔW_m of every path; row m belongs to noise number m.
    fn increments(&self) -> &[Row];

    /// The increments, to be written.
    fn increments_mut(&mut self) -> &mut [Row];

    /// Draws the next increments, each N(0, τ); `sqrt_tau` = √τ.
    fn draw(&mut self, wiener: &mut WienerRows, sqrt_tau: f64);

    /// Gives path `p` the noise of path `q` of `other`.
    fn set_path(&mut self, p: usize, other: &Self, q: usize) {
        for (row, other) in self.increments_mut().iter_mut().zip(other.increments()) {
            row[p] = other[q];
        }
    }

    /// Makes this the noise of its step and the `next` one together: sums of increments, and areas
    /// by Chen's relation.
    fn join(&mut self, next: &Self) {
        for (row, next) in self.increments_mut().iter_mut().zip(next.increments()) {
            row.iter_mut().zip(next).for_each(|(dw, next)| *dw += next);
        }
    }

    /// What draws the Lévy areas of the paths from `first_path` on; `None` if this type has none.
    fn area_draw(
        _key: StreamKey,
        _first_path: u64,
        _method: AreaMethod,
        _terms: usize,
    ) -> Option<AreaDraw<Self>> {
        None
    }

    /// What joins Lévy areas on a ladder of `levels` levels above the finest; `None` if this type
    /// has none.
    fn area_sums(_levels: usize) -> Option<Box<dyn AreaSums<Self>>> {
        None
    }
}

/// Writes the Lévy areas of the next step, of the size given, into a noise whose *untruncated*
/// increments are there.
pub type AreaDraw<N> = Box<dyn FnMut(f64, &mut N) + Send>;

/// The Lévy areas of every level of a ladder, see [`AreaLadder`].
pub trait AreaSums<N>: Send {
    /// Adds the areas of the next finest step; see [`AreaLadder::push`].
    fn push(&mut self, noise: &N, sums: &DyadicLadder, complete: usize);

    /// Writes the areas of the last complete step of `level`, clipped to ±`bound`, into `noise`.
    fn clip(&self, level: usize, bound: f64, noise: &mut N);

    /// The same for the first half of that step.
    fn clip_first_half(&self, level: usize, bound: f64, noise: &mut N);
}

/// The noise of one step on one path: M increments and their Lévy areas.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noise<const M: usize> {
    /// ΔW_m over the step, in √time.
    pub increments: [f64; M],
    /// The skew matrix of Lévy areas A_ml = ½∫(W_m dW_l − W_l dW_m), in time; zero if none are
    /// drawn.
    pub areas: [[f64; M]; M],
}

impl<const M: usize> Noise<M> {
    /// Increments with zero areas, the mean of the areas given the increments.
    pub fn increments(increments: [f64; M]) -> Self {
        Self { increments, areas: [[0.0; M]; M] }
    }
}

/// The noise of one step on a block of 32 paths.
#[derive(Clone, Debug, PartialEq)]
pub struct BlockNoise<const M: usize> {
    /// ΔW_m of every path.
    pub increments: Block<M>,
    /// Lévy areas of every path; zero if none are drawn.
    pub areas: AreaBlock<M>,
}

impl<const M: usize> BlockNoise<M> {
    /// No noise.
    pub fn zero() -> Self {
        Self::increments(Block::zero())
    }

    /// Increments with zero areas, the mean of the areas given the increments.
    pub fn increments(increments: Block<M>) -> Self {
        Self { increments, areas: AreaBlock::zero() }
    }

    /// The noise of path `p`.
    #[inline(always)]
    pub fn path(&self, p: usize) -> Noise<M> {
        Noise { increments: self.increments.path(p), areas: self.areas.path(p) }
    }
}

impl<const M: usize> StepNoise for BlockNoise<M> {
    fn zero(_noises: usize) -> Self {
        Self::zero()
    }

    #[inline]
    fn increments(&self) -> &[Row] {
        &self.increments.0
    }

    #[inline]
    fn increments_mut(&mut self) -> &mut [Row] {
        &mut self.increments.0
    }

    #[inline]
    fn draw(&mut self, wiener: &mut WienerRows, sqrt_tau: f64) {
        // The kernel knows the number of rows.
        wiener.increments(sqrt_tau, &mut self.increments.0);
    }

    fn set_path(&mut self, p: usize, other: &Self, q: usize) {
        self.increments.set_path(p, other.increments.path(q));
        self.areas.set_path(p, other.areas.path(q));
    }

    fn join(&mut self, next: &Self) {
        let (first, second) = (&mut self.increments, &next.increments);
        self.areas = join(&self.areas, &first.0, &next.areas, &second.0);
        for (row, next) in first.0.iter_mut().zip(&second.0) {
            row.iter_mut().zip(next).for_each(|(dw, next)| *dw += next);
        }
    }

    fn area_draw(
        key: StreamKey,
        first_path: u64,
        method: AreaMethod,
        terms: usize,
    ) -> Option<AreaDraw<Self>> {
        let mut sampler = AreaSampler::new(key, first_path, method, terms);
        Some(Box::new(move |step, noise: &mut Self| {
            sampler.areas(step, &noise.increments, &mut noise.areas);
        }))
    }

    fn area_sums(levels: usize) -> Option<Box<dyn AreaSums<Self>>> {
        Some(Box::new(AreaLadder::<M>::new(levels)))
    }
}

impl<const M: usize> AreaSums<BlockNoise<M>> for AreaLadder<M> {
    fn push(&mut self, noise: &BlockNoise<M>, sums: &DyadicLadder, complete: usize) {
        self.push(&noise.areas, sums, complete);
    }

    fn clip(&self, level: usize, bound: f64, noise: &mut BlockNoise<M>) {
        noise.areas = self.areas(level).clipped(bound);
    }

    fn clip_first_half(&self, level: usize, bound: f64, noise: &mut BlockNoise<M>) {
        noise.areas = self.first_half(level).clipped(bound);
    }
}

/// The increments of one step on 32 paths, for any number of noises. It has no Lévy areas.
#[derive(Debug)]
pub struct NoiseRows {
    /// ΔW_m of every path; row m belongs to noise number m.
    pub increments: Rows,
}

impl StepNoise for NoiseRows {
    fn zero(noises: usize) -> Self {
        Self { increments: zero_rows(noises) }
    }

    #[inline]
    fn increments(&self) -> &[Row] {
        &self.increments
    }

    #[inline]
    fn increments_mut(&mut self) -> &mut [Row] {
        &mut self.increments
    }

    #[inline]
    fn draw(&mut self, wiener: &mut WienerRows, sqrt_tau: f64) {
        wiener.increments(sqrt_tau, &mut self.increments[..]);
    }
}

/// Rows of zeros.
///
/// # Panics
/// If there is no memory for them.
pub(crate) fn zero_rows(count: usize) -> Rows {
    Rows::zero(count).unwrap_or_else(|error| panic!("{error}"))
}
