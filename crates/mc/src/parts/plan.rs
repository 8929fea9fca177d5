//! How long works take and how large their files are, from a little of each.

use std::{
    ops::Range,
    time::{Duration, Instant},
};

use super::{
    JobError, Share,
    balance::{Load, Shares},
    file::packed_bytes,
    job::Work,
};
use crate::{
    driver::GROUP_PATHS,
    parallel::grow,
    tree::{MergeTree, Node},
};

/// A piece of work before it is computed.
#[derive(Clone, Debug, PartialEq)]
pub struct Planned {
    /// Its name.
    pub name: String,
    /// Paths, or the tasks of [`Job::tasks`](super::Job::tasks).
    pub items: u64,
    /// Steps of a path; 0 for tasks.
    pub steps: u64,
    /// Groups of paths, or tasks: what is divided among parts.
    pub groups: u64,
    /// Seconds of a group on one thread, while all threads are busy.
    pub seconds: f64,
    /// Bytes of the sums of groups in a file.
    pub bytes: u64,
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
        self.works.iter().map(|work| work.items * work.steps).sum()
    }

    /// Nanoseconds of a path-step on one thread, on the average.
    pub fn nanoseconds(&self) -> f64 {
        let ladders = self.works.iter().filter(|work| work.steps > 0);
        let (seconds, steps) = ladders.fold((0.0, 0.0), |(seconds, steps), work| {
            let groups = work.groups as f64;
            (seconds + groups * work.seconds, steps + (work.items * work.steps) as f64)
        });
        1e9 * seconds / steps
    }

    /// What each of so many parts takes.
    pub fn parts(&self, of: u64, threads: u64) -> Vec<PlannedPart> {
        let load = |work: &Planned| Load {
            name: work.name.clone(),
            groups: 0..work.groups,
            steps: work.steps,
        };
        let shares = Shares::new(self.works.iter().map(load).collect(), of);
        let shares_of = (1..=of).filter_map(|number| Share::new(number, of).ok());
        let part = |share: Share| {
            let mut part = PlannedPart::default();
            for work in &self.works {
                let groups = shares.range(&work.name, share, &(0..work.groups));
                part.add(work, groups, threads);
            }
            part
        };
        shares_of.map(part).collect()
    }
}

/// What a part takes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PlannedPart {
    /// Path-steps.
    pub path_steps: u64,
    /// Seconds.
    pub seconds: f64,
    /// Bytes of its file.
    pub bytes: u64,
}

impl PlannedPart {
    fn add(&mut self, work: &Planned, groups: Range<u64>, threads: u64) {
        let paths = |group: u64| work.items.min(group * GROUP_PATHS);
        self.path_steps += (paths(groups.end) - paths(groups.start)) * work.steps;
        // Groups are computed by all threads at a time; the last ones leave some idle.
        self.seconds += length(&groups).div_ceil(threads) as f64 * work.seconds;
        let mut tree = MergeTree::new(|_: &mut (), ()| ());
        groups.for_each(|group| tree.push(Node::leaf(group, ())));
        self.bytes += tree.nodes().len() as u64 * work.bytes;
    }
}

fn length(groups: &Range<u64>) -> u64 {
    groups.end - groups.start
}

/// A plan in the making.
pub struct Pilot {
    /// How long a piece of work is measured. A single group may take longer.
    each: Duration,
    plan: Plan,
}

impl Pilot {
    pub fn new(each: Duration) -> Self {
        Self { each, plan: Plan::default() }
    }

    /// Whether nothing is measured.
    pub fn only_lists(&self) -> bool {
        self.each.is_zero()
    }

    /// Lists a piece of work, unless it follows from the results of others. There are no results.
    pub fn list<T>(&mut self, work: &Work<'_, T>) -> Option<Vec<Node<T>>> {
        if work.round.is_none() {
            self.add(work, 0.0, 0);
        }
        None
    }

    /// Computes some groups. There are no results.
    pub fn measure<T: Send>(
        &mut self,
        work: &Work<'_, T>,
    ) -> Result<Option<Vec<Node<T>>>, JobError> {
        let (groups, threads) = (&work.groups, rayon::current_num_threads() as u64);
        let mut tree = MergeTree::new(work.merge);
        let (start, mut next, mut waves) = (Instant::now(), groups.start, 0);
        while next < groups.end && (waves == 0 || start.elapsed() < self.each) {
            let end = groups.end.min(next + threads);
            if grow(&mut tree, next..end, work.compute, &mut |_, _| true) < end {
                return Err(JobError::Stopped);
            }
            (next, waves) = (end, waves + 1);
        }
        let seconds = start.elapsed().as_secs_f64() / f64::from(waves.max(1));
        let bytes = tree.finish().map(|sum| packed_bytes(&sum, work)).transpose()?;
        self.add(work, seconds, bytes.unwrap_or(0));
        Ok(None)
    }

    fn add<T>(&mut self, work: &Work<'_, T>, seconds: f64, bytes: u64) {
        let groups = length(&work.groups);
        self.plan.works.push(Planned {
            name: work.name.to_owned(),
            items: if work.steps == 0 { groups } else { work.paths },
            steps: work.steps,
            groups,
            seconds,
            bytes,
        });
    }

    pub fn finish(self) -> Plan {
        self.plan
    }
}
