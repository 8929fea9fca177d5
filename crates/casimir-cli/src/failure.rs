//! Why the program does not end with success, and its exit code.

use std::process::ExitCode;

use casimir::mc::parts::JobError;

use crate::scene::SceneError;

/// What ended the program early.
#[derive(Debug)]
pub enum Failure {
    /// The scene is wrong: exit code 2.
    Scene(Box<SceneError>),
    /// The command line asks for what cannot be: exit code 2.
    Usage(String),
    /// The run failed: exit code 1.
    Run(anyhow::Error),
    /// It was stopped by a signal: exit code 130. The words say what is kept.
    Stopped(String),
}

/// The result of a command.
pub type Done<T = ()> = Result<T, Failure>;

impl Failure {
    /// Prints it on the standard error and gives the exit code.
    pub fn report(self) -> ExitCode {
        let (code, words) = match self {
            Self::Scene(error) => (2, format!("error: {error}")),
            Self::Usage(words) => (2, format!("error: {words}")),
            Self::Run(error) => (1, format!("error: {error:#}")),
            Self::Stopped(words) => (130, format!("stopped: {words}")),
        };
        eprintln!("{words}");
        ExitCode::from(code)
    }
}

impl From<SceneError> for Failure {
    fn from(error: SceneError) -> Self {
        Self::Scene(Box::new(error))
    }
}

impl From<anyhow::Error> for Failure {
    fn from(error: anyhow::Error) -> Self {
        Self::Run(error)
    }
}

impl From<std::io::Error> for Failure {
    fn from(error: std::io::Error) -> Self {
        Self::Run(error.into())
    }
}

impl From<serde_json::Error> for Failure {
    fn from(error: serde_json::Error) -> Self {
        Self::Run(error.into())
    }
}

impl From<JobError> for Failure {
    fn from(error: JobError) -> Self {
        match error {
            JobError::Argument(words) => Self::Usage(words),
            other => Self::Run(other.into()),
        }
    }
}
