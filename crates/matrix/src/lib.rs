//! Stochastic Lie–Poisson systems of Hermitian matrices, whose Casimirs of all degrees are kept.
//!
//! The equation is dW = (−i\[∇H₀(W), W\] − γW)dt − iΣ\[Lₘ, W\] ∘ dWₘ. Steps are W⁺ = CWC* with a
//! unitary C between two halves of exact damping, so that the spectrum of W, and each tr Wᵏ, is on
//! its law e^{−k∫γ} to round-off: see [`Scheme`]. Products and equations of matrices are those of
//! [faer](https://docs.rs/faer). The bits are those of a processor, on any number of threads.
//!
//! ```
//! use std::sync::Arc;
//! use matrix::{InCoordinates, Scheme, Sphere, Stirring, setup};
//! use mc::Simulation;
//! use noise::{StreamKey, Truncation};
//! use systems::{Constant, run_time::Problem};
//!
//! // Euler's equations on the sphere with transport noise of degree 2.
//! let fluid = Arc::new(Sphere::new(8, 0.0, 1.0, Stirring::isotropic(2, 0.3))?);
//! let mut w = vec![Default::default(); 64];
//! fluid.harmonics().add(&mut w, 2, 0, 1.0);
//! fluid.harmonics().add(&mut w, 2, 1, 1.0);
//! let mut y0 = vec![0.0; 64];
//! matrix::coordinates(8, &w, |i, y| y0[i] = y);
//! let system = InCoordinates::new(Arc::clone(&fluid));
//! let problem = Problem::new(Arc::new(system), Arc::new(Constant::new(0.1)?), y0, 1.0)?;
//! let setup = setup(&problem, fluid, Scheme::Explicit);
//! let simulation = Simulation::new(setup, Truncation::none());
//! let paths = simulation.paths(64, StreamKey { seed: 1, experiment: 0 }, 0..2)?;
//! assert!(paths[1].column("C3 defect").unwrap().iter().all(|defect| defect.abs() < 1e-12));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! | item | purpose |
//! |---|---|
//! | [`MatrixSystem`], [`InCoordinates`] | a system, and what problems take |
//! | [`Scheme`], [`OnMatrices`], [`setup`] | schemes that keep the spectrum |
//! | [`Sphere`], [`Stirring`], [`Harmonics`], [`Grid`] | fluids on a sphere |
//! | [`SuSpins`] | spins with N levels on a lattice, with a heat bath |
//! | [`Quantum`], [`pure`] | quantum systems with classical noise |
//! | [`Function`] | functions of matrices, such as energies |
//!
//! A state has N² real components for each matrix, for which ‖W‖² is the Euclidean one:
//! [`coordinates`]. Every driver and statistic takes it, and so do schemes for any system, such as
//! `heun`, which keep no spectrum.

mod dense;
mod functions;
mod quantum;
mod scheme;
mod sphere;
mod spins;
mod system;

use std::sync::Arc;

use mc::{Problem, Setup};
use systems::run_time;

pub use faer::c64;
pub use functions::Function;
pub use quantum::Quantum;
pub use scheme::{OnMatrices, Scheme};
pub use sphere::{Grid, Harmonics, Sphere, Stirring, bracket_scale, gauss};
pub use spins::{SpinCouplings, SuSpins};
pub use system::{
    InCoordinates, MatrixSystem, bracket, coordinates, dimension, inner, matrices, pure, traces,
};

/// A problem of a system in coordinates, with a scheme on its matrices.
pub fn setup<'a>(
    problem: &'a run_time::Problem,
    system: Arc<dyn MatrixSystem + 'a>,
    scheme: Scheme,
) -> Setup<'a> {
    let scheme = Arc::new(OnMatrices { system, scheme });
    Setup { problem: Problem::at_run_time(problem), scheme }
}
