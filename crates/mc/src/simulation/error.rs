//! Errors of simulations.

use crate::LadderError;

/// An invalid simulation, detected before the first step.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SimulationError {
    /// The steps, the truncation or the areas are invalid.
    #[error(transparent)]
    Ladder(#[from] LadderError),
    /// k = 0 where every k-th step is saved.
    #[error("to save every k-th step, k must be at least 1, got k = 0")]
    Every,
    /// Two columns have the same name.
    #[error("two columns have the name {name:?}; rename the observable")]
    Column {
        /// The name.
        name: String,
    },
    /// A recording does not end at the final time.
    #[error(
        "the recorded increments must end at the final time T = {t_end} of the problem, got \
         {recorded}"
    )]
    Duration {
        /// The end of the recording.
        recorded: f64,
        /// The final time of the problem.
        t_end: f64,
    },
    /// The scheme reads Lévy areas and the recording has none.
    #[error(
        "{scheme} reads Levy areas: the recording must have the columns A12, A13, ..., got \
         increments only"
    )]
    NoAreas {
        /// The scheme.
        scheme: &'static str,
    },
}
