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
    let (mut tree, start) = (MergeTree::new(merge), Instant::now());
    let done = work.grow(&mut tree, 0..groups, &mut |_, _| start.elapsed() < each);
    if work.stop.is_asked() {
        return Err(JobError::Stopped);
    }
    let each_thread = threads.min(done) as f64 / done.max(1) as f64;
    Ok(Planned {
        name: work.name.to_owned(),
        paths: work.paths,
        steps: work.ladder.steps_per_path(),
        groups,
        seconds: start.elapsed().as_secs_f64() * each_thread,
    })
}
