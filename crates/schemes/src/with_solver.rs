//! A formula with options of its solver.

use nonlin::Solver;

use crate::{Implicit, Increment};

/// An implicit formula that is solved with these options.
///
/// Without it the options are known when a kernel is compiled, which then has the method of its
/// system only; with it a kernel has all methods, and takes longer to compile.
///
/// ```
/// use nonlin::{Method, Solver};
/// use schemes::{Sexp, WithSolver};
///
/// let newton = WithSolver { formula: Sexp, solver: Solver::new(Method::Newton) };
/// # let _ = newton;
/// ```
#[derive(Clone, Copy, Debug)]
pub struct WithSolver<F> {
    /// The formula.
    pub formula: F,
    /// The options for solving the implicit equation.
    pub solver: Solver,
}

impl<F: Implicit> Implicit for WithSolver<F> {
    const ID: &'static str = F::ID;
    const READS_AREAS: bool = F::READS_AREAS;
    const CLIPS_INCREMENTS: bool = F::CLIPS_INCREMENTS;
    const EXACT_DAMPING: bool = F::EXACT_DAMPING;
    const PREDICTED: bool = F::PREDICTED;
    const EXPLICIT: bool = F::EXPLICIT;
    const SOLVER: Option<fn(&Self) -> Solver> = Some(|scheme| scheme.solver);

    #[inline(always)]
    fn psi<H: Increment>(&self, h: H, start: H::Vector, z: H::Vector) -> H::Vector {
        self.formula.psi(h, start, z)
    }
}
