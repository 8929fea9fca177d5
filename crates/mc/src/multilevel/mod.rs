//! E[φ(y(T))] to a requested accuracy, by multilevel and by plain Monte Carlo.
//!
//! E[φ(y_L)] = E[φ(y_0)] + Σ_{l=1}^{L} E[φ(y_l) − φ(y_{l−1})], where y_l takes 2^l times the steps
//! of y_0. Each term is a mean over paths of its own; those of a difference share their noise, so
//! that few are needed where steps are many (Giles, *Oper. Res.* 56, 2008). With the [`Coupling`]
//! that suits the scheme the variance of a difference falls like τ² and the cost of an accuracy ε
//! is of order ε⁻², where that of single paths is ε⁻³ for weak order one.
//!
//! **Accuracy.** The half-width of the 95 % interval of each test function: 1.96 standard errors
//! plus a bound on the bias. Of ε the bias gets a quarter at most (half on the finest level
//! allowed), the standard error the rest. The bound is [`Estimate::bias_bound`]; it is as good as
//! the weak order that it assumes, and the observed order is reported with it. Each interval stands
//! for itself, not all of them together.
//!
//! **Algorithm.** A pilot on levels 0, 1 and 2; then rounds of samples until every level has the
//! number that is optimal for the variances observed so far; then, while the bound on the bias is
//! too large, one more level. Decisions are made from samples and counted path-steps alone, so the
//! result is the same bits for any number of threads.
//!
//! **Samples are kept.** Each round of each level has a family of streams of its own
//! ([`Settings::key`]), and all of its samples count, those of the pilot too. That a level stops
//! when its sample variance is small enough shifts its mean by −μ₃/(σ²N) to first order, at most
//! √(κ/N) of its own standard error, where κ is the kurtosis: below a tenth with κ = 10 and a
//! thousand samples, and less for the sum.
//!
//! **What is checked.** Failed paths, kurtosis, the decay of variances and means, and whether the
//! coarse mean of a level agrees with the fine mean below it; see [`Warning`]. The last check sees
//! what is above some standard errors of φ itself on that level, which is far more than the
//! accuracy.
//!
//! **Lévy areas.** The sum over the levels is E[φ(y_L)] only if the coarse path of a level has the
//! law of the fine path below. Areas are drawn on fine steps and joined on coarse ones, so the two
//! agree if the law of a drawn area is right: its covariance given the increments is, for any
//! number of terms (see [`Ladder::new`](crate::Ladder::new)); what is left are cumulants from the
//! fourth on, which no interval here has been able to see. With areas cut off after the terms, and
//! less variance, E[cos y₃] of the rigid body with three noises was off by −2.5·10⁻⁴ from a
//! coarsest step of ¼.
//!
//! ```
//! use mc::Observable;
//! use mc::multilevel::{Coupling, Settings, expectation};
//! use noise::{StreamKey, Truncation};
//! use schemes::Sexp;
//! use systems::{Constant, Problem, RigidBody};
//!
//! // A symmetric top, shaken about its axis: y₂ + iy₃ turns by a normal angle of variance y₁²T, and its mean decays.
//! let body = RigidBody::one_noise([1.0, 1.0, 1.0], 1.0)?;
//! let problem = Problem::new(body, Constant::new(0.0)?, [1.0, 0.5, 0.0], 1.0)?;
//! let settings = Settings::new(StreamKey { seed: 1, experiment: 1 }, Truncation::new(4)?, 4, Coupling::Plain);
//! let y2 = [Observable { name: "y2", function: |y| y[1] }];
//! let expectation = expectation(&Sexp::default(), &problem, &y2, 0.01, &settings, &|_| ())?;
//!
//! let (lower, upper) = expectation.estimates[0].interval();
//! assert!(expectation.reached() && expectation.warnings.is_empty() && upper - lower <= 0.02);
//! let exact = 0.5 * (-0.5f64).exp();
//! assert!(lower < exact && exact < upper);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod central;
mod diagnosis;
mod error;
mod level;
mod plan;
mod report;
mod settings;

