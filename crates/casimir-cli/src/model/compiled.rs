//! A system of the project, on its tuned kernels.

use std::sync::Arc;

use casimir::{
    analysis::{
        Candidates,
        facts::{Kept, fastest},
        inspect,
        inspect::{InspectError, InspectSettings, Inspection},
    },
    mc::{self, Expect, bind_owned},
    schemes::{BuiltIn, Method, Scheme, SchemeError},
    systems::{
        Damping, Flows, InvariantKind, Linearity, PoissonSystem, Problem, linearity,
        noises_commute, run_time,
    },
};

use super::Model;

/// A problem with any damping.
pub type Damped<S, const D: usize> = Problem<S, Arc<dyn Damping>, D>;

type Compiles<S, const D: usize, const M: usize> =
    fn(BuiltIn, &S, [f64; D]) -> Result<Box<dyn Scheme<S, D, M>>, SchemeError>;

/// A problem whose schemes are compiled for it.
pub struct Compiled<S, const D: usize, const M: usize> {
    problem: Damped<S, D>,
    scheme: Compiles<S, D, M>,
    expect: for<'a> fn(&'a Damped<S, D>) -> Expect<'a>,
}

impl<S: PoissonSystem<D, M> + 'static, const D: usize, const M: usize> Compiled<S, D, M> {
    /// The problem of a system without flows of its own.
    pub fn new(problem: Damped<S, D>) -> Self {
        Self { problem, scheme: BuiltIn::compiled, expect: |problem| Expect::new(problem) }
    }

    /// The problem of a system with flows.
    pub fn by_parts(problem: Damped<S, D>) -> Self
    where
        S: Flows<D, M>,
    {
        Self { problem, scheme: BuiltIn::by_parts, expect: |problem| Expect::by_parts(problem) }
    }
}

impl<S: PoissonSystem<D, M> + 'static, const D: usize, const M: usize> Model for Compiled<S, D, M> {
    fn problem(&self) -> mc::Problem<'_> {
        mc::Problem::of(&self.problem)
    }

    fn scheme(&self, scheme: BuiltIn) -> Result<Arc<dyn Method + '_>, SchemeError> {
        let scheme = (self.scheme)(scheme, self.problem.system(), self.problem.y0())?;
        Ok(bind_owned(&self.problem, scheme))
    }

    fn candidates(&self) -> Result<Candidates<'_>, SchemeError> {
        Ok(Candidates::compiled(&self.problem, self.scheme))
    }

    fn recommended(&self) -> (&'static str, String) {
        let (system, y0) = (self.problem.system(), self.problem.y0());
        let has = |kind| system.invariants().iter().any(|law| law.kind == kind);
        let areas = !noises_commute(system, y0);
        Kept { casimirs: has(InvariantKind::Casimir), energy: has(InvariantKind::Energy), areas }
            .scheme()
    }

    fn fastest(&self) -> f64 {
        let system = run_time::Compiled::new(self.problem.system(), self.problem.y0());
        fastest(&system, &self.problem.y0())
    }

    fn constant_structure(&self) -> bool {
        linearity(self.problem.system(), self.problem.y0()) == Linearity::Constant
    }

    fn expect(&self) -> Option<Expect<'_>> {
        Some((self.expect)(&self.problem))
    }

    fn findings(&self) -> Result<Inspection, InspectError> {
        let system = run_time::Compiled::new(self.problem.system(), self.problem.y0());
        inspect(&system, &InspectSettings::of(&self.problem))
    }
}
