//! Strong and weak orders; an exact solution on sampled paths.

use mc::{LadderError, Observe, Setup, TimeChange, View};
use real::{PathMask, Row, WIDTH};
use stats::{
    Against, CrossMoments, Expansion, Point, fit_strong, fit_weak, lower_share, root_mean_squares,
};

use super::{
    Decision, Limit, OneStep, Order, StepSizes,
    consistency::consistency,
    decision::{self, More, undecided},
    limit::weak_limit,
    one_step::one_step as one_step_of,
    runs::{kept, visits},
    step_sizes::within,
};
use crate::FinalMoments;

/// Relative error of a weak difference that the model, some powers of an expansion, need not
/// explain.
const MODEL_ERROR: f64 = 0.01;

/// Number of paths whose states single steps start from.
const VISITS: u64 = 256;
/// Number of paths that show whether most fail: steps that fail take longest.
const FEW: u64 = 32;

/// The strong order of a scheme, from root-mean-square differences y_τ − y_{τ/2} at the final time.
///
/// Of a system from formulas:
///
/// ```
/// use std::sync::Arc;
///
/// use formula::{Definition, FormulaSystem};
/// use mc::Setup;
/// use noise::{StreamKey, Truncation};
/// use schemes::Sexp;
/// use systems::{Constant, run_time::Problem};
/// use analysis::{StepSizes, strong_order};
///
/// let words = |texts: &[&str]| texts.iter().map(|text| text.to_string()).collect::<Vec<_>>();
/// let pendulum = Definition {
///     name: "pendulum".into(),
///     state: words(&["p", "q"]),
///     structure: vec![words(&["-1"])].into(),
///     energy: "p^2/2 - cos(q)".into(),
///     noises: words(&["p^2/2 - cos(q)"]),
///     ..Definition::default()
/// };
/// let (y0, damping) = ([0.2, 1.0], Constant::new(2.0)?);
/// let system = FormulaSystem::new(&pendulum, &y0)?;
/// let problem = Problem::new(Arc::new(system), Arc::new(damping), y0.into(), 1.0)?;
/// let key = StreamKey { seed: 1, experiment: 1 };
/// let sizes = StepSizes::new(16, Truncation::new(4)?, key);
/// let setup = Setup::at_run_time(&problem, &Sexp)?;
/// let order = strong_order(&setup, &sizes)?;
/// assert_eq!(order.order(), Some(1.0), "{order}");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`LadderError`] if there are fewer than four step sizes (`levels` + `refinement`) or no step, if
/// there are too many of either, or if the truncation is not defined at one of the step sizes.
pub fn strong_order(setup: &Setup<'_>, sizes: &StepSizes) -> Result<Order, LadderError> {
    within(sizes, &|sizes| once(setup, None, sizes, None))
}

/// The weak order of a scheme for one test function φ, from the differences E[φ(y_τ) − φ(y_{τ/2})]
/// at the final time on the same noise, or from errors against the exact solution, fitted by
/// [`stats::fit_weak`].
///
/// # Errors
/// [`LadderError`] as in [`strong_order`](super::strong_order), with five step sizes at least.
pub fn weak_order(
    setup: &Setup<'_>,
    observable: &dyn Observe,
    sizes: &StepSizes,
    exact: Option<&Exact<'_>>,
) -> Result<Order, LadderError> {
    within(sizes, &|sizes| once(setup, Some(observable), sizes, exact))
}

