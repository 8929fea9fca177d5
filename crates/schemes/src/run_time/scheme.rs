//! Schemes for systems known at run time.

use real::OutOfMemory;
use systems::run_time::System;

use super::{explicit::ExplicitStepper, implicit::ImplicitStepper};
use crate::{Implicit, SexpLiError, Stepper};

/// A one-step method for systems whose dimension is known at run time. Every formula is one, with
/// the same formula as for compiled systems; see [`Explicit`](crate::Explicit) and [`Implicit`].
pub trait Scheme: Send + Sync {
    /// Identifier in results, for example `sexp`.
    fn id(&self) -> &'static str;

    /// Whether the driver truncates increments for this scheme.
    fn clips_increments(&self) -> bool;

    /// The state of 32 paths, or of one large path, that advances by this scheme.
    ///
    /// # Errors
    /// [`SchemeError`] if the scheme is not for the system, or memory is not there.
    fn stepper<'a>(&'a self, system: &'a dyn System) -> Result<Box<dyn Stepper + 'a>, SchemeError>;
}

/// A scheme that cannot be used for a system known at run time.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SchemeError {
    /// Lévy areas are drawn for compiled systems only.
    #[error(
        "{scheme} reads Lévy areas, which are drawn for compiled systems only; `{system}` has \
         {noises} noises and is known at run time: take sexp or sexp-li, of strong order 1/2"
    )]
    Areas {
        /// The scheme.
        scheme: &'static str,
        /// The system.
        system: String,
        /// The number of its noises.
        noises: usize,
    },
    /// The system has no parts with flows.
    #[error("split needs a sum of parts with flows, which `{system}` has not: {reason}")]
    Parts {
        /// The system.
        system: String,
        /// Why it has none.
        reason: String,
    },
    /// The scheme is not for the system.
    #[error(transparent)]
    System(#[from] SexpLiError),
    /// Averages of ∇h are computed tile by tile for quadratic h only.
    #[error(
        "∇̄h of `{system}`, whose h is not quadratic, cannot be computed in tiles: take midpoint, \
         or one tile"
    )]
    Average {
        /// The system.
        system: String,
    },
    /// Newton's method, which solves where fixed-point iteration does not, needs a derivative that
    /// is not known.
    #[error(
        "an implicit formula cannot have `cayley` or `ito_correction` of z, whose derivatives \
         along z are not known: take them of ẑ"
    )]
    Derivative,
    /// Rows of the system hold one path.
    #[error(
        "rows of `{system}` hold one path, and not 32: take `mc::LargePath`, or the layout of the \
         system for many paths"
    )]
    OnePath {
        /// The system.
        system: String,
    },
    /// There is no memory for the states.
    #[error(transparent)]
    Memory(#[from] OutOfMemory),
}

impl<F: Implicit> Scheme for F {
    fn id(&self) -> &'static str {
        F::ID
    }

    fn clips_increments(&self) -> bool {
        F::CLIPS_INCREMENTS
    }

    fn stepper<'a>(&'a self, system: &'a dyn System) -> Result<Box<dyn Stepper + 'a>, SchemeError> {
        if F::READS_AREAS && system.noises() > 1 {
            let (scheme, noises) = (F::ID, system.noises());
            return Err(SchemeError::Areas { scheme, system: system.name().into(), noises });
        }
        if F::EXPLICIT {
            return Ok(Box::new(ExplicitStepper::new(self, system)?));
        }
        Ok(Box::new(ImplicitStepper::new(self, system)?))
    }
}
