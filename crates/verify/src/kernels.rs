//! **The kernels of the paper, each compiled once.**
//!
//! [`schemes`] are generic over the system, so each crate that runs one compiles its block kernel
//! anew, three times, for three instruction sets. This module does it for the systems of the paper
//! and the schemes that its panels need, behind [`Scheme`] as an object. The numbers are the same:
//! these are the schemes of [`schemes`] and nothing else.
//!
//! ```
//! use noise::Noise;
//! use schemes::{Scheme, Sexp, Step};
//! use systems::paper::pendulum;
//!
//! let problem = pendulum();
//! let step = Step::new(problem.damping(), 0, 0.01)?;
//! let noise = Noise::increments([0.1]);
//! let (system, y0) = (problem.system(), problem.y0());
//! let compiled = verify::compiled(Sexp).step(system, &step, &noise, y0);
//! let generic = Sexp.step(system, &step, &noise, y0);
//! assert_eq!(compiled.z, generic.z);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! A system of your own needs none of this: take its schemes from [`schemes`].

use schemes::{EulerMaruyama, Midpoint, Nv, Scheme, Sexp, SexpLevy, SexpLi, Split};
use systems::{
    IntegerExponents, LotkaVolterra, MaxwellBloch, Pendulum, Poisson3, PoissonSystem, RigidBody,
    RigidBodyEnergy,
};

use crate::TwoSpins;

/// A system for which the scheme F is compiled here.
pub trait Compiled<F, const D: usize, const M: usize>: PoissonSystem<D, M> + Sized {
    /// The scheme as an object.
    fn compiled(scheme: F) -> Box<dyn Scheme<Self, D, M>>;
}

/// A scheme as an object, compiled here.
pub fn compiled<F, S: Compiled<F, D, M>, const D: usize, const M: usize>(
    scheme: F,
) -> Box<dyn Scheme<S, D, M>> {
    S::compiled(scheme)
}

/// A system of the paper, for which its three schemes are compiled and those without iteration.
pub trait PaperSystem<const D: usize, const M: usize>:
    Compiled<Sexp, D, M>
    + Compiled<EulerMaruyama, D, M>
    + Compiled<Midpoint, D, M>
    + Compiled<SexpLi, D, M>
{
    /// `split` and `nv`, where the system is a sum of parts with known flows.
    fn by_parts() -> Option<[Box<dyn Scheme<Self, D, M>>; 2]>;
}

// Not inlined: a caller that sees the constructor would compile what it constructs.
macro_rules! compiled {
    ($($scheme:ident { $($system:ty, $d:literal, $m:literal;)+ })+) => {$($(
        impl Compiled<$scheme, $d, $m> for $system {
            #[inline(never)]
            fn compiled(scheme: $scheme) -> Box<dyn Scheme<Self, $d, $m>> {
                Box::new(scheme)
            }
        }
    )+)+};
}

macro_rules! systems_of_the_paper {
    ($($by_parts:expr => { $($system:ty, $d:literal, $m:literal;)+ })+) => {$($(
        compiled! {
            Sexp { $system, $d, $m; }
            EulerMaruyama { $system, $d, $m; }
            Midpoint { $system, $d, $m; }
            SexpLi { $system, $d, $m; }
        }
        impl PaperSystem<$d, $m> for $system {
            #[inline(never)]
            fn by_parts() -> Option<[Box<dyn Scheme<Self, $d, $m>>; 2]> {
                $by_parts
            }
        }
    )+)+};
}

systems_of_the_paper! {
    Some([Box::new(Split), Box::new(Nv::of_parts())]) => {
        Pendulum, 2, 1;
        RigidBody<1>, 3, 1;
        RigidBody<3>, 3, 3;
        RigidBodyEnergy, 3, 1;
        MaxwellBloch, 3, 1;
        Poisson3, 3, 1;
    }
    None => {
        LotkaVolterra<IntegerExponents<1, 1>>, 3, 1;
        LotkaVolterra<IntegerExponents<2, 2>>, 3, 1;
    }
}
compiled! {
    Sexp { TwoSpins, 6, 3; }
    SexpLevy { RigidBody<3>, 3, 3; TwoSpins, 6, 3; }
}
