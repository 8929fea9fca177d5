//! The schemes that are compared.

use std::sync::Arc;

use mc::Setup;
use noise::{BlockNoise, NoiseRows};
use schemes::{
    DynScheme, EulerMaruyama, Heun, Midpoint, Nv, Scheme, Sexp, SexpLevy, SexpLi, Split,
    run_time::{self, SchemeError},
};
use systems::{
    Damping, Flows, PoissonSystem, Problem,
    run_time::{Compiled, Problem as RunTimeProblem},
};

use super::own_areas::OwnAreas;
use crate::facts::{Form, casimirs_around};

/// Schemes to compare, the reference, and Casimirs whose laws are measured.
pub struct Candidates<'a, S, const D: usize, const M: usize> {
    schemes: Vec<Held<'a, S, D, M>>,
    reference: Held<'a, S, D, M>,
    casimirs: Vec<Form>,
    /// The scheme that errors are related to, by number.
    base: Option<usize>,
}

/// A scheme of one's own or of someone else's.
enum Held<'a, S, const D: usize, const M: usize> {
    Own(Box<dyn Scheme<S, D, M> + 'a>),
    Lent(&'a dyn Scheme<S, D, M>),
}

impl<S, const D: usize, const M: usize> Held<'_, S, D, M> {
    fn scheme(&self) -> &dyn Scheme<S, D, M> {
        match self {
            Self::Own(scheme) => scheme.as_ref(),
            Self::Lent(scheme) => *scheme,
        }
    }
}

impl<'a, S, const D: usize, const M: usize> Candidates<'a, S, D, M> {
    /// No scheme yet, and this reference. It should have strong order one:
    /// [`SexpLevy`], or [`Sexp`] where noises commute.
    pub fn against(reference: &'a dyn Scheme<S, D, M>) -> Self {
        let reference = Held::Lent(reference);
        Self { schemes: Vec::new(), reference, casimirs: Vec::new(), base: None }
    }

    /// With this scheme, too.
    #[must_use]
    pub fn and(mut self, scheme: &'a dyn Scheme<S, D, M>) -> Self {
        self.schemes.push(Held::Lent(scheme));
        self
    }
}

impl<S: PoissonSystem<D, M>, const D: usize, const M: usize> Candidates<'_, S, D, M> {
    /// All schemes for `problem`: [`Sexp`] and, if it is for the system, [`SexpLi`], both with Lévy
    /// areas as well if the noises do not commute; [`Nv`] if it is for the system; [`Midpoint`],
    /// [`Heun`] and [`EulerMaruyama`]. The reference is [`SexpLevy`]. Strong errors are related to
    /// those of [`Heun`] on the same paths ([`StrongPoint::ratio`](super::StrongPoint::ratio)).
    ///
    /// If the system names no invariant, the linear and quadratic Casimirs that [`Facts`](crate::facts::Facts) have
    /// are measured.
    pub fn all<G>(problem: &Problem<S, G, D>) -> Self
    where
        S: 'static,
    {
        let nv = Nv::new(problem.system(), problem.y0()).ok();
        Self::with_flows(problem, nv.map(|nv| Box::new(nv) as _), None)
    }

    /// The same for a system of parts with flows: [`Nv`] by these, and [`Split`].
    pub fn by_parts<G>(problem: &Problem<S, G, D>) -> Self
    where
        S: Flows<D, M> + 'static,
    {
        Self::with_flows(problem, Some(Box::new(Nv::of_parts())), Some(Box::new(Split)))
    }

    /// All schemes but those of flows, and these.
    fn with_flows<G>(
        problem: &Problem<S, G, D>,
        nv: Option<Box<dyn Scheme<S, D, M>>>,
        split: Option<Box<dyn Scheme<S, D, M>>>,
    ) -> Self
    where
        S: 'static,
    {
        let (system, y0) = (problem.system(), problem.y0());
        let levy = SexpLevy::new(system, y0);
        let mut schemes: Vec<Box<dyn Scheme<S, D, M>>> = vec![Box::new(Sexp)];
        if !levy.commuting() {
            schemes.push(Box::new(levy));
        }
        if let Ok(scheme) = SexpLi::new(system, y0) {
            schemes.push(Box::new(scheme));
        }
        if !levy.commuting()
            && let Ok(scheme) = SexpLi::with_areas(system, y0)
        {
            schemes.push(Box::new(scheme));
        }
        schemes.extend(split);
        schemes.extend(nv);
        schemes.push(Box::new(Midpoint));
        let base = Some(schemes.len());
        schemes.push(Box::new(Heun));
        schemes.push(Box::new(EulerMaruyama));
        let casimirs = match system.invariants()[..] {
            [] => casimirs_around(&Compiled::new(system, y0), &y0),
            _ => Vec::new(),
        };
        let schemes = schemes.into_iter().map(Held::Own).collect();
        Self { schemes, reference: Held::Own(Box::new(levy)), casimirs, base }
    }

    /// The same without the dimension; `problem` is theirs.
    pub fn erased<'b, G: Damping>(
        &'b self,
        problem: &'b Problem<S, G, D>,
    ) -> DynCandidates<'b, BlockNoise<M>> {
        let entrant = |held: &'b Held<'_, S, D, M>| Entrant::of(problem, held.scheme());
        DynCandidates {
            schemes: self.schemes.iter().map(entrant).collect(),
            reference: entrant(&self.reference),
            casimirs: self.casimirs.clone(),
            base: self.base,
        }
    }
}

