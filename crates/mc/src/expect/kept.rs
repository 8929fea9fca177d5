//! What was sampled of an expectation that was stopped, in a file to go on from.

use std::{fs, path::PathBuf};

use serde::{Deserialize, Serialize};

use super::{
    level::{PathValues, Values},
    resolution::Motion,
};
use crate::{driver::Tally, ladder::Nodes, parts::{folder, replace}, tree::Node};

/// The samples of an attempt.
#[derive(Serialize, Deserialize)]
pub struct Kept {
    /// What tells the expectation from others.
    pub study: String,
    /// Number of the attempt.
    pub attempt: usize,
    /// Path-steps of all attempts so far.
    pub spent: u64,
    /// The level that the sum begins with.
    pub first: usize,
    /// Of each level the points of complete rounds, and the sums of each replicate.
    pub levels: Vec<(u64, Vec<Vec<Sums>>)>,
}

/// The sums of a node: its first group and its height, and what was added up.
pub type Sums = (u64, u32, (Vec<Values>, Motion, Motion), Tally);

/// Where samples are kept.
#[derive(Clone, Debug)]
pub struct Keeping {
    /// The file.
    pub file: PathBuf,
    /// What tells the expectation from others: whatever its samples depend on.
    pub study: String,
}

impl Keeping {
    /// What is kept of this expectation.
    pub(super) fn read(&self) -> Option<Kept> {
        let bytes = fs::read(&self.file).ok()?;
        postcard::from_bytes(&bytes).ok().filter(|kept: &Kept| kept.study == self.study)
    }

    /// Whether there is something to go on from.
    pub fn holds(&self) -> bool {
        self.read().is_some()
    }

    pub(super) fn write(&self, kept: &Kept) {
        let bytes = postcard::to_stdvec(kept).map_err(|error| error.to_string());
        let written = bytes.and_then(|bytes| {
            let prepared = fs::create_dir_all(folder(&self.file));
            prepared.and_then(|()| replace(&self.file, &bytes)).map_err(|error| error.to_string())
        });
        if let Err(error) = written {
            eprintln!("warning: the samples are not kept in {}: {error}", self.file.display());
        }
    }
}

/// Nodes as they are kept.
pub fn packed(nodes: &Nodes<PathValues<'_>>) -> Vec<Sums> {
    let sums = |Node { first, level, sum: (values, tally) }: &Node<(PathValues<'_>, Tally)>| {
        let PathValues { values, motion, functions, .. } = values.clone();
        (*first, *level, (values, motion, functions), tally.clone())
    };
    nodes.iter().map(sums).collect()
}

/// Nodes that were kept.
pub fn unpacked<'a>(kept: Vec<Sums>, empty: &PathValues<'a>) -> Nodes<PathValues<'a>> {
    let node = |(first, level, (values, motion, functions), tally): Sums| {
        let values = PathValues { values, motion, functions, ..empty.clone() };
        Node { first, level, sum: (values, tally) }
    };
    kept.into_iter().map(node).collect()
}
