//! What goes wrong with parts.

use std::{io, path::PathBuf};

use super::{Share, arguments::USAGE, share::array};

/// Why a job did not come to its end. Nothing that was in its folder is lost by any of these.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum JobError {
    /// There is no such part.
    #[error("there is no part {number} of {of}: parts are numbered from 1 to their number")]
    Share {
        /// The given number.
        number: u64,
        /// The given number of parts.
        of: u64,
    },
    /// An argument of a command line that is not understood.
    #[error("cannot understand {0}; arguments are {USAGE}")]
    Argument(String),
    /// The number of threads cannot be set.
    #[error("cannot compute with {threads} threads: {why}")]
    Threads {
        /// The given number.
        threads: u64,
        /// The reason.
        why: String,
    },
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
    /// A file is not what was written.
    #[error(
        "{} is damaged: {found}. Delete the file of a part and run that part again; without \
         merged.bin begin anew in another folder",
        path.display()
    )]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        found: String,
    },
    /// A file was replaced while it was merged.
    #[error("{} was replaced while it was merged: wait until its part has ended", .0.display())]
    Replaced(PathBuf),
    /// A file belongs to another study.
    #[error(
        "{} is of another study: {work} has {what} {found}, here it is {here}. Take another \
         folder, or the arguments with which that study was begun",
        path.display()
    )]
    Foreign {
        /// The file.
        path: PathBuf,
        /// The piece of work that differs.
        work: String,
        /// What differs.
        what: String,
        /// As the file has it.
        found: String,
        /// As this program has it.
        here: String,
    },
    /// Two files have the same groups of paths.
    #[error(
        "{} and {} both have paths of {work}: they are parts of different numbers of parts. Delete \
         those of one number", first.display(), second.display()
    )]
    Overlap {
        /// A file.
        first: PathBuf,
        /// Another.
        second: PathBuf,
        /// The piece of work.
        work: String,
    },
    /// Another process has the same part.
    #[error(
        "{part} in {} is being computed by {holder}; wait for its end, or stop it",
        folder.display()
    )]
    Busy {
        /// The part.
        part: Share,
        /// The folder.
        folder: PathBuf,
        /// The other process.
        holder: String,
    },
    /// A folder has no parts.
    #[error("there are no parts in {}", .0.display())]
    NoParts(PathBuf),
    /// Parts are missing or have not come to their end.
    #[error("missing or incomplete: run these parts again: --array={}", array(parts))]
    Missing {
        /// Their numbers.
        parts: Vec<u64>,
    },
    /// The next round of paths depends on those that are now merged.
    #[error("{work} needs more paths: run the same parts once more, then merge again")]
    NextRound {
        /// The piece of work.
        work: String,
    },
    /// Two pieces of work have the same name.
    #[error("the name {0:?} is given to two pieces of work; names tell them apart in files")]
    SameName(String),
    /// A statistic does not come back from a file as it was.
    #[error(
        "the sums of {work} cannot be written and read back: {found}. Derive Serialize and \
         Deserialize for them without skipping or flattening fields"
    )]
    NotKept {
        /// The piece of work.
        work: String,
        /// What happened.
        found: String,
    },
    /// The computation was stopped. A checkpoint is written if the job has a folder.
    #[error("stopped; where there is a folder, the same command goes on from the checkpoint")]
    Stopped,
}
