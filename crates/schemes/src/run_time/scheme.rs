//! Schemes for systems known at run time.

use systems::run_time::{Description, Lanes, System};

use super::stepper::FormulaStepper;
use crate::{About, Implicit, SchemeError, Stepper, kernel::about};

/// A one-step method for systems whose dimension is known at run time. Every formula is one, with
/// the same formula as for compiled systems; see [`Explicit`](crate::Explicit) and [`Implicit`].
pub trait Scheme: Send + Sync {
    /// Identifier, and what the scheme needs of a driver: areas only if there are several noises.
    fn about(&self) -> About;

    /// The state of 32 paths, or of one large path, that advances by this scheme.
    ///
    /// # Errors
    /// [`SchemeError`] if the scheme is not for the system, or an allocation fails.
    fn stepper<'a>(&'a self, system: &'a dyn System) -> Made<'a>;
}

/// The result of [`Scheme::stepper`].
pub type Made<'a> = Result<Box<dyn Stepper + 'a>, SchemeError>;

/// Checks that a system has what a scheme with Lévy areas needs.
fn check_areas(scheme: &'static str, system: &dyn System) -> Result<(), SchemeError> {
    let Description { name, noises, jacobi_holds, layout, plain, .. } = system.description();
    match (layout.lanes, jacobi_holds) {
        _ if *noises < 2 => Ok(()),
        (Lanes::Components, _) => Err(SchemeError(format!(
            "no Lévy areas are drawn for one large path, and {scheme} reads them: take sexp-li"
        ))),
        (Lanes::Paths, false) if *plain => {
            Err(SchemeError::not_for(scheme, name, "its noises are too many for Lévy areas"))
        }
        (Lanes::Paths, false) => Err(SchemeError::jacobi(scheme, name)),
        (Lanes::Paths, true) => Ok(()),
    }
}

impl<F: Implicit> Scheme for F {
    fn about(&self) -> About {
        about::<F>()
    }

    fn stepper<'a>(&'a self, system: &'a dyn System) -> Made<'a> {
        if F::READS_AREAS {
            check_areas(F::ID, system)?;
        }
        Ok(Box::new(FormulaStepper::new(self, system)?))
    }
}
