//! E[φ(y(T))] to a requested accuracy, by multilevel and by plain Monte Carlo.
//!
//! E[φ(y_L)] = E[φ(y_0)] + Σ_{l=1}^{L} E[φ(y_l) − φ(y_{l−1})], where y_l takes 2^l times the steps
//! of y_0. Each term is a mean over paths of its own. The two paths of a difference share their
//! noise, so that few are needed where steps are many (Giles, *Oper. Res.* 56, 2008). With the
//! [`Coupling`] that suits the scheme the variance of a difference falls like τ², and the cost of
//! an accuracy ε is of order ε⁻²; that of single paths is ε⁻³ for weak order one.
//!
//! **Accuracy.** The half-width of the 95 % interval of each test function: 1.96 standard errors
//! and, in quadrature, what events that the samples missed may add ([`Estimate::missed`]), plus a
//! bound on the bias ([`Estimate::bias_bound`]). The bias gets at most a quarter of ε (half on the
//! finest level allowed), the rest what is left. The 95 % hold for each interval alone, not for all
//! of them together.
//!
//! **What is judged.** Three things, for each test function ([`Judged`]);
//! [`reached`](Expectation::reached) is true only if all are good, and a [`Warning`] names each
//! that is not.
//! - *Variance.* N/κ samples carry the variance, with the kurtosis κ. Below thirty, or where no
//!   sample differs, the interval is widened by 3.69·R/N: without an event in N samples up to −ln
//!   0.025 of them are expected, each no larger than R, the largest that was seen. More samples are
//!   drawn until that fits into the accuracy, and until thirty single paths carry the variance of a
//!   φ of more than two values, whose tail may reach further, and until the largest of them fall
//!   faster than a power that has no variance (Hill's estimate). If φ is the same to the bit on
//!   every path of a level that decides, nothing is known of R.
//! - *Bias.* Three differences or more bound it, by one term of the expansion in τ and by two; the
//!   observed order must not lie below ½; coarse and fine means of a level must agree.
//! - *Resolution.* Each component of fine and coarse states must agree to half of its motion in
//!   root mean square over all coarse times, better than on the levels below, φ to 0.7 of its
//!   motion at eight of them, and φ must vary on both in the same way. The damping that the scheme
//!   reads, summed over the steps, must agree with ∫γ by quadrature, or converge to it
//!   ([`SeenDamping`]). Else a finer level is added.
//!
//! **What is assumed.** A scheme that converges to the solution, the weak order given, and
//! E[φ(y_τ)] = E[φ(y(T))] + Aτ^p + Bτ^{p+1} on the last three levels. Nothing that occurs on no
//! path of any level: an event larger than all that were seen, or a jump of φ that is hidden beside
//! a part that varies smoothly. Components all count, those that φ does not read too: they may
//! drive the others.
//!
//! **Algorithm.** A pilot on levels 0, 1 and 2; finer levels until there are three differences and
//! the last resolves the motion; then rounds of samples until every level has the number that is
//! optimal for the variances and tails observed so far; then, while φ is not resolved or the bound
//! on the bias is too large, one more level, or more samples where missed events make the bound.
//! Decisions depend on samples and counted path-steps only, so the result is the same bits for any
//! number of threads.
//!
//! **Stopping.** Each level has its own family of streams ([`ExpectationSettings::key`]), later
//! rounds draw its next paths, and all samples count, those of the pilot too. Since a level stops
//! when its sample variance is small enough, its mean is biased by −μ₃/(σ²N) to first order. That
//! is at most √(κ/N) of its standard error, where κ is the kurtosis: below a tenth with κ = 10 and
//! a thousand samples, and less for the sum.
//!
//! **Paths that fail** are in no mean, from their failure on; their number stands beside each
//! estimate and level, and the estimate is conditional on survival.
//!
//! **Further checks** only warn: the decay of means; see [`Warning`].
//! Whether the levels telescope is seen to some standard errors of φ itself on a level, which is
//! far more than the accuracy.
//!
//! **Without noise** there is one path, on as many levels as the accuracy takes, extrapolated with
//! the order that its differences show. The interval is a bound on what extrapolation leaves.
//!
//! **Lévy areas.** The sum over the levels is E[φ(y_L)] only if the coarse path of a level has the
//! law of the fine path below. Areas are drawn on fine steps and joined on coarse ones, so the two
//! agree if the law of a drawn area is right. Its covariance given the increments is exact for any
//! number of terms (see [`Ladder::new`](crate::Ladder::new)); cumulants from the fourth on are not,
//! which no interval has been able to detect. Without the variance of the omitted terms, E[cos y₃]
//! of the rigid body with three noises was off by −2.5·10⁻⁴ for a coarsest step of ¼.
//!
//! ```
//! use mc::{Observable, Setup};
//! use mc::multilevel::{Coupling, ExpectationSettings, expectation};
//! use noise::{StreamKey, Truncation};
//! use schemes::Sexp;
//! use systems::{Constant, Problem, RigidBody};
//!
//! // A symmetric top with noise about its axis: y₂ + iy₃ turns by a normal angle of variance y₁²T,
//! // and its mean decays.
//! let body = RigidBody::one_noise([1.0, 1.0, 1.0], 1.0)?;
//! let problem = Problem::new(body, Constant::new(0.0)?, [1.0, 0.5, 0.0], 1.0)?;
//! let key = StreamKey { seed: 1, experiment: 1 };
//! let settings = ExpectationSettings::new(key, Truncation::new(4)?, 4, Coupling::Plain);
//! let y2 = [Observable { name: "y2", function: |y: [f64; 3]| y[1] }];
//! let expectation = expectation(&Setup::of(&problem, &Sexp), &y2, 0.01, &settings, &|_| ())?;
//!
//! let (lower, upper) = expectation.estimates[0].interval();
//! assert!(expectation.reached() && expectation.warnings.is_empty() && upper - lower <= 0.02);
//! let exact = 0.5 * (-0.5f64).exp();
//! assert!(lower < exact && exact < upper);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod algorithm;
mod bias;
mod diagnosis;
mod error;
mod level;
mod plan;
mod quasi;
mod report;
mod resolution;
mod settings;
mod tails;
#[cfg(test)]
mod tests;
mod write;

