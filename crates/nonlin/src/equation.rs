//! The equation z = ψ(z).

use real::{Dual, Real};

/// One equation z = ψ(z) in D unknowns.
pub trait FixedPoint<const D: usize>: Copy {
    /// Where iterations start. For an implicit step this is the state before the step, to which the solution
    /// shrinks with the step; continuation follows the branch that starts here.
    fn start(&self) -> [f64; D];

    /// ψ(z). Must be `#[inline(always)]` and free of branches to run fast in a block.
    fn map<R: Real>(&self, z: [R; D]) -> [R; D];

    /// ψ(z) and the Jacobian ψ′(z), row i holding ∂ψᵢ/∂zⱼ. By dual numbers unless overridden.
    #[inline(always)]
    fn jacobian(&self, z: [f64; D]) -> ([f64; D], [[f64; D]; D]) {
        let mut value = [0.0; D];
        let mut jacobian = [[0.0; D]; D];
        for j in 0..D {
            let mut seeded = [Dual::new(0.0, 0.0); D];
            for i in 0..D {
                seeded[i] = Dual::fixed(z[i]);
            }
            seeded[j].derivative = 1.0;
            let column = self.map(seeded);
            for i in 0..D {
                value[i] = column[i].value;
                jacobian[i][j] = column[i].derivative;
            }
        }
        (value, jacobian)
    }
}

/// The equations of a block of paths.
pub trait BlockFixedPoint<const D: usize> {
    /// The equation of one path.
    type Path: FixedPoint<D>;
    /// The equation of path `p`. Must be `#[inline(always)]`.
    fn path(&self, p: usize) -> Self::Path;
}
