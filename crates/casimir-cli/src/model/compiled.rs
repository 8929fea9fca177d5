//! A system of the project, on its tuned kernels.

use std::sync::Arc;

use casimir::{
    mc::{self, Expect, Friction, bind_owned},
    schemes::{BuiltIn, Method, SchemeError},
    systems::{
        Damping, Problem,
        run_time::{self, System},
    },
};
use kernels::Tuned;

use super::Model;

/// A problem whose schemes are compiled for it.
pub struct Compiled<S, const D: usize, const M: usize> {
    problem: Problem<S, Arc<dyn Damping>, D>,
    friction: Vec<Friction>,
    at_run_time: run_time::Compiled<S, D, M>,
}

impl<S: Tuned<D, M> + Copy + 'static, const D: usize, const M: usize> Compiled<S, D, M> {
    /// The problem of a system of the project.
    pub fn new(problem: Problem<S, Arc<dyn Damping>, D>, friction: Vec<Friction>) -> Self {
        let at_run_time = run_time::Compiled::new(*problem.system(), problem.y0());
        Self { problem, friction, at_run_time }
    }
}

impl<S: Tuned<D, M> + Copy + 'static, const D: usize, const M: usize> Model for Compiled<S, D, M> {
    fn problem(&self) -> mc::Problem<'_> {
        mc::Problem::of(&self.problem).with_friction(&self.friction)
    }

    fn scheme(&self, scheme: BuiltIn) -> Result<Arc<dyn Method + '_>, SchemeError> {
        let scheme = S::scheme(scheme, self.problem.system(), self.problem.y0())?;
        Ok(Friction::around(bind_owned(&self.problem, scheme), &self.friction))
    }

    fn expect(&self) -> Option<Expect<'_>> {
        Some(Expect::compiled(&self.problem, S::scheme).with_friction(&self.friction))
    }

    fn friction(&self) -> &[Friction] {
        &self.friction
    }

    fn system(&self) -> &dyn System {
        &self.at_run_time
    }
}
