//! The file of a part, of a checkpoint and of what was merged: one format for all three.

use std::{
    collections::BTreeMap,
    fs, io,
    ops::Range,
    path::{Path, PathBuf},
};

use base64::{Engine, engine::general_purpose::STANDARD_NO_PAD};
use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;

use super::{
    Fingerprint, JobError, Share, atomic,
    fingerprint::checksum,
    job::{Packing, Work},
};
use crate::{driver::GROUP_PATHS, tree::Node};

/// The version of the format.
const SCHEMA: u32 = 1;

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
    #[serde(flatten)]
    pub fingerprint: Fingerprint,
    pub seed: u64,
    pub experiment: u64,
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

/// A piece of work in a file.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Entry {
    #[serde(flatten)]
    pub header: Header,
    pub nodes: Vec<Packed>,
}

/// A node of the tree with its sums: little-endian bytes in base 64, so that every number comes
/// back to the bit, NaN and infinities too, which JSON cannot write.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Packed {
    first: u64,
    level: u32,
    sums: String,
}

impl Entry {
    /// Packs the nodes of a piece of work.
    pub fn new<T>(header: Header, nodes: &[Node<T>], work: &Work<'_, T>) -> Result<Self, JobError> {
        let pack = |node: &Node<T>| {
            let bytes = (work.pack)(&node.sum)?;
            // What cannot be read back must be known before hours of computing depend on it.
            let again = (work.unpack)(&bytes).and_then(|sum| (work.pack)(&sum))?;
            let sums = STANDARD_NO_PAD.encode(&bytes);
            let packed = Packed { first: node.first, level: node.level, sums };
            Ok((bytes == again).then_some(packed))
        };
        let packed: Packing<Option<Vec<Packed>>> = nodes.iter().map(pack).collect();
        match packed {
            Ok(Some(nodes)) => Ok(Self { header, nodes }),
            Ok(None) => Err(not_kept(work, "they come back as others")),
            Err(error) => Err(not_kept(work, error)),
        }
    }

    /// The nodes, which must be the tree's nodes of the groups that are done.
    pub fn nodes<T>(&self, path: &Path, work: &Work<'_, T>) -> Result<Vec<Node<T>>, JobError> {
        let mut next = self.header.groups.start;
        let unpack = |packed: &Packed| {
            let bytes = STANDARD_NO_PAD.decode(&packed.sums).map_err(|e| damaged(path, e))?;
            let sum = (work.unpack)(&bytes).map_err(|error| damaged(path, error))?;
            let node = Node { first: packed.first, level: packed.level, sum };
            if node.first != next || packed.level > 63 {
                return Err(damaged(path, format!("{} has groups twice or not at all", work.name)));
            }
            next = node.end();
            Ok(node)
        };
        let nodes: Vec<_> = self.nodes.iter().map(unpack).collect::<Result<_, _>>()?;
        if next == self.header.done { Ok(nodes) } else { Err(damaged(path, "groups are missing")) }
    }
}

fn not_kept<T>(work: &Work<'_, T>, found: impl ToString) -> JobError {
    JobError::NotKept { work: work.name.to_owned(), found: found.to_string() }
}

/// Bytes that a node with these sums takes in a file.
pub fn packed_bytes<T>(sum: &T, work: &Work<'_, T>) -> Result<u64, JobError> {
    let bytes = (work.pack)(sum).map_err(|error| not_kept(work, error))?;
    let packed = Packed { first: 0, level: 0, sums: STANDARD_NO_PAD.encode(bytes) };
    let written = serde_json::to_vec(&packed).map_err(|error| not_kept(work, error))?;
    Ok(written.len() as u64)
}

#[derive(Serialize, Deserialize)]
struct Content<W> {
    schema: u32,
    program: Program,
    /// None of what was merged.
    part: Option<Share>,
    works: W,
}

/// Works that are not read yet.
type Raw<'a> = BTreeMap<String, &'a RawValue>;

#[derive(Serialize)]
struct Sealed<'a> {
    sha256: String,
    content: &'a RawValue,
}

#[derive(Deserialize)]
struct Opened<'a> {
    sha256: String,
    #[serde(borrow)]
    content: &'a RawValue,
}

/// A file whose pieces of work are in memory.
pub struct PartFile {
    pub path: PathBuf,
    pub part: Option<Share>,
    program: Program,
    pub works: BTreeMap<String, Entry>,
}

impl PartFile {
    /// A file without works, not written yet.
    fn new(path: PathBuf, program: &Program, part: Option<Share>) -> Self {
        Self { path, part, program: program.clone(), works: BTreeMap::new() }
    }

    /// The file at `path`, or one without works if there is none.
    pub fn open(path: PathBuf, program: &Program, part: Option<Share>) -> Result<Self, JobError> {
        let mut file = Self::new(path, program, part);
        let path = &file.path;
        let Some(bytes) = read(path)? else { return Ok(file) };
        let content = content(path, &bytes)?;
        check_program(path, &content.program, program)?;
        let entry = |(name, raw): (String, &RawValue)| match serde_json::from_str(raw.get()) {
            Ok(entry) => Ok((name, entry)),
            Err(error) => Err(damaged(path, error)),
        };
        file.works = content.works.into_iter().map(entry).collect::<Result<_, _>>()?;
        Ok(file)
    }

