//! **The kernels of the paper, each compiled once.**
//!
//! [`schemes`] are generic over the system, so each crate that runs one compiles its block kernel
//! anew, three times, for three instruction sets. This module does it for the systems of the paper,
//! behind objects. The numbers are the same: these are the schemes of [`schemes`] and nothing else.
//!
//! ```
//! use noise::Noise;
//! use schemes::{BuiltIn, Scheme, Sexp, Step};
//! use systems::paper::pendulum;
//! use verify::PaperSystem;
//!
//! let problem = pendulum();
//! let step = Step::new(problem.damping(), 0, 0.01)?;
//! let noise = Noise::increments([0.1]);
//! let (system, y0) = (problem.system(), problem.y0());
//! let compiled = system.compiled(BuiltIn::Sexp, y0).expect("it is compiled");
//! assert_eq!(compiled.step(system, &step, &noise, y0).z, Sexp.step(system, &step, &noise, y0).z);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! A system of your own needs none of this: take its schemes from [`schemes`].

use mc::{Setup, bind_owned};
use schemes::{BuiltIn, Scheme};
use systems::{
    Damping, IntegerExponents, LotkaVolterra, MaxwellBloch, Pendulum, Poisson3, PoissonSystem,
    Problem, RigidBody, RigidBodyEnergy,
};

use crate::TwoSpins;

/// A system for which schemes are compiled here.
pub trait PaperSystem<const D: usize, const M: usize>: PoissonSystem<D, M> + Sized {
    /// The scheme, if it is compiled for this system.
    fn compiled(&self, scheme: BuiltIn, y0: [f64; D]) -> Option<Box<dyn Scheme<Self, D, M>>>;
}

macro_rules! new {
    (Nv, $system:expr, $y0:expr) => {
        schemes::Nv::of_parts()
    };
    (SexpLevy, $system:expr, $y0:expr) => {
        schemes::SexpLevy::new($system, $y0)
    };
    (SexpLi, $system:expr, $y0:expr) => {
        schemes::SexpLi::new($system, $y0).ok()?
    };
    (SexpLiLevy, $system:expr, $y0:expr) => {
        schemes::SexpLi::with_areas($system, $y0).ok()?
    };
    ($scheme:ident, $system:expr, $y0:expr) => {
        schemes::$scheme
    };
}

// Not inlined: a caller that sees the constructors would compile what they construct.
macro_rules! compiled {
    ($($system:ty, $d:literal, $m:literal: $($scheme:ident)+;)+) => {$(
        impl PaperSystem<$d, $m> for $system {
            #[inline(never)]
            fn compiled(
                &self,
                scheme: BuiltIn,
                _y0: [f64; $d],
            ) -> Option<Box<dyn Scheme<Self, $d, $m>>> {
                $(if scheme == BuiltIn::$scheme {
                    return Some(Box::new(new!($scheme, self, _y0)));
                })+
                None
            }
        }
    )+};
}

compiled! {
    Pendulum, 2, 1: Sexp SexpLi Split Nv Midpoint Heun EulerMaruyama;
    RigidBody<1>, 3, 1: Sexp SexpLi Split Nv Midpoint Heun EulerMaruyama;
    RigidBody<3>, 3, 3: Sexp SexpLevy SexpLi SexpLiLevy Split Nv Midpoint Heun EulerMaruyama;
    RigidBodyEnergy, 3, 1: Sexp SexpLi Split Nv Midpoint EulerMaruyama;
    MaxwellBloch, 3, 1: Sexp SexpLi Split Nv Midpoint Heun EulerMaruyama;
    Poisson3, 3, 1: Sexp SexpLi Split Nv Midpoint Heun EulerMaruyama;
    LotkaVolterra<IntegerExponents<1, 1>>, 3, 1: Sexp SexpLi Midpoint Heun EulerMaruyama;
    LotkaVolterra<IntegerExponents<2, 2>>, 3, 1: Sexp SexpLi Midpoint EulerMaruyama;
    TwoSpins, 6, 3: Sexp SexpLevy;
}

/// A problem of any dimension with the schemes that are compiled for its system.
pub struct Compiled<'a> {
    /// The problem.
    pub problem: mc::Problem<'a>,
    setup: Box<dyn Fn(BuiltIn) -> Option<Setup<'a>> + 'a>,
}

/// A scheme on the problem of a figure, with the name of its curve.
pub struct Curve<'a> {
    /// The name.
    pub name: &'static str,
    /// The scheme in the registry.
    pub method: BuiltIn,
    /// The problem with the scheme.
    pub setup: Setup<'a>,
}

impl<'a> Compiled<'a> {
    /// Those for this problem.
    pub fn of<S: PaperSystem<D, M>, G: Damping, const D: usize, const M: usize>(
        problem: &'a Problem<S, G, D>,
    ) -> Self {
        let setup = |scheme| {
            let scheme = problem.system().compiled(scheme, problem.y0())?;
            let scheme = bind_owned(problem, scheme);
            Some(Setup { problem: mc::Problem::of(problem), scheme })
        };
        Self { problem: mc::Problem::of(problem), setup: Box::new(setup) }
    }

    /// A curve for each of the schemes that is compiled for the system.
    pub fn curves(&self, schemes: &[BuiltIn]) -> Vec<Curve<'a>> {
        let curve = |&method: &BuiltIn| {
            Some(Curve { name: method.id(), method, setup: (self.setup)(method)? })
        };
        schemes.iter().filter_map(curve).collect()
    }

    /// The problem with `sexp`, which is compiled for every system.
    pub fn sexp(&self) -> Setup<'a> {
        (self.setup)(BuiltIn::Sexp).expect("sexp is compiled for every system")
    }
}
