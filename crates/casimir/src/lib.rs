//! **Structure-preserving simulation of damped stochastic Poisson systems.**
//!
//! ```text
//! dy = (B(y)∇H₀(y) − γ(t)y) dt + Σₘ B(y)∇Hₘ(y) ∘ dWₘ,        B(y)ᵀ = −B(y)        (Stratonovich)
//! ```
//!
//! One dependency with everything that a program needs. A system is two formulas, B(y)·v and the
//! Hamiltonian increment; a scheme is one formula; the rest follows: vectorised ensembles, tables
//! of paths, expectations with error bars, measured orders, and a report on what the system is.
//!
//! ```
//! use casimir::prelude::*;
//! use casimir::systems::{Cosine, RigidBody};
//!
//! // A damped rigid body with three noises: its Casimir ½|y|² obeys exp(−2∫γ).
//! let body = RigidBody::three_noises([2.0, 1.0, 2.0 / 3.0], [1.0, 2.0, 3.0])?;
//! let problem = Problem::new(body, Cosine::new(0.5, 2.0)?, [0.45, 0.0, 0.89], 10.0)?;
//! let key = StreamKey { seed: 1, experiment: 0 };
//! let sexp = Sexp;
//! let path = Simulation::new(Setup::of(&problem, &sexp), Truncation::new(4)?).path(100, key, 0)?;
//! assert!(path.column("C defect").unwrap().iter().all(|defect| defect.abs() < 1e-13));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! - [`systems`]: [`PoissonSystem`](systems::PoissonSystem), damping, the systems of the paper,
//!   [`Problem`](systems::Problem).
//! - [`schemes`]: [`Sexp`](schemes::Sexp) and its peers; [`Explicit`](schemes::Explicit) and
//!   [`Implicit`](schemes::Implicit) for your own.
//! - [`mc`]: many paths with [`Simulation`](mc::Simulation), [`Study`](study::Study),
//!   [`Ladder`](mc::Ladder) and [`Expect`](expectation::Expect).
//! - [`lattice`]: one path of a large lattice of spins on all threads.
//! - [`analysis`]: [`inspect`](inspect::inspect()), [`strong_order`](analysis::strong_order),
//!   [`weak_order`](analysis::weak_order), and [`compare`](analysis::compare()), which says which
//!   scheme is cheapest for an error.
//! - [`formula`]: systems, dampings and observables from text; [`systems::run_time`] and
//!   [`schemes::run_time`] for any system whose dimension is known at run time.
//! - [`noise`], [`dgrad`], [`nonlin`], [`stats`], [`real`]: increments and Lévy areas, discrete
//!   gradients, implicit equations, fits of orders, numbers.
//! - `plot`, with the feature of that name: figures and pages; `figures` draws what is found.

#[cfg(feature = "plot")]
pub mod figures;

#[cfg(feature = "plot")]
pub use plot;
pub use {
    analysis, dgrad, expectation, formula, inspect, lattice, mc, noise, nonlin, real, schemes,
    stationary, stats, study, systems,
};

/// The names that most programs use: `use casimir::prelude::*`.
pub mod prelude {
    pub use analysis::{Candidates, CompareSettings, StepSizes, compare, strong_order};
    pub use inspect::{InspectSettings, inspect};
    pub use mc::{Observable, Setup, Simulation, StateFunction, bind, write_csv};
    pub use noise::{StreamKey, Truncation};
    pub use real::Real;
    pub use schemes::{Explicit, Heun, Implicit, Increment, Scheme, Sexp, SexpLevy, SexpLi, Split};
    pub use study::{Study, StudySettings};
    pub use systems::{Constant, Damping, PoissonSystem, Problem, run_time::Compiled};
}