use schemes::Scheme;
use systems::{Damping, PoissonSystem, Problem};

use crate::Observable;
use level::{Row, Sampler};
use plan::{BIAS_SHARE, QUANTILE};

pub use error::MultilevelError;
pub use report::{Estimate, Expectation, Level, LevelValue, Rate, Warning};
pub use settings::{Coupling, Settings};

/// The highest level of the pilot: two differences, to see how they decay.
const PILOT_LEVEL: usize = 2;
/// A level that is added later begins with at least this part of a pilot.
const LATER_PILOT: u64 = 4;

/// E[φ(y(T))] of every φ to the half-width `accuracy` by multilevel Monte Carlo.
///
/// `progress` is told now and then how many more path-steps are done, from any thread.
///
/// # Errors
/// [`MultilevelError`] when a setting is out of range, when a level cannot be run or has no paths
/// left, or when φ is not finite. A limit that is met is no error: the result says so in its
/// [`warnings`](Expectation::warnings), and its intervals are those that were reached.
pub fn expectation<S: PoissonSystem<D, M>, G: Damping, const D: usize, const M: usize>(
    scheme: &dyn Scheme<S, D, M>,
    problem: &Problem<S, G, D>,
    observables: &[Observable<D>],
    accuracy: f64,
    settings: &Settings,
    progress: &(dyn Fn(u64) + Sync),
) -> Result<Expectation, MultilevelError> {
    settings.check(accuracy, observables.len())?;
    let mut sampler =
        Sampler { scheme, problem, observables, settings, progress, cost: 0, reserve: 0 };
    let mut rows = vec![sampler.row(0, None)?];
    for level in 1..=PILOT_LEVEL {
        rows.push(sampler.row(level, Some(settings.coupling))?);
    }
    pilot(&mut sampler, &mut rows)?;
    let limit = loop {
        let biases: Vec<_> = (0..observables.len())
            .map(|k| plan::bias(&rows[1..], k, settings.weak_order))
            .collect();
        let last = rows.len() - 1;
        // On the finest level allowed, a bias that more samples may show to be small gets half.
        let resolvable = biases.iter().all(|bias| bias.size <= BIAS_SHARE * accuracy);
        let share = if last == settings.max_level && resolvable { 0.5 } else { BIAS_SHARE };
        let half_widths: Vec<f64> =
            biases.iter().map(|bias| accuracy - bias.bound.min(share * accuracy)).collect();
        let wide = |k: usize| QUANTILE * plan::variance_of_sum(&rows, k).sqrt() > half_widths[k];
        if (0..observables.len()).any(wide) {
            let wanted = plan::samples(&plan::costs_and_variances(&rows), &half_widths);
            if !sampler.sample_up_to(&mut rows, &wanted)? {
                break Some(Warning::CostLimit { max_cost: settings.max_cost });
            }
        } else if biases.iter().all(|bias| bias.bound <= share * accuracy) {
            break None;
        } else if last == settings.max_level {
            let wanted = bias_samples(&sampler, &rows[1..], 0.5 * share * accuracy);
            let wanted = [&[0], wanted.as_slice()].concat();
            if !resolvable || enough(&rows, &wanted) {
                break Some(Warning::LevelLimit { level: last });
            }
            if !sampler.sample_up_to(&mut rows, &wanted)? {
                break Some(Warning::CostLimit { max_cost: settings.max_cost });
            }
        } else {
            let mut levels = plan::costs_and_variances(&rows);
            levels.push(plan::next_level(&rows));
            let first =
                plan::samples(&levels, &half_widths)[last + 1].max(settings.pilot / LATER_PILOT);
            if !add_level(&mut sampler, &mut rows, first)? {
                break Some(Warning::CostLimit { max_cost: settings.max_cost });
            }
        }
    };
    let mut expectation = report(&sampler, accuracy, &rows, &rows, &rows[1..]);
    if let Some(steps) = diagnosis::better_coarsest_steps(&rows, settings) {
        expectation.warnings.push(Warning::CoarsestSteps { steps });
    }
    expectation.warnings.extend(limit);
    Ok(expectation)
}

