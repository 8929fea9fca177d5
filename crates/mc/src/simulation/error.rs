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
}
