//! The schemes on a problem of the paper, and the curves of a figure.

use mc::bind_owned;
use schemes::{Scheme, SchemeError, Sexp, SexpLevy};

use crate::{two_spins::TwoSpins, *};

/// Schemes that are measured, and no others: kernels in six dimensions take long to compile.
impl Tuned<6, 3> for TwoSpins {
    #[inline(never)]
    fn scheme(
        scheme: BuiltIn,
        system: &Self,
        y0: [f64; 6],
    ) -> Result<Box<dyn Scheme<Self, 6, 3>>, SchemeError> {
        match scheme {
            BuiltIn::Sexp => Ok(Box::new(Sexp)),
            BuiltIn::SexpLevy => Ok(Box::new(SexpLevy::new(system, y0))),
            _ => {
                Err(SchemeError::not_for(scheme.id(), system.name(), "nothing is measured with it"))
            }
        }
    }
}

/// Problem of any dimension with the schemes that are compiled for its system.
pub struct Compiled<'a> {
    /// The problem.
    pub problem: mc::Problem<'a>,
    setup: Box<dyn Fn(BuiltIn) -> Option<Setup<'a>> + 'a>,
}

/// Scheme on the problem of a figure, with the name of its curve.
pub struct Curve<'a> {
    /// Name of the curve.
    pub name: &'static str,
    /// The scheme in the registry.
    pub method: BuiltIn,
    /// Problem with the scheme.
    pub setup: Setup<'a>,
}

impl<'a> Compiled<'a> {
    /// Binds the schemes that are compiled for the system of `problem`.
    pub fn of<S: Tuned<D, M>, G: Damping, const D: usize, const M: usize>(
        problem: &'a Problem<S, G, D>,
    ) -> Self {
        let setup = |scheme| {
            let made = S::scheme(scheme, problem.system(), problem.y0()).ok()?;
            // Without areas to read, it is the scheme without areas.
            if scheme.is_for_areas() && !made.about().reads_areas {
                return None;
            }
            let scheme = bind_owned(problem, made);
            Some(Setup { problem: mc::Problem::of(problem), scheme })
        };
        Self { problem: mc::Problem::of(problem), setup: Box::new(setup) }
    }

    /// A curve for each of the schemes that is compiled for the system.
    pub fn curves(&self, schemes: &[BuiltIn]) -> Vec<Curve<'a>> {
        let curve = |&method: &BuiltIn| {
            Some(Curve { name: method.id(), method, setup: (self.setup)(method)? })
        };
        schemes.iter().filter_map(curve).collect()
    }

    /// The problem with `sexp`, which is compiled for every system.
    pub fn sexp(&self) -> Setup<'a> {
        (self.setup)(BuiltIn::Sexp).expect("sexp is compiled for every system")
    }
}
