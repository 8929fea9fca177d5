//! Why a command does not end with success.

use std::error::Error;

use casimir::mc::{MemoryError, RunError, parts::JobError};

use scenes::SceneError;

/// What ended a command early.
#[derive(Debug)]
pub enum Failure {
    /// The scene is wrong.
    Scene(SceneError),
    /// Something is asked for that cannot be.
    Usage(String),
    /// The run failed.
    Run(String),
    /// It was stopped by a signal. The words say what is kept.
    Stopped(String),
}

/// The result of a command.
pub type Done<T = ()> = Result<T, Failure>;

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
