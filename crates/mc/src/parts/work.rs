//! A piece of work: groups of paths of a ladder, whose sums become bytes and come back.

use std::{ops::Range, path::Path, sync::OnceLock};

use super::{
    JobError, Stop,
    file::{Header, foreign},
};
use crate::{
    Kept, Ladder,
    driver::{GROUP_PATHS, Tally},
    ladder::{Nodes, merge},
    parallel::grow,
    tree::{MergeTree, Node},
};

/// Groups of paths of a ladder.
pub struct Work<'a, T> {
    pub name: String,
    /// Path-steps, if later work follows from its result: then it is computed here, whatever the
    /// job is, unless it is worth a round of parts.
    pub round: Option<u64>,
    /// Paths of the whole.
    pub paths: u64,
    pub groups: Range<u64>,
    pub ladder: &'a Ladder<'a>,
    /// What tells the study from others, once it was asked for.
    pub study: &'a OnceLock<Vec<(String, String)>>,
    /// An empty statistic.
    pub new: &'a (dyn Fn() -> T + Sync),
    pub progress: &'a (dyn Fn(u64) + Sync),
    pub stop: &'a Stop,
}

/// The sums of one group.
pub type Sum<T> = (T, Tally);
/// Sees the nodes and the next group, and says whether to go on.
type After<'a, T> = dyn FnMut(&[Node<Sum<T>>], u64) -> bool + 'a;

impl<T: Kept> Work<'_, T> {
    /// Adds the sums of groups to a tree. `after` sees the nodes and the next group now and then,
    /// and says whether to go on. Returns the first group that is not computed.
    pub fn grow<F: Fn(&mut Sum<T>, Sum<T>) + Sync>(
        &self,
        tree: &mut MergeTree<Sum<T>, F>,
        groups: Range<u64>,
        after: &mut After<'_, T>,
    ) -> u64 {
        let compute = |group| {
            let (statistic, tally) =
                self.ladder.group(0, self.paths, group, self.new, self.progress, self.stop);
            tally.ok().map(|tally| (statistic, tally))
        };
        grow(tree, groups, &compute, after)
    }

    /// The nodes of all groups, computed here; of those that are done if it is stopped and
    /// `incomplete`.
    pub fn here(&self, incomplete: bool) -> Result<Nodes<T>, JobError> {
        let mut tree = MergeTree::new(merge);
        let end = self.grow(&mut tree, self.groups.clone(), &mut |_, _| true);
        match end == self.groups.end || incomplete {
            true => Ok(tree.into_nodes()),
            false => Err(JobError::Stopped),
        }
    }

    /// Reports the steps of groups that need not be computed.
    pub fn skip(&self, groups: u64) {
        (self.progress)(groups * GROUP_PATHS * self.ladder.steps_per_path());
    }

    /// An empty tree for its nodes. The last group stays apart if it is not full, since it is
    /// computed again when there are more paths.
    pub fn tree(&self) -> MergeTree<Sum<T>, impl Fn(&mut Sum<T>, Sum<T>) + Sync> {
        MergeTree::of_whole(merge, self.paths / GROUP_PATHS)
    }

    /// A node with the sums of no path.
    pub fn empty(&self) -> Node<Sum<T>> {
        Node::leaf(self.groups.start, self.ladder.nothing(self.new))
    }

    pub fn pack(&self, nodes: &[Node<Sum<T>>]) -> postcard::Result<Vec<u8>> {
        let parts = nodes.iter().map(|Node { first, level, sum: (statistic, tally) }| {
            (first, level, statistic.sums(), tally)
        });
        postcard::to_stdvec(&parts.collect::<Vec<_>>())
    }

    pub fn unpack(&self, bytes: &[u8]) -> postcard::Result<Nodes<T>> {
        let parts: Vec<(u64, u32, T::Sums, Tally)> = postcard::from_bytes(bytes)?;
        let node = |(first, level, sums, tally)| {
            let mut statistic = (self.new)();
            *statistic.sums_mut() = sums;
            Node { first, level, sum: (statistic, tally) }
        };
        Ok(parts.into_iter().map(node).collect())
    }

    fn study(&self) -> &[(String, String)] {
        self.study.get_or_init(|| self.ladder.fingerprint(self.new))
    }

    /// What a file says of these groups, of which it has none yet.
    pub fn header(&self, groups: Range<u64>) -> Header {
        let (study, paths, done) = (self.study().to_vec(), self.paths, groups.start);
        Header { study, paths, done, groups }
    }

    /// Whether a file has the same study, of any size.
    pub fn check(&self, path: &Path, found: &Header) -> Result<(), JobError> {
        let mut pairs = found.study.iter().zip(self.study());
        match pairs.find(|(found, here)| found != here) {
            None => Ok(()),
            Some(((what, found), (_, here))) => Err(foreign(path, &self.name, what, found, here)),
        }
    }

    /// That a file has another number of paths.
    pub fn other_paths(&self, path: &Path, found: &Header) -> JobError {
        foreign(path, &self.name, "a number of paths", found.paths, self.paths)
    }
}
