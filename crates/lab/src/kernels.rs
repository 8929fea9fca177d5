//! **Every scheme on every system of the paper, and on a pair of spins, compiled once.**
//!
//! [`schemes`] are generic over the system, so each crate that runs one compiles its block kernels
//! anew, three times, for three instruction sets. This module does it for the systems of
//! [`systems`], behind [`Scheme`] as an object, and those that run these systems link it. The
//! numbers are the same: these are the schemes of [`schemes`] and nothing else.
//!
//! ```
//! use lab::Compiled;
//! use schemes::{Scheme, Sexp, Step};
//! use systems::{Constant, Pendulum};
//!
//! let pendulum = Pendulum::new(1.0)?;
//! let step = Step::new(&Constant::new(2.0)?, 0, 0.01)?;
//! let compiled = Pendulum::sexp(Sexp::default()).step(&pendulum, &step, [0.1], [0.2, 1.0]);
//! assert_eq!(compiled.z, Sexp::default().step(&pendulum, &step, [0.1], [0.2, 1.0]).z);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! A system of your own needs none of this: take its schemes from [`schemes`].

use schemes::{EulerMaruyama, Heun, Midpoint, Scheme, Sexp, SexpLevy};
use systems::{
    IntegerExponents, LotkaVolterra, MaxwellBloch, Pendulum, Poisson3, PoissonSystem, RigidBody,
    RigidBodyEnergy, SpinChain,
};

/// A system for which the schemes are compiled here.
pub trait Compiled<const D: usize, const M: usize>: PoissonSystem<D, M> + Sized {
    /// The conformal exponential integrator.
    fn sexp(scheme: Sexp) -> Box<dyn Scheme<Self, D, M>>;
    /// The same with Lévy areas.
    fn sexp_levy(scheme: SexpLevy) -> Box<dyn Scheme<Self, D, M>>;
    /// The stochastic midpoint rule.
    fn midpoint(scheme: Midpoint) -> Box<dyn Scheme<Self, D, M>>;
    /// The stochastic Heun method.
    fn heun() -> Box<dyn Scheme<Self, D, M>>;
    /// Euler–Maruyama in the form of the paper.
    fn euler_maruyama() -> Box<dyn Scheme<Self, D, M>>;
}

// Not inlined: a caller that sees the constructor would compile what it constructs.
macro_rules! compiled {
    ($($system:ty, $d:literal, $m:literal;)+) => {$(
        impl Compiled<$d, $m> for $system {
            #[inline(never)]
            fn sexp(scheme: Sexp) -> Box<dyn Scheme<Self, $d, $m>> {
                Box::new(scheme)
            }
            #[inline(never)]
            fn sexp_levy(scheme: SexpLevy) -> Box<dyn Scheme<Self, $d, $m>> {
                Box::new(scheme)
            }
            #[inline(never)]
            fn midpoint(scheme: Midpoint) -> Box<dyn Scheme<Self, $d, $m>> {
                Box::new(scheme)
            }
            #[inline(never)]
            fn heun() -> Box<dyn Scheme<Self, $d, $m>> {
                Box::new(Heun)
            }
            #[inline(never)]
            fn euler_maruyama() -> Box<dyn Scheme<Self, $d, $m>> {
                Box::new(EulerMaruyama)
            }
        }
    )+};
}

compiled! {
    Pendulum, 2, 1;
    RigidBody<1>, 3, 1;
    RigidBody<3>, 3, 3;
    RigidBodyEnergy, 3, 1;
    LotkaVolterra<IntegerExponents<1, 1>>, 3, 1;
    LotkaVolterra<IntegerExponents<2, 2>>, 3, 1;
    MaxwellBloch, 3, 1;
    Poisson3, 3, 1;
    SpinChain<6>, 6, 3;
}
