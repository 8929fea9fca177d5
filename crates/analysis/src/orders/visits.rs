//! States that paths visit, and their times.

use std::sync::Arc;

use mc::{Ladder, LadderError, Run, Statistic, View, parts::Stop};

use super::{StepSizes, steps::Subject};

/// A state of a path.
#[derive(Clone, Debug)]
pub struct Visit {
    pub t: f64,
    pub state: Vec<f64>,
}

/// States of 256 paths.
pub fn visits(subject: Subject<'_>, sizes: &StepSizes) -> Result<Vec<Visit>, LadderError> {
    visits_of(subject, sizes, 256, &Stop::default())
}

/// States of so many paths of the scheme, each at a time of its own, or y₀ if none survives.
pub fn visits_of(
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
