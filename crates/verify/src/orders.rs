//! Orders of any scheme on any problem.
//!
//! [`StepSizes`] says which step sizes, how many paths and which noise. The scheme runs at all of
//! them on a ladder beside a reference, on the same noise, and an order is fitted to the errors at
//! the final time, with its interval.

use mc::{Ladder, LadderError, Observable, Run, TimeChange, View};
use noise::{StreamKey, Truncation};
use schemes::{Scheme, Sexp, SexpLevy};
use stats::{Against, CrossMoments, Point, Rate, fit_strong, fit_weak, root_mean_squares};
use systems::{Damping, PoissonSystem, Problem};

use crate::{FinalMoments, FinalValues};

/// Step sizes, paths and noise of a measurement of an order.
#[derive(Clone, Copy, Debug)]
pub struct StepSizes {
    /// Number of the coarsest steps on [0, T].
    pub coarsest_steps: u64,
    /// Step sizes, each half of the one before.
    pub levels: usize,
    /// The reference's steps are 2^refinement times finer than the finest of these. With 0, a
    /// scheme has no error against itself at the finest step, and no order can be named.
    pub refinement: u32,
    /// Paths.
    pub samples: u64,
    /// How increments are truncated.
    pub truncation: Truncation,
    /// Which noise.
    pub key: StreamKey,
}

/// What errors are measured against, path by path.
pub enum ReferenceSolution<'a, S, const D: usize, const M: usize> {
    /// The scheme itself at the reference step.
    Itself,
    /// This scheme at the reference step.
    Scheme(&'a dyn Scheme<S, D, M>),
    /// The exact solution.
    Exact(Exact<'a, D, M>),
}

/// An exact solution at the final time, a function of a random time ([`TimeChange`]).
#[derive(Clone, Copy)]
pub struct Exact<'a, const D: usize, const M: usize> {
    /// The random time, carried along each path.
    pub time_change: &'a dyn TimeChange<M>,
    /// y(T) as a function of the random time at T.
    pub solution: &'a (dyn Fn(f64) -> [f64; D] + Sync),
}

/// Errors of one scheme with a fitted order.
#[derive(Clone, Debug)]
pub struct Order {
    /// Error at each step size, coarsest first, with its standard error.
    pub points: Vec<Point>,
    /// The fitted order; `None` if no order can be named.
    pub rate: Option<Rate>,
    /// Paths that were left out.
    pub failed: u64,
}

/// The strong order of `scheme`: root-mean-square errors at the final time against `sexp` at the
/// reference step, or against `sexp-levy` if the scheme reads Lévy areas.
///
/// # Errors
/// [`LadderError`] if there is no step size or no step, if there are too many of either, or if the
/// truncation is not defined at one of the step sizes.
pub fn strong_order<S, G, const D: usize, const M: usize>(
    scheme: &dyn Scheme<S, D, M>,
    problem: &Problem<S, G, D>,
    sizes: &StepSizes,
) -> Result<Order, LadderError>
where
    S: PoissonSystem<D, M>,
    G: Damping,
{
    let (sexp, levy) = (Sexp::default(), SexpLevy::new(problem.system(), problem.y0()));
    let reference: &dyn Scheme<S, D, M> = if scheme.reads_areas() { &levy } else { &sexp };
    strong_order_against(scheme, problem, sizes, ReferenceSolution::Scheme(reference))
}

/// The strong order of `scheme`: root-mean-square errors √E|y − y_ref|² at the final time, fitted
/// by [`stats::fit_strong`].
///
/// # Errors
/// As [`strong_order`].
pub fn strong_order_against<S, G, const D: usize, const M: usize>(
    scheme: &dyn Scheme<S, D, M>,
    problem: &Problem<S, G, D>,
    sizes: &StepSizes,
    reference: ReferenceSolution<'_, S, D, M>,
) -> Result<Order, LadderError>
where
    S: PoissonSystem<D, M>,
    G: Damping,
{
    let square =
        |y: [f64; D], exact: [f64; D]| (0..D).map(|i| (y[i] - exact[i]) * (y[i] - exact[i])).sum();
    let (squares, failed) = errors(scheme, problem, sizes, &reference, &square)?;
    let taus = sizes.taus(problem.t_end());
    let step = match reference {
        ReferenceSolution::Exact(_) => None,
        _ => Some(problem.t_end() / sizes.reference_steps() as f64),
    };
    let rate = fit_strong(&taus, step, &squares);
    Ok(Order { points: root_mean_squares(&taus, &squares), rate, failed })
}

/// The weak order of `scheme` for one test function φ, from the errors E[φ(y) − φ(y_ref)] at the
/// final time on the same noise, fitted by [`stats::fit_weak`].
///
/// Errors against [`ReferenceSolution::Itself`] are fitted as the differences e(τ) − e(τ_ref) that
/// they are; those against another scheme as if it had no error, so `refinement` should make its
/// error small.
///
/// # Errors
/// As [`strong_order`].
pub fn weak_order<S, G, const D: usize, const M: usize>(
    scheme: &dyn Scheme<S, D, M>,
    problem: &Problem<S, G, D>,
    observable: Observable<D>,
    sizes: &StepSizes,
    reference: ReferenceSolution<'_, S, D, M>,
) -> Result<Order, LadderError>
where
    S: PoissonSystem<D, M>,
    G: Damping,
{
    let phi = observable.function;
    let error = |y: [f64; D], exact: [f64; D]| phi(y) - phi(exact);
    let (moments, failed) = errors(scheme, problem, sizes, &reference, &error)?;
    let (taus, means) = (sizes.taus(problem.t_end()), moments.means());
    let covariance = moments.covariances_of_means();
    let points = (0..taus.len()).map(|l| Point::normal(taus[l], means[l], covariance[l][l].sqrt()));
    let against = match reference {
        ReferenceSolution::Itself => {
            Against::Step(problem.t_end() / sizes.reference_steps() as f64)
        }
        _ => Against::Exact,
    };
    let rate = fit_weak(&taus, &means, &covariance, against);
    Ok(Order { points: points.collect(), rate, failed })
}

