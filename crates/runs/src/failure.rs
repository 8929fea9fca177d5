//! Why a command does not end with success.

use std::error::Error;

use casimir::mc::{MemoryError, RunError, parts::JobError};

use scenes::SceneError;

/// The reason why a command ended early.
#[derive(Debug)]
pub enum Failure {
    /// The scene is wrong.
    Scene(SceneError),
    /// A request that cannot be met.
    Usage(String),
    /// The run failed.
    Run(String),
    /// A signal stopped the command. The words say what is kept.
    Stopped(String),
}

/// The result of a command.
pub type Done<T = ()> = Result<T, Failure>;

/// Refuses a request that cannot be met.
///
/// # Errors
/// Always: [`Failure::Usage`].
pub fn refuse<T>(words: impl Into<String>) -> Done<T> {
    Err(Failure::Usage(words.into()))
}

/// A scene or an argument is wrong, or else the run failed.
impl<E: Error + 'static> From<E> for Failure {
    fn from(error: E) -> Self {
        let (any, words): (&dyn Error, _) = (&error, error.to_string());
        match any.downcast_ref::<SceneError>() {
            Some(error) => Self::Scene(error.clone()),
            None if any.is::<MemoryError>()
                || matches!(any.downcast_ref(), Some(JobError::Argument(_)))
                || matches!(
                    any.downcast_ref(),
                    Some(RunError::Setting(_) | RunError::Memory(_))
                ) =>
            {
                Self::Usage(words)
            }
            None => Self::Run(words),
        }
    }
}
