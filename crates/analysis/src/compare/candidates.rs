//! The schemes that are compared.

use std::sync::Arc;

use mc::bind_owned;
use schemes::{BuiltIn, Method, Scheme, SchemeError};
use systems::{PoissonSystem, Problem, run_time::Compiled};

use crate::facts::{Form, casimirs_around};

/// Schemes to compare, the reference, and Casimirs whose laws are measured. Schemes are those on
/// the system of one problem, see [`bind`](mc::bind).
pub struct Candidates<'a> {
    pub(super) schemes: Vec<Arc<dyn Method + 'a>>,
    pub(super) reference: Arc<dyn Method + 'a>,
    /// Casimirs that the system does not name.
    pub(super) casimirs: Vec<Form>,
}

impl<'a> Candidates<'a> {
    /// No scheme yet, and this reference. It should have strong order one:
    /// [`SexpLevy`](schemes::SexpLevy), or [`Sexp`](schemes::Sexp) where noises commute.
    pub fn against(reference: Arc<dyn Method + 'a>) -> Self {
        Self { schemes: Vec::new(), reference, casimirs: Vec::new() }
    }

    /// With this scheme, too.
    #[must_use]
    pub fn and(mut self, scheme: Arc<dyn Method + 'a>) -> Self {
        self.schemes.push(scheme);
        self
    }

    /// The built-in schemes that `scheme` makes for the system: all that need no flows with
    /// [`BuiltIn::compiled`], also [`Nv`](schemes::Nv) and [`Split`](schemes::Split) with
    /// [`BuiltIn::by_parts`]; with Lévy areas only if the noises do not commute. The reference is
    /// [`SexpLevy`](schemes::SexpLevy).
    ///
    /// If the system names no invariant, the linear and quadratic Casimirs that
    /// [`Facts`](crate::facts::Facts) have are measured.
    ///
    /// # Panics
    /// If it does not make [`Sexp`](schemes::Sexp).
    pub fn compiled<S: PoissonSystem<D, M> + Clone + 'static, G, const D: usize, const M: usize>(
        problem: &'a Problem<S, G, D>,
        scheme: impl Fn(BuiltIn, &S, [f64; D]) -> Result<Box<dyn Scheme<S, D, M>>, SchemeError>,
    ) -> Self {
        let (system, y0) = (problem.system(), problem.y0());
        let bind = |id| scheme(id, system, y0).map(|scheme| bind_owned(problem, scheme));
        let all = Self::built_in(bind).unwrap_or_else(|error| unreachable!("{error}"));
        let casimirs = match system.invariants()[..] {
            [] => casimirs_around(&Compiled::new(system.clone(), y0), &y0),
            _ => Vec::new(),
        };
        Self { casimirs, ..all }
    }

    /// All [built-in schemes](BuiltIn) that `bind` makes; with Lévy areas only if it makes them and
    /// the noises do not commute.
    ///
    /// The reference is [`SexpLevy`](schemes::SexpLevy); without areas it is
    /// [`Sexp`](schemes::Sexp), which is of strong order ½ as all other schemes are, and needs many
    /// steps for an error that is small beside theirs.
    ///
    /// # Errors
    /// Those of [`Sexp`](schemes::Sexp).
    pub fn built_in(
        bind: impl Fn(BuiltIn) -> Result<Arc<dyn Method + 'a>, SchemeError>,
    ) -> Result<Self, SchemeError> {
        let mut all = Self::against(bind(BuiltIn::SexpLevy).or_else(|_| bind(BuiltIn::Sexp))?);
        for id in BuiltIn::ALL {
            match bind(id) {
                // The same without areas is there already.
                Ok(scheme) if id.is_for_areas() && !scheme.reads_areas() => {}
                Ok(scheme) => all = all.and(scheme),
                Err(_) => {}
            }
        }
        Ok(all)
    }
}
