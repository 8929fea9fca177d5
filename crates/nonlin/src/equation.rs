//! The equation z = ψ(z).

use real::{DualNumber, Real, Variation, Varies, seeded, unrolled};

use crate::Method;

/// The equation z = ψ(z) of one path in D unknowns.
pub trait FixedPoint<const D: usize>: Copy {
    /// The preferred method, used if [`Solver::method`](crate::Solver::method) is `None`.
    const METHOD: Method = Method::FixedPoint;

    /// The first sweep of the preferred method.
    const FIRST_SWEEP: FirstSweep = FirstSweep::Plain;

    /// The start of the iteration. For an implicit step this is the state before the step.
    /// Continuation follows the branch of solutions that begins here.
    fn start(&self) -> [f64; D];

    /// ψ(z). Mark it `#[inline(always)]` and avoid branches, so that blocks are vectorised.
    fn map<R: Real>(&self, z: [R; D]) -> [R; D];

    /// ψ(z) and the Jacobian ψ′(z) by dual numbers; entry (i, j) is ∂ψᵢ/∂zⱼ.
    #[inline(always)]
    fn jacobian(&self, z: [f64; D]) -> ([f64; D], [[f64; D]; D]) {
        let (mut value, mut jacobian) = ([0.0; D], [[0.0; D]; D]);
        // Up to three columns are written out. For more, code that is written out takes long to
        // compile.
        if const { D <= 3 } {
            unrolled!(f64: j in 0..D => {
                let column = self.map(seeded::<f64, Varies, D>(z, j));
                (value, jacobian) = with_column(column, jacobian, j);
            });
        } else {
            for j in 0..D {
                let column = self.map(seeded::<f64, Varies<2>, D>(z, j));
                (value, jacobian) = with_column(column, jacobian, j);
            }
        }
        (value, jacobian)
    }

    /// For [`FirstSweep::Predicted`]: a prediction of the solution and a bound of its residual
    /// ‖z − ψ(z)‖₁ in exact arithmetic. The prediction must lie on the branch that begins at the
    /// start. It is not used if the bound is infinite or NaN.
    #[inline(always)]
    fn predict(&self) -> ([f64; D], f64) {
        (self.start(), f64::INFINITY)
    }
}

/// The first sweep of the iteration for an equation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FirstSweep {
    /// A sweep like every other.
    Plain,
    /// Eleven evaluations of ψ, or two steps of Newton's method from ψ(ψ(start)), written out for
    /// two paths at a time. It is fast if ψ is a few dozen operations. Otherwise it is long code
    /// that takes time to compile. `cargo bench -p casimir-verify` shows the gain: with eleven
    /// evaluations the rigid body at τ = 2⁻⁸ converges in the first sweep on nearly every block.
    Long,
    /// [`FixedPoint::predict`], accepted if its residual bound is below the tolerance. Otherwise
    /// the sweeps start from the prediction.
    Predicted,
}

/// The values of ψ, and the Jacobian with column j filled in.
#[inline(always)]
fn with_column<V: Variation, const D: usize>(
    column: [DualNumber<f64, V>; D],
    mut jacobian: [[f64; D]; D],
    j: usize,
) -> ([f64; D], [[f64; D]; D]) {
    let mut value = [0.0; D];
    for i in 0..D {
        value[i] = column[i].value;
        jacobian[i][j] = column[i].derivative();
    }
    (value, jacobian)
}

/// The equations of a block of paths. The solver copies them when a path needs the robust method,
/// so they should hold large data by reference.
pub trait BlockFixedPoint<const D: usize>: Copy {
    /// The equation of one path.
    type Path: FixedPoint<D>;
    /// The equation of path `p`. Mark it `#[inline(always)]`.
    fn path(&self, p: usize) -> Self::Path;
}
