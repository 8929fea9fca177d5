//! Weak orders.

use mc::{LadderError, Observe, Setup, View};
use real::{PathMask, Row, WIDTH};
use stats::{Against, CrossMoments, Point, fit_weak, lower_share};

use super::{
    Decision, Limit, Measure, Order, ReferenceSolution, StepSizes, decision,
    errors::widen,
    limit::limit,
    one_step::mean_order,
    runs::{at_all_sizes, failing, measure},
    steps::Subject,
    visits::visits,
    within::within,
};

/// Four differences and their order.
const LEAST_SIZES: usize = 5;
/// Relative error of a difference for which the model, some powers of an expansion, is not
/// answerable.
const MODEL_ERROR: f64 = 0.01;

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
    reference: &ReferenceSolution<'_>,
) -> Result<Order, LadderError> {
    within(sizes, &|sizes| once(setup, observable, sizes, reference))
}

/// The order from one measurement.
fn once(
    setup: &Setup<'_>,
    observable: &dyn Observe,
    sizes: &StepSizes,
    reference: &ReferenceSolution<'_>,
) -> Result<Order, LadderError> {
    sizes.check_order(LEAST_SIZES)?;
    let (levels, number) = (sizes.levels, sizes.sizes());
    let (subject, exact) = (Subject::from(setup), reference.exact());
    if let Some(failing) = failing(subject, sizes)? {
        return Ok(failing);
    }
    // φ(y_k) − φ(y_{k+1}) for all but the finest, then the finest against the exact solution.
    let values = |view: &View<'_>, numbers: &mut [Row]| {
        let phi = |y: &[Row]| evaluate(observable, y, view.live);
        let mut next = phi(view.state(0));
        for run in 1..view.runs() {
            let this = std::mem::replace(&mut next, phi(view.state(run)));
            numbers[run - 1] = difference(&this, &next);
        }
        if let Some(exact) = exact {
            numbers[number - 1] =
                difference(&next, &phi(&exact.rows(view, subject.problem.y0.len())));
        }
    };
    let (runs, time_change) =
        (at_all_sizes(subject.scheme, sizes), exact.map(|exact| exact.time_change));
    let (moments, failed) = measure(subject.problem, sizes, runs, time_change, number, &values)?;

    let taus = sizes.taus(subject.problem.t_end);
    // Errors against the exact solution at all step sizes, or differences at all but the finest.
    let (fitted, against) = match exact {
        Some(_) => (errors(number, &moments, None), Against::Exact),
        None => {
            let row = |k: usize| (0..number).map(|l| f64::from(u8::from(l == k))).collect();
            (moments.combined(&(0..number - 1).map(row).collect::<Vec<_>>()), Against::HalfStep)
        }
    };
    let (means, mut covariance) = (fitted.means(), fitted.covariances_of_means());
    for (l, mean) in means.iter().enumerate() {
        covariance[l][l] += (MODEL_ERROR * mean).powi(2);
    }
    let mut rate = fit_weak(&taus[..means.len()], &means, &covariance, against);
    let obstacle = decision::obstacle(failed, sizes.samples, sizes.damping(setup));
    let (visits, limit) = match obstacle {
        Some(Decision::Failures { .. }) => (Vec::new(), Limit::Unchecked),
        _ => {
            let visits = visits(subject, sizes)?;
            let limit = limit(subject, sizes, &visits, reference, Measure::Weak(observable))?;
            (visits, limit)
        }
    };
    let share = |order| lower_share(&taus[..means.len()], &means, &covariance, order, against);
    let one_step = || mean_order(subject, sizes, &visits);
    let y0: Vec<Row> = subject.problem.y0.iter().map(|&y| [y; WIDTH]).collect();
    let size = evaluate(observable, &y0, PathMask::first(1))[0];
    let decide = || match decision::weak(rate.as_ref(), share, one_step, limit) {
        Decision::WrongLimit => Decision::WrongLimit,
        _ if decision::kept(&fitted, sizes.reference_steps(), size) => Decision::Kept,
        decision => decision,
    };
    let decision = obstacle.unwrap_or_else(decide);
    let likely = rate.as_mut().map_or(1.0, |rate| decision.settle(rate)).max(0.5);
    let tail = |p: f64| if exact.is_some() { None } else { Some(1.0 / (p.exp2() - 1.0)) };
    let mut points = match rate.is_some() || exact.is_some() {
        true => weak_points(&taus[..levels], &moments, tail(likely)),
        false => Vec::new(),
    };
    if let (None, Some(rate)) = (exact, &rate) {
        for end in [rate.lo, rate.hi] {
            let other = weak_points(&taus[..levels], &moments, tail(end.max(0.5)));
            points.iter_mut().zip(other).for_each(|(point, other)| widen(point, &other));
        }
    }
    Ok(Order { points, rate, one_step: None, limit, decision, failed: failed.paths })
}

/// φ of the paths that are live.
pub fn evaluate(observable: &dyn Observe, y: &[Row], live: PathMask) -> Row {
    let mut values = [0.0; WIDTH];
    observable.evaluate(y, live, &mut values);
    values
}

/// a − b on every path.
pub fn difference(a: &Row, b: &Row) -> Row {
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
