//! How long works take, from a little of each.

use std::time::{Duration, Instant};

use super::{JobError, work::Work};
use crate::{Kept, ladder::merge, tree::MergeTree};

/// A piece of work before it is computed.
#[derive(Clone, Debug, PartialEq)]
pub struct Planned {
    /// Its name.
    pub name: String,
    /// Paths.
    pub paths: u64,
    /// Steps of a path.
    pub steps: u64,
    /// Groups of paths: what is divided among parts.
    pub groups: u64,
    /// Seconds of a group on one thread, while all threads are busy.
    pub seconds: f64,
}

/// All works of a study.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Plan {
    /// In their order.
    pub works: Vec<Planned>,
}

impl Plan {
    /// Path-steps in all.
    pub fn path_steps(&self) -> u64 {
        self.works.iter().map(|work| work.paths * work.steps).sum()
    }

    /// Seconds that the longest of so many parts takes. Groups are computed by all threads at a
    /// time; the last ones leave some idle.
    pub fn seconds(&self, parts: u64, threads: u64) -> f64 {
        let waves = |groups: u64| groups.div_ceil(parts).div_ceil(threads);
        self.works.iter().map(|work| waves(work.groups) as f64 * work.seconds).sum()
    }
}

/// A plan in the making.
pub struct Pilot {
    /// How long a piece of work is measured. A single group may take longer.
    pub each: Duration,
    pub plan: Plan,
}

impl Pilot {
    /// Computes some groups. There are no results.
    pub fn measure<T: Kept>(&mut self, work: &Work<'_, T>) -> Result<(), JobError> {
        let (groups, threads) = (&work.groups, rayon::current_num_threads() as u64);
        let mut tree = MergeTree::new(merge);
        let (start, mut next, mut waves) = (Instant::now(), groups.start, 0);
        while next < groups.end && (waves == 0 || start.elapsed() < self.each) {
            let end = groups.end.min(next + threads);
            if work.grow(&mut tree, next..end, &mut |_, _| true) < end {
                return Err(JobError::Stopped);
            }
            (next, waves) = (end, waves + 1);
        }
        self.plan.works.push(Planned {
            name: work.name.clone(),
            paths: work.paths,
            steps: work.ladder.steps_per_path(),
            groups: groups.end - groups.start,
            seconds: start.elapsed().as_secs_f64() / f64::from(waves.max(1)),
        });
        Ok(())
    }
}
