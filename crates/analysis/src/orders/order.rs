//! Strong and weak orders.

use mc::{LadderError, Observe, Setup, View, parts::Stop};
use real::{PathMask, Row, WIDTH};
use stats::{Against, CrossMoments, Expansion, Point, fit_strong, fit_weak, lower_share};

use super::{
    Decision, Exact, Measure, Order, StepSizes,
    consistency::consistency,
    decision,
    errors::{differences, record, record_length, strong_points, widest},
    limit::weak_limit,
    one_step::one_step,
    runs::{at_all_sizes, failing, measure, visits},
    steps::Subject,
    within::within,
};

/// Relative error of a weak difference for which the model, some powers of an expansion, is not
/// answerable.
const MODEL_ERROR: f64 = 0.01;

/// Paths whose states single steps start from.
const VISITS: u64 = 256;

/// The strong order of a scheme, with root-mean-square errors at the final time.
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
///     structure: vec![words(&["-1"])],
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
    within(sizes, &|sizes| once(setup, Measure::Strong, sizes, None))
}

/// The weak order of a scheme for one test function φ, from the differences E[φ(y_τ) − φ(y_{τ/2})]
/// at the final time on the same noise, or from errors against the exact solution, fitted by
/// [`stats::fit_weak`].
///
/// Points are errors E[φ(y_τ) − φ(y)] with the error of the finest step extrapolated, or against
/// the exact solution.
///
/// # Errors
/// As [`strong_order`](super::strong_order), with five step sizes at least.
pub fn weak_order(
    setup: &Setup<'_>,
    observable: &dyn Observe,
    sizes: &StepSizes,
    exact: Option<&Exact<'_>>,
) -> Result<Order, LadderError> {
    within(sizes, &|sizes| once(setup, Measure::Weak(observable), sizes, exact))
}

/// The order from one measurement.
fn once(
    setup: &Setup<'_>,
    what: Measure<'_>,
    sizes: &StepSizes,
    exact: Option<&Exact<'_>>,
) -> Result<Order, LadderError> {
    // Three differences and their order, or four.
    let (levels, number) = (sizes.levels, sizes.sizes());
    let (least, length) = match what {
        Measure::Strong => (4, record_length(number, levels)),
        Measure::Weak(_) => (5, number),
    };
    sizes.check_order(least)?;
    let subject = Subject::from(setup);
    if let Some(failing) = failing(subject, sizes)? {
        return Ok(failing);
    }
    let values = |view: &View<'_>, numbers: &mut [Row]| {
        let solution = exact.map(|exact| exact.rows(view, subject.problem.y0.len()));
        let states: Vec<&[Row]> = (0..view.runs()).map(|run| view.state(run)).collect();
        match what {
            Measure::Strong => record(&states, view.live, levels, numbers),
            // φ(y_k) − φ(y_{k+1}) for all but the finest, then the finest against the solution.
            Measure::Weak(observable) => {
                let states = states.into_iter().chain(solution.as_deref());
                let phi = states.map(|y| evaluate(observable, y, view.live));
                let phi: Vec<Row> = phi.collect();
                for (number, pair) in numbers.iter_mut().zip(phi.windows(2)) {
                    *number = difference(&pair[0], &pair[1]);
                }
            }
        }
    };
    let (runs, time_change) =
        (at_all_sizes(subject.scheme, sizes), exact.map(|exact| exact.time_change));
    let (moments, failed) = measure(subject.problem, sizes, runs, time_change, length, &values)?;

    // Where paths fail, steps that fail take longest, and decide nothing.
    if 10 * failed.paths > sizes.samples {
        return Ok(failed.order(sizes.samples));
    }
    let visits = visits(subject, sizes, VISITS, &Stop::default())?;
    let limit = match exact {
        Some(_) => weak_limit(&moments),
        None => {
            let law = matches!(what, Measure::Weak(_));
            consistency(subject, sizes, &visits, law, &Stop::default())
        }
    };
    let taus = sizes.taus(subject.problem.t_end);
    let (mut rate, one_step, mut decision) = match what {
        Measure::Strong => {
            let rate = fit_strong(&taus[..number - 1], &differences(&moments, number, levels));
            let one_step = one_step(subject, sizes, &visits);
            let decision = decision::strong(rate.as_ref(), one_step, limit);
            (rate, one_step, decision)
        }
        Measure::Weak(observable) => {
            // Errors at all step sizes, or differences at all but the finest.
            let (fitted, against) = match exact {
                Some(_) => (errors(number, &moments, None), Against::Exact),
                None => (moments.part(0..number - 1), Against::HalfStep),
            };
            let (means, mut covariance) = (fitted.means(), fitted.covariances_of_means());
            for (l, mean) in means.iter().enumerate() {
                covariance[l][l] += (MODEL_ERROR * mean).powi(2);
            }
            let taus = &taus[..means.len()];
            let rate = fit_weak(taus, &means, &covariance, against, Expansion::EveryPower);
            let share = |order| lower_share(taus, &means, &covariance, order, against);
            let y0: Vec<Row> = subject.problem.y0.iter().map(|&y| [y; WIDTH]).collect();
            let size = evaluate(observable, &y0, PathMask::first(1))[0];
            let decision = match decision::weak(rate.as_ref(), share, limit) {
                Decision::WrongLimit => Decision::WrongLimit,
                _ if decision::kept(&fitted, sizes.reference_steps(), size) => Decision::Kept,
                decision => decision,
            };
            (rate, None, decision)
        }
    };
    if let Some(defect) = sizes.damping(setup) {
        let because = format!("the steps resolve the damping to {defect:.1e} only");
        decision = decision::undecided(decision::More::Steps, because);
    }
    let mut orders = Vec::new();
    if let Some(rate) = &mut rate {
        let fitted = rate.estimate;
        let likely = decision.settle(rate);
        // The orders that the error left at the finest step may have; below ½ it would be as large
        // as one likes.
        orders = [likely, fitted, rate.lo, rate.hi].map(|p| p.max(0.5)).into();
    }
    let taus = &taus[..levels];
    let points = match (what, &orders[..]) {
        (Measure::Weak(_), _) if exact.is_some() => weak_points(taus, &moments, None),
        (_, []) => Vec::new(),
        (Measure::Strong, orders) => strong_points(taus, &moments, orders),
        (Measure::Weak(_), orders) => {
            let of = |k: usize| weak_points(taus, &moments, Some(1.0 / (orders[k].exp2() - 1.0)));
            widest([0, 2, 3].into_iter().map(of))
        }
    };
    Ok(Order { points, rate, one_step, limit, decision, failed: failed.paths })
}

