//! What the command lines of all programs share.

use std::fmt::Display;
use std::process::ExitCode;

use real::Level;

/// Reads the value of `--simd`: `baseline`, `avx2` or `avx512`.
///
/// # Errors
/// A sentence, when there is no such instruction set or this machine does not have it: kernels
/// would run on a narrower one, and a time would be that of something else.
///
/// ```
/// use real::Level;
///
/// assert_eq!(lab::command::simd("baseline"), Ok(Level::Baseline));
/// assert!(lab::command::simd("mmx").is_err());
/// ```
pub fn simd(name: &str) -> Result<Level, String> {
    level_up_to(Level::available(), name)
}

fn level_up_to(available: Level, name: &str) -> Result<Level, String> {
    let levels = [Level::Baseline, Level::Avx2, Level::Avx512];
    let names = |levels: &[Level]| levels.iter().map(|level| level.name()).collect::<Vec<_>>();
    match levels.iter().find(|level| level.name() == name) {
        None => Err(format!("the instruction sets are {}", names(&levels).join(", "))),
        Some(&level) if level > available => {
            let has: Vec<Level> = levels.into_iter().filter(|&level| level <= available).collect();
            Err(format!("this machine does not have it, only {}", names(&has).join(", ")))
        }
        Some(&level) => Ok(level),
    }
}

/// The exit code of a program: its own, or 2 after the error has been printed.
pub fn exit_code<E: Display>(result: Result<ExitCode, E>) -> ExitCode {
    result.unwrap_or_else(|error| {
        eprintln!("error: {error:#}");
        ExitCode::from(2)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_instruction_set_that_the_machine_lacks_is_refused() {
        assert_eq!(level_up_to(Level::Avx2, "avx2"), Ok(Level::Avx2));
        let refused = level_up_to(Level::Avx2, "avx512");
        assert_eq!(refused, Err("this machine does not have it, only baseline, avx2".to_owned()));
        assert!(level_up_to(Level::Avx512, "AVX2").is_err());
    }
}
