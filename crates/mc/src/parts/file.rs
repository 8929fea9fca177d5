//! The file of a part, of a checkpoint and of what was merged: one format for all three.
//!
//! A SHA-256, and in postcard what it is of: the version of the format, the program, the part, and
//! the works by their names. Every number comes back to the bit.

use std::{
    collections::BTreeMap,
    fmt::Display,
    fs, io,
    ops::Range,
    path::{Path, PathBuf},
};

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::{JobError, Share, atomic};
use crate::driver::GROUP_PATHS;

/// The version of the format.
const SCHEMA: u32 = 6;
/// Bytes of a SHA-256.
const SUM: usize = 32;

/// The first 16 bytes of the SHA-256 of a value, in hexadecimal. What cannot be written is told
/// when sums are tried before the computing.
pub fn hash(value: &impl Serialize) -> String {
    let sum = Sha256::digest(postcard::to_stdvec(value).unwrap_or_default());
    sum[..16].iter().map(|byte| format!("{byte:02x}")).collect()
}

/// The program that made a file.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Program {
    /// Its name.
    pub name: String,
    /// Its version: parts of different versions are not merged.
    pub version: String,
}

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
    pub path: PathBuf,
    /// None of what was merged.
    pub part: Option<Share>,
    program: Program,
    pub works: BTreeMap<String, Entry>,
}

impl PartFile {
    /// The file at `path`, or one of this part without works if there is none.
    pub fn open(path: PathBuf, program: &Program, part: Option<Share>) -> Result<Self, JobError> {
        let (part, works) = match fs::read(&path) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => (part, BTreeMap::new()),
            Err(error) => return Err(file_error("read", &path)(error)),
            Ok(bytes) => content(&path, &bytes, program)?,
        };
        Ok(Self { path, part, program: program.clone(), works })
    }

    /// Replaces the file in one step.
    pub fn write(&self) -> Result<(), JobError> {
        let Self { path, part, program, works } = self;
        let content = postcard::to_stdvec(&(SCHEMA, program, part, works));
        let written = content.map_err(io::Error::other).and_then(|content| {
            let sum = Sha256::digest(&content);
            atomic::replace(path, &[&sum[..], &content].concat())
        });
        written.map_err(file_error("write", path))
    }
}

/// The part and the works of a file of this program whose checksum is right.
fn content(
    path: &Path,
    bytes: &[u8],
    program: &Program,
) -> Result<(Option<Share>, BTreeMap<String, Entry>), JobError> {
    let content = bytes.split_at_checked(SUM);
    let content = content.filter(|(sum, content)| Sha256::digest(content)[..] == **sum);
    let (_, content) = content.ok_or_else(|| damaged(path, "its checksum is wrong"))?;
    let made_by = postcard::take_from_bytes::<(u32, Program)>(content);
    let ((schema, found), rest) = made_by.map_err(|error| damaged(path, error))?;
    if (schema, &found) != (SCHEMA, program) {
        let of = |Program { name, version }: &Program, schema| {
            format!("{name} {version}, format {schema}")
        };
        return Err(foreign(
            path,
            "the file",
            "the program",
            of(&found, schema),
            of(program, SCHEMA),
        ));
    }
    postcard::from_bytes(rest).map_err(|error| damaged(path, error))
}

pub fn foreign(
    path: &Path,
    work: &str,
    what: &str,
    found: impl Display,
    here: impl Display,
) -> JobError {
    JobError::Refused(format!(
        "{} is of another study: {work} has {what} {found}, here it is {here}. Take another folder, \
         or the arguments of that study",
        path.display()
    ))
}

pub fn damaged(path: &Path, found: impl Display) -> JobError {
    JobError::Refused(format!(
        "{} is damaged: {found}. Delete the file of a part and run that part again; without \
         merged.bin begin anew in another folder",
        path.display()
    ))
}

pub fn file_error(action: &'static str, path: &Path) -> impl FnOnce(io::Error) -> JobError {
    move |source| JobError::File { action, path: path.to_owned(), source }
}
