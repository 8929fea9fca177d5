//! What the command lines of all programs share.

use std::{fmt::Display, process::ExitCode};

use comfy_table::{CellAlignment, Table, presets::ASCII_MARKDOWN};
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
    one_of(&available.copied().collect::<Vec<_>>(), name)
}

fn one_of(levels: &[Level], name: &str) -> Result<Level, String> {
    levels.iter().copied().find(|level| level.name() == name).ok_or_else(|| {
        let has = levels.iter().map(|level| level.name()).collect::<Vec<_>>().join(", ");
        format!("this machine does not have it, only {has}")
    })
}

/// A table for the terminal, whose columns from number `first_number` on are numbers.
pub fn table<const N: usize>(
    header: [&str; N],
    first_number: usize,
    rows: impl IntoIterator<Item = [String; N]>,
) -> Table {
    let mut table = Table::new();
    table.load_style(ASCII_MARKDOWN).set_header(header).add_rows(rows);
    for column in table.column_iter_mut().skip(first_number) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    table
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
        let two = &[Level::Baseline, Level::Avx2];
        assert_eq!(one_of(two, "avx2"), Ok(Level::Avx2));
        let refused = one_of(two, "avx512");
        assert_eq!(refused, Err("this machine does not have it, only baseline, avx2".to_owned()));
        assert!(one_of(two, "AVX2").is_err());
    }
}
