//! The output folder: found unwritable before any computing, written without half-finished files.

use std::fs;
use std::io::Write;
use std::path::Path;

use anyhow::{Context, Result};
use tempfile::{Builder, NamedTempFile};

/// Creates the folder and checks that a file can be written into it.
pub fn prepare(dir: &Path) -> Result<()> {
    fs::create_dir_all(dir)
        .with_context(|| format!("cannot create the output folder {}", dir.display()))?;
    NamedTempFile::new_in(dir)
        .with_context(|| format!("cannot write into the output folder {}", dir.display()))?;
    Ok(())
}

/// Replaces a file in one step: a reader sees the old file or the new one, whenever this is
/// interrupted.
pub fn write(path: &Path, content: &[u8]) -> Result<()> {
    let folder = path.parent().unwrap_or_else(|| Path::new("."));
    let mut builder = Builder::new();
    // Temporary files are private by default; a report is for everybody whom the umask admits.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let write = || -> Result<()> {
        let mut file = builder.tempfile_in(folder)?;
        file.write_all(content)?;
        file.persist(path)?;
        Ok(())
    };
    write().with_context(|| format!("cannot write {}", path.display()))
}
