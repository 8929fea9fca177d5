//! Blocks of paths and subsets of them.

use crate::path;

/// Number of paths in a block. The compiler unrolls a loop of exactly 8 before it vectorises it.
/// A loop of 32 it vectorises: four AVX-512 vectors, enough to hide latency.
pub const WIDTH: usize = 32;

/// D numbers for each of [`WIDTH`] paths, path index innermost: component `i` of path `p` is
/// `block.0[i][p]`.
///
/// A block is aligned to a cache line, so that no vector load straddles two lines.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(64))]
pub struct Block<const D: usize>(pub [[f64; WIDTH]; D]);

impl<const D: usize> Block<D> {
    /// Block of zeros.
    #[inline(always)]
    pub fn zero() -> Self {
        Self([[0.0; WIDTH]; D])
    }

    /// Block with the number vector `y` on every path.
    #[inline(always)]
    pub fn splat(y: [f64; D]) -> Self {
        let mut block = Self::zero();
        for i in 0..D {
            block.0[i] = [y[i]; WIDTH];
        }
        block
    }

    /// The D numbers of path `p` < [`WIDTH`].
    #[inline(always)]
    pub fn path(&self, p: usize) -> [f64; D] {
        path(&self.0, p)
    }

    /// Replaces the D numbers of path `p` < [`WIDTH`].
    #[inline(always)]
    pub fn set_path(&mut self, p: usize, y: [f64; D]) {
        for i in 0..D {
            self.0[i][p] = y[i];
        }
    }
}

/// A subset of the paths of a block: bit `p` is path `p`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PathMask(pub u32);

impl PathMask {
    /// No path.
    pub const NONE: Self = Self(0);
    /// Every path.
    pub const ALL: Self = Self(u32::MAX);

    /// The first `n` paths; all of them for n ≥ [`WIDTH`].
    pub fn first(n: usize) -> Self {
        if n >= WIDTH { Self::ALL } else { Self((1 << n) - 1) }
    }

    /// The paths that `are` in the set.
    pub fn of(are: impl Fn(usize) -> bool) -> Self {
        (0..WIDTH).filter(|&p| are(p)).fold(Self::NONE, |paths, p| Self(paths.0 | 1 << p))
    }

    /// Whether path `p` is in the set.
    pub fn contains(self, p: usize) -> bool {
        self.0 >> p & 1 == 1
    }

    /// Adds path `p`.
    pub fn insert(&mut self, p: usize) {
        self.0 |= 1 << p;
    }

    /// Takes path `p` out.
    pub fn remove(&mut self, p: usize) {
        self.0 &= !(1 << p);
    }

    /// Whether no path is in the set.
    pub fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// Number of paths in the set.
    pub fn len(self) -> u32 {
        self.0.count_ones()
    }

    /// Paths in both sets.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }

    /// Paths in either set.
    #[must_use]
    pub fn or(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// Paths in this set and not in the other.
    #[must_use]
    pub fn without(self, other: Self) -> Self {
        Self(self.0 & !other.0)
    }

    /// The paths in increasing order.
    pub fn paths(self) -> impl Iterator<Item = usize> {
        (0..WIDTH).filter(move |&p| self.contains(p))
    }
}
