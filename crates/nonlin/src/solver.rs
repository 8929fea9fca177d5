//! Which iteration, and what became of it.

use real::{Block, PathMask, WIDTH};

/// The fast method, tried first on every path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// z ← ψ(z): linear convergence with the Lipschitz constant of ψ, three evaluations a sweep,
    /// eleven in a long first one. The faster one where ψ is a few products (`cargo bench -p
    /// schemes`).
    FixedPoint,
    /// z ← z − (I − ψ′(z))⁻¹(z − ψ(z)), in a long first sweep from ψ(ψ(start)) with two corrections
    /// that keep the matrix, and a full Newton iteration in each later sweep. The faster one where
    /// ψ is costly. Where ψ does not contract it may find a solution on another branch than the one
    /// that starts at the start.
    Newton,
}

/// How implicit steps are solved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Solver {
    /// The fast method; `None` is the one that the equation prefers
    /// ([`FixedPoint::METHOD`](crate::FixedPoint::METHOD)).
    pub method: Option<Method>,
    /// Sweeps of the fast method before a path is handed to the robust one; one is made in any
    /// case.
    pub max_sweeps: u32,
    /// Whether one more sweep is made when a path is done. A path is done when its residual is
    /// below 2ε, and what is left of it has a direction: over n steps the error of a conserved
    /// quantity grows like n·ε. With the sweep it is rounding alone, and grows like √n·ε. For runs
    /// of millions of steps; off by default, since it costs a sweep.
    pub settle: bool,
}

/// At least 3·55 = 165 evaluations: a contraction with constant 0.8 reaches round-off from a start
/// with error 1 in ln ε/ln 0.8 ≈ 162. A map that contracts more slowly is better served by Newton,
/// which then takes over.
const MAX_SWEEPS: u32 = 55;

impl Default for Solver {
    fn default() -> Self {
        Self { method: None, max_sweeps: MAX_SWEEPS, settle: false }
    }
}

impl Solver {
    /// The given method with the default number of sweeps.
    #[must_use]
    pub fn new(method: Method) -> Self {
        Self { method: Some(method), ..Self::default() }
    }

    /// The same with one more sweep on every path that is done, for runs of millions of steps.
    #[must_use]
    pub fn settled(self) -> Self {
        Self { settle: true, ..self }
    }
}

/// What became of one equation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Outcome {
    /// Solved by the fast method.
    Fast {
        /// Sweeps.
        iterations: u32,
    },
    /// Solved by Newton with continuation after the fast method gave up.
    Robust {
        /// Newton iterations over all continuation steps.
        iterations: u32,
        /// ‖z − ψ(z)‖₁.
        residual: f64,
    },
    /// Solved by neither; z is where the robust method stopped.
    Failed {
        /// ‖z − ψ(z)‖₁ there.
        residual: f64,
    },
}

impl Outcome {
    /// Whether there is a solution.
    #[must_use]
    pub fn converged(self) -> bool {
        !matches!(self, Self::Failed { .. })
    }
}

/// A solved equation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solution<const D: usize> {
    /// The solution, or the last iterate.
    pub z: [f64; D],
    /// What became of it.
    pub outcome: Outcome,
}

impl<const D: usize> Solution<D> {
    /// A solution whose state is not finite has failed, with an infinite residual: what
    /// [`BlockStatus::fail_where_not_finite`] is for a block.
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

/// What became of the equations of a block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlockStatus {
    /// Minus the number of iterations of each solved path; the residual of each failed one.
    pub(crate) pending: Block<1>,
    /// The residual of each path that the robust method solved.
    pub(crate) residuals: Block<1>,
    /// Paths that the robust method solved.
    pub robust: PathMask,
    /// Paths without a solution.
    pub failed: PathMask,
}

impl BlockStatus {
    /// Every path solved in one iteration: the status of an explicit step.
    #[must_use]
    pub fn explicit() -> Self {
        Self {
            pending: Block::splat([-1.0]),
            residuals: Block::zero(),
            robust: PathMask::NONE,
            failed: PathMask::NONE,
        }
    }

    /// Records what became of path `p`, which is marked neither as robust nor as failed: for a
    /// scheme that takes the paths of a block one by one.
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

    /// Marks the paths whose state is not finite as failed, with an infinite residual: what an
    /// explicit step, or a factor, may have made of them. Meant to be called inside a kernel.
    #[inline(always)]
    pub fn fail_where_not_finite<const D: usize>(&mut self, y: &Block<D>) {
        // 0·y is NaN where y is infinite or NaN, else zero.
        let mut sums = Block::<1>::zero();
        for i in 0..D {
            for p in 0..WIDTH {
                sums.0[0][p] += 0.0 * y.0[i][p];
            }
        }
        let mut count = 0u64;
        for p in 0..WIDTH {
            count = count.wrapping_add(u64::from(sums.0[0][p].is_nan()));
        }
        if count > 0 {
            self.fail(&sums);
        }
    }

    #[cold]
    #[inline(never)]
    fn fail(&mut self, sums: &Block<1>) {
        for p in (0..WIDTH).filter(|&p| sums.0[0][p].is_nan()) {
            self.robust = self.robust.without(PathMask(1 << p));
            self.failed.insert(p);
            self.pending.0[0][p] = f64::INFINITY;
        }
    }

    /// Iterations of path `p`: sweeps of the fast method, or Newton iterations of the robust one;
    /// zero where both failed.
    #[must_use]
    pub fn iterations(&self, p: usize) -> u32 {
        f64::max(-self.pending.0[0][p], 0.0) as u32
    }

    /// ‖z − ψ(z)‖₁ on path `p` where the robust method was needed; zero where the fast one found a
    /// solution to its tolerance.
    #[must_use]
    pub fn residual(&self, p: usize) -> f64 {
        // It may be infinite or NaN.
        if self.failed.contains(p) {
            self.pending.0[0][p]
        } else if self.robust.contains(p) {
            self.residuals.0[0][p]
        } else {
            0.0
        }
    }
}
