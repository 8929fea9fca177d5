//! The statements of the paper that are measured on their own.

use crate::statement::Statement;

/// In the order of the paper.
pub const STATEMENTS: &[Statement] = &[];
