//! The lock of a part.

use std::{fs, io, io::Write, path::PathBuf};

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
        let mut opened =
            fs::File::options().read(true).write(true).create(true).truncate(false).open(file)?;
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