/// φ of the paths that are live.
fn evaluate(observable: &dyn Observe, y: &[Row], live: PathMask) -> Row {
    let mut values = [0.0; WIDTH];
    observable.evaluate(y, live, &mut values);
    values
}

/// a − b on every path.
fn difference(a: &Row, b: &Row) -> Row {
    std::array::from_fn(|p| a[p] - b[p])
}

/// Points with normal intervals.
fn weak_points(taus: &[f64], moments: &CrossMoments, tail: Option<f64>) -> Vec<Point> {
    let errors = errors(taus.len(), moments, tail);
    let point = |(l, &tau): (usize, &f64)| {
        let (value, se) = (errors.mean(l), errors.covariance_of_means(l, l).sqrt());
        let reach = 1.96 * se;
        let (lo, hi) = (Some(value - reach), Some(value + reach));
        Point::Error { tau, value, se, lo, hi, warning: None }
    };
    taus.iter().enumerate().map(point).collect()
}

/// Errors at the first step sizes: sums of the differences from each on, with the last difference
/// times `tail` more, or with the error of the finest step where it was measured.
fn errors(sizes: usize, moments: &CrossMoments, tail: Option<f64>) -> CrossMoments {
    let length = moments.length();
    let row = |l: usize| {
        let mut row = vec![0.0; length];
        row[l..length - 1].fill(1.0);
        match tail {
            Some(tail) => row[length - 2] += tail,
            None => row[length - 1] = 1.0,
        }
        row
    };
    moments.combined(&(0..sizes).map(row).collect::<Vec<_>>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_sums_of_the_differences_that_follow() {
        // Differences 8, 4 and 2 between four sizes, and 1 of the finest against the solution.
        let mut moments = CrossMoments::new(4);
        for path in 0..64 {
            let size = if path % 2 == 0 { 1.5 } else { 0.5 };
            moments.add(&[8.0, 4.0, 2.0, 1.0].map(|x| size * x));
        }
        // The sum of what would follow is the last difference again for order one.
        assert_eq!(errors(3, &moments, Some(1.0)).means(), [16.0, 8.0, 4.0]);
        assert_eq!(errors(3, &moments, Some(0.5)).means(), [15.0, 7.0, 3.0]);
        assert_eq!(errors(4, &moments, None).means(), [15.0, 7.0, 3.0, 1.0]);
        let points = weak_points(&[0.5, 0.25], &moments, Some(1.0));
        for (point, (tau, exact)) in points.iter().zip([(0.5, 16.0), (0.25, 8.0)]) {
            let Point::Error { tau: at, value, se, lo, hi, .. } = *point else {
                panic!("{point:?}")
            };
            // The paths differ by half of the value to either side: √(1/63) of that.
            assert!(at == tau && value == exact, "{point:?}");
            assert!((se / (0.5 * exact / 63f64.sqrt()) - 1.0).abs() < 1e-12, "{point:?}");
            assert_eq!((lo, hi), (Some(value - 1.96 * se), Some(value + 1.96 * se)));
        }
    }
}
