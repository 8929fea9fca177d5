//! Strong orders.

use mc::{LadderError, Setup, View};
use real::Row;
use stats::fit_strong;

use super::{
    Decision, Limit, Measure, Order, ReferenceSolution, StepSizes, decision,
    errors::{differences, record, record_length, squared_distance, strong_points},
    limit::limit,
    one_step::one_step,
    runs::{at_all_sizes, failing, measure},
    steps::Subject,
    visits::visits,
    within::within,
};

/// Three differences and their order.
const LEAST_SIZES: usize = 4;

/// The strong order of a scheme, with root-mean-square errors at the final time. The limit is
/// compared with `reference`; against an exact solution the points are errors against it.
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
/// use analysis::{ReferenceSolution, StepSizes, strong_order};
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
/// let order = strong_order(&setup, &sizes, &ReferenceSolution::at_run_time(&problem)?)?;
/// assert_eq!(order.order(), Some(1.0), "{order}");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`LadderError`] if there are fewer than four step sizes (`levels` + `refinement`) or no step, if
/// there are too many of either, or if the truncation is not defined at one of the step sizes.
pub fn strong_order(
    setup: &Setup<'_>,
    sizes: &StepSizes,
    reference: &ReferenceSolution<'_>,
) -> Result<Order, LadderError> {
    within(sizes, &|sizes| once(setup, sizes, reference))
}

/// The order from one measurement.
fn once(
    setup: &Setup<'_>,
    sizes: &StepSizes,
    reference: &ReferenceSolution<'_>,
) -> Result<Order, LadderError> {
    sizes.check_order(LEAST_SIZES)?;
    let (levels, number) = (sizes.levels, sizes.sizes());
    let (subject, exact) = (Subject::from(setup), reference.exact());
    if let Some(failing) = failing(subject, sizes)? {
        return Ok(failing);
    }
    let values = |view: &View<'_>, numbers: &mut [Row]| {
        let states: Vec<&[Row]> = (0..view.runs()).map(|run| view.state(run)).collect();
        record(&states, view.live, levels, numbers);
        if let Some(exact) = exact {
            let solution = exact.rows(view, subject.problem.y0.len());
            for (number, state) in numbers.iter_mut().zip(&states[..levels]) {
                *number = squared_distance(state, &solution, view.live);
            }
        }
    };
    let (runs, time_change) =
        (at_all_sizes(subject.scheme, sizes), exact.map(|exact| exact.time_change));
    let length = record_length(number, levels);
    let (moments, failed) = measure(subject.problem, sizes, runs, time_change, length, &values)?;

    let taus = sizes.taus(subject.problem.t_end);
    let mut rate = fit_strong(&taus[..number - 1], &differences(&moments, number, levels));
    let obstacle = decision::obstacle(failed, sizes.samples, sizes.damping(setup));
    // Where paths fail, steps that fail take longest, and decide nothing.
    let (one_step, limit) = match obstacle {
        Some(Decision::Failures { .. }) => (None, Limit::Unchecked),
        _ => {
            let visits = visits(subject, sizes)?;
            let limit = limit(subject, sizes, &visits, reference, Measure::Strong)?;
            (one_step(subject, sizes, &visits), limit)
        }
    };
    let decision = obstacle.unwrap_or_else(|| decision::strong(rate.as_ref(), one_step, limit));
    let points = match &mut rate {
        _ if exact.is_some() => stats::root_mean_squares(&taus[..levels], &moments),
        Some(rate) => {
            let fitted = rate.estimate;
            let orders = [decision.settle(rate), fitted, rate.lo, rate.hi];
            // Orders below ½ would make the tail as large as one likes.
            strong_points(&taus[..levels], &moments, &orders.map(|p| p.max(0.5)))
        }
        None => Vec::new(),
    };
    if let Some(rate) = rate.as_mut().filter(|_| exact.is_some()) {
        decision.settle(rate);
    }
    Ok(Order { points, rate, one_step, limit, decision, failed: failed.paths })
}
