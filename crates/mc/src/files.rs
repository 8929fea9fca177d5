//! Files that are written whole or not at all, into folders that are checked before the computing.

use std::{
    fs,
    io::{Error, Result, Write},
    path::Path,
    time::Duration,
};

use serde::Serialize;
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

/// Replaces a file in one step by the content that `write` writes: a reader sees the old file or
/// the new one, whenever this is interrupted, and after a power failure too.
pub(crate) fn replace_by(
    file: &Path,
    write: impl FnOnce(&mut fs::File) -> Result<()>,
) -> Result<()> {
    let mut builder = Builder::new();
    // Temporary files are private by default; this one is for everybody whom the umask admits.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let mut temporary =
        builder.prefix(&prefix(file)).suffix(TEMPORARY).tempfile_in(folder(file))?;
    write(temporary.as_file_mut())?;
    temporary.as_file().sync_all()?;
    temporary.persist(file)?;
    // The new name is durable when the folder is. Not every file system can do that.
    let _ = fs::File::open(folder(file)).and_then(|folder| folder.sync_all());
    Ok(())
}

/// Removes temporary files of `file`, which no other process writes.
pub(crate) fn tidy(file: &Path) {
    remove_temporary(folder(file), &prefix(file), Duration::ZERO);
}

/// Removes temporary files whose names begin with `prefix`, and whose age is `age` or more.
fn remove_temporary(folder: &Path, prefix: &str, age: Duration) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let file = entry.file_name();
        let name = file.to_string_lossy();
        let unchanged = || entry.metadata()?.modified()?.elapsed().map_err(Error::other);
        if name.starts_with(prefix)
            && name.ends_with(TEMPORARY)
            && unchanged().is_ok_and(|since| since >= age)
        {
            _ = fs::remove_file(entry.path());
        }
    }
}

fn named(what: &str, path: &Path) -> impl FnOnce(Error) -> Error {
    move |error| Error::new(error.kind(), format!("cannot {what} {}: {error}", path.display()))
}

/// Creates a folder and checks that a file can be written into it. Files that killed processes left
/// there are removed.
///
/// # Errors
/// When it cannot; the error names the folder.
pub fn prepare(folder: &Path) -> Result<()> {
    fs::create_dir_all(folder).map_err(named("create the output folder", folder))?;
    remove_temporary(folder, ".", STALE);
    let file = folder.join(".casimir");
    replace_by(&file, |to| to.write_all(b"\n"))
        .map_err(named("write into the output folder", folder))?;
    // Or another process has done that.
    _ = fs::remove_file(file);
    Ok(())
}

/// Checks that a folder can be created and written, and leaves nothing that was not there.
///
/// # Errors
/// When it cannot be created or written; the error names the folder.
pub fn check(folder: &Path) -> Result<()> {
    let new: Vec<&Path> = folder.ancestors().take_while(|folder| !folder.exists()).collect();
    let checked = prepare(folder);
    new.iter().for_each(|folder| drop(fs::remove_dir(folder)));
    checked
}

/// Replaces a file in one step: a reader sees the old file or the new one, whenever this is
/// interrupted, and after a power failure too.
///
/// # Errors
/// When it cannot be written; the error names the file, and the old one is still there.
pub fn write(file: &Path, content: impl AsRef<[u8]>) -> Result<()> {
    replace_by(file, |to| to.write_all(content.as_ref())).map_err(named("write", file))
}

/// Writes a value as indented JSON.
///
/// # Errors
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
