//! The file of a part, of a checkpoint and of what was merged: one format for all three.
//!
//! A SHA-256, and in postcard what it is of: the version of the format, the program, the part, and
//! the works by their names. Every number comes back to the bit.

use std::{
    borrow::Cow,
    collections::BTreeMap,
    fmt::Display,
    fs, io,
    io::{Read, Seek},
    ops::Range,
    path::{Path, PathBuf},
};

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::{
    JobError, Share, atomic,
    work::{Sum, Work},
};
use crate::{Kept, driver::GROUP_PATHS, ladder::Nodes, tree::Node};

/// The version of the format.
const SCHEMA: u32 = 3;
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
    /// What tells the study from others: names and values.
    pub study: Vec<(String, String)>,
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
#[derive(Clone, Serialize, Deserialize)]
pub struct Entry<'a> {
    pub header: Header,
    #[serde(borrow)]
    nodes: Cow<'a, [u8]>,
}

impl Entry<'_> {
    /// Packs the nodes of a piece of work. What cannot be read back must be known before hours of
    /// computing depend on it.
    pub fn new<T: Kept>(
        header: Header,
        nodes: &[Node<Sum<T>>],
        work: &Work<'_, T>,
    ) -> Result<Self, JobError> {
        let packed = work.pack(nodes);
        let again = packed.clone().and_then(|bytes| work.pack(&work.unpack(&bytes)?));
        let why = match (packed, again) {
            (Ok(bytes), Ok(again)) if bytes == again => {
                return Ok(Self { header, nodes: Cow::Owned(bytes) });
            }
            (Ok(_), Ok(_)) => "they come back as others".into(),
            (Err(error), _) | (_, Err(error)) => error.to_string(),
        };
        Err(JobError::Refused(format!(
            "the sums of {} cannot be written and read back: {why}. Derive Serialize and \
             Deserialize for them without skipping or flattening fields",
            work.name
        )))
    }

    /// The nodes, which must be the tree's nodes of the groups that are done.
    pub fn nodes<T: Kept>(&self, path: &Path, work: &Work<'_, T>) -> Result<Nodes<T>, JobError> {
        let nodes = work.unpack(&self.nodes).map_err(|error| damaged(path, error))?;
        let mut next = self.header.groups.start;
        let follows = nodes.iter().all(|node| {
            let follows = node.first == next && node.level < 64;
            next = if follows { node.end() } else { next };
            follows
        });
        if follows && next == self.header.done {
            Ok(nodes)
        } else {
            Err(damaged(path, format!("{} has groups twice or not at all", work.name)))
        }
    }
}

type Works<'a> = BTreeMap<String, Entry<'a>>;

/// A file whose pieces of work are in memory.
pub struct PartFile {
    pub path: PathBuf,
    /// None of what was merged.
    part: Option<Share>,
    program: Program,
    pub works: Works<'static>,
}

impl PartFile {
    /// The file at `path`, or one without works if there is none.
    pub fn open(path: PathBuf, program: &Program, part: Option<Share>) -> Result<Self, JobError> {
        let works = match fs::read(&path) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => BTreeMap::new(),
            Err(error) => return Err(file_error("read", &path)(error)),
            Ok(bytes) => {
                let owned = |(name, Entry { header, nodes })| {
                    (name, Entry { header, nodes: Cow::Owned(Cow::into_owned(nodes)) })
                };
                content(&path, &bytes, program)?.1.into_iter().map(owned).collect()
            }
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

/// Where a piece of work is in a file that is not kept in memory.
pub struct Place {
    pub path: PathBuf,
    pub part: Share,
    pub header: Header,
    bytes: Range<usize>,
    sum: Vec<u8>,
}

impl Place {
    /// The part of a file, and where its works are.
    pub fn all(
        path: &Path,
        program: &Program,
    ) -> Result<(Share, BTreeMap<String, Self>), JobError> {
        let bytes = fs::read(path).map_err(file_error("read", path))?;
        let (part, works) = content(path, &bytes, program)?;
        let part = part.ok_or_else(|| damaged(path, "it names no part"))?;
        let place = |(name, Entry { header, nodes }): (String, Entry<'_>)| {
            let start = nodes.as_ptr() as usize - bytes.as_ptr() as usize;
            let (bytes, sum) = (start..start + nodes.len(), Sha256::digest(&nodes).to_vec());
            (name, Self { path: path.to_owned(), part, header, bytes, sum })
        };
        Ok((part, works.into_iter().map(place).collect()))
    }

    /// The nodes, read from the file.
    pub fn nodes<T: Kept>(&self, work: &Work<'_, T>) -> Result<Nodes<T>, JobError> {
        let mut nodes = vec![0; self.bytes.len()];
        let mut read = || -> io::Result<()> {
            let mut file = fs::File::open(&self.path)?;
            file.seek(io::SeekFrom::Start(self.bytes.start as u64))?;
            file.read_exact(&mut nodes)
        };
        read().map_err(file_error("read", &self.path))?;
        if Sha256::digest(&nodes)[..] != self.sum[..] {
            let file = self.path.display();
            return Err(JobError::Refused(format!(
                "{file} was replaced while it was merged: wait until its part has ended"
            )));
        }
        Entry { header: self.header.clone(), nodes: nodes.into() }.nodes(&self.path, work)
    }
}

/// The part and the works of a file of this program whose checksum is right.
fn content<'a>(
    path: &Path,
    bytes: &'a [u8],
    program: &Program,
) -> Result<(Option<Share>, Works<'a>), JobError> {
    let content = bytes.split_at_checked(SUM);
    let content = content.filter(|(sum, content)| Sha256::digest(content)[..] == **sum);
    let (_, content) = content.ok_or_else(|| damaged(path, "its checksum is wrong"))?;
    let made_by = postcard::take_from_bytes::<(u32, Program)>(content);
    let ((schema, found), rest) = made_by.map_err(|error| damaged(path, error))?;
    let pairs = [
        ("format", schema.to_string(), SCHEMA.to_string()),
        ("program", found.name, program.name.clone()),
        ("version", found.version, program.version.clone()),
    ];
    match pairs.into_iter().find(|(_, found, here)| found != here) {
        Some((what, found, here)) => Err(foreign(path, "it", what, found, here)),
        None => postcard::from_bytes(rest).map_err(|error| damaged(path, error)),
    }
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
         or the arguments with which that study was begun",
        path.display()
    ))
}

fn damaged(path: &Path, found: impl Display) -> JobError {
    JobError::Refused(format!(
        "{} is damaged: {found}. Delete the file of a part and run that part again; without \
         merged.bin begin anew in another folder",
        path.display()
    ))
}

pub fn file_error(action: &'static str, path: &Path) -> impl FnOnce(io::Error) -> JobError {
    move |source| JobError::File { action, path: path.to_owned(), source }
}
