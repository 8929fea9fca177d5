//! Failed paths.

use noise::StreamKey;
use serde::{Deserialize, Serialize};

/// The reason why a path failed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, thiserror::Error)]
pub enum Cause {
    /// The solver found no solution of the implicit step.
    #[error("no solution found, residual {residual:e}")]
    NoSolution {
        /// ‖z − ψ(z)‖₁ at the last iterate.
        residual: f64,
    },
    /// The state is NaN or infinite.
    #[error("the state is not finite")]
    NotFinite,
}

impl Cause {
    /// The reason of a failed step with this residual, which is infinite if the state is not
    /// finite.
    pub(crate) fn of_residual(residual: f64) -> Self {
        if residual == f64::INFINITY { Self::NotFinite } else { Self::NoSolution { residual } }
    }
}

/// A failed path, with everything needed to replay it. Statistics exclude it from this time on.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "path {path} (seed {}, experiment {}): {scheme}{} at tau = {tau}, step {step}, t = {}: {cause}",
    key.seed,
    key.experiment,
    if *swapped { ", increments exchanged," } else { "" },
    *step as f64 * tau
)]
pub struct PathFailure {
    /// Number of the path; of Sobol points 2³² times the scramble plus the point.
    pub path: u64,
    /// The key of its random streams.
    pub key: StreamKey,
    /// Identifier of the scheme.
    pub scheme: &'static str,
    /// Whether the run was swapped, see [`Run`](crate::Run).
    pub swapped: bool,
    /// The step size.
    pub tau: f64,
    /// The number of the failed step, counted from zero.
    pub step: u64,
    /// The reason.
    pub cause: Cause,
}
