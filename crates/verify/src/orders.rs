//! Orders of any scheme on any problem: the door for other people's methods.
//!
//! A [`StepSizes`] says which step sizes, how many paths and which noise; [`strong_order`] and
//! [`weak_order`] run the scheme on a ladder beside a reference and fit the order with its
//! interval. The reference is `sexp` on the same noise, `sexp-levy` for a scheme that reads Lévy
//! areas, or the exact solution where there is one.

use mc::{
    Ladder, LadderError, Measured, Observable, Reference, Run, Statistic, StrongErrors, TimeChange,
    View,
};
use noise::{StreamKey, Truncation};
use schemes::{Scheme, Sexp, SexpLevy};
use stats::{
    CrossMoments, Moments, Point, Rate, fit_strong, fit_weak, fit_weak_against, root_mean_squares,
};
use systems::{Damping, PoissonSystem, Problem};

/// Step sizes, paths and noise of a convergence study.
#[derive(Clone, Copy, Debug)]
pub struct StepSizes {
    /// Number of the coarsest steps on [0, T].
    pub coarsest_steps: u64,
    /// Step sizes, each half of the one before.
    pub levels: usize,
    /// The reference's steps are 2^refinement times finer than the finest of the study. With 0,
    /// `sexp` has no error at the finest step, and no order can be named.
    pub refinement: u32,
    /// Paths.
    pub samples: u64,
    /// How increments are truncated.
    pub truncation: Truncation,
    /// Which noise.
    pub key: StreamKey,
}

/// The most step sizes, and the largest refinement: 2⁴⁸ steps would take years.
const MAX_LEVELS: usize = 24;
const MAX_REFINEMENT: u32 = 24;

/// Errors of one scheme with a fitted order.
#[derive(Clone, Debug)]
pub struct Order {
    /// Error at each step size, coarsest first, with its standard error.
    pub points: Vec<Point>,
    /// The fitted order; `None` when no order can be named.
    pub rate: Option<Rate>,
    /// Paths that were left out.
    pub failed: u64,
}

impl StepSizes {
    /// The level above the finest of step size number `index`, coarsest first.
    fn level(&self, index: usize) -> usize {
        self.levels - 1 - index + self.refinement as usize
    }

    fn taus(&self, t_end: f64) -> Vec<f64> {
        (0..self.levels).map(|index| t_end / (self.coarsest_steps << index) as f64).collect()
    }

    /// The step size of the reference.
    fn reference(&self, t_end: f64) -> f64 {
        t_end / (self.coarsest_steps << self.level(0)) as f64
    }

    /// Runs a reference at the finest level and the scheme at every step size, the scheme's runs
    /// from number 1 on.
    fn run<S, G, T, const D: usize, const M: usize>(
        &self,
        scheme: &dyn Scheme<S, D, M>,
        problem: &Problem<S, G, D>,
        time_change: Option<&dyn TimeChange<M>>,
        statistic: impl Fn(u64, Vec<usize>) -> T + Sync,
    ) -> Result<Measured<T>, LadderError>
    where
        S: PoissonSystem<D, M>,
        G: Damping,
        T: Statistic<D>,
    {
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
        let (sexp, levy) = (Sexp::default(), SexpLevy::new(&problem.system, problem.y0));
        let reference: &dyn Scheme<S, D, M> = if scheme.reads_areas() { &levy } else { &sexp };
        let mut runs: Vec<Run<'_, S, D, M>> = vec![Run::new(reference, 0)];
        runs.extend((0..self.levels).map(|index| Run::new(scheme, self.level(index))));
        let top = self.level(0);
        let mut ladder =
            Ladder::new(problem, self.coarsest_steps << top, top, self.truncation, self.key, runs)?;
        if let Some(time_change) = time_change {
            ladder = ladder.with_time_change(time_change);
        }
        let steps = ladder.coarse_steps();
        Ok(ladder.run(self.samples, || statistic(steps, (1..=self.levels).collect()), &|_| ()))
    }
}

/// The strong order of `scheme`: root-mean-square errors at the final time against `sexp`, or
/// `sexp-levy` if the scheme reads Lévy areas, at the reference step.
///
/// # Errors
/// [`LadderError`] when there is no step size or no step, too many of either, or when the
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
    let outcome = sizes.run(scheme, problem, None, |steps, runs| {
        StrongErrors::new(Reference::Run(0), &[runs], steps)
    })?;
    let taus = sizes.taus(problem.t_end);
    let reference = sizes.reference(problem.t_end);
    let squares = outcome.statistic.at_end(0);
    Ok(Order {
        points: root_mean_squares(&taus, squares),
        rate: fit_strong(&taus, Some(reference), squares),
        failed: outcome.failed,
    })
}

/// The strong order of `scheme` against the exact solution, which is `solution` of the random time
/// that `time_change` reaches at the end.
///
/// # Errors
/// [`LadderError`] when there is no step size or no step, too many of either, or when the
/// truncation is not defined at one of the step sizes.
pub fn strong_order_exact<S, G, const D: usize, const M: usize>(
    scheme: &dyn Scheme<S, D, M>,
    problem: &Problem<S, G, D>,
    sizes: &StepSizes,
    time_change: &dyn TimeChange<M>,
    solution: &(dyn Fn(f64) -> [f64; D] + Sync),
) -> Result<Order, LadderError>
where
    S: PoissonSystem<D, M>,
    G: Damping,
{
    let outcome = sizes.run(scheme, problem, Some(time_change), |steps, runs| {
        StrongErrors::new(Reference::Exact(solution), &[runs], steps)
    })?;
    let taus = sizes.taus(problem.t_end);
    let squares = outcome.statistic.at_end(0);
    Ok(Order {
        points: root_mean_squares(&taus, squares),
        rate: fit_strong(&taus, None, squares),
        failed: outcome.failed,
    })
}

