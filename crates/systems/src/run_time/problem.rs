//! A system known at run time with its damping, initial value and final time.

use std::sync::Arc;

use super::System;
use crate::{Damping, SystemError};

/// An initial value problem for dy = (B∇H₀ − γy)dt + Σₘ B∇Hₘ ∘ dWₘ on [0, T], checked at
/// construction.
#[derive(Clone)]
pub struct Problem {
    system: Arc<dyn System>,
    damping: Arc<dyn Damping>,
    y0: Vec<f64>,
    t_end: f64,
}

/// An invalid problem.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ProblemError {
    /// The initial value has another number of components than the system.
    #[error("the initial value must have {dimension} components, got {components}")]
    Dimension {
        /// The dimension of the system.
        dimension: usize,
        /// The number of components given.
        components: usize,
    },
    /// The initial value or the final time is invalid.
    #[error(transparent)]
    System(#[from] SystemError),
}

impl Problem {
    /// The problem with y(0) = `y0` on [0, `t_end`].
    ///
    /// # Errors
    /// [`ProblemError::Dimension`], and those of [`Problem::new`](crate::Problem::new).
    pub fn new(
        system: Arc<dyn System>,
        damping: Arc<dyn Damping>,
        y0: Vec<f64>,
        t_end: f64,
    ) -> Result<Self, ProblemError> {
        let (dimension, components) = (system.description().dimension, y0.len());
        if components != dimension {
            return Err(ProblemError::Dimension { dimension, components });
        }
        if let Some(i) = y0.iter().position(|component| !component.is_finite()) {
            return Err(SystemError::NonFiniteState { component: i + 1, value: y0[i] }.into());
        }
        system.check_domain(&y0)?;
        if !(t_end > 0.0 && t_end.is_finite()) {
            return Err(SystemError::FinalTime { t_end }.into());
        }
        Ok(Self { system, damping, y0, t_end })
    }

    /// The system.
    #[must_use]
    pub fn system(&self) -> &dyn System {
        &*self.system
    }

    /// The damping γ.
    #[must_use]
    pub fn damping(&self) -> &dyn Damping {
        &*self.damping
    }

    /// The initial value y(0).
    #[must_use]
    pub fn y0(&self) -> &[f64] {
        &self.y0
    }

    /// The final time T.
    #[must_use]
    pub fn t_end(&self) -> f64 {
        self.t_end
    }
}
