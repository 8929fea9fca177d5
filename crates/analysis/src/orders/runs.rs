//! Runs of a scheme at several step sizes, moments of what is made of their final states, and
//! states that paths visit.

use std::sync::Arc;

use mc::{Ladder, LadderError, Measured, PathFailure, Run, Setup, Statistic, TimeChange, View};

use super::{
    Limit, Order, StepSizes,
    decision::{More, undecided},
};
use crate::{FinalMoments, FinalRows, number};

/// Moments of a vector of this length, made of the final states of the scheme at every step size,
/// coarsest first.
pub fn measure<'a>(
    Setup { problem, scheme }: &'a Setup<'a>,
    sizes: &StepSizes,
    time_change: Option<&dyn TimeChange>,
    length: usize,
    values: &'a FinalRows<'a>,
) -> Result<Measured<FinalMoments<'a>>, LadderError> {
    let (steps, top) = (sizes.reference_steps(), sizes.level(0));
    let runs = (0..=top).rev().map(|level| Run::new(Arc::clone(scheme), level)).collect();
    let mut ladder = Ladder::new(problem, steps, top, sizes.truncation, sizes.key, runs)?;
    if let Some(time_change) = time_change {
        ladder = ladder.with_time_change(time_change);
    }
    let none = || FinalMoments::new(ladder.coarse_steps(), length, values);
    Ok(ladder.run_until(&sizes.stop, 0, sizes.samples, none))
}

/// What is said where so many of all paths failed: the rest says little about the scheme.
pub fn failing(failures: &[PathFailure], [failed, paths]: [u64; 2]) -> Order {
    let t = failures.first().map_or(0.0, |first| first.step as f64 * first.tau);
    let because = format!(
        "{failed} of {paths} paths failed, the first at t = {}, where the solution may end",
        number(t)
    );
    let (decision, limit) = (undecided(More::Steps, because), Limit::Unchecked);
    Order { points: Vec::new(), rate: None, one_step: None, limit, decision, failed }
}

/// A state of a path.
#[derive(Clone, Debug)]
pub struct Visit {
    pub t: f64,
    pub state: Vec<f64>,
}

/// States of so many paths of the scheme, each at a time of its own, or y₀ if none survives.
pub fn visits(setup: &Setup<'_>, sizes: &StepSizes, paths: u64) -> Result<Vec<Visit>, LadderError> {
    let (Setup { problem, scheme }, steps) = (setup, sizes.coarsest_steps << (sizes.levels - 1));
    let runs = vec![Run::new(Arc::clone(scheme), 0)];
    let ladder = Ladder::new(problem, steps, 0, sizes.truncation, sizes.key, runs)?;
    let tau = problem.t_end / steps as f64;
    let none = || Visits { steps, tau, visits: Vec::new() };
    let mut visits = ladder.run_until(&sizes.stop, 0, paths, none).statistic.visits;
    if visits.is_empty() {
        visits.push(Visit { t: 0.0, state: setup.start().iter().map(|row| row[0]).collect() });
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