/// E[φ(y(T))] of every φ to the half-width `accuracy` by single paths on one level.
///
/// The level is the first on which the bias is bounded by a quarter of the accuracy. The bias is
/// judged as [`expectation`] does it, from coupled differences, which are sampled until they show
/// it and count in the cost.
///
/// # Errors
/// As [`expectation`].
pub fn expectation_plain<S: PoissonSystem<D, M>, G: Damping, const D: usize, const M: usize>(
    scheme: &dyn Scheme<S, D, M>,
    problem: &Problem<S, G, D>,
    observables: &[Observable<D>],
    accuracy: f64,
    settings: &Settings,
    progress: &(dyn Fn(u64) + Sync),
) -> Result<Expectation, MultilevelError> {
    settings.check(accuracy, observables.len())?;
    let mut sampler =
        Sampler { scheme, problem, observables, settings, progress, cost: 0, reserve: 0 };
    // What the first single paths cost is kept, or there would be no estimate when the limit is
    // met.
    sampler.reserve = settings.pilot.saturating_mul(settings.steps(PILOT_LEVEL));
    let mut differences = Vec::new();
    for level in 1..=PILOT_LEVEL {
        differences.push(sampler.row(level, Some(settings.coupling))?);
    }
    pilot(&mut sampler, &mut differences)?;
    let mut limit = resolve_bias(&mut sampler, &mut differences, accuracy)?;
    sampler.reserve = 0;
    let bounds = |k: usize| plan::bias(&differences, k, settings.weak_order).bound;
    // What a bound beyond its share leaves is not worth more samples: the accuracy is not reached
    // in any case.
    let half_widths: Vec<f64> =
        (0..observables.len()).map(|k| accuracy - bounds(k).min(BIAS_SHARE * accuracy)).collect();
    let mut single = vec![sampler.row(differences.len(), None)?];
    let mut complete = sampler.sample_up_to(&mut single, &[settings.pilot])?;
    let wide =
        |rows: &[Row], k: usize| QUANTILE * plan::variance_of_sum(rows, k).sqrt() > half_widths[k];
    while complete && (0..observables.len()).any(|k| wide(&single, k)) {
        let wanted = plan::samples(&plan::costs_and_variances(&single), &half_widths);
        complete = sampler.sample_up_to(&mut single, &wanted)?;
    }
    if !complete {
        limit = Some(Warning::CostLimit { max_cost: settings.max_cost });
    }
    let rows = [single.as_slice(), differences.as_slice()].concat();
    let mut expectation = report(&sampler, accuracy, &rows, &single, &differences);
    expectation.warnings.extend(limit);
    Ok(expectation)
}

/// Samples every row with the pilot.
fn pilot<S: PoissonSystem<D, M>, G: Damping, const D: usize, const M: usize>(
    sampler: &mut Sampler<'_, S, G, D, M>,
    rows: &mut [Row],
) -> Result<(), MultilevelError> {
    let Settings { pilot, max_cost, .. } = *sampler.settings;
    let cost = rows.iter().map(|row| row.cost_per_path).sum::<u64>().saturating_mul(pilot);
    let pilot_cost = cost.saturating_add(sampler.reserve);
    if pilot_cost > max_cost {
        return Err(MultilevelError::PilotCost { pilot_cost, max_cost });
    }
    rows.iter_mut().try_for_each(|row| sampler.sample(row, pilot))
}

/// Adds a level with about `paths` samples, or as many as can be paid for; false if that is less
/// than they should be.
fn add_level<S: PoissonSystem<D, M>, G: Damping, const D: usize, const M: usize>(
    sampler: &mut Sampler<'_, S, G, D, M>,
    rows: &mut Vec<Row>,
    paths: u64,
) -> Result<bool, MultilevelError> {
    let level = rows.last().map_or(0, |row| row.level) + 1;
    let row = sampler.row(level, Some(sampler.settings.coupling))?;
    // Fewer than a pilot say nothing about the variance.
    if (sampler.settings.pilot / LATER_PILOT).saturating_mul(row.cost_per_path) > sampler.budget() {
        return Ok(false);
    }
    let mut row = [row];
    let complete = sampler.sample_up_to(&mut row, &[paths])?;
    rows.extend(row);
    Ok(complete)
}

