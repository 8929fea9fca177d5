//! A system known at run time with its damping, initial value and final time.

use std::sync::Arc;

use super::System;
use crate::{
    Damping, SystemError,
    error::{final_time, finite_state},
};

/// An initial value problem for dy = (B∇H₀ − γy)dt + Σₘ B∇Hₘ ∘ dWₘ on [0, T], checked at
/// construction.
#[derive(Clone)]
pub struct Problem {
    system: Arc<dyn System>,
    damping: Arc<dyn Damping>,
    y0: Vec<f64>,
    t_end: f64,
}

impl Problem {
    /// The problem with y(0) = `y0` on [0, `t_end`].
    ///
    /// # Errors
    /// [`SystemError`], and those of [`Problem::new`](crate::Problem::new).
    pub fn new(
        system: Arc<dyn System>,
        damping: Arc<dyn Damping>,
        y0: Vec<f64>,
        t_end: f64,
    ) -> Result<Self, SystemError> {
        let (dimension, components) = (system.description().dimension, y0.len());
        if components != dimension {
            return Err(SystemError(format!(
                "the initial value must have {dimension} components, got {components}"
            )));
        }
        finite_state(&y0)?;
        system.check_domain(&y0)?;
        Ok(Self { system, damping, y0, t_end: final_time(t_end)? })
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
