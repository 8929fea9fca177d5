//! Options that the command lines of all programs share.

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