/// Samples differences, and adds them, until the bias on the last is bounded by its share of the
/// accuracy; the limit that was met, if one was.
fn resolve_bias<S: PoissonSystem<D, M>, G: Damping, const D: usize, const M: usize>(
    sampler: &mut Sampler<'_, S, G, D, M>,
    differences: &mut Vec<Row>,
    accuracy: f64,
) -> Result<Option<Warning>, MultilevelError> {
    let settings = *sampler.settings;
    let budget = BIAS_SHARE * accuracy;
    let cost_limit = Some(Warning::CostLimit { max_cost: settings.max_cost });
    loop {
        let observables = 0..sampler.observables.len();
        let biases: Vec<_> =
            observables.map(|k| plan::bias(differences, k, settings.weak_order)).collect();
        if biases.iter().all(|bias| bias.bound <= budget) {
            return Ok(None);
        }
        // A finer level where the bias is there; more samples where it may only seem to be.
        let wanted = bias_samples(sampler, differences, 0.5 * budget);
        if biases.iter().all(|bias| bias.size <= budget) && !enough(differences, &wanted) {
            if !sampler.sample_up_to(differences, &wanted)? {
                return Ok(cost_limit);
            }
            continue;
        }
        let last = differences.len();
        if last == settings.max_level {
            return Ok(Some(Warning::LevelLimit { level: last }));
        }
        let reserve =
            std::mem::replace(&mut sampler.reserve, settings.pilot * settings.steps(last + 1));
        if !add_level(sampler, differences, settings.pilot)? {
            if differences.len() == last {
                sampler.reserve = reserve;
            }
            return Ok(cost_limit);
        }
    }
}

/// Samples of each difference with which the margin in every bias is at most `margin`.
fn bias_samples<S, G, const D: usize, const M: usize>(
    sampler: &Sampler<'_, S, G, D, M>,
    differences: &[Row],
    margin: f64,
) -> Vec<u64> {
    let mut wanted = vec![0; differences.len()];
    for k in 0..sampler.observables.len() {
        let samples = plan::samples_for_bias(differences, k, sampler.settings.weak_order, margin);
        wanted.iter_mut().zip(samples).for_each(|(wanted, samples)| *wanted = samples.max(*wanted));
    }
    wanted
}

/// Whether every level has the samples wanted.
fn enough(rows: &[Row], wanted: &[u64]) -> bool {
    rows.iter().zip(wanted).all(|(row, &wanted)| row.samples() >= wanted)
}

/// The result, with the warnings that are not about limits.
fn report<S: PoissonSystem<D, M>, G: Damping, const D: usize, const M: usize>(
    sampler: &Sampler<'_, S, G, D, M>,
    accuracy: f64,
    rows: &[Row],
    terms: &[Row],
    differences: &[Row],
) -> Expectation {
    let settings = sampler.settings;
    let estimate = |(k, observable): (usize, &Observable<D>)| {
        plan::estimate(observable.name, terms, differences, k, settings.weak_order)
    };
    let estimates: Vec<Estimate> = sampler.observables.iter().enumerate().map(estimate).collect();
    let level = |row: &Row| Level {
        level: row.level,
        tau: settings.tau(sampler.problem, row.level),
        coupling: row.coupling,
        samples: row.samples(),
        failed: row.failed,
        cost_per_path: row.cost_per_path,
        values: diagnosis::level_values(rows, row),
    };
    let levels = rows.iter().map(level).collect();
    let warnings = diagnosis::warnings(rows, &estimates, settings);
    Expectation { estimates, accuracy, cost: sampler.cost, levels, warnings }
}
