//! Runs of a scheme at several step sizes, moments of what is made of their final states, and
//! states that paths visit.

use std::sync::Arc;

use mc::{Ladder, LadderError, Problem, Run, Statistic, TimeChange, View, parts::Stop};
use schemes::Method;
use stats::CrossMoments;

use super::{
    Limit, Order, StepSizes,
    decision::{More, undecided},
    steps::Subject,
};
use crate::{FinalMoments, FinalRows, number};

/// The scheme at every step size, coarsest first.
pub fn at_all_sizes<'a>(scheme: &Arc<dyn Method + 'a>, sizes: &StepSizes) -> Vec<Run<'a>> {
    let run = |index| Run::new(Arc::clone(scheme), sizes.sizes() - 1 - index);
    (0..sizes.sizes()).map(run).collect()
}

/// Paths that were left out.
#[derive(Clone, Copy)]
pub struct Failed {
    /// Their number.
    pub paths: u64,
    /// When the first of them failed.
    pub t: f64,
}

/// Moments of a vector of this length at the final time, and the paths that were left out.
pub fn measure<'a>(
    problem: &Problem<'a>,
    sizes: &StepSizes,
    runs: Vec<Run<'a>>,
    time_change: Option<&'a dyn TimeChange>,
    length: usize,
    values: &FinalRows<'_>,
) -> Result<(CrossMoments, Failed), LadderError> {
    sizes.check()?;
    let (steps, top) = (sizes.reference_steps(), sizes.level(0));
    let mut ladder = Ladder::new(problem, steps, top, sizes.truncation, sizes.key, runs)?;
    if let Some(time_change) = time_change {
        ladder = ladder.with_time_change(time_change);
    }
    let none = || FinalMoments::new(ladder.coarse_steps(), length, values);
    let measured = ladder.run(sizes.samples, none, &|_| ());
    let t = measured.failures.first().map_or(problem.t_end, |first| first.step as f64 * first.tau);
    Ok((measured.statistic.moments, Failed { paths: measured.failed, t }))
}

impl Failed {
    /// What is said where too many of these paths failed: the rest says little about the scheme.
    pub fn order(self, samples: u64) -> Order {
        let (Self { paths: failed, t }, limit) = (self, Limit::Unchecked);
        let t = number(t);
        let because = format!(
            "{failed} of {samples} paths failed, the first at t = {t}, where the solution may end"
        );
        let decision = undecided(More::Steps, because);
        Order { points: Vec::new(), rate: None, one_step: None, limit, decision, failed }
    }
}

/// Paths that show whether most fail: one block.
const FEW: u64 = 32;

/// What is said where half of a few paths fail. More of them decide nothing, and steps that fail
/// take longest.
pub fn failing(subject: Subject<'_>, sizes: &StepSizes) -> Result<Option<Order>, LadderError> {
    let few = StepSizes { samples: sizes.samples.min(FEW), ..*sizes };
    let runs = at_all_sizes(subject.scheme, sizes);
    let (_, failed) = measure(subject.problem, &few, runs, None, 0, &|_, _| ())?;
    let most = failed.paths > 0 && 2 * failed.paths >= few.samples;
    Ok(most.then(|| failed.order(few.samples)))
}

/// A state of a path.
#[derive(Clone, Debug)]
pub struct Visit {
    pub t: f64,
    pub state: Vec<f64>,
}

/// States of so many paths of the scheme, each at a time of its own, or y₀ if none survives.
pub fn visits(
    subject: Subject<'_>,
    sizes: &StepSizes,
    paths: u64,
    stop: &Stop,
) -> Result<Vec<Visit>, LadderError> {
    let Subject { problem, scheme } = subject;
    let steps = sizes.coarsest_steps << (sizes.levels - 1);
    let runs = vec![Run::new(Arc::clone(scheme), 0)];
    let ladder = Ladder::new(problem, steps, 0, sizes.truncation, sizes.key, runs)?;
    let tau = problem.t_end / steps as f64;
    let none = || Visits { steps, tau, visits: Vec::new() };
    let mut visits = ladder.run_until(stop, 0, paths, none, &|_| ()).statistic.visits;
    if visits.is_empty() {
        visits.push(Visit { t: 0.0, state: problem.y0.clone() });
    }
    Ok(visits)
}

/// Collects states.
struct Visits {
    steps: u64,
    tau: f64,
    visits: Vec<Visit>,
}

impl Statistic for Visits {
    fn observe(&mut self, view: &View<'_>) {
        // Multiples of the golden ratio, modulo one, are spread evenly.
        let fraction = |path: u64| (path as f64 * 0.618_033_988_749_894_8).fract();
        for p in view.live.paths() {
            let time = 1 + (fraction(view.first_path + p as u64) * self.steps as f64) as u64;
            if time.min(self.steps) == view.time {
                let t = view.time as f64 * self.tau;
                let state = view.state(0).iter().map(|row| row[p]).collect();
                self.visits.push(Visit { t, state });
            }
        }
    }

    fn merge(&mut self, later: Self) {
        self.visits.extend(later.visits);
    }
}
