//! The noise of one step: increments and Lévy areas.

use real::Block;

use crate::AreaBlock;

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
