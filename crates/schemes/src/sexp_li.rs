//! The linearly implicit conformal exponential integrator.

use systems::{
    Form, Invariant, InvariantKind, Linearity, PoissonSystem,
    run_time::{Description, System},
};

use crate::{Explicit, Increment, SchemeError};

/// The linearly implicit conformal exponential integrator, `sexp-li`: the conformal laws of
/// [`Sexp`](crate::Sexp) for Casimirs, at the price of an explicit scheme.
///
/// With ẑ = e^{−∫γ, first half} y_n, m = ẑ + ½B(ẑ)∇h(ẑ) and v = ∇̄h(ẑ, ẑ + B(m)∇h(m)),
///
/// z = ẑ + B((ẑ+z)/2) v,  y_{n+1} = e^{−∫γ, second half} z.
///
/// For a quadratic h this v is replaced by ∇h(m), which is as accurate. `sexp-li-levy`, by
/// [`with_areas`](Self::with_areas), subtracts Σ_{m<l} Â_ml ∇{Hₘ, H_l}(m) from v, with the Lévy
/// areas of the step; by Jacobi's identity \[fₘ, f_l\] = −B∇{Hₘ, H_l}, so this is the term of
/// [`SexpLevy`](crate::SexpLevy).
///
/// For every v, C(z) − C(ẑ) = ∇C((ẑ+z)/2)ᵀ B((ẑ+z)/2) v = 0 for a quadratic Casimir C, so v has to
/// be accurate only. If B is affine in y, the equation is linear in z. This is the semi-implicit
/// idea of spin dynamics (Mentink, Tretyakov, Fasolino, Katsnelson and Rasing 2010) with conformal
/// damping and any affine B. Where all Casimirs are linear, B may be evaluated anywhere: then z = ẑ
/// + B(m) v.
///
/// - Orders: strong 1 for one noise, for commuting noises and with areas, else ½; weak 1.
/// - Preserves the conformal law of linear and quadratic Casimirs exactly for every τ. It does not
///   preserve an energy: [`Sexp`](crate::Sexp) does with one noise.
/// - Increments are not truncated where the equation has a solution for every v.
/// - Cost per step: ∇h twice, ∇̄h as well if h is not quadratic, and D linear equations; with areas
///   a derivative of each ∇Hₘ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SexpLi {
    pub(crate) implicit: bool,
    pub(crate) areas: bool,
    pub(crate) clips: bool,
}

impl SexpLi {
    /// The scheme for `system`. How B depends on y is found by [`systems::linearity`] at `y0`, and
    /// whether every step has a solution by [`systems::always_solvable`].
    ///
    /// # Errors
    /// [`SchemeError`] if B is neither constant nor affine, unless the system names its
    /// Casimirs and all of them are linear.
    pub fn new<S, const D: usize, const M: usize>(
        system: &S,
        y0: [f64; D],
    ) -> Result<Self, SchemeError>
    where
        S: PoissonSystem<D, M>,
    {
        Self::of(&Description::of(system, y0), false)
    }

    /// The scheme with Lévy areas, `sexp-li-levy`: strong order 1 for any noises. If the noises
    /// commute ([`systems::noises_commute`] around `y0`), no areas are read and it is that of
    /// [`new`](Self::new).
    ///
    /// # Errors
    /// Errors of [`new`](Self::new), and [`SchemeError`] unless [`systems::jacobi_holds`].
    pub fn with_areas<S, const D: usize, const M: usize>(
        system: &S,
        y0: [f64; D],
    ) -> Result<Self, SchemeError>
    where
        S: PoissonSystem<D, M>,
    {
        Self::of(&Description::of(system, y0), true)
    }

    /// The scheme for a system known at run time.
    ///
    /// # Errors
    /// Errors of [`new`](Self::new).
    pub fn at_run_time(system: &dyn System) -> Result<Self, SchemeError> {
        Self::of(system.description(), false)
    }

    /// The scheme with Lévy areas for a system known at run time.
    ///
    /// # Errors
    /// Errors of [`with_areas`](Self::with_areas).
    pub fn at_run_time_with_areas(system: &dyn System) -> Result<Self, SchemeError> {
        Self::of(system.description(), true)
    }

    fn of(system: &Description, areas: bool) -> Result<Self, SchemeError> {
        let Description { name, linearity, noises_commute, .. } = system;
        let is_casimir = |function: &&Invariant| function.kind == InvariantKind::Casimir;
        let mut casimirs = system.invariants.iter().filter(is_casimir).peekable();
        let named = casimirs.peek().is_some();
        let linear = named && casimirs.all(|casimir| casimir.form == Form::Linear);
        if *linearity == Linearity::Other && !linear {
            let found = if named { "a Casimir that is not linear" } else { "no Casimir" };
            return Err(SchemeError(format!(
                "sexp-li needs a structure matrix that is constant or affine in y, or a system \
                 whose Casimirs are all linear; B of `{name}` is neither, and the system names \
                 {found}; sexp is for any B"
            )));
        }
        if areas && !noises_commute && !system.jacobi_holds {
            return Err(SchemeError::jacobi("sexp-li-levy", name));
        }
        Ok(Self {
            implicit: *linearity == Linearity::Affine,
            areas: areas && !noises_commute,
            clips: match linearity {
                Linearity::Constant => false,
                Linearity::Affine => !system.always_solvable,
                Linearity::Other => true,
            },
        })
    }
}

/// The formula. `IMPLICIT`: for an affine B, else for linear Casimirs.
pub struct LinearlyImplicit<const IMPLICIT: bool, const AREAS: bool>;

impl<const IMPLICIT: bool, const AREAS: bool> Explicit for LinearlyImplicit<IMPLICIT, AREAS> {
    const ID: &'static str = if AREAS { "sexp-li-levy" } else { "sexp-li" };
    const READS_AREAS: bool = AREAS;

    #[inline(always)]
    fn advance<H: Increment>(&self, h: H, y: H::Vector) -> H::Vector {
        let start = y * h.step().first_decay;
        let middle = start + h.field(start) * 0.5;
        let mut v = if h.is_quadratic() {
            h.gradient(middle)
        } else {
            h.averaged_gradient(start, start + h.field(middle))
        };
        if AREAS {
            v = v - h.area_gradient(middle);
        }
        let z = if IMPLICIT { h.cayley(start, v) } else { start + h.structure(middle, v) };
        z * h.step().second_decay
    }
}
