//! The folder of results.

use std::path::{Path, PathBuf};

use casimir::plot::files;
use casimir_cli::failure::{Done, Failure};

/// The folder of results: the one asked for, or `<scene>-<command>` here; prepared.
pub fn of(out: Option<PathBuf>, scene: &Path, command: &str) -> Done<PathBuf> {
    let folder = named(out, scene, command);
    prepare(&folder)?;
    Ok(folder)
}

/// The same as it is.
pub fn named(out: Option<PathBuf>, scene: &Path, command: &str) -> PathBuf {
    let stem = scene.file_stem().unwrap_or_default().to_string_lossy();
    out.unwrap_or_else(|| format!("{stem}-{command}").into())
}

/// Checks that a folder can be written, and says which results it has that will be replaced.
pub fn prepare(folder: &Path) -> Done {
    if folder.exists() && !folder.is_dir() {
        let folder = folder.display();
        return Err(Failure::Run(format!("{folder} is a file: name a folder with --out")));
    }
    let replaces = folder.join(REPORT).exists();
    files::prepare(folder)?;
    if replaces {
        eprintln!("note: the results in {} will be replaced", folder.display());
    }
    Ok(())
}

/// The report in a folder.
pub const REPORT: &str = "index.html";