/// The same as [`Candidates`] for systems of any dimension; N is the noise of a step, see
/// [`Setup`], whose schemes these are.
pub struct DynCandidates<'a, N> {
    pub(super) schemes: Vec<Entrant<'a, N>>,
    pub(super) reference: Entrant<'a, N>,
    /// Casimirs that the system does not name.
    pub(super) casimirs: Vec<Form>,
    /// The scheme that errors are related to, by number.
    pub(super) base: Option<usize>,
}

/// A scheme in a comparison.
pub(super) struct Entrant<'a, N> {
    pub scheme: Arc<dyn DynScheme<N> + 'a>,
    /// The scheme with Lévy areas as it would draw them, if it reads areas.
    pub drawn: Option<Arc<dyn DynScheme<N> + 'a>>,
}

impl<N> Clone for Entrant<'_, N> {
    fn clone(&self) -> Self {
        Self { scheme: Arc::clone(&self.scheme), drawn: self.drawn.clone() }
    }
}

impl<'a, N> Entrant<'a, N> {
    /// The scheme as users have it: with Lévy areas as it would draw them.
    pub fn as_drawn(&self) -> &Arc<dyn DynScheme<N> + 'a> {
        self.drawn.as_ref().unwrap_or(&self.scheme)
    }
}

impl<'a, const M: usize> Entrant<'a, BlockNoise<M>> {
    pub fn of<S: PoissonSystem<D, M>, G: Damping, const D: usize>(
        problem: &'a Problem<S, G, D>,
        scheme: &'a dyn Scheme<S, D, M>,
    ) -> Self {
        let scheme = Setup::of(problem, scheme).scheme;
        let drawn = || Arc::new(OwnAreas(Arc::clone(&scheme))) as Arc<dyn DynScheme<_> + 'a>;
        Self { drawn: scheme.reads_areas().then(drawn), scheme }
    }
}

impl<'a> DynCandidates<'a, NoiseRows> {
    /// No scheme yet, and this reference, see [`Candidates::against`].
    pub fn against(reference: Arc<dyn DynScheme<NoiseRows> + 'a>) -> Self {
        let reference = Entrant { scheme: reference, drawn: None };
        Self { schemes: Vec::new(), reference, casimirs: Vec::new(), base: None }
    }

    /// With this scheme, too.
    #[must_use]
    pub fn and(mut self, scheme: Arc<dyn DynScheme<NoiseRows> + 'a>) -> Self {
        self.schemes.push(Entrant { scheme, drawn: None });
        self
    }

    /// With the laws of these Casimirs, such as those that
    /// [`Facts`](crate::facts::Facts) have.
    #[must_use]
    pub fn with_casimirs(self, casimirs: Vec<Form>) -> Self {
        Self { casimirs, ..self }
    }

    /// All schemes for a system known at run time: [`Sexp`] and, if it is for the system,
    /// [`SexpLi`] and [`Nv`]; [`Midpoint`], [`Heun`] and [`EulerMaruyama`]. Strong errors are
    /// related to those of [`Heun`].
    ///
    /// The reference is [`Sexp`]. Where noises do not commute it is of strong order ½, as all of
    /// these schemes are, and needs many steps for an error that is small beside theirs.
    ///
    /// # Errors
    /// Those of [`Setup::at_run_time`].
    pub fn all(problem: &'a RunTimeProblem) -> Result<Self, SchemeError> {
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
        all.base = Some(all.schemes.len());
        Ok(all.and(scheme(&Heun)?).and(scheme(&EulerMaruyama)?))
    }
}
