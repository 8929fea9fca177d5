//! Files that are written whole or not at all, into folders that are checked before the computing.

use std::{
    fs,
    io::{Error, Result},
    path::Path,
};

pub use mc::parts::folder;
use serde::Serialize;

fn named(what: &str, path: &Path) -> impl FnOnce(Error) -> Error {
    move |error| Error::new(error.kind(), format!("cannot {what} {}: {error}", path.display()))
}

/// Creates a folder and checks that a file can be written into it. Files that killed processes left
/// there are removed.
///
/// # Errors
///
/// When it cannot; the error names the folder.
pub fn prepare(folder: &Path) -> Result<()> {
    fs::create_dir_all(folder).map_err(named("create the output folder", folder))?;
    mc::parts::tidy_folder(folder);
    let file = folder.join(".casimir");
    mc::parts::replace(&file, b"\n").map_err(named("write into the output folder", folder))?;
    // Or another process has done that.
    _ = fs::remove_file(file);
    Ok(())
}

/// Checks that a folder can be created and written, and leaves nothing that was not there.
///
/// # Errors
///
/// When it cannot be created or written; the error names the folder.
pub fn check(folder: &Path) -> Result<()> {
    let new: Vec<&Path> = folder.ancestors().take_while(|folder| !folder.exists()).collect();
    let checked = prepare(folder);
    new.iter().for_each(|folder| drop(fs::remove_dir(folder)));
    checked
}

/// Replaces a file in one step, as [`mc::parts::replace`] does: a reader sees the old file or the
/// new one, whenever this is interrupted.
///
/// # Errors
///
/// When it cannot be written; the error names the file.
pub fn write(file: &Path, content: impl AsRef<[u8]>) -> Result<()> {
    mc::parts::replace(file, content.as_ref()).map_err(named("write", file))
}

/// Writes a value as indented JSON.
///
/// # Errors
///
/// When the value cannot be serialized or the file cannot be written.
pub fn write_json(file: &Path, value: &impl Serialize) -> Result<()> {
    let mut json = serde_json::to_vec_pretty(value)?;
    json.push(b'\n');
    write(file, json)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_name_the_file() {
        assert_eq!(folder(Path::new("speed.json")), Path::new("."));
        let error = write(Path::new("/nowhere/at-all"), "text").unwrap_err();
        assert!(error.to_string().starts_with("cannot write /nowhere/at-all"), "{error}");
    }
}
