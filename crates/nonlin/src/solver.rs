//! The options of the solver and its results.

use real::{Block, PathMask, Row, WIDTH};

/// The fast method, which is tried first on every path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// Fixed-point iteration z ← ψ(z), three evaluations per sweep and eleven in a long first
    /// sweep. It converges linearly with the Lipschitz constant of ψ. It is the faster method if ψ
    /// is a few products (`cargo bench -p casimir-verify`).
    FixedPoint,
    /// Newton's method z ← z − (I − ψ′(z))⁻¹(z − ψ(z)), one iteration per sweep. A long first sweep
    /// makes two steps with the same matrix from ψ(ψ(start)). It is the faster method if ψ is
    /// costly. If ψ does not contract, it may find a solution on another branch than that of the
    /// start.
    Newton,
}

/// The options for solving implicit steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Solver {
    /// The fast method. `None` means [`FixedPoint::METHOD`](crate::FixedPoint::METHOD), the method
    /// that the equation prefers.
    pub method: Option<Method>,
    /// Largest number of sweeps of the fast method before the robust one takes over; at least one.
    pub max_sweeps: u32,
    /// Whether to make one more sweep after convergence, for runs of millions of steps.
    ///
    /// A path has converged when its residual is below 2ε. The remaining residuals are biased, so
    /// over n steps the error of a conserved quantity grows like n·ε. After one more sweep only
    /// rounding errors remain, and the error grows like √n·ε. Off by default, since it costs a
    /// sweep.
    pub settle: bool,
}

/// 3·55 = 165 evaluations. A contraction with constant 0.8 reduces an error of 1 to round-off in
/// ln ε/ln 0.8 ≈ 162. Newton's method is faster for maps that contract more slowly.
const MAX_SWEEPS: u32 = 55;

impl Default for Solver {
    fn default() -> Self {
        Self::DEFAULT
    }
}

impl Solver {
    /// The method that the equation prefers, the default number of sweeps, and no more.
    pub(crate) const DEFAULT: Self = Self { method: None, max_sweeps: MAX_SWEEPS, settle: false };

    /// The given method with the default number of sweeps.
    pub fn new(method: Method) -> Self {
        Self { method: Some(method), ..Self::default() }
    }

    /// Options with [`settle`](Self::settle) switched on, for runs of millions of steps.
    #[must_use]
    pub fn settled(self) -> Self {
        Self { settle: true, ..self }
    }
}

/// Outcome of the iteration for one equation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Outcome {
    /// Solved by the fast method.
    Fast {
        /// Number of sweeps.
        iterations: u32,
    },
    /// Solved by Newton's method with continuation, after the fast method failed.
    Robust {
        /// Newton iterations over all continuation steps.
        iterations: u32,
        /// ‖z − ψ(z)‖₁.
        residual: f64,
    },
    /// Not solved; z is the last iterate.
    Failed {
        /// ‖z − ψ(z)‖₁, or infinity if the state is not finite.
        residual: f64,
    },
}

impl Outcome {
    /// Whether the equation was solved.
    pub fn converged(self) -> bool {
        !matches!(self, Self::Failed { .. })
    }
}

/// The result of the iteration for one equation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solution<const D: usize> {
    /// The solution, or the last iterate.
    pub z: [f64; D],
    /// Outcome of the iteration.
    pub outcome: Outcome,
}

impl<const D: usize> Solution<D> {
    /// Solution if z is finite, otherwise a failure with an infinite residual. For blocks see
    /// [`BlockStatus::fail_where_not_finite`].
    #[must_use]
    pub fn checked(self) -> Self {
        let finite = self.z.iter().all(|component| component.is_finite());
        if finite {
            self
        } else {
            Self { outcome: Outcome::Failed { residual: f64::INFINITY }, ..self }
        }
    }
}

/// Outcomes of the iterations for the equations of a block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlockStatus {
    /// Minus the number of iterations of each solved path; the residual of each failed path.
    pub(crate) pending: Block<1>,
    /// The residual of each path that the robust method solved.
    pub(crate) residuals: Block<1>,
    /// Paths that the robust method solved.
    pub robust: PathMask,
    /// Paths without a solution.
    pub failed: PathMask,
}

/// Whether all numbers are finite. Call it inside a kernel.
#[inline(always)]
pub fn are_finite(y: &[Row]) -> bool {
    // 0·y is NaN if y is infinite or NaN, else zero of some sign: the first bit.
    let mut bits = [0; WIDTH];
    for row in y {
        for p in 0..WIDTH {
            bits[p] |= (0.0 * row[p]).to_bits();
        }
    }
    bits.iter().fold(0, |all, bits| all | bits) << 1 == 0
}

impl BlockStatus {
    /// The status of an explicit step: every path solved in one iteration.
    pub fn explicit() -> Self {
        Self {
            pending: Block::splat([-1.0]),
            residuals: Block::zero(),
            robust: PathMask::NONE,
            failed: PathMask::NONE,
        }
    }

    /// Every path solved by the fast method, `sweeps` being minus the number of its sweeps.
    pub fn fast(sweeps: Row) -> Self {
        Self { pending: Block([sweeps]), ..Self::explicit() }
    }

    /// Records the outcome of path `p`, which must not be marked as robust or failed yet. For a
    /// scheme that advances the paths of a block one by one.
    pub fn set(&mut self, p: usize, outcome: Outcome) {
        match outcome {
            Outcome::Fast { iterations } => self.pending.0[0][p] = -f64::from(iterations),
            Outcome::Robust { iterations, residual } => {
                self.robust.insert(p);
                self.pending.0[0][p] = -f64::from(iterations);
                self.residuals.0[0][p] = residual;
            }
            Outcome::Failed { residual } => {
                self.failed.insert(p);
                self.pending.0[0][p] = residual;
            }
        }
    }

    /// Marks paths with a state that is not finite as failed, with an infinite residual; row i of
    /// `y` is component i. Call it inside a kernel.
    #[inline(always)]
    pub fn fail_where_not_finite(&mut self, y: &[Row]) {
        if !are_finite(y) {
            self.fail(y);
        }
    }

    /// Marks every path as failed, with an infinite residual.
    pub fn fail_everywhere(&mut self) {
        (self.robust, self.failed) = (PathMask::NONE, PathMask::ALL);
        self.pending = Block::splat([f64::INFINITY]);
    }

    #[cold]
    #[inline(never)]
    fn fail(&mut self, y: &[Row]) {
        let failed = PathMask::of(|p| y.iter().any(|row| !row[p].is_finite()));
        self.robust = self.robust.without(failed);
        self.failed = self.failed.or(failed);
        failed.paths().for_each(|p| self.pending.0[0][p] = f64::INFINITY);
    }

    /// Number of iterations on path `p`: sweeps of the fast method or Newton iterations of the
    /// robust one. Zero if both failed.
    pub fn iterations(&self, p: usize) -> u32 {
        f64::max(-self.pending.0[0][p], 0.0) as u32
    }

    /// ‖z − ψ(z)‖₁ on path `p` if it failed or needed the robust method. Zero if the fast method
    /// solved it to its tolerance. May be infinite or NaN on a failed path.
    pub fn residual(&self, p: usize) -> f64 {
        if self.failed.contains(p) {
            self.pending.0[0][p]
        } else if self.robust.contains(p) {
            self.residuals.0[0][p]
        } else {
            0.0
        }
    }
}