use std::{
    cell::{Cell, RefCell},
    collections::BTreeMap,
    sync::Arc,
};

use crate::{
    Ladder, Observe, Run, SeenDamping, Setup,
    driver::GROUP_PATHS,
    ladder::Piece,
    observable::{erased, value},
    parts::Job,
};
use algorithm::{Halt, Sampler};
use level::{Drawn, PathValues, Samples, Sums, Values};
use resolution::Motion;

pub use error::MultilevelError;
pub use report::{Estimate, Expectation, Judged, Level, LevelValue, Rate, Warning};
pub use settings::{Coupling, Estimator, ExpectationSettings, SoFar};

pub(crate) use quasi::{Orders, QuasiSettings, quasi_expectation};

/// E[φ(y(T))] of every φ to the half-width `accuracy`, by the [`Estimator`] of the settings.
///
/// `progress` is called now and then, from any thread, with the number of path-steps done since.
///
/// # Errors
/// [`MultilevelError`] if a setting is out of range, a level cannot be run or has no paths left, or
/// φ is not finite. Reaching a limit is no error: the result says so in its
/// [`warnings`](Expectation::warnings), and its intervals are those that were reached.
pub fn expectation(
    setup: &Setup<'_>,
    observables: &[impl Observe],
    accuracy: f64,
    settings: &ExpectationSettings,
    progress: &(dyn Fn(u64) + Sync),
) -> Result<Expectation, MultilevelError> {
    let job = Job::here();
    let found = expectation_in(&job, "", setup, observables, accuracy, settings, progress)?;
    Ok(found.unwrap_or_else(|| unreachable!("a job that computes everything here has results")))
}

