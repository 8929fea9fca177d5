//! Checkpoints: unfinished work in a file, to go on from.
//!
//! A SHA-256, and in postcard what it is of: the version of the format, the program with its input,
//! and the work. Every number comes back to the bit. A file that is damaged or of another input is
//! refused, never overwritten.

use std::{
    collections::HashSet,
    fmt::Display,
    fs,
    io::{self, BufWriter, Seek, Write},
    path::{Path, PathBuf},
    sync::Mutex,
    time::{Duration, Instant},
};

use serde::{Deserialize, Serialize, de::DeserializeOwned};
use sha2::{Digest, Sha256};

use crate::{
    files::{folder, replace_by},
    parallel::locked,
    parts::JobError,
};

/// The version of the format.
const FORMAT: u32 = 8;
/// Bytes of a SHA-256.
const SUM: usize = 32;
/// Default time between checkpoints.
const INTERVAL: Duration = Duration::from_secs(2);
/// Least time between checkpoints, in multiples of the time that the last one took.
const RARELY: u32 = 50;

/// The program that computes, and what it computes.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Program {
    /// Name of the program.
    pub name: String,
    /// Version of the program: work of different versions is not mixed.
    pub version: String,
    /// All that the results depend on, in lines: formulas, numbers, settings. Files of another
    /// input are refused with the first lines that differ. A number of paths does not belong here
    /// if more may be asked for later.
    pub input: String,
}

/// A file for unfinished work.
#[derive(Debug)]
pub struct Checkpoint {
    file: PathBuf,
    program: Program,
    /// Time between checkpoints, two seconds unless set; writing takes a fiftieth of the time at
    /// most.
    pub interval: Duration,
    state: Mutex<State>,
}

#[derive(Debug)]
struct State {
    written: Instant,
    takes: Duration,
    failure: Option<String>,
}

impl Checkpoint {
    /// A checkpoint of `program` in `file`, written every two seconds, but for a fiftieth of the
    /// time at most.
    pub fn new(file: impl Into<PathBuf>, program: Program) -> Self {
        let state = State { written: Instant::now(), takes: Duration::ZERO, failure: None };
        Self { file: file.into(), program, interval: INTERVAL, state: Mutex::new(state) }
    }

    /// A checkpoint of the same program in another file of the folder.
    pub(crate) fn beside(&self, name: &str) -> Self {
        Self::new(self.file.with_file_name(name), self.program.clone())
    }

    /// Path of the file.
    pub fn file(&self) -> &Path {
        &self.file
    }

    /// Whether the file has work to resume.
    ///
    /// # Errors
    /// [`JobError`] if the file cannot be read, is damaged, or is of another program or input.
    pub fn holds(&self) -> Result<bool, JobError> {
        Ok(self.read::<()>()?.is_some())
    }

    /// Reads the work in the file; `None` if there is no file.
    ///
    /// # Errors
    /// As [`holds`](Self::holds).
    pub fn read<T: DeserializeOwned>(&self) -> Result<Option<T>, JobError> {
        let bytes = match fs::read(&self.file) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
            read => read.map_err(file_error("read", &self.file))?,
        };
        let (_, content) = bytes
            .split_at_checked(SUM)
            .filter(|(sum, content)| Sha256::digest(content)[..] == **sum)
            .ok_or_else(|| damaged(&self.file, "its checksum is wrong"))?;
        let unreadable = |error: postcard::Error| damaged(&self.file, error);
        let (format, rest) = postcard::take_from_bytes::<u32>(content).map_err(unreadable)?;
        if format != FORMAT {
            let (found, here) = (format!("format {format}"), format!("format {FORMAT}"));
            return Err(foreign(&self.file, &found, &here));
        }
        let (found, work) = postcard::take_from_bytes::<Program>(rest).map_err(unreadable)?;
        let Program { name, version, input } = &self.program;
        if (&found.name, &found.version) != (name, version) {
            let found = format!("{} {}", found.name, found.version);
            return Err(foreign(&self.file, &found, &format!("{name} {version}")));
        }
        if found.input != *input {
            let [found, here] = [(&found.input, input), (input, &found.input)].map(only);
            return Err(foreign(&self.file, &found, &here));
        }
        postcard::from_bytes(work).map(Some).map_err(unreadable)
    }

    /// Replaces the file in one step.
    ///
    /// # Errors
    /// [`JobError::File`] if it cannot be written. Until it can be,
    /// [`failure`](Self::failure) says so.
    pub fn write(&self, work: &impl Serialize) -> Result<(), JobError> {
        let begun = Instant::now();
        let content = (FORMAT, &self.program, work);
        let write = |file: &mut fs::File| {
            file.write_all(&[0; SUM])?;
            let to = Summed { file: BufWriter::new(file), sum: Sha256::new() };
            let to = postcard::to_io(&content, to).map_err(io::Error::other)?;
            let (sum, file) = (to.sum.finalize(), to.file.into_inner()?);
            file.rewind()?;
            file.write_all(&sum)
        };
        let written = fs::create_dir_all(folder(&self.file))
            .and_then(|()| replace_by(&self.file, write))
            .map_err(file_error("write", &self.file));
        let mut state = locked(&self.state);
        // After a failure, too: a disk that is full is not asked again after every wave.
        (state.written, state.takes) = (Instant::now(), begun.elapsed());
        state.failure = written.as_ref().err().map(ToString::to_string);
        written
    }

    /// Removes the file, when the work is done.
    pub fn remove(&self) {
        _ = fs::remove_file(&self.file);
    }

    /// Reason why the last write failed, if it did.
    pub fn failure(&self) -> Option<String> {
        locked(&self.state).failure.clone()
    }

    /// Whether the next write is due.
    pub fn is_due(&self) -> bool {
        let State { written, takes, .. } = &*locked(&self.state);
        written.elapsed() >= self.interval.max(RARELY * *takes)
    }
}

