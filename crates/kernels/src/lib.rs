//! **The built-in schemes on the paper's systems, each kernel compiled once.**
//!
//! [`schemes`] are generic over the system, so each crate that runs one compiles its block kernel
//! anew, for three instruction sets. This crate does it for the systems of the paper, behind
//! [`Scheme`] as an object, for the program and the panels. The numbers are the same: these are the
//! schemes of [`BuiltIn`] and nothing else.
//!
//! ```
//! use kernels::Tuned;
//! use noise::Noise;
//! use schemes::{BuiltIn, Scheme, Sexp, Step};
//! use systems::paper::pendulum;
//!
//! let problem = pendulum();
//! let step = Step::new(problem.damping(), 0, 0.01)?;
//! let noise = Noise::increments([0.1]);
//! let (system, y0) = (problem.system(), problem.y0());
//! let compiled = Tuned::scheme(BuiltIn::Sexp, system, y0)?.step(system, &step, &noise, y0);
//! let generic = Sexp.step(system, &step, &noise, y0);
//! assert_eq!(compiled.z, generic.z);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! [`Tuned`] is all there is. A system of your own needs none of this: take its schemes from
//! [`schemes`].

use schemes::{BuiltIn, Scheme, SchemeError};
use systems::{
    LotkaVolterra, MaxwellBloch, Pendulum, Poisson3, PoissonSystem, RigidBody, RigidBodyEnergy,
};

/// A system whose built-in schemes are compiled once, where this trait is implemented.
pub trait Tuned<const D: usize, const M: usize>: PoissonSystem<D, M> {
    /// The scheme on the system, as [`BuiltIn::by_parts`] makes it where flows are known, and else
    /// [`BuiltIn::compiled`].
    ///
    /// # Errors
    /// [`SchemeError`] if the scheme does not apply to the system.
    fn scheme(
        scheme: BuiltIn,
        system: &Self,
        y0: [f64; D],
    ) -> Result<Box<dyn Scheme<Self, D, M>>, SchemeError>;
}

// Not inlined: a caller that sees the constructor would compile what it constructs.
macro_rules! tuned {
    ($($constructor:ident { $($system:ty, $d:literal, $m:literal;)+ })+) => {$($(
        impl Tuned<$d, $m> for $system {
            #[inline(never)]
            fn scheme(
                scheme: BuiltIn,
                system: &Self,
                y0: [f64; $d],
            ) -> Result<Box<dyn Scheme<Self, $d, $m>>, SchemeError> {
                scheme.$constructor(system, y0)
            }
        }
    )+)+};
}

tuned! {
    by_parts {
        Pendulum, 2, 1;
        RigidBody<1>, 3, 1;
        RigidBody<3>, 3, 3;
        RigidBodyEnergy, 3, 1;
        MaxwellBloch, 3, 1;
        Poisson3, 3, 1;
    }
    compiled {
        LotkaVolterra<1, 1>, 3, 1;
        LotkaVolterra<2, 2>, 3, 1;
    }
}
