//! What the limit of a scheme is compared with.

use std::sync::Arc;

use mc::{Setup, TimeChange, View, bind};
use real::{Row, WIDTH};
use schemes::{Heun, Method, Midpoint, run_time::SchemeError};
use systems::{PoissonSystem, Problem, run_time};

/// What the limit of a scheme is compared with, path by path.
pub enum ReferenceSolution<'a> {
    /// The coefficients of the equation, in single steps as τ → 0, and the paths of the first of
    /// these schemes that does not fail and is not the scheme itself.
    Independent(Vec<Arc<dyn Method + 'a>>),
    /// The exact solution. Errors of points are measured against it.
    Exact(Exact<'a>),
}

/// An exact solution at the final time, a function of a random time ([`TimeChange`]).
pub struct Exact<'a> {
    /// The random time, carried along each path.
    pub time_change: &'a dyn TimeChange,
    /// y(T) as a function of the random time at T.
    pub solution: Box<dyn Fn(f64) -> Vec<f64> + Sync + 'a>,
}

impl<'a> ReferenceSolution<'a> {
    /// [`ReferenceSolution::Independent`] with `heun` and `midpoint`.
    pub fn independent<S: PoissonSystem<D, M>, G, const D: usize, const M: usize>(
        problem: &'a Problem<S, G, D>,
    ) -> Self {
        Self::Independent(vec![bind(problem, &Heun), bind(problem, &Midpoint)])
    }

    /// [`ReferenceSolution::Independent`] with `heun` and `midpoint` on a system known at run time.
    ///
    /// # Errors
    /// Those of [`Setup::at_run_time`].
    pub fn at_run_time(problem: &'a run_time::Problem) -> Result<Self, SchemeError> {
        let [heun, midpoint] = [
            Setup::at_run_time(problem, &Heun)?.scheme,
            Setup::at_run_time(problem, &Midpoint)?.scheme,
        ];
        Ok(Self::Independent(vec![heun, midpoint]))
    }

    pub(super) fn exact(&self) -> Option<&Exact<'a>> {
        match self {
            Self::Exact(exact) => Some(exact),
            _ => None,
        }
    }
}

impl<'a> Exact<'a> {
    /// The solution y(T) as a function of the random time at T, which `time_change` carries along
    /// each path.
    pub fn new<Y: Into<Vec<f64>>>(
        time_change: &'a dyn TimeChange,
        solution: impl Fn(f64) -> Y + Sync + 'a,
    ) -> Self {
        Self { time_change, solution: Box::new(move |time| solution(time).into()) }
    }

    /// The solutions of the paths of a block that are live; zero on the others.
    pub(super) fn rows(&self, view: &View<'_>, dimension: usize) -> Vec<Row> {
        let mut rows = vec![[0.0; WIDTH]; dimension];
        for p in view.live.paths() {
            let solution = (self.solution)(view.random_time[p]);
            rows.iter_mut().zip(solution).for_each(|(row, y)| row[p] = y);
        }
        rows
    }
}