/// A file with the SHA-256 of the bytes written.
struct Summed<'a> {
    file: BufWriter<&'a mut fs::File>,
    sum: Sha256,
}

impl Write for Summed<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = self.file.write(bytes)?;
        self.sum.update(&bytes[..written]);
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

/// Error of a damaged file.
pub fn damaged(file: &Path, why: impl Display) -> JobError {
    let file = file.display();
    let remedy = "move it away: this work, or this part, begins anew";
    JobError::Refused(format!("{file} is damaged: {why}; {remedy}"))
}

/// Error of a file of another computation, with `found` in the file and `here` in this program.
pub fn foreign(file: &Path, found: &str, here: &str) -> JobError {
    let file = file.display();
    JobError::Refused(format!(
        "{file} is of another computation: it has\n  {found}\nand here is\n  {here}\nGo on with \
         what it has, take another folder, or move the file away to begin anew"
    ))
}

/// The first line that one text has and the other has not.
fn only((text, other): (&String, &String)) -> String {
    let known: HashSet<&str> = other.lines().collect();
    let line = text.lines().find(|line| !known.contains(line));
    line.map_or("nothing else, or another order".into(), str::to_owned)
}

/// The first 16 bytes of the SHA-256 of a value, in hexadecimal. A value that cannot be serialized
/// is refused when sums are tried before the computing.
pub fn hash(value: &impl Serialize) -> String {
    let sum = Sha256::digest(postcard::to_stdvec(value).unwrap_or_default());
    sum[..16].iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Makes the error of an `action` on a file from its cause.
pub fn file_error(action: &'static str, path: &Path) -> impl FnOnce(io::Error) -> JobError {
    move |source| JobError::File { action, path: path.to_owned(), source }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(input: &str) -> Program {
        Program { input: input.into(), ..Program::default() }
    }

    #[test]
    fn what_differs_is_said() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("kept/work.bin");
        let here = Checkpoint::new(&file, of("a = 1\nb = 2\n"));
        assert_eq!(here.read::<u8>().unwrap(), None);
        here.write(&7u8).unwrap();
        assert_eq!((here.read::<u8>().unwrap(), here.holds().unwrap()), (Some(7), true));
        let newer = Program { version: "2".into(), ..of("a = 1\nb = 2\n") };
        let rows = [
            (of("a = 1\nb = 3\n"), "it has\n  b = 2\nand here is\n  b = 3\n"),
            (of("a = 1\n"), "it has\n  b = 2\nand here is\n  nothing else, or another order\n"),
            (of("b = 2\na = 1\n"), "another order"),
            (newer, "here is\n   2\n"),
        ];
        for (program, words) in rows {
            let refused = Checkpoint::new(&file, program).holds().unwrap_err().to_string();
            assert!(refused.contains(words), "{refused}");
        }
        here.remove();
        assert!(!here.holds().unwrap());
    }

    #[test]
    fn every_flipped_bit_and_every_cut_is_found() {
        let folder = tempfile::tempdir().unwrap();
        let here = Checkpoint::new(folder.path().join("work.bin"), of("a = 1"));
        here.write(&[1.5, 2.5]).unwrap();
        let whole = fs::read(here.file()).unwrap();
        let refuses = |bytes: &[u8]| {
            fs::write(here.file(), bytes).unwrap();
            let refused = here.read::<[f64; 2]>().unwrap_err().to_string();
            assert!(refused.contains("is damaged: its checksum is wrong"), "{refused}");
        };
        for bit in 0..8 * whole.len() {
            let mut bytes = whole.clone();
            bytes[bit / 8] ^= 1 << (bit % 8);
            refuses(&bytes);
        }
        (0..whole.len()).for_each(|length| refuses(&whole[..length]));
        // Another format, with a right checksum.
        let mut other = postcard::to_stdvec(&(FORMAT + 1)).unwrap();
        other.splice(0..0, Sha256::digest(&other).to_vec());
        fs::write(here.file(), other).unwrap();
        assert!(here.holds().unwrap_err().to_string().contains("format 8"));
    }

    #[test]
    fn a_file_that_cannot_be_written_is_told_until_it_can_be() {
        let folder = tempfile::tempdir().unwrap();
        let blocked = folder.path().join("blocked");
        fs::write(&blocked, "").unwrap();
        // Within a file, as in a folder.
        let here = Checkpoint::new(blocked.join("within"), of(""));
        assert!(here.write(&1u8).is_err());
        assert!(here.failure().is_some_and(|why| why.contains("cannot write")));
        fs::remove_file(&blocked).unwrap();
        here.write(&1u8).unwrap();
        assert!(here.failure().is_none() && here.holds().unwrap());
    }

    #[test]
    fn checkpoints_take_a_fiftieth_of_the_time_at_most() {
        let mut here = Checkpoint::new("work.bin", of(""));
        assert!(!here.is_due());
        here.interval = Duration::ZERO;
        assert!(here.is_due());
        here.state.get_mut().unwrap().takes = Duration::from_secs(60);
        assert!(!here.is_due());
    }
}