/// The order from one measurement, weak for an observable.
fn once(
    setup: &Setup<'_>,
    observable: Option<&dyn Observe>,
    sizes: &StepSizes,
    exact: Option<&Exact<'_>>,
) -> Result<Order, LadderError> {
    // Three differences and their order, or four.
    let (number, one_more) = (sizes.sizes(), usize::from(observable.is_some()));
    sizes.check(4 + one_more)?;
    let values = |view: &View<'_>, numbers: &mut [Row]| {
        // φ(y_k) − φ(y_{k+1}) for all but the finest, then the finest against the solution.
        let solution = exact.map(|exact| exact.rows(view, setup.problem.y0.len()));
        let states = (0..view.runs()).map(|run| view.state(run)).chain(solution.as_deref());
        if let Some(observable) = observable {
            let phi: Vec<Row> = states.map(|y| observable.values(y, view.live)).collect();
            for (number, pair) in numbers.iter_mut().zip(phi.windows(2)) {
                *number = std::array::from_fn(|p| pair[0][p] - pair[1][p]);
            }
        } else {
            for (number, y) in numbers.iter_mut().zip(states.collect::<Vec<_>>().windows(2)) {
                *number = squared_distance(y[0], y[1], view.live);
            }
        }
    };
    let (steps, length) = (sizes.reference_steps(), number - 1 + one_more);
    let measured = |samples| {
        let mut ladder = sizes.ladder(setup, steps, sizes.level(0), samples)?;
        if let Some(exact) = exact {
            ladder = ladder.with_time_change(exact.time_change);
        }
        let new = || FinalMoments::new(ladder.coarse_steps(), length, &values);
        // Few paths show whether most fail, at step sizes that more paths have again.
        let job = sizes.job.as_deref().filter(|_| samples > FEW);
        Ok::<_, LadderError>(kept(
            &ladder,
            (job, &sizes.stop),
            &format!("{steps} steps"),
            samples,
            new,
        ))
    };
    let few = sizes.samples.min(FEW);
    let mut measurement = measured(few)?;
    if 2 * measurement.failed <= few {
        measurement = measured(sizes.samples)?;
    }
    let (moments, failed) = (measurement.statistic.moments, measurement.failed);
    let paths = moments.count() + failed;
    if 10 * failed > paths {
        // The others say little about the scheme.
        let first = measurement.failures.first();
        let t = crate::number(first.map_or(0.0, |first| first.step as f64 * first.tau));
        let because = format!(
            "{failed} of {paths} paths failed, the first at t = {t}, where the solution may end"
        );
        let (decision, limit) = (undecided(More::Steps, because), Limit::Unchecked);
        return Ok(Order {
            points: Vec::new(),
            rate: None,
            one_step: None,
            limit,
            decision,
            failed,
        });
    }
    let (visits, _) = visits(setup, sizes, VISITS)?;
    let limit = match exact {
        Some(_) => weak_limit(&moments),
        None => consistency(setup, sizes, &visits, one_more > 0),
    };
    let taus = sizes.taus(setup.problem.t_end);
    let mut order = if let Some(observable) = observable {
        // Errors at all step sizes, or differences at all but the finest.
        let (fitted, against) = match exact {
            Some(_) => (errors(number, &moments), Against::Exact),
            None => (moments.part(0..number - 1), Against::HalfStep),
        };
        let mut states = setup.start();
        for (p, visit) in visits.iter().take(WIDTH).enumerate() {
            states.iter_mut().zip(&visit.state).for_each(|(row, y)| row[p] = *y);
        }
        let sizes = observable.values(&states, PathMask::first(visits.len()));
        let size = sizes.iter().take(visits.len()).fold(0.0, |most: f64, phi| most.max(phi.abs()));
        weak(&taus[..fitted.length()], &fitted, against, limit, (steps, size))
    } else {
        let one_step = one_step_of(setup, sizes, &visits);
        let squares = visits.iter().map(|at| at.state.iter().map(|y| y * y).sum::<f64>());
        let size = squares.fold(0.0, f64::max).sqrt();
        strong(&taus[..number - 1], &moments, one_step, limit, (steps, size))
    };
    if let Some(because) = sizes.unresolved(setup) {
        order.decision = undecided(More::Steps, because);
    }
    order.failed = failed;
    order.settle();
    Ok(order)
}

