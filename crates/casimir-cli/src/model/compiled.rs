//! A system of the project, on its tuned kernels.

use std::{error::Error, sync::Arc};

use casimir::{
    mc::{DynProblem, Expect, Setup},
    noise::BlockNoise,
    schemes::{EulerMaruyama, Heun, Midpoint, Scheme, Sexp, SexpLevy, SexpLi, Split},
    systems::{Damping, Flows, PoissonSystem, Problem},
    verify::{Candidates, Comparison, DynCompareSettings, compare_of, inspect_problem},
};

use super::{Findings, Model};

type Schemes<S, const D: usize, const M: usize> =
    Vec<(&'static str, Result<Box<dyn Scheme<S, D, M>>, String>)>;

/// Expectations of a problem, by the flows of its parts or without them.
type Expected<S, const D: usize, const M: usize> =
    for<'a> fn(&'a Problem<S, Arc<dyn Damping>, D>) -> Expect<'a, BlockNoise<M>>;

/// A problem with the schemes that are compiled for it.
pub struct Compiled<S, const D: usize, const M: usize> {
    problem: Problem<S, Arc<dyn Damping>, D>,
    schemes: Schemes<S, D, M>,
    names: Vec<&'static str>,
    /// The number of `split`, where the system has flows.
    split: Option<usize>,
    expect: Expected<S, D, M>,
}

impl<S: PoissonSystem<D, M> + 'static, const D: usize, const M: usize> Compiled<S, D, M> {
    /// The problem with all schemes but `split`.
    pub fn new(problem: Problem<S, Arc<dyn Damping>, D>) -> Self {
        let (system, y0) = (problem.system(), problem.y0());
        let mut schemes: Schemes<S, D, M> = vec![
            ("sexp", Ok(Box::new(Sexp))),
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
        Self { problem, schemes, names, split: None, expect: |problem| Expect::new(problem) }
    }

    /// With `split`, too.
    #[must_use]
    pub fn with_flows(mut self) -> Self
    where
        S: Flows<D, M>,
    {
        self.split = Some(self.schemes.len());
        self.schemes.push(("split", Ok(Box::new(Split))));
        self.names.push("split");
        self.expect = |problem| Expect::by_parts(problem);
        self
    }
}

impl<S: PoissonSystem<D, M> + 'static, const D: usize, const M: usize> Model<BlockNoise<M>>
    for Compiled<S, D, M>
{
    fn setup(&self, scheme: &str) -> Result<Setup<'_, BlockNoise<M>>, String> {
        let found = self.schemes.iter().find(|(name, _)| *name == scheme);
        let (_, scheme) = found.ok_or_else(|| super::unknown_scheme(scheme, &self.names))?;
        Ok(Setup::of(&self.problem, &**scheme.as_ref()?))
    }

    fn expect(&self) -> Option<Expect<'_, BlockNoise<M>>> {
        Some((self.expect)(&self.problem))
    }

    fn compare(&self, settings: &DynCompareSettings<'_>) -> Result<Comparison, Box<dyn Error>> {
        let mut candidates = Candidates::all(&self.problem);
        if let Some(Ok(split)) = self.split.map(|number| self.schemes[number].1.as_ref()) {
            candidates = candidates.and(&**split);
        }
        let candidates = candidates.erased(&self.problem);
        Ok(compare_of(&DynProblem::of(&self.problem), &candidates, settings)?)
    }

    fn findings(&self) -> Result<Findings, Box<dyn Error>> {
        Ok(Findings::Small(Box::new(inspect_problem(&self.problem)?)))
    }
}
