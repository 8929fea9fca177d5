//! A piece of work: groups of paths of a ladder, whose sums become bytes and come back; and its
//! file. The files of a part, of a checkpoint and of merged nodes have one format.

use std::{
    collections::BTreeMap,
    fmt::Display,
    io::{self, Write},
    ops::Range,
    path::{Path, PathBuf},
    sync::OnceLock,
};

use serde::{Deserialize, Serialize};

use super::{JobError, Share, Stop};
use crate::{
    Kept, Ladder,
    checkpoint::{Checkpoint, Program, damaged, foreign},
    ladder::{
        After, Nodes, Sum,
        driver::{GROUP_PATHS, Tally},
        merge,
    },
    tree::{MergeTree, Node},
};

/// A piece of work: the paths of a ladder.
pub struct Work<'a, T> {
    pub name: &'a str,
    pub paths: u64,
    pub ladder: &'a Ladder<'a>,
    /// Fingerprint of the study, once it was asked for.
    pub study: OnceLock<String>,
    /// An empty statistic.
    pub new: &'a (dyn Fn() -> T + Sync),
    pub stop: &'a Stop,
}

impl<T: Kept> Work<'_, T> {
    /// Number of groups of paths.
    pub fn groups(&self) -> u64 {
        self.paths.div_ceil(GROUP_PATHS)
    }

    /// Adds the sums of groups to a tree; see [`Ladder::grow`].
    pub fn grow(
        &self,
        tree: &mut MergeTree<Sum<T>>,
        groups: Range<u64>,
        after: &mut After<'_, T>,
    ) -> u64 {
        self.ladder.grow(tree, (self.paths, groups), self.new, self.stop, after)
    }

    /// An empty tree for the nodes of this work. The last group stays apart if it is not full,
    /// since it is computed again when there are more paths.
    pub fn tree(&self) -> MergeTree<Sum<T>> {
        MergeTree::of_whole(merge, self.paths / GROUP_PATHS)
    }

    /// Entry of a file with these nodes as bytes. Sums that cannot be read back are refused, before
    /// hours of computing depend on them.
    pub fn entry(&self, header: Header, nodes: &[Node<Sum<T>>]) -> Result<Entry, JobError> {
        let checked = |node| {
            let bytes = packed(node, Vec::new())?;
            let rest = packed(&self.unpacked(&bytes)?, Same(&bytes))?.0;
            if rest.is_empty() { Ok(bytes) } else { Err(postcard::Error::SerializeBufferFull) }
        };
        match nodes.iter().map(checked).collect() {
            Ok(nodes) => Ok(Entry { header, nodes }),
            Err(error) => {
                let why = match error {
                    postcard::Error::SerializeBufferFull => "they come back as others".into(),
                    error => error.to_string(),
                };
                Err(JobError::Refused(format!(
                    "the sums of {} cannot be written and read back: {why}. Derive Serialize and \
                     Deserialize for all of their fields",
                    self.name,
                )))
            }
        }
    }

    /// Nodes of a file, which must be the tree's nodes of the groups that are done.
    pub fn nodes(
        &self,
        path: &Path,
        Entry { header, nodes }: &Entry,
    ) -> Result<Nodes<T>, JobError> {
        let unpacked = nodes.iter().map(|bytes| self.unpacked(bytes));
        let nodes: Nodes<T> =
            unpacked.collect::<Result<_, _>>().map_err(|error| damaged(path, error))?;
        let next = nodes.iter().try_fold(header.groups.start, |next, node| {
            (node.first == next && node.level < 64).then(|| node.end())
        });
        if next == Some(header.done) {
            Ok(nodes)
        } else {
            Err(damaged(path, format!("{} has groups twice or not at all", self.name)))
        }
    }

    fn unpacked(&self, bytes: &[u8]) -> postcard::Result<Node<Sum<T>>> {
        let (first, level, sums, tally) =
            postcard::from_bytes::<(u64, u32, T::Sums, Tally)>(bytes)?;
        let mut statistic = (self.new)();
        *statistic.sums_mut() = sums;
        Ok(Node { first, level, sum: (statistic, tally) })
    }

    fn study(&self) -> &String {
        self.study.get_or_init(|| self.ladder.fingerprint(self.new))
    }

    /// Header of a file with these groups, of which it has those before `done`.
    pub fn header(&self, groups: Range<u64>, done: u64) -> Header {
        Header { study: self.study().clone(), paths: self.paths, groups, done }
    }

    /// Refuses a file of another study; the number of paths does not count.
    pub fn check(&self, path: &Path, found: &Header) -> Result<(), JobError> {
        let (found, here) = (&found.study, self.study());
        if found == here {
            Ok(())
        } else {
            Err(differs(path, self.name, "the fingerprint", found, here))
        }
    }

    /// Error of a file with another number of paths.
    pub fn other_paths(&self, path: &Path, found: &Header) -> JobError {
        differs(path, self.name, "a number of paths", found.paths, self.paths)
    }
}

fn packed<T: Kept, W: Write>(node: &Node<Sum<T>>, to: W) -> postcard::Result<W> {
    let Node { first, level, sum: (statistic, tally) } = node;
    postcard::to_io(&(first, level, statistic.sums(), tally), to)
}

/// A writer that takes these bytes and no others.
struct Same<'a>(&'a [u8]);

impl Write for Same<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0 = self.0.strip_prefix(bytes).ok_or(io::ErrorKind::InvalidData)?;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Header of a piece of work in a file: all except its sums.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Header {
    /// Fingerprint of the study.
    pub study: String,
    /// Number of paths of the whole work.
    pub paths: u64,
    /// Groups of paths that this file is to have.
    pub groups: Range<u64>,
    /// First group that the file does not have yet.
    pub done: u64,
}

impl Header {
    pub fn is_complete(&self) -> bool {
        self.done == self.groups.end
    }

    /// End of the groups that are the same in a study of `paths` paths: the last group has more
    /// paths there if it is not full here.
    pub fn whole(&self, paths: u64) -> u64 {
        if self.paths < paths { self.paths / GROUP_PATHS } else { self.groups.end }
    }
}

/// A piece of work in a file: each of its nodes as bytes.
#[derive(Serialize, Deserialize)]
pub struct Entry {
    pub header: Header,
    pub nodes: Vec<Vec<u8>>,
}

/// A file whose pieces of work are in memory.
pub struct PartFile {
    pub kept: Checkpoint,
    /// The part of the file; `None` for merged nodes.
    pub part: Option<Share>,
    pub works: BTreeMap<String, Entry>,
}

impl PartFile {
    /// Opens the file at `path`, or one of this part without works if there is none.
    pub fn open(path: PathBuf, program: &Program, part: Option<Share>) -> Result<Self, JobError> {
        let kept = Checkpoint::new(path, program.clone());
        let (part, works) = kept.read()?.unwrap_or((part, BTreeMap::new()));
        Ok(Self { kept, part, works })
    }

    /// Replaces the file in one step.
    pub fn write(&self) -> Result<(), JobError> {
        self.kept.write(&(self.part, &self.works))
    }
}

/// Error of a file that differs in `what` of a piece of work, with `found` there and `here` in this
/// program.
pub fn differs(
    path: &Path,
    work: &str,
    what: &str,
    found: impl Display,
    here: impl Display,
) -> JobError {
    foreign(path, &format!("{what} {found} of {work}"), &format!("{what} {here}"))
}
