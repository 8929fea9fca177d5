//! Options that the command lines of all programs share.

use real::Simd;

/// Reads the value of `--simd`: `baseline`, `avx2` or `avx512`.
///
/// # Errors
/// A sentence, when there is no such instruction set or this build or machine does not have it:
/// kernels would run on a narrower one, and a time would be that of something else.
///
/// ```
/// use real::Simd;
///
/// let built = Simd::BUILT[0];
/// assert_eq!(verify::command::simd(built.name()), Ok(built));
/// assert!(verify::command::simd("mmx").is_err());
/// ```
pub fn simd(name: &str) -> Result<Simd, String> {
    let available = Simd::BUILT.iter().filter(|level| **level <= Simd::available());
    let names: Vec<_> = available.clone().map(|level| level.name()).collect();
    let found = available.copied().find(|level| level.name() == name);
    found.ok_or_else(|| format!("this machine does not have it, only {}", names.join(", ")))
}
