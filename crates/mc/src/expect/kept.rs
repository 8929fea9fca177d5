//! What was sampled of an expectation that was stopped, in a file to go on from.

use std::{
    fs, io,
    path::PathBuf,
    sync::{Arc, OnceLock},
};

use serde::{Deserialize, Serialize, de::DeserializeOwned};

use super::level::PathValues;
use crate::{
    ladder::Nodes,
    parts::{folder, replace},
};

/// The samples of an attempt.
#[derive(Serialize, Deserialize)]
pub struct Kept<'a> {
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
#[derive(Clone, Debug, Default)]
pub struct Keeping {
    /// The file.
    pub file: PathBuf,
    /// What tells the computation from others: whatever its samples depend on.
    pub study: String,
    /// Why the file could not be written, if it could not. The computation goes on without it.
    pub failure: Arc<OnceLock<String>>,
}

impl Keeping {
    /// What is kept of this computation.
    pub(crate) fn read<T: DeserializeOwned>(&self) -> Option<T> {
        let bytes = fs::read(&self.file).ok()?;
        let (study, rest) = postcard::take_from_bytes::<String>(&bytes).ok()?;
        if study == self.study { postcard::from_bytes(rest).ok() } else { None }
    }

    /// Whether there is something to go on from.
    pub fn holds(&self) -> bool {
        self.read::<()>().is_some()
    }

    pub(crate) fn write(&self, kept: &impl Serialize) {
        let bytes = postcard::to_stdvec(&(&self.study, kept)).map_err(io::Error::other);
        let written = bytes.and_then(|bytes| {
            fs::create_dir_all(folder(&self.file))?;
            replace(&self.file, &bytes)
        });
        if let Err(error) = written {
            self.failure.get_or_init(|| error.to_string());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_that_cannot_be_written_is_told_and_no_error() {
        let file = tempfile::NamedTempFile::new().unwrap();
        // Within a file, as in a folder.
        let keeping = Keeping { file: file.path().join("within"), ..Keeping::default() };
        keeping.clone().write(&1u8);
        assert!(!keeping.holds() && keeping.failure.get().is_some_and(|why| !why.is_empty()));
        let folder = tempfile::tempdir().unwrap();
        let keeping = Keeping { file: folder.path().join("within"), ..Keeping::default() };
        keeping.write(&1u8);
        assert!(keeping.holds() && keeping.failure.get().is_none());
    }
}
