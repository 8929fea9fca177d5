//! The schemes that are compared.

use schemes::{EulerMaruyama, Heun, Midpoint, Scheme, Sexp, SexpLevy, SexpLi};
use systems::{PoissonSystem, Problem};

use crate::inspect::{FoundCasimir, inspect};

/// Schemes to compare, the reference, and Casimirs whose laws are measured.
pub struct Candidates<'a, S, const D: usize, const M: usize> {
    schemes: Vec<Held<'a, S, D, M>>,
    reference: Held<'a, S, D, M>,
    casimirs: Vec<FoundCasimir>,
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

    /// The schemes.
    pub(super) fn schemes(&self) -> Vec<&dyn Scheme<S, D, M>> {
        self.schemes.iter().map(Held::scheme).collect()
    }

    /// The reference.
    pub(super) fn reference(&self) -> &dyn Scheme<S, D, M> {
        self.reference.scheme()
    }

    /// The scheme that errors are related to, by number.
    pub(super) fn base(&self) -> Option<usize> {
        self.base
    }

    /// Casimirs that the system does not name.
    pub(super) fn casimirs(&self) -> &[FoundCasimir] {
        &self.casimirs
    }
}

impl<S: PoissonSystem<D, M>, const D: usize, const M: usize> Candidates<'_, S, D, M> {
    /// All schemes for `problem`: [`Sexp`] and, if it is for the system, [`SexpLi`], both with Lévy
    /// areas as well if the noises do not commute; [`Midpoint`], [`Heun`] and [`EulerMaruyama`].
    /// The reference is [`SexpLevy`]. Strong errors are related to those of [`Heun`] on the same
    /// paths ([`StrongPoint::ratio`](super::StrongPoint::ratio)).
    ///
    /// If the system names no invariant, the linear and quadratic Casimirs that [`inspect()`] finds
    /// are measured.
    pub fn all<G>(problem: &Problem<S, G, D>) -> Self
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
        schemes.push(Box::new(Midpoint));
        let base = Some(schemes.len());
        schemes.push(Box::new(Heun));
        schemes.push(Box::new(EulerMaruyama));
        let casimirs = match system.invariants()[..] {
            // A domain that is hard to find leaves the Casimirs unknown.
            [] => inspect(system).map(|report| report.casimirs.found).unwrap_or_default(),
            _ => Vec::new(),
        };
        let schemes = schemes.into_iter().map(Held::Own).collect();
        Self { schemes, reference: Held::Own(Box::new(levy)), casimirs, base }
    }
}