    /// Replaces the file in one step.
    pub fn write(&self) -> Result<(), JobError> {
        let Self { path, part, program, works } = self;
        let content = Content { schema: SCHEMA, program: program.clone(), part: *part, works };
        let bytes = || -> serde_json::Result<Vec<u8>> {
            let content = serde_json::value::to_raw_value(&content)?;
            let sha256 = checksum(content.get().as_bytes());
            serde_json::to_vec(&Sealed { sha256, content: &content })
        };
        let bytes = bytes().map_err(io::Error::from);
        bytes.and_then(|bytes| atomic::replace(path, &bytes)).map_err(file_error("write", path))
    }
}

/// Where a piece of work is in a file that is not kept in memory.
#[derive(Clone, Debug)]
pub struct Place {
    pub path: PathBuf,
    pub header: Header,
    bytes: Range<usize>,
}

/// What a file has, found in one reading that checks its sum.
pub struct Index {
    pub part: Share,
    pub works: BTreeMap<String, Place>,
}

impl Index {
    pub fn read(path: &Path, program: &Program) -> Result<Self, JobError> {
        let bytes = fs::read(path).map_err(file_error("read", path))?;
        let content = content(path, &bytes)?;
        check_program(path, &content.program, program)?;
        let part = content.part.ok_or_else(|| damaged(path, "it names no part"))?;
        let place = |(name, raw): (String, &RawValue)| {
            let header = serde_json::from_str(raw.get()).map_err(|error| damaged(path, error))?;
            let start = raw.get().as_ptr() as usize - bytes.as_ptr() as usize;
            let bytes = start..start + raw.get().len();
            Ok((name, Place { path: path.to_owned(), header, bytes }))
        };
        let works = content.works.into_iter().map(place).collect::<Result<_, JobError>>()?;
        Ok(Self { part, works })
    }
}

impl Place {
    /// The piece of work, read from the file.
    pub fn entry(&self) -> Result<Entry, JobError> {
        use io::{Read, Seek};
        let mut bytes = vec![0; self.bytes.len()];
        let read = |bytes: &mut [u8]| -> io::Result<()> {
            let mut file = fs::File::open(&self.path)?;
            file.seek(io::SeekFrom::Start(self.bytes.start as u64))?;
            file.read_exact(bytes)
        };
        read(&mut bytes).map_err(file_error("read", &self.path))?;
        let entry: Entry = serde_json::from_slice(&bytes).map_err(|_| self.changed())?;
        if entry.header == self.header { Ok(entry) } else { Err(self.changed()) }
    }

    fn changed(&self) -> JobError {
        JobError::Replaced(self.path.clone())
    }
}

/// The bytes of a file, if there is one.
fn read(path: &Path) -> Result<Option<Vec<u8>>, JobError> {
    match fs::read(path) {
        Ok(bytes) => Ok(Some(bytes)),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
        Err(error) => Err(file_error("read", path)(error)),
    }
}

/// The content of a file whose checksum is right.
fn content<'a>(path: &Path, bytes: &'a [u8]) -> Result<Content<Raw<'a>>, JobError> {
    let opened: Opened<'a> = serde_json::from_slice(bytes).map_err(|error| damaged(path, error))?;
    if checksum(opened.content.get().as_bytes()) != opened.sha256 {
        return Err(damaged(path, "its checksum is wrong"));
    }
    let content: Content<Raw<'a>> =
        serde_json::from_str(opened.content.get()).map_err(|error| damaged(path, error))?;
    match content.schema {
        SCHEMA => Ok(content),
        other => Err(foreign(path, "the file", "format", other, SCHEMA)),
    }
}

fn check_program(path: &Path, found: &Program, here: &Program) -> Result<(), JobError> {
    match (found.name == here.name, found.version == here.version) {
        (true, true) => Ok(()),
        (true, false) => Err(foreign(path, "it", "version", &found.version, &here.version)),
        (false, _) => Err(foreign(path, "it", "program", &found.name, &here.name)),
    }
}

pub fn foreign(
    path: &Path,
    work: &str,
    what: &'static str,
    found: impl ToString,
    here: impl ToString,
) -> JobError {
    let (path, work) = (path.to_owned(), work.to_owned());
    JobError::Foreign { path, work, what, found: found.to_string(), here: here.to_string() }
}

pub fn damaged(path: &Path, found: impl ToString) -> JobError {
    JobError::Damaged { path: path.to_owned(), found: found.to_string() }
}

pub fn file_error(action: &'static str, path: &Path) -> impl FnOnce(io::Error) -> JobError {
    move |source| JobError::File { action, path: path.to_owned(), source }
}
