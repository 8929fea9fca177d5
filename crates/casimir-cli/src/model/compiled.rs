//! A system of the project, on its tuned kernels.

use std::{error::Error, sync::Arc};

use casimir::{
    analysis::{Candidates, CompareSettings, Comparison, compare, inspect::Kept, inspect_problem},
    mc::{self, Expect, Setup},
    schemes::{EulerMaruyama, Heun, Midpoint, Nv, Scheme, Sexp, SexpLevy, SexpLi, Split},
    systems::{Damping, Flows, InvariantKind, Linearity, PoissonSystem, Problem, linearity},
};

use super::{Findings, Model};

/// A scheme, or why it is not for the system.
type Suited<S, const D: usize, const M: usize> = Result<Box<dyn Scheme<S, D, M>>, String>;

type Schemes<S, const D: usize, const M: usize> = Vec<(&'static str, Suited<S, D, M>)>;

/// Expectations of a problem, by the flows of its parts or without them.
type Expected<S, const D: usize, const M: usize> =
    for<'a> fn(&'a Problem<S, Arc<dyn Damping>, D>) -> Expect<'a>;

/// A problem with the schemes that are compiled for it.
pub struct Compiled<S, const D: usize, const M: usize> {
    problem: Problem<S, Arc<dyn Damping>, D>,
    schemes: Schemes<S, D, M>,
    names: Vec<&'static str>,
    /// The schemes of a comparison.
    candidates: Compared<S, D, M>,
    expect: Expected<S, D, M>,
}

type Compared<S, const D: usize, const M: usize> =
    for<'a> fn(&'a Problem<S, Arc<dyn Damping>, D>) -> Candidates<'a>;

impl<S: PoissonSystem<D, M> + 'static, const D: usize, const M: usize> Compiled<S, D, M> {
    /// The problem of a system without flows of its own, and its schemes.
    pub fn new(problem: Problem<S, Arc<dyn Damping>, D>) -> Self {
        let nv = Nv::new(problem.system(), problem.y0());
        let nv = nv.map(|nv| Box::new(nv) as _).map_err(|error| error.to_string());
        Self::with(problem, nv, |p| Candidates::all(p), |p| Expect::new(p))
    }

    /// The problem of a system with flows, and its schemes.
    pub fn by_parts(problem: Problem<S, Arc<dyn Damping>, D>) -> Self
    where
        S: Flows<D, M>,
    {
        let nv = Ok(Box::new(Nv::of_parts()) as _);
        let mut all = Self::with(problem, nv, |p| Candidates::by_parts(p), |p| Expect::by_parts(p));
        all.schemes.push(("split", Ok(Box::new(Split))));
        all.names.push("split");
        all
    }

    fn with(
        problem: Problem<S, Arc<dyn Damping>, D>,
        nv: Suited<S, D, M>,
        candidates: Compared<S, D, M>,
        expect: Expected<S, D, M>,
    ) -> Self {
        let (system, y0) = (problem.system(), problem.y0());
        let mut schemes: Schemes<S, D, M> = vec![
            ("sexp", Ok(Box::new(Sexp))),
            ("nv", nv),
            ("midpoint", Ok(Box::new(Midpoint))),
            ("heun", Ok(Box::new(Heun))),
            ("em", Ok(Box::new(EulerMaruyama))),
        ];
        let boxed = |scheme| -> Box<dyn Scheme<S, D, M>> { Box::new(scheme) };
        let words = |error: casimir::schemes::SexpLiError| error.to_string();
        schemes.push(("sexp-li", SexpLi::new(system, y0).map(boxed).map_err(words)));
        // The areas of one noise are zero.
        if M > 1 {
            schemes.push(("sexp-levy", Ok(Box::new(SexpLevy::new(system, y0)))));
            let scheme = SexpLi::with_areas(system, y0);
            schemes.push(("sexp-li-levy", scheme.map(boxed).map_err(words)));
        }
        let names = schemes.iter().map(|(name, _)| *name).collect();
        Self { problem, schemes, names, candidates, expect }
    }
}

impl<S: PoissonSystem<D, M> + 'static, const D: usize, const M: usize> Model for Compiled<S, D, M> {
    fn setup(&self, scheme: &str) -> Result<Setup<'_>, String> {
        let found = self.schemes.iter().find(|(name, _)| *name == scheme);
        let (_, scheme) = found.ok_or_else(|| super::unknown_scheme(scheme, &self.names))?;
        Ok(Setup::of(&self.problem, &**scheme.as_ref()?))
    }

    fn recommended(&self) -> (&'static str, String) {
        let (system, y0) = (self.problem.system(), self.problem.y0());
        let has = |kind| system.invariants().iter().any(|law| law.kind == kind);
        let areas = M > 1 && !SexpLevy::new(system, y0).commuting();
        Kept { casimirs: has(InvariantKind::Casimir), energy: has(InvariantKind::Energy), areas }
            .scheme()
    }

    fn constant_structure(&self) -> bool {
        linearity(self.problem.system(), self.problem.y0()) == Linearity::Constant
    }

    fn expect(&self) -> Option<Expect<'_>> {
        Some((self.expect)(&self.problem))
    }

    fn compare(&self, settings: &CompareSettings<'_>) -> Result<Comparison, Box<dyn Error>> {
        let candidates = (self.candidates)(&self.problem);
        Ok(compare(&mc::Problem::of(&self.problem), &candidates, settings)?)
    }

    fn findings(&self) -> Result<Findings, Box<dyn Error>> {
        Ok(Findings::Small(Box::new(inspect_problem(&self.problem)?)))
    }
}
