//! A system of the project, on its tuned kernels.

use std::sync::Arc;

use casimir::{
    analysis::{Candidates, InspectSettings},
    mc::{self, Expect, bind_owned},
    schemes::{BuiltIn, Method, Scheme, SchemeError},
    systems::{
        Damping, Flows, PoissonSystem, Problem,
        run_time::{self, System},
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
    at_run_time: run_time::Compiled<S, D, M>,
    scheme: Compiles<S, D, M>,
    expect: for<'a> fn(&'a Damped<S, D>) -> Expect<'a>,
}

impl<S: PoissonSystem<D, M> + Copy + 'static, const D: usize, const M: usize> Compiled<S, D, M> {
    /// The problem of a system without flows of its own.
    pub fn new(problem: Damped<S, D>) -> Self {
        let at_run_time = run_time::Compiled::new(*problem.system(), problem.y0());
        let scheme = BuiltIn::compiled;
        Self { problem, at_run_time, scheme, expect: |problem| Expect::new(problem) }
    }

    /// The problem of a system with flows.
    pub fn by_parts(problem: Damped<S, D>) -> Self
    where
        S: Flows<D, M>,
    {
        let scheme = BuiltIn::by_parts;
        Self { scheme, expect: |problem| Expect::by_parts(problem), ..Self::new(problem) }
    }
}

impl<S: PoissonSystem<D, M> + Copy + 'static, const D: usize, const M: usize> Model
    for Compiled<S, D, M>
{
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

    fn expect(&self) -> Option<Expect<'_>> {
        Some((self.expect)(&self.problem))
    }

    fn system(&self) -> &dyn System {
        &self.at_run_time
    }

    fn inspect_settings(&self) -> InspectSettings<'_> {
        InspectSettings::of(&self.problem)
    }
}
