//! Errors of recorded noise.

use std::fmt;

/// Why noise is not a recording. Lines and columns are those of the table, counted from 1.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum RecordingError {
    /// There is no step.
    Empty,
    /// A name of the header is not the one that belongs there.
    Header {
        /// Number of the column.
        column: usize,
        /// What is there.
        found: String,
        /// What should be there.
        expected: String,
    },
    /// A line has too few or too many columns.
    Columns {
        /// Number of the line.
        line: usize,
        /// Its columns.
        found: usize,
        /// The columns that it should have.
        expected: usize,
    },
    /// An entry is not a number.
    NotANumber {
        /// Number of the line.
        line: usize,
        /// Name of the column.
        column: String,
        /// The entry.
        text: String,
    },
    /// An increment or an area is NaN or infinite.
    NotFinite {
        /// Number of the line.
        line: usize,
        /// Name of the column.
        column: String,
        /// The value.
        value: f64,
    },
    /// A step size is not positive and finite.
    StepSize {
        /// Number of the line.
        line: usize,
        /// The step size.
        tau: f64,
    },
    /// A step has another size than the first.
    UnequalSteps {
        /// Number of the line.
        line: usize,
        /// Its step size.
        tau: f64,
        /// That of the first step.
        first: f64,
    },
    /// The areas are not one matrix for each step.
    AreaRows {
        /// Matrices of areas.
        found: usize,
        /// Steps.
        expected: usize,
    },
}

impl fmt::Display for RecordingError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Empty => write!(f, "a recording must have at least one step, got none"),
            Self::Header { column, found, expected } => {
                write!(f, "line 1, column {column}: the header must say {expected}, got {found:?}")
            }
            Self::Columns { line, found, expected } => {
                write!(f, "line {line}: expected {expected} columns, got {found}")
            }
            Self::NotANumber { line, column, text } => {
                write!(f, "line {line}, column {column}: expected a number, got {text:?}")
            }
            Self::NotFinite { line, column, value } => {
                write!(f, "line {line}, column {column}: an increment must be finite, got {value}")
            }
            Self::StepSize { line, tau } => {
                write!(
                    f,
                    "line {line}, column tau: a step size must be positive and finite, got {tau}"
                )
            }
            Self::UnequalSteps { line, tau, first } => {
                write!(
                    f,
                    "line {line}, column tau: all steps must have the size of the first, \
                     {first}, got {tau}"
                )
            }
            Self::AreaRows { found, expected } => {
                write!(
                    f,
                    "there must be one matrix of areas for each of {expected} steps, got {found}"
                )
            }
        }
    }
}

impl std::error::Error for RecordingError {}
