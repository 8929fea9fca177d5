//! Paths that were left out.

use std::fmt;

use noise::StreamKey;

/// Why a path was left out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cause {
    /// Neither solver found a solution of the implicit step.
    NoSolution {
        /// ‖z − ψ(z)‖₁ where the robust solver stopped.
        residual: f64,
    },
    /// The state is NaN or infinite.
    NotFinite,
}

impl Cause {
    /// Why a step failed, from its residual: infinite where the state itself is not finite.
    pub(crate) fn of_residual(residual: f64) -> Self {
        if residual == f64::INFINITY { Self::NotFinite } else { Self::NoSolution { residual } }
    }
}

impl fmt::Display for Cause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoSolution { residual } => write!(f, "no solution found, residual {residual:e}"),
            Self::NotFinite => write!(f, "the state is not finite"),
        }
    }
}

/// A path that was left out of every statistic from some time on: enough to replay it alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathFailure {
    /// Number of the path in its family of streams.
    pub path: u64,
    /// The family of streams.
    pub key: StreamKey,
    /// The scheme that failed.
    pub scheme: &'static str,
    /// Whether it ran on exchanged increments, see [`Run`](crate::Run).
    pub swapped: bool,
    /// Its step size.
    pub tau: f64,
    /// The step that failed, counted from zero; for a state that was found not finite, the last
    /// step before.
    pub step: u64,
    /// Why.
    pub cause: Cause,
}

impl fmt::Display for PathFailure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { path, key, scheme, swapped, tau, step, cause } = self;
        let swapped = if *swapped { ", increments exchanged," } else { "" };
        write!(
            f,
            "path {path} (seed {}, experiment {}): {scheme}{swapped} at tau = {tau}, step {step}, t = {}: ",
            key.seed,
            key.experiment,
            *step as f64 * tau
        )?;
        cause.fmt(f)
    }
}
