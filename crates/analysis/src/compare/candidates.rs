//! The schemes that are compared.

use std::sync::Arc;

use mc::{Setup, bind_owned};
use schemes::{
    EulerMaruyama, Heun, Method, Midpoint, Nv, Scheme, Sexp, SexpLevy, SexpLi, Split,
    run_time::{self, SchemeError},
};
use systems::{
    Flows, PoissonSystem, Problem,
    run_time::{Compiled, Problem as RunTimeProblem},
};

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
    /// [`SexpLevy`], or [`Sexp`] where noises commute.
    pub fn against(reference: Arc<dyn Method + 'a>) -> Self {
        Self { schemes: Vec::new(), reference, casimirs: Vec::new() }
    }

    /// With this scheme, too.
    #[must_use]
    pub fn and(mut self, scheme: Arc<dyn Method + 'a>) -> Self {
        self.schemes.push(scheme);
        self
    }

    /// With the laws of these Casimirs, such as those that
    /// [`Facts`](crate::facts::Facts) have.
    #[must_use]
    pub fn with_casimirs(self, casimirs: Vec<Form>) -> Self {
        Self { casimirs, ..self }
    }

    /// All schemes for `problem`: [`Sexp`] and, if it is for the system, [`SexpLi`], both with Lévy
    /// areas as well if the noises do not commute; [`Nv`] if it is for the system; [`Midpoint`],
    /// [`Heun`] and [`EulerMaruyama`]. The reference is [`SexpLevy`].
    ///
    /// If the system names no invariant, the linear and quadratic Casimirs that [`Facts`](crate::facts::Facts) have
    /// are measured.
    pub fn all<S: PoissonSystem<D, M> + 'static, G, const D: usize, const M: usize>(
        problem: &'a Problem<S, G, D>,
    ) -> Self {
        let nv = Nv::new(problem.system(), problem.y0()).ok();
        Self::with_flows(problem, nv.map(|nv| Box::new(nv) as _), None)
    }

    /// The same for a system of parts with flows: [`Nv`] by these, and [`Split`].
    pub fn by_parts<S: Flows<D, M> + 'static, G, const D: usize, const M: usize>(
        problem: &'a Problem<S, G, D>,
    ) -> Self {
        Self::with_flows(problem, Some(Box::new(Nv::of_parts())), Some(Box::new(Split)))
    }

    /// All schemes but those of flows, and these.
    fn with_flows<S: PoissonSystem<D, M> + 'static, G, const D: usize, const M: usize>(
        problem: &'a Problem<S, G, D>,
        nv: Option<Box<dyn Scheme<S, D, M>>>,
        split: Option<Box<dyn Scheme<S, D, M>>>,
    ) -> Self {
        let (system, y0) = (problem.system(), problem.y0());
        let levy = SexpLevy::new(system, y0);
        let on = |scheme: Box<dyn Scheme<S, D, M>>| bind_owned(problem, scheme);
        let mut all = Self::against(on(Box::new(levy))).and(on(Box::new(Sexp)));
        if !levy.commuting() {
            all = all.and(on(Box::new(levy)));
        }
        if let Ok(scheme) = SexpLi::new(system, y0) {
            all = all.and(on(Box::new(scheme)));
        }
        if !levy.commuting()
            && let Ok(scheme) = SexpLi::with_areas(system, y0)
        {
            all = all.and(on(Box::new(scheme)));
        }
        for scheme in split.into_iter().chain(nv) {
            all = all.and(on(scheme));
        }
        all = all.and(on(Box::new(Midpoint)));
        all = all.and(on(Box::new(Heun))).and(on(Box::new(EulerMaruyama)));
        match system.invariants()[..] {
            [] => all.with_casimirs(casimirs_around(&Compiled::new(system, y0), &y0)),
            _ => all,
        }
    }

    /// All schemes for a system known at run time: [`Sexp`] and, if it is for the system,
    /// [`SexpLi`] and [`Nv`]; [`Midpoint`], [`Heun`] and [`EulerMaruyama`].
    ///
    /// The reference is [`Sexp`]. Where noises do not commute it is of strong order ½, as all of
    /// these schemes are, and needs many steps for an error that is small beside theirs.
    ///
    /// # Errors
    /// Those of [`Setup::at_run_time`].
    pub fn at_run_time(problem: &'a RunTimeProblem) -> Result<Self, SchemeError> {
        let scheme = |scheme: &'a dyn run_time::Scheme| {
            Setup::at_run_time(problem, scheme).map(|setup| setup.scheme)
        };
        let mut all = Self::against(scheme(&Sexp)?).and(scheme(&Sexp)?);
        if let Ok(linear) = SexpLi::at_run_time(problem.system()) {
            all = all.and(Setup::owning(problem, Box::new(linear))?.scheme);
        }
        if let Ok(nv) = Nv::at_run_time(problem.system()) {
            all = all.and(Setup::owning(problem, Box::new(nv))?.scheme);
        }
        all = all.and(scheme(&Midpoint)?);
        Ok(all.and(scheme(&Heun)?).and(scheme(&EulerMaruyama)?))
    }
}
