//! What the command lines of all programs share.

use std::{fmt::Display, process::ExitCode};

use real::Level;

/// Reads the value of `--simd`: `baseline`, `avx2` or `avx512`.
///
/// # Errors
/// A sentence, when there is no such instruction set or this build or machine does not have it:
/// kernels would run on a narrower one, and a time would be that of something else.
///
/// ```
/// use real::Level;
///
/// let built = Level::BUILT[0];
/// assert_eq!(verify::command::simd(built.name()), Ok(built));
/// assert!(verify::command::simd("mmx").is_err());
/// ```
pub fn simd(name: &str) -> Result<Level, String> {
    let available = Level::BUILT.iter().filter(|level| **level <= Level::available());
    let names: Vec<_> = available.clone().map(|level| level.name()).collect();
    let found = available.copied().find(|level| level.name() == name);
    found.ok_or_else(|| format!("this machine does not have it, only {}", names.join(", ")))
}

/// The exit code of a program: its own, or 2 after the error has been printed.
pub fn exit_code<E: Display>(result: Result<ExitCode, E>) -> ExitCode {
    result.unwrap_or_else(|error| {
        eprintln!("error: {error:#}");
        ExitCode::from(2)
    })
}
