//! A system with its damping, initial value and final time.

use crate::{
    Damping, PoissonSystem, SystemError,
    error::{final_time, finite_state},
};

/// An initial value problem for dy = (B∇H₀ − γy) dt + Σₘ B∇Hₘ ∘ dWₘ on [0, T], checked at
/// construction.
#[derive(Clone, Debug)]
pub struct Problem<S, G, const D: usize> {
    /// The system: B and H₀ … H_M.
    system: S,
    /// The damping rate γ.
    damping: G,
    /// The initial value y(0).
    y0: [f64; D],
    /// The final time T.
    t_end: f64,
}

impl<S, G: Damping, const D: usize> Problem<S, G, D> {
    /// The problem with y(0) = `y0` on [0, `t_end`].
    ///
    /// # Errors
    /// [`SystemError`] for an invalid initial value, [`SystemError`]
    /// unless 0 < `t_end` < ∞.
    pub fn new<const M: usize>(
        system: S,
        damping: G,
        y0: [f64; D],
        t_end: f64,
    ) -> Result<Self, SystemError>
    where
        S: PoissonSystem<D, M>,
    {
        finite_state(&y0)?;
        system.check_domain(y0)?;
        Ok(Self { system, damping, y0, t_end: final_time(t_end)? })
    }

    /// Problem with the final time changed to `t_end`.
    ///
    /// # Errors
    /// [`SystemError`] unless 0 < `t_end` < ∞.
    pub fn until(self, t_end: f64) -> Result<Self, SystemError> {
        Ok(Self { t_end: final_time(t_end)?, ..self })
    }
}

impl<S, G, const D: usize> Problem<S, G, D> {
    /// The system.
    #[must_use]
    pub fn system(&self) -> &S {
        &self.system
    }

    /// The damping γ.
    #[must_use]
    pub fn damping(&self) -> &G {
        &self.damping
    }

    /// The initial value y(0).
    #[must_use]
    pub fn y0(&self) -> [f64; D] {
        self.y0
    }

    /// System, damping, initial value and final time.
    #[must_use]
    pub fn into_parts(self) -> (S, G, [f64; D], f64) {
        (self.system, self.damping, self.y0, self.t_end)
    }

    /// The final time T.
    #[must_use]
    pub fn t_end(&self) -> f64 {
        self.t_end
    }
}