/// The same as [`expectation`], as a piece of work of a job with the name `name`, whole, in parts
/// or merged, with the same bits. `None` if the results are not here; [`Job::finish`] says why. A
/// job that is stopped and [gives what is done](Job::giving_what_is_done) has the estimates of the
/// rounds before, with [`Warning::Stopped`].
///
/// Samples are drawn in rounds, and every round follows from those before: run the parts, merge,
/// and if [`Job::finish`] reports [`NextRound`](crate::parts::JobError::NextRound), run the parts
/// and merge again. Small rounds are not worth that, see [`Job::splitting_rounds_above`]. With a
/// smaller accuracy in the same folder, samples that are there count.
///
/// # Errors
/// Those of [`expectation`].
pub fn expectation_in(
    job: &Job,
    name: &str,
    setup: &Setup<'_>,
    observables: &[impl Observe],
    accuracy: f64,
    settings: &ExpectationSettings,
    progress: &(dyn Fn(u64) + Sync),
) -> Result<Option<Expectation>, MultilevelError> {
    let observables = &erased(observables)[..];
    let Setup { problem, scheme } = setup;
    if problem.noises == 0 {
        let orders = Orders { weak: settings.weak_order, next: settings.weak_order + 1.0 };
        let quasi = QuasiSettings { mirror: None, orders, scrambles: 1, spent: &Cell::new(0) };
        return quasi_expectation(
            job,
            name,
            setup,
            &quasi,
            observables,
            accuracy,
            settings,
            progress,
        );
    }
    let y0 = &problem.y0[..];
    let starts: Vec<f64> = observables.iter().map(|phi| value(*phi, y0)).collect();
    // The nodes of each family of streams so far.
    let drawn = RefCell::new(BTreeMap::new());
    // Draws all samples of a level up to `paths` paths.
    let draw = |level: &Samples, paths: u64, round: u64| {
        let mut runs = vec![Run::new(Arc::clone(scheme), 0)];
        if level.coupling.is_some() {
            runs.push(Run::new(Arc::clone(scheme), 1));
        }
        if level.coupling == Some(Coupling::Antithetic) {
            runs.push(Run::swapped(Arc::clone(scheme), 0));
        }
        // Single paths have the families of level 0, whatever their step size.
        let (levels, family) = level.coupling.map_or((0, 0), |_| (1, level.level));
        let (key, steps) = (settings.stream(family), settings.steps(level.level));
        let ladder = Ladder::new(problem, steps, levels, settings.truncation, key, runs)?;
        let last_time = ladder.coarse_steps();
        let values = vec![Values::default(); observables.len()];
        let motion = Motion::new(y0);
        let new = || {
            let sums = Sums { values: values.clone(), motion: motion.clone() };
            let coupled = level.coupling.is_some();
            PathValues { observables, y0, starts: &starts, last_time, coupled, sums }
        };
        let piece = Piece {
            name: format!("{name}/level {family} from {}", level.paths),
            paths,
            groups: level.paths / GROUP_PATHS..paths / GROUP_PATHS,
        };
        let more = ladder.nodes_in(job, &[piece], Some(round), &new, progress);
        let more = more.filter(|_| !job.stop().is_asked());
        let Some(more) = more.and_then(|mut more| more.pop()) else { return Ok(None) };
        let mut drawn = drawn.borrow_mut();
        let nodes: &mut Vec<_> = drawn.entry(family).or_default();
        let outcome = ladder.join(nodes, more, &new);
        let first_failure = outcome.failures.first().copied();
        Ok(Some(Drawn { sums: outcome.statistic.sums, failed: outcome.failed, first_failure }))
    };
    let names = observables.iter().map(|observable| observable.name().to_owned()).collect();
    let t_end = problem.t_end;
    let ranges = vec![None; observables.len()];
    let damping = SeenDamping::new(setup, settings.coarsest_steps);
    let sampler = Sampler {
        draw: &draw,
        scheme: scheme.id(),
        t_end,
        damping,
        names,
        accuracy,
        settings,
        ranges,
        cost: 0,
        reserve: 0,
        stopped: &|| job.gives_what_is_done(),
    };
    match sampler.expectation() {
        Ok(expectation) => Ok(Some(expectation)),
        Err(Halt::Elsewhere) => Ok(None),
        Err(Halt::Error(error)) => Err(error),
    }
}
