//! The file of a part, of a checkpoint and of what was merged: one format for all three.

use std::{
    collections::BTreeMap,
    fmt::Display,
    ops::Range,
    path::{Path, PathBuf},
};

use serde::{Deserialize, Serialize};

use super::{JobError, Share};
use crate::{
    checkpoint::{Checkpoint, Program, foreign},
    driver::GROUP_PATHS,
};

/// What a file says of a piece of work beside its sums.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Header {
    /// What tells the study from others.
    pub study: String,
    /// Paths of the whole.
    pub paths: u64,
    /// The groups of paths that this file is to have.
    pub groups: Range<u64>,
    /// The groups that it has are those before this one.
    pub done: u64,
}

impl Header {
    pub fn is_complete(&self) -> bool {
        self.done == self.groups.end
    }

    /// The end of the groups that are the same in a study of so many paths: the last group has
    /// more paths there if it is not full here.
    pub fn whole(&self, paths: u64) -> u64 {
        if self.paths < paths { self.paths / GROUP_PATHS } else { self.groups.end }
    }
}

/// A piece of work in a file: its nodes as bytes.
#[derive(Serialize, Deserialize)]
pub struct Entry {
    pub header: Header,
    pub nodes: Vec<u8>,
}

/// A file whose pieces of work are in memory.
pub struct PartFile {
    pub kept: Checkpoint,
    /// None of what was merged.
    pub part: Option<Share>,
    pub works: BTreeMap<String, Entry>,
}

impl PartFile {
    /// The file at `path`, or one of this part without works if there is none.
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

/// That a file has something else of a piece of work than what is here.
pub fn differs(
    path: &Path,
    work: &str,
    what: &str,
    found: impl Display,
    here: impl Display,
) -> JobError {
    foreign(path, &format!("{what} {found} of {work}"), &format!("{what} {here}"))
}
