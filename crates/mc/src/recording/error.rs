//! Errors of recorded noise.

/// Why noise is not a recording. Lines and columns are those of the table, counted from 1.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RecordingError {
    /// There is no step.
    #[error("a recording must have at least one step, got none")]
    Empty,
    /// A name of the header is not the one that belongs there.
    #[error("line 1, column {column}: the header must say {expected}, got {found:?}")]
    Header {
        /// Number of the column.
        column: usize,
        /// What is there.
        found: String,
        /// What should be there.
        expected: String,
    },
    /// A line has too few or too many columns.
    #[error("line {line}: expected {expected} columns, got {found}")]
    Columns {
        /// Number of the line.
        line: usize,
        /// Its columns.
        found: usize,
        /// The columns that it should have.
        expected: usize,
    },
    /// An entry is not a number.
    #[error("line {line}, column {column}: expected a number, got {text:?}")]
    NotANumber {
        /// Number of the line.
        line: usize,
        /// Name of the column.
        column: String,
        /// The entry.
        text: String,
    },
    /// An increment or an area is NaN or infinite.
    #[error("line {line}, column {column}: an increment must be finite, got {value}")]
    NotFinite {
        /// Number of the line.
        line: usize,
        /// Name of the column.
        column: String,
        /// The value.
        value: f64,
    },
    /// A step size is not positive and finite.
    #[error("line {line}, column tau: a step size must be positive and finite, got {tau}")]
    StepSize {
        /// Number of the line.
        line: usize,
        /// The step size.
        tau: f64,
    },
    /// A step has another size than the first.
    #[error(
        "line {line}, column tau: all steps must have the size of the first, {first}, got \
         {tau}"
    )]
    UnequalSteps {
        /// Number of the line.
        line: usize,
        /// Its step size.
        tau: f64,
        /// That of the first step.
        first: f64,
    },
    /// The areas are not one matrix for each step.
    #[error("there must be one matrix of areas for each of {expected} steps, got {found}")]
    AreaRows {
        /// Matrices of areas.
        found: usize,
        /// Steps.
        expected: usize,
    },
}