/// Mean of φ over exact solutions on sampled paths, with its standard error.
///
/// # Errors
/// As [`strong_order`].
pub fn exact_mean<S, G, const D: usize, const M: usize>(
    problem: &Problem<S, G, D>,
    observable: Observable<D>,
    sizes: &StepSizes,
    exact: Exact<'_, D, M>,
) -> Result<(f64, f64), LadderError>
where
    S: PoissonSystem<D, M>,
    G: Damping,
{
    let values = |view: &View<'_, D>, p: usize, values: &mut [f64]| {
        values[0] = (observable.function)((exact.solution)(view.random_time.0[0][p]));
    };
    let (values, _) = measure(problem, sizes, Vec::new(), Some(exact.time_change), 1, &values)?;
    Ok((values.mean(0), values.covariance_of_means(0, 0).sqrt()))
}

/// The most step sizes, and the largest refinement: 2⁴⁸ steps would take years.
const MAX_LEVELS: usize = 24;
const MAX_REFINEMENT: u32 = 24;

impl StepSizes {
    /// The level above the finest of step size number `index`, coarsest first.
    pub(crate) fn level(&self, index: usize) -> usize {
        self.levels - 1 - index + self.refinement as usize
    }

    /// The numbers of steps, coarsest first.
    pub fn steps(&self) -> impl Iterator<Item = u64> {
        (0..self.levels).map(|index| self.coarsest_steps << index)
    }

    /// Number of steps of the reference.
    pub fn reference_steps(&self) -> u64 {
        self.coarsest_steps << self.level(0)
    }

    fn taus(&self, t_end: f64) -> Vec<f64> {
        self.steps().map(|steps| t_end / steps as f64).collect()
    }

    /// Refuses sizes without a step or a step size, or with too many.
    pub(crate) fn check(&self) -> Result<(), LadderError> {
        if self.levels == 0 || self.levels > MAX_LEVELS || self.refinement > MAX_REFINEMENT {
            return Err(LadderError::Level {
                level: self.levels + self.refinement as usize,
                swapped: false,
                levels: MAX_LEVELS + MAX_REFINEMENT as usize,
            });
        }
        if self.coarsest_steps == 0 || self.coarsest_steps.leading_zeros() <= self.level(0) as u32 {
            return Err(LadderError::Steps { steps: self.coarsest_steps, multiple_of: 1 });
        }
        Ok(())
    }
}

/// Moments of error(y, y_ref) at the final time over the step sizes, coarsest first, and the number
/// of paths that were left out.
fn errors<S, G, const D: usize, const M: usize>(
    scheme: &dyn Scheme<S, D, M>,
    problem: &Problem<S, G, D>,
    sizes: &StepSizes,
    reference: &ReferenceSolution<'_, S, D, M>,
    error: &(dyn Fn([f64; D], [f64; D]) -> f64 + Sync),
) -> Result<(CrossMoments, u64), LadderError>
where
    S: PoissonSystem<D, M>,
    G: Damping,
{
    sizes.check()?;
    let levels = sizes.levels;
    let mut runs: Vec<Run<'_, S, D, M>> =
        (0..levels).map(|index| Run::new(scheme, sizes.level(index))).collect();
    let exact = match *reference {
        ReferenceSolution::Exact(exact) => Some(exact),
        ReferenceSolution::Itself => {
            runs.push(Run::new(scheme, 0));
            None
        }
        ReferenceSolution::Scheme(reference) => {
            runs.push(Run::new(reference, 0));
            None
        }
    };
    let values = |view: &View<'_, D>, p: usize, values: &mut [f64]| {
        let exact = match exact {
            None => view.states[levels].path(p),
            Some(exact) => (exact.solution)(view.random_time.0[0][p]),
        };
        for (value, y) in values.iter_mut().zip(view.states) {
            *value = error(y.path(p), exact);
        }
    };
    measure(problem, sizes, runs, exact.map(|exact| exact.time_change), levels, &values)
}

/// Moments of a vector of this length at the final time, and the number of paths that were left
/// out.
fn measure<S, G, const D: usize, const M: usize>(
    problem: &Problem<S, G, D>,
    sizes: &StepSizes,
    runs: Vec<Run<'_, S, D, M>>,
    time_change: Option<&dyn TimeChange<M>>,
    length: usize,
    values: &FinalValues<'_, D>,
) -> Result<(CrossMoments, u64), LadderError>
where
    S: PoissonSystem<D, M>,
    G: Damping,
{
    sizes.check()?;
    let top = sizes.level(0);
    let steps = sizes.reference_steps();
    let mut ladder = Ladder::new(problem, steps, top, sizes.truncation, sizes.key, runs)?;
    if let Some(time_change) = time_change {
        ladder = ladder.with_time_change(time_change);
    }
    let none = || FinalMoments::new(ladder.coarse_steps(), length, values);
    let measured = ladder.run(sizes.samples, none, &|_| ());
    Ok((measured.statistic.moments, measured.failed))
}
