//! Errors of studies.

use crate::LadderError;

/// An invalid study, detected before the first step.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StudyError {
    /// A setting is out of range, missing or given twice. The text says which.
    #[error("{0}")]
    Setting(String),
    /// The scheme cannot be run on these steps.
    #[error(transparent)]
    Ladder(#[from] LadderError),
}
