//! What the command lines of all programs share.

use std::{fmt::Display, process::ExitCode};

use comfy_table::{CellAlignment, Row, Table, presets::ASCII_MARKDOWN};
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
    let names = || available.clone().map(|level| level.name());
    let found = available.clone().find(|level| level.name() == name).copied();
    let refused = || {
        format!("this machine does not have it, only {}", names().collect::<Vec<_>>().join(", "))
    };
    found.ok_or_else(refused)
}

/// A table for the terminal, whose columns from number `first_number` on are numbers.
pub fn table(
    header: impl Into<Row>,
    first_number: usize,
    rows: impl IntoIterator<Item = impl Into<Row>>,
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
