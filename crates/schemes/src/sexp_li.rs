//! The linearly implicit conformal exponential integrator.

use noise::{BlockNoise, Noise};
use nonlin::{BlockStatus, Solution};
use real::Block;
use systems::{Form, InvariantKind, Linearity, PoissonSystem, always_solvable, linearity};

use crate::{Explicit, Increment, Scheme, Step};

/// The linearly implicit conformal exponential integrator, `sexp-li`: the conformal laws of
/// [`Sexp`](crate::Sexp) for Casimirs, at the price of an explicit scheme.
///
/// With ẑ = e^{−∫γ, first half} y_n, m = ẑ + ½B(ẑ)∇h(ẑ) and v = ∇̄h(ẑ, ẑ + B(m)∇h(m)),
///
/// z = ẑ + B((ẑ+z)/2) v,  y_{n+1} = e^{−∫γ, second half} z.
///
/// For a quadratic h this v is replaced by ∇h(m), which is as accurate.
///
/// For every v, C(z) − C(ẑ) = ∇C((ẑ+z)/2)ᵀ B((ẑ+z)/2) v = 0 for a quadratic Casimir C, so v has to
/// be accurate only. If B is affine in y, the equation is linear in z. This is the semi-implicit
/// idea of spin dynamics (Mentink, Tretyakov, Fasolino, Katsnelson and Rasing 2010) with conformal
/// damping and any affine B. Where all Casimirs are linear, B may be evaluated anywhere: then z = ẑ
/// + B(m) v.
///
/// - Orders: strong 1 for one noise or commuting noises, else ½; weak 1.
/// - Preserves the conformal law of linear and quadratic Casimirs exactly for every τ. It does not
///   preserve an energy: [`Sexp`](crate::Sexp) does with one noise.
/// - Increments are not truncated where the equation has a solution for every v.
/// - Cost per step: ∇h twice, ∇̄h as well if h is not quadratic, and D linear equations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SexpLi {
    implicit: bool,
    clips: bool,
}

/// A system that [`SexpLi`] is not for.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SexpLiError {
    /// The structure matrix is neither constant nor affine, and Casimirs need not be linear.
    #[error(
        "sexp-li needs a structure matrix that is constant or affine in y, or a system whose \
         Casimirs are all linear; B of `{system}` is {found}, take sexp"
    )]
    Structure {
        /// The name of the system.
        system: &'static str,
        /// What was found.
        found: &'static str,
    },
}

impl SexpLi {
    /// The scheme for `system`. How B depends on y is found by [`systems::linearity`] at `y0`, and
    /// whether every step has a solution by [`systems::always_solvable`].
    ///
    /// # Errors
    /// [`SexpLiError::Structure`] if B is neither constant nor affine, unless the system names its
    /// Casimirs and all of them are linear.
    pub fn new<S, const D: usize, const M: usize>(
        system: &S,
        y0: [f64; D],
    ) -> Result<Self, SexpLiError>
    where
        S: PoissonSystem<D, M>,
    {
        match linearity(system, y0) {
            Linearity::Constant => Ok(Self { implicit: false, clips: false }),
            Linearity::Affine => Ok(Self { implicit: true, clips: !always_solvable(system, y0) }),
            Linearity::Other => {
                let mut forms = system.invariants();
                forms.retain(|invariant| invariant.kind == InvariantKind::Casimir);
                let refused = |found| Err(SexpLiError::Structure { system: system.name(), found });
                if forms.is_empty() {
                    return refused("neither, and the system names no Casimir");
                }
                if forms.iter().any(|casimir| casimir.form != Form::Linear) {
                    return refused("neither, and the system names a Casimir that is not linear");
                }
                Ok(Self { implicit: false, clips: true })
            }
        }
    }
}

/// m and v.
#[inline(always)]
fn middle_and_gradient<H: Increment>(h: H, start: H::Vector) -> (H::Vector, H::Vector) {
    let middle = start + h.field(start) * 0.5;
    let gradient = h.gradient(middle);
    if H::QUADRATIC {
        return (middle, gradient);
    }
    (middle, h.averaged_gradient(start, start + h.structure(middle, gradient)))
}

/// The formula for an affine B.
struct LinearlyImplicit;

impl Explicit for LinearlyImplicit {
    const ID: &'static str = "sexp-li";

    #[inline(always)]
    fn advance<H: Increment>(&self, h: H, y: H::Vector) -> H::Vector {
        let start = y * h.step().first_decay;
        let (_, v) = middle_and_gradient(h, start);
        h.cayley(start, v) * h.step().second_decay
    }
}

/// The formula for linear Casimirs.
struct LinearCasimirs;

impl Explicit for LinearCasimirs {
    const ID: &'static str = "sexp-li";

    #[inline(always)]
    fn advance<H: Increment>(&self, h: H, y: H::Vector) -> H::Vector {
        let start = y * h.step().first_decay;
        let (middle, v) = middle_and_gradient(h, start);
        (start + h.structure(middle, v)) * h.step().second_decay
    }
}

impl<S: PoissonSystem<D, M>, const D: usize, const M: usize> Scheme<S, D, M> for SexpLi {
    fn id(&self) -> &'static str {
        <LinearlyImplicit as Explicit>::ID
    }

    fn reads_areas(&self) -> bool {
        false
    }

    fn clips_increments(&self) -> bool {
        self.clips
    }

    fn step_block(
        &self,
        system: &S,
        step: &Step,
        noise: &BlockNoise<M>,
        y: &mut Block<D>,
        status: &mut BlockStatus,
    ) {
        if self.implicit {
            LinearlyImplicit.step_block(system, step, noise, y, status);
        } else {
            LinearCasimirs.step_block(system, step, noise, y, status);
        }
    }

    fn step(&self, system: &S, step: &Step, noise: &Noise<M>, y: [f64; D]) -> Solution<D> {
        if self.implicit {
            LinearlyImplicit.step(system, step, noise, y)
        } else {
            LinearCasimirs.step(system, step, noise, y)
        }
    }
}
