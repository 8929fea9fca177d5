//! What the limit of a scheme is compared with.

use std::sync::Arc;

use mc::{Setup, TimeChange, View};
use noise::{BlockNoise, NoiseRows};
use real::{Row, WIDTH};
use schemes::{DynScheme, Heun, Midpoint, Scheme, run_time::SchemeError};
use systems::{Damping, PoissonSystem, Problem, run_time};

/// What the limit of a scheme is compared with, path by path.
pub enum ReferenceSolution<'a, S, const D: usize, const M: usize> {
    /// The coefficients of the equation, in single steps as τ → 0, and the paths of `heun`, or of
    /// `midpoint` where that fails or is the scheme itself.
    Independent,
    /// This scheme.
    Scheme(&'a dyn Scheme<S, D, M>),
    /// The exact solution. Errors of points are measured against it.
    Exact(Exact<'a, D>),
}

/// An exact solution at the final time, a function of a random time ([`TimeChange`]).
#[derive(Clone, Copy)]
pub struct Exact<'a, const D: usize> {
    /// The random time, carried along each path.
    pub time_change: &'a dyn TimeChange,
    /// y(T) as a function of the random time at T.
    pub solution: &'a (dyn Fn(f64) -> [f64; D] + Sync),
}

/// The same as [`ReferenceSolution`] for systems of any dimension; N is the noise of a step, see
/// [`Setup`].
pub enum DynReference<'a, N> {
    /// The coefficients of the equation, in single steps as τ → 0, and the paths of the first of
    /// these schemes that does not fail and is not the scheme itself.
    Independent(Vec<Arc<dyn DynScheme<N> + 'a>>),
    /// This scheme.
    Scheme(Arc<dyn DynScheme<N> + 'a>),
    /// The exact solution. Errors of points are measured against it.
    Exact(DynExact<'a>),
}

/// The same as [`Exact`] for systems of any dimension.
pub struct DynExact<'a> {
    /// The random time, carried along each path.
    pub time_change: &'a dyn TimeChange,
    /// y(T) as a function of the random time at T.
    pub solution: Box<dyn Fn(f64) -> Vec<f64> + Sync + 'a>,
}

impl<'a> DynReference<'a, NoiseRows> {
    /// [`DynReference::Independent`] with `heun` and `midpoint` on a system known at run time.
    ///
    /// # Errors
    /// Those of [`Setup::at_run_time`].
    pub fn independent(problem: &'a run_time::Problem) -> Result<Self, SchemeError> {
        let [heun, midpoint] = [
            Setup::at_run_time(problem, &Heun)?.scheme,
            Setup::at_run_time(problem, &Midpoint)?.scheme,
        ];
        Ok(Self::Independent(vec![heun, midpoint]))
    }
}

impl<'a, N> DynReference<'a, N> {
    pub(super) fn exact(&self) -> Option<&DynExact<'a>> {
        match self {
            Self::Exact(exact) => Some(exact),
            _ => None,
        }
    }
}

impl<'a, S: PoissonSystem<D, M>, const D: usize, const M: usize> ReferenceSolution<'a, S, D, M> {
    /// The same without the dimension.
    pub(super) fn erased<G: Damping>(
        &self,
        problem: &'a Problem<S, G, D>,
    ) -> DynReference<'a, BlockNoise<M>> {
        let on = |scheme: &'a dyn Scheme<S, D, M>| Setup::of(problem, scheme).scheme;
        match *self {
            Self::Independent => DynReference::Independent(vec![on(&Heun), on(&Midpoint)]),
            Self::Scheme(scheme) => DynReference::Scheme(on(scheme)),
            Self::Exact(exact) => DynReference::Exact(exact.into()),
        }
    }
}

impl<'a, const D: usize> From<Exact<'a, D>> for DynExact<'a> {
    fn from(exact: Exact<'a, D>) -> Self {
        let Exact { time_change, solution } = exact;
        Self { time_change, solution: Box::new(move |time| solution(time).into()) }
    }
}

impl DynExact<'_> {
    /// The solutions of the paths of a block that are live; zero on the others.
    pub(super) fn rows(&self, view: &View<'_>) -> Vec<Row> {
        let mut rows = vec![[0.0; WIDTH]; view.state(0).len()];
        for p in view.live.paths() {
            let solution = (self.solution)(view.random_time[p]);
            rows.iter_mut().zip(solution).for_each(|(row, y)| row[p] = y);
        }
        rows
    }
}
