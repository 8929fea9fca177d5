//! What was sampled of an expectation that was stopped, in a file to go on from.

use std::{fs, path::PathBuf};

use serde::{Deserialize, Serialize};

use super::level::PathValues;
use crate::{
    ladder::Nodes,
    parts::{folder, replace},
};

/// The samples of an attempt.
#[derive(Serialize, Deserialize)]
pub struct Kept<'a> {
    /// What tells the expectation from others.
    pub study: String,
    /// Number of the attempt.
    pub attempt: usize,
    /// Path-steps of all attempts so far.
    pub spent: u64,
    /// The level that the sum begins with.
    pub first: usize,
    /// Of each level the points of complete rounds, and the sums of each replicate.
    pub levels: Vec<(u64, Vec<Nodes<PathValues<'a>>>)>,
}

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
    pub(super) fn read<'a>(&self) -> Option<Kept<'a>> {
        let bytes = fs::read(&self.file).ok()?;
        postcard::from_bytes(&bytes).ok().filter(|kept: &Kept| kept.study == self.study)
    }

    /// Whether there is something to go on from.
    pub fn holds(&self) -> bool {
        self.read().is_some()
    }

    pub(super) fn write(&self, kept: &Kept<'_>) {
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
