//! What goes wrong with parts.

use std::{io, path::PathBuf};

use super::share::array;

/// Why a job did not come to its end. Nothing that was in its folder is lost by any of these.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum JobError {
    /// A part, an argument of a command line or a number of threads that cannot be. The text says
    /// which are possible.
    #[error("{0}")]
    Argument(String),
    /// A file or folder cannot be read or written.
    #[error("cannot {action} {}: {source}", path.display())]
    File {
        /// "read", "write", …
        action: &'static str,
        /// The file or folder.
        path: PathBuf,
        /// The cause.
        source: io::Error,
    },
    /// What is in the folder cannot be used: a file is damaged, belongs to another study or is
    /// being computed by another process; or sums cannot be written and read back. The text names
    /// file and work, and says what to do.
    #[error("{0}")]
    Refused(String),
    /// Parts are missing or have not come to their end.
    #[error("missing or incomplete: run these parts again: --array={}", array(parts))]
    Missing {
        /// Their numbers.
        parts: Vec<u64>,
    },
    /// The computation was stopped. A checkpoint is written if the job has a folder.
    #[error("stopped; where there is a folder, the same command goes on from the checkpoint")]
    Stopped,
}
