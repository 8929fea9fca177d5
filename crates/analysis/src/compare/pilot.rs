//! What is known of a scheme before errors are measured.

use std::{
    ops::Range,
    sync::{Arc, mpsc},
    thread,
    time::Duration,
};

use mc::{Ladder, LadderError, Run, Setup, View, parts::Stop};
use schemes::Method;

use super::{Outcome, search::Search};
use crate::{FinalMoments, Limit, StepSizes, Stopwatch, orders::single_steps};

/// Paths of a pilot.
const PATHS: u64 = 64;
/// The finest pilot has 2^this times the base steps.
const FINEST: u32 = 8;

/// What a pilot shows of a scheme. Step sizes are numbered by the base 2 logarithm of their steps
/// over the base steps.
pub struct Known {
    /// The coarsest step size at which no path fails.
    pub first: u32,
    /// Why the scheme is not recommended: paths fail at all step sizes, there is no time, or it
    /// converges to something else.
    pub excluded: Option<Outcome>,
}

impl Known {
    /// Runs the scheme with finer and finer steps until no path fails, and checks single steps.
    pub fn new<'a>(
        scheme: &Arc<dyn Method + 'a>,
        search: &Search<'a>,
        stop: &Stop,
    ) -> Result<Self, LadderError> {
        let (problem, truncation) = (search.problem, search.settings.truncation);
        let mut excluded = Outcome::NotMeasured;
        for first in 0..=FINEST {
            let steps = search.base << first;
            let runs = vec![Run::new(Arc::clone(scheme), 0)];
            let ladder = Ladder::new(problem, steps, 0, truncation, search.key(1), runs)?;
            let nothing = |_: &View<'_>, _: &mut [_]| ();
            let new = || FinalMoments::new(ladder.coarse_steps(), 0, &nothing);
            let failures = ladder.run_until(stop, 0, PATHS, new).failures;
            if let Some(failure) = failures.first() {
                excluded = Outcome::Fails(failure.to_string());
            } else if !stop.is_asked() {
                let sizes = StepSizes::new(steps, truncation, search.key(1));
                let sizes = StepSizes { levels: 1, stop: stop.clone(), ..sizes };
                let setup = Setup { problem: problem.clone(), scheme: Arc::clone(scheme) };
                let excluded = match single_steps(&setup, &sizes)? {
                    Limit::Inconsistent { defect } => Some(Outcome::Inconsistent(defect)),
                    _ => None,
                };
                return Ok(Self { first, excluded });
            }
            if stop.is_asked() {
                break;
            }
        }
        Ok(Self { first: FINEST, excluded: Some(excluded) })
    }

    /// Whether it has errors.
    pub fn runs(&self) -> bool {
        matches!(self.excluded, None | Some(Outcome::Inconsistent(_)))
    }

    /// The coarsest step size and so many halvings, if it has errors.
    pub fn sizes(&self, halvings: u32) -> Range<u32> {
        if self.runs() { self.first..self.first + halvings + 1 } else { 0..0 }
    }
}

/// How often a wish is seen.
const OFTEN: Duration = Duration::from_millis(20);

/// Does something that ends after so many seconds, or when the end is asked for.
pub fn within<R>(seconds: f64, asked: &Stop, work: impl FnOnce(&Stop) -> R) -> R {
    let (stop, (done, ended)) = (Stop::default(), mpsc::channel::<()>());
    thread::scope(|scope| {
        let (wish, watch) = (stop.clone(), Stopwatch::start());
        scope.spawn(move || {
            while watch.wall_s() < seconds && !asked.is_asked() {
                if ended.recv_timeout(OFTEN) != Err(mpsc::RecvTimeoutError::Timeout) {
                    return;
                }
            }
            wish.now();
        });
        let result = work(&stop);
        drop(done);
        result
    })
}
