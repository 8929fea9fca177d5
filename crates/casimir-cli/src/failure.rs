//! Why the program does not end with success, and its exit code.

use std::{error::Error, fmt::Display, process::ExitCode};

use casimir::mc::{RunError, parts::JobError};

use crate::scene::SceneError;

/// What ended the program early.
#[derive(Debug)]
pub struct Failure {
    code: u8,
    words: String,
}

/// The result of a command.
pub type Done<T = ()> = Result<T, Failure>;

impl Failure {
    /// The command line asks for what cannot be.
    pub fn usage(words: impl Display) -> Self {
        Self { code: 2, words: format!("error: {words}") }
    }

    /// The run failed.
    pub fn run(words: impl Display) -> Self {
        Self { code: 1, words: format!("error: {words}") }
    }

    /// It was stopped by a signal. The words say what is kept.
    pub fn stopped(words: impl Display) -> Self {
        Self { code: 130, words: format!("stopped: {words}") }
    }

    /// Prints it on the standard error and gives the exit code.
    pub fn report(self) -> ExitCode {
        eprintln!("{}", self.words);
        ExitCode::from(self.code)
    }
}

/// A scene or an argument is wrong, or else the run failed.
impl<E: Error + 'static> From<E> for Failure {
    fn from(error: E) -> Self {
        let any: &dyn Error = &error;
        let argument = matches!(any.downcast_ref(), Some(JobError::Argument(_)));
        let setting = matches!(any.downcast_ref(), Some(RunError::Setting(_)));
        match argument || setting || any.is::<SceneError>() {
            true => Self::usage(error),
            false => Self::run(error),
        }
    }
}