/// The strong order from squared differences of successive step sizes, of states of size `size`
/// after `steps` steps.
pub fn strong(
    taus: &[f64],
    squares: &CrossMoments,
    one_step: Option<OneStep>,
    limit: Limit,
    (steps, size): (u64, f64),
) -> Order {
    let (points, rate) = (root_mean_squares(taus, squares), fit_strong(taus, squares));
    let mut decision = decision::strong(rate.as_ref(), one_step, limit);
    if decision::exact(squares, decision::rounding(steps, size), rate.as_ref(), limit) {
        decision = Decision::Kept;
    }
    Order { points, rate, one_step, limit, decision, failed: 0 }
}

/// Weak order from differences of successive step sizes, or errors, of a function of size `size`
/// after `steps` steps.
pub fn weak(
    taus: &[f64],
    fitted: &CrossMoments,
    against: Against,
    limit: Limit,
    (steps, size): (u64, f64),
) -> Order {
    let (means, mut covariance) = (fitted.means(), fitted.covariances_of_means());
    for (l, mean) in means.iter().enumerate() {
        covariance[l][l] += (MODEL_ERROR * mean).powi(2);
    }
    let rate = fit_weak(taus, &means, &covariance, against, Expansion::EveryPower);
    let share = |order| lower_share(taus, &means, &covariance, order, against);
    let mut decision = decision::weak(rate.as_ref(), share, limit);
    if decision != Decision::WrongLimit && decision::kept(fitted, decision::rounding(steps, size)) {
        decision = Decision::Kept;
    }
    let points = taus.iter().zip(means).enumerate().map(|(l, (&tau, value))| {
        let se = fitted.standard_error(l);
        let [lo, hi] = [-1.96, 1.96].map(|reach| Some(value + reach * se));
        Point::Error { tau, value, se, lo, hi, warning: None }
    });
    Order { points: points.collect(), rate, one_step: None, limit, decision, failed: 0 }
}

impl Order {
    /// Widens the interval of the rate to the order that is named, or adds the warning that none
    /// is.
    pub fn settle(&mut self) {
        let Some(rate) = &mut self.rate else { return };
        if let Decision::Order { order, .. } = self.decision {
            (rate.lo, rate.hi) = (rate.lo.min(order), rate.hi.max(order));
        } else {
            let before = rate.warning.take().map_or(String::new(), |warning| warning + "; ");
            rate.warning = Some(format!("{before}{}", self.decision));
        }
    }
}

/// Squared distances |y − x|² of the live paths.
pub fn squared_distance(y: &[Row], x: &[Row], live: PathMask) -> Row {
    let mut squares = [0.0; WIDTH];
    for p in live.paths() {
        squares[p] = y.iter().zip(x).map(|(y, x)| (y[p] - x[p]).powi(2)).sum();
    }
    squares
}

/// Errors at all step sizes: sums of the differences from each on, the last one from the solution.
fn errors(sizes: usize, moments: &CrossMoments) -> CrossMoments {
    let rows = (0..sizes).map(|l| (0..sizes).map(|k| f64::from(u8::from(k >= l))).collect());
    moments.combined(&rows.collect::<Vec<_>>())
}

/// An exact solution at the final time, a function of a random time ([`TimeChange`]).
pub struct Exact<'a> {
    /// The random time, carried along each path.
    pub time_change: &'a dyn TimeChange,
    /// Solution y(T) as a function of the random time at T.
    solution: Box<dyn Fn(f64) -> Vec<f64> + Sync + 'a>,
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
    pub fn rows(&self, view: &View<'_>, dimension: usize) -> Vec<Row> {
        let mut rows = vec![[0.0; WIDTH]; dimension];
        for p in view.live.paths() {
            let solution = (self.solution)(view.random_time[p]);
            rows.iter_mut().zip(solution).for_each(|(row, y)| row[p] = y);
        }
        rows
    }
}
