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

impl Planned {
    /// Seconds that the longest of so many parts takes. Groups are computed by all threads at a
    /// time; the last ones leave some idle.
    pub fn seconds(&self, parts: u64, threads: u64) -> f64 {
        self.groups.div_ceil(parts).div_ceil(threads) as f64 * self.seconds
    }
}

/// Measures some groups of a piece of work, for so long or a single one. There are no results.
pub fn measure<T: Kept>(each: Duration, work: &Work<'_, T>) -> Result<Planned, JobError> {
    let (groups, threads) = (work.groups(), rayon::current_num_threads() as u64);
    let mut tree = MergeTree::new(merge);
    let (start, mut next, mut waves) = (Instant::now(), 0, 0);
    while next < groups && (waves == 0 || start.elapsed() < each) {
        let end = groups.min(next + threads);
        if work.grow(&mut tree, next..end, &mut |_, _| true) < end {
            return Err(JobError::Stopped);
        }
        (next, waves) = (end, waves + 1);
    }
    Ok(Planned {
        name: work.name.to_owned(),
        paths: work.paths,
        steps: work.ladder.steps_per_path(),
        groups,
        seconds: start.elapsed().as_secs_f64() / f64::from(waves.max(1)),
    })
}