/// The weak order of `scheme` for one test function, by coupled differences: the mean over paths of
/// φ of the scheme minus φ of the reference on the same noise.
///
/// The reference is `sexp` at the reference step, or the exact solution where `exact` gives a clock
/// and a solution. The errors of `sexp` against itself are fitted as the differences e(τ) −
/// e(τ_ref) that they are; those of another scheme as if the reference had no error, so
/// `refinement` should make it small.
///
/// # Errors
/// [`LadderError`] when there is no step size or no step, too many of either, or when the
/// truncation is not defined at one of the step sizes.
pub fn weak_order<S, G, const D: usize, const M: usize>(
    scheme: &dyn Scheme<S, D, M>,
    problem: &Problem<S, G, D>,
    observable: Observable<D>,
    sizes: &StepSizes,
    exact: Option<Exact<'_, D, M>>,
) -> Result<Order, LadderError>
where
    S: PoissonSystem<D, M>,
    G: Damping,
{
    let outcome =
        sizes.run(scheme, problem, exact.map(|exact| exact.time_change), |steps, runs| {
            CoupledDifferences {
                observable,
                reference: exact
                    .map_or(Reference::Run(0), |exact| Reference::Exact(exact.solution)),
                differences: CrossMoments::new(runs.len()),
                runs,
                last_time: steps,
            }
        })?;
    let taus = sizes.taus(problem.t_end);
    let differences = &outcome.statistic.differences;
    let levels = sizes.levels;
    let errors: Vec<f64> = (0..levels).map(|l| differences.mean(l)).collect();
    let covariance: Vec<Vec<f64>> = (0..levels)
        .map(|l| (0..levels).map(|m| differences.covariance_of_means(l, m)).collect())
        .collect();
    let points =
        (0..levels).map(|l| Point::normal(taus[l], errors[l], covariance[l][l].sqrt())).collect();
    let against_itself = exact.is_none() && scheme.id() == Scheme::<S, D, M>::id(&Sexp::default());
    let rate = if against_itself {
        fit_weak_against(&taus, sizes.reference(problem.t_end), &errors, &covariance)
    } else {
        fit_weak(&taus, &errors, &covariance)
    };
    Ok(Order { points, rate, failed: outcome.failed })
}

/// An exact solution at the final time as a function of what a clock shows there.
#[derive(Clone, Copy)]
pub struct Exact<'a, const D: usize, const M: usize> {
    /// Carried along each path.
    pub time_change: &'a dyn TimeChange<M>,
    /// y(T) as a function of the clock.
    pub solution: &'a (dyn Fn(f64) -> [f64; D] + Sync),
}

/// Mean of φ over exact solutions on sampled paths, with its standard error.
///
/// # Errors
/// [`LadderError`] as of [`weak_order`].
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
    let outcome =
        sizes.run(&Sexp::default(), problem, Some(exact.time_change), |steps, _| ExactMean {
            observable,
            solution: exact.solution,
            last_time: steps,
            moments: Moments::default(),
        })?;
    Ok((outcome.statistic.moments.mean(), outcome.statistic.moments.standard_error()))
}

/// φ of the exact solution at the final time.
struct ExactMean<'a, const D: usize> {
    observable: Observable<D>,
    solution: &'a (dyn Fn(f64) -> [f64; D] + Sync),
    last_time: u64,
    moments: Moments,
}

impl<const D: usize> Statistic<D> for ExactMean<'_, D> {
    fn observe(&mut self, view: &View<'_, D>) {
        if view.time == self.last_time {
            for p in view.live.paths() {
                self.moments
                    .add((self.observable.function)((self.solution)(view.random_time.0[0][p])));
            }
        }
    }

    fn merge(&mut self, later: Self) {
        self.moments.merge(later.moments);
    }
}

/// φ(run) − φ(reference) at the final time, with covariances between the runs.
struct CoupledDifferences<'a, const D: usize> {
    observable: Observable<D>,
    reference: Reference<'a, D>,
    runs: Vec<usize>,
    last_time: u64,
    differences: CrossMoments,
}

impl<const D: usize> Statistic<D> for CoupledDifferences<'_, D> {
    fn observe(&mut self, view: &View<'_, D>) {
        if view.time != self.last_time {
            return;
        }
        for p in view.live.paths() {
            let exact = match self.reference {
                Reference::Run(run) => view.states[run].path(p),
                Reference::Exact(solution) => solution(view.random_time.0[0][p]),
            };
            let expected = (self.observable.function)(exact);
            let difference =
                |&run: &usize| (self.observable.function)(view.states[run].path(p)) - expected;
            self.differences.add(&self.runs.iter().map(difference).collect::<Vec<_>>());
        }
    }

    fn merge(&mut self, later: Self) {
        self.differences.merge(&later.differences);
    }
}
