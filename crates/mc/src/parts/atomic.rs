//! Files that are replaced whole or not at all.

use std::{
    fs, io,
    io::Write,
    path::{Path, PathBuf},
    time::{Duration, SystemTime},
};

use tempfile::Builder;

/// Suffix of the names of temporary files.
const TEMPORARY: &str = ".casimir";
/// Age from which on an unchanged temporary file is of a process that was killed.
const STALE: Duration = Duration::from_secs(600);

/// The folder of a file.
pub fn folder(file: &Path) -> &Path {
    file.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or_else(|| Path::new("."))
}

/// Prefix of the names of temporary files of `file`.
fn prefix(file: &Path) -> String {
    format!(".{}.", file.file_name().unwrap_or_default().to_string_lossy())
}

/// Replaces a file in one step: a reader sees the old file or the new one, whenever this is
/// interrupted, and after a power failure too.
///
/// # Errors
/// When it cannot be written; the old file is then still there.
pub fn replace(file: &Path, content: &[u8]) -> io::Result<()> {
    replace_by(file, |to| to.write_all(content))
}

/// Replaces a file in one step by the content that `write` writes; see [`replace`].
pub fn replace_by(
    file: &Path,
    write: impl FnOnce(&mut fs::File) -> io::Result<()>,
) -> io::Result<()> {
    let mut builder = Builder::new();
    // Temporary files are private by default; this one is for everybody whom the umask admits.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder.suffix(TEMPORARY);
    let mut temporary = builder.prefix(&prefix(file)).tempfile_in(folder(file))?;
    write(temporary.as_file_mut())?;
    temporary.as_file().sync_all()?;
    temporary.persist(file)?;
    // The new name is durable when the folder is. Not every file system can do that.
    let _ = fs::File::open(folder(file)).and_then(|folder| folder.sync_all());
    Ok(())
}

/// Removes temporary files of `file`, which no other process writes.
pub fn tidy(file: &Path) {
    remove_temporary(folder(file), &prefix(file), Duration::ZERO);
}

/// Removes temporary files that processes left in a folder when they were killed.
pub fn tidy_folder(folder: &Path) {
    remove_temporary(folder, ".", STALE);
}

/// Removes temporary files whose names begin with `prefix`, and whose age is `age` or more.
fn remove_temporary(folder: &Path, prefix: &str, age: Duration) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        let modified = || entry.metadata().and_then(|data| data.modified());
        let is_old = |time: SystemTime| time.elapsed().is_ok_and(|since| since >= age);
        if name.starts_with(prefix) && name.ends_with(TEMPORARY) && modified().is_ok_and(is_old) {
            _ = fs::remove_file(entry.path());
        }
    }
}

/// A lock that ends with the process, however that ends.
#[derive(Debug)]
pub struct Lock {
    _file: fs::File,
    /// Whether no other process can have the lock. Not every file system can say so.
    pub is_sole: bool,
}

impl Lock {
    /// Locks `file`, which it creates and in which it writes who holds it. `Err` has the holder if
    /// another process has it. On file systems without locks everybody gets one: two processes with
    /// the same part write the same bits, so that only time is lost.
    pub fn take(file: &PathBuf) -> io::Result<Result<Self, String>> {
        let options = fs::OpenOptions::new().read(true).write(true).create(true).clone();
        let mut opened = options.open(file)?;
        let is_sole = match opened.try_lock() {
            Ok(()) => true,
            Err(fs::TryLockError::Error(_)) => false,
            Err(fs::TryLockError::WouldBlock) => {
                let holder = fs::read_to_string(file).unwrap_or_default();
                return Ok(Err(if holder.is_empty() { "another process".into() } else { holder }));
            }
        };
        opened.set_len(0)?;
        let job = std::env::var("SLURM_JOB_ID").map(|job| format!(" of Slurm job {job}"));
        write!(opened, "process {}{}", std::process::id(), job.unwrap_or_default())?;
        Ok(Ok(Self { _file: opened, is_sole }))
    }
}
