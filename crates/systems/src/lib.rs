//! **Damped stochastic Poisson systems, defined by two formulas: B(y)·v and the Hamiltonian
//! increment.**
//!
//! The equation is dy = (B(y)∇H₀(y) − γ(t)y) dt + Σₘ B(y)∇Hₘ(y) ∘ dWₘ (Stratonovich) with a
//! skew-symmetric B. A [`PoissonSystem`] defines B(y)v and h(y) = H₀(y)dt + Σₘ Hₘ(y)dwₘ, generic
//! over the number type. Gradients, discrete gradients, Itô corrections and Jacobians follow from
//! them. A [`Damping`] gives γ and its integral. A [`Problem`] adds an initial value and a final
//! time.
//!
//! The way through the crate: two formulas (`system`) → what follows from them (`field`, `cayley`,
//! `linearity`) → [`run_time::Compiled`], a [`run_time::System`] with a
//! [`Description`](run_time::Description) and operations ([`Op`](run_time::Op)) on rows. Lattices
//! and formulas are such systems from the start. [`Flows`] are exact solutions of parts.
//!
//! ```
//! use systems::{Constant, PoissonSystem, Problem, real::Real};
//!
//! /// A harmonic oscillator with a random frequency.
//! struct Oscillator;
//! impl PoissonSystem<2, 1> for Oscillator {
//!     fn name(&self) -> &'static str {
//!         "oscillator"
//!     }
//!     #[inline(always)]
//!     fn structure<R: Real>(&self, _y: [R; 2], v: [R; 2]) -> [R; 2] {
//!         [-v[1], v[0]]
//!     }
//!     #[inline(always)]
//!     fn energy<R: Real>(&self, y: [R; 2], dt: f64, dw: [f64; 1]) -> R {
//!         (y[0] * y[0] + y[1] * y[1]) * (0.5 * dt) + y[1] * y[1] * (0.5 * dw[0])
//!     }
//! }
//! let problem = Problem::new(Oscillator, Constant::new(0.1)?, [1.0, 0.0], 1.0)?;
//! assert_eq!(problem.system().gradient([1.0, 2.0], 0.5, [0.25]), [0.5, 1.5]);
//! assert!(Problem::new(Oscillator, Constant::new(0.1)?, [f64::NAN, 0.0], 1.0).is_err());
//! # Ok::<(), systems::SystemError>(())
//! ```
//!
//! | item | purpose |
//! |---|---|
//! | [`PoissonSystem`] | B(y)v, h(y), and what follows from them |
//! | [`vector_field`], [`vector_field_derivative`], [`ito_correction`] | f = B∇h, f′v, ½Σ fₘ′fₘ |
//! | [`area_gradient`], [`jacobi_holds`] | Σ A_ml ∇{Hₘ, H_l}, and whether −B times it is Σ A_ml [fₘ, f_l] |
//! | [`is_quadratic`] | whether ∇h is affine, from its formula |
//! | [`noises_commute`] | whether [fₘ, f_l] = 0, so that Lévy areas are not needed |
//! | [`Damping`] | γ(t) and ∫γ |
//! | [`Invariant`] | a Casimir or an energy with its conformal law |
//! | [`Problem`] | system, damping, initial value and final time |
//! | [`probe`] | how the crates above look at a system |
//! | [`run_time`] | systems whose dimension is known at run time |
//! | [`paper`] | the problems of Bréhier, Cohen and Komori (2025) |
//!
//! Dampings: [`Constant`], [`Linear`], [`Sine`], [`Cosine`], [`DampingFunction`]. Systems:
//! [`Pendulum`], [`RigidBody`], [`RigidBodyEnergy`], [`LotkaVolterra`], [`MaxwellBloch`],
//! [`Poisson3`] (Bréhier, Cohen and Komori 2025). Spins on lattices: [`lattice`].

pub use real;

mod cayley;
mod damping;
mod error;
mod field;
mod flows;
mod invariant;
pub mod lattice;
mod linearity;
mod lotka_volterra;
mod maxwell_bloch;
pub mod paper;
mod pendulum;
mod poisson3;
mod problem;
mod rigid_body;
pub mod run_time;
mod system;

pub use damping::{Constant, Cosine, Damping, DampingFunction, Harmonic, Linear, Sine};
pub use error::{SystemError, finite};
pub use field::{
    HamiltonianIncrement, area_gradient, is_quadratic, ito_correction, jacobi_holds,
    noises_commute, unit_noise, vector_field, vector_field_derivative,
};
pub use flows::Flows;
pub use invariant::{Form, Invariant, InvariantKind};
pub use linearity::{Linearity, always_solvable, linearity};
pub use lotka_volterra::LotkaVolterra;
pub use maxwell_bloch::MaxwellBloch;
pub use pendulum::Pendulum;
pub use poisson3::Poisson3;
pub use problem::Problem;
pub use rigid_body::{RigidBody, RigidBodyEnergy};
pub use system::{ImplicitStep, PoissonSystem};

/// How the crates above look at a system: points around a state, what vanishes there, integrals of
/// a rate.
pub mod probe {
    pub use crate::{
        damping::{RateIntegrals, rate_integrals},
        field::{around, vanish},
        flows::TRIPLE_JUMP,
        linearity::shown_solvable,
    };
}
