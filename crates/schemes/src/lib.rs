//! **The stochastic conformal exponential integrator, with and without Lévy areas, and classical
//! schemes for comparison.**
//!
//! A [`Scheme`] advances one path or a block of 32 paths by one step, with the same bits. [`Sexp`]
//! preserves the conformal law of linear and quadratic Casimirs exactly, and with one noise that of
//! homogeneous Hamiltonians. [`EulerMaruyama`], [`Heun`] and [`Midpoint`] do not. To define a
//! scheme, implement [`Explicit`], [`Implicit`] or [`Composition`].
//!
//! The way through the crate: a formula ([`Explicit`] or [`Implicit`], written against
//! [`Increment`]) → `kernel` (compiled systems: one path, or blocks of 32) or [`run_time`] (the
//! formula is recorded and run on rows). [`Split`] and [`Nv`] are each a
//! [`Composition`] of flows. [`Step`] has time and damping. [`BuiltIn`] is the registry of schemes.
//!
//! ```
//! use noise::Noise;
//! use schemes::{Scheme, Sexp, Step};
//! use systems::{Cosine, PoissonSystem, RigidBody};
//!
//! let body = RigidBody::three_noises([2.0, 1.0, 2.0 / 3.0], [1.0, 2.0, 3.0])?;
//! let damping = Cosine::new(0.5, 2.0)?;
//! let step = Step::new(&damping, 0, 0.1)?;
//! let y0 = [1.1f64.cos(), 0.0, 1.1f64.sin()];
//! let y1 = Sexp.step(&body, &step, &Noise::increments([0.2, -0.3, 0.1]), y0);
//!
//! // One step damps the Casimir ½|y|² by exp(−2∫γ) for every outcome of the noise.
//! let law = (-2.0 * step.damping_integral()).exp();
//! let ratio = body.invariant(0, y1.z) / body.invariant(0, y0);
//! assert!((ratio / law - 1.0).abs() < 1e-15);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! | scheme | kind | strong order for one / several noises |
//! |---|---|---|
//! | [`Sexp`] | implicit, exponential | 1 / ½ |
//! | [`SexpLevy`] | implicit, exponential, with Lévy areas | 1 / 1 |
//! | [`SexpLi`] | linearly implicit, exponential | 1 / ½ |
//! | [`Split`] | explicit, exponential | 1 / ½ |
//! | [`Nv`] | explicit, exponential, weak order 2 | 1 / ½ |
//! | [`Baoab`] | explicit, exponential, weak order 2 | 1 / 1, of noises that commute |
//! | [`SplitH`] | explicit, exponential, weak order 2 | 1.5 or 2, of noises that commute |
//! | [`SexpH`] | implicit, exponential, weak order 2 | 1.5 or 2, of noises that commute |
//! | [`Midpoint`] | implicit | 1 / ½ |
//! | [`Heun`] | explicit | 1 / ½ |
//! | [`HeunLevy`] | explicit, with Lévy areas | 1 / 1 |
//! | [`EulerMaruyama`] | explicit | ½ / ½ |
//!
//! A [`Method`] is a scheme on a system, of any dimension and with any number of noises.

mod baoab;
mod built_in;
mod chosen;
mod composition;
mod device;
mod em;
mod error;
mod formula;
mod heun;
mod heun_levy;
mod increment;
mod kernel;
mod listing;
mod method;
mod midpoint;
mod nv;
pub mod run_time;
mod scheme;
mod sexp;
mod sexp_levy;
mod sexp_li;
mod split;
mod split_h;
mod step;
mod with_solver;

pub use baoab::Baoab;
pub use built_in::{BuiltIn, Energy, Explicitness, Properties, StrongOrder};
pub use composition::{Composed, Composition, Paths, Times};
pub use device::{Device, Task, TaskRun, Trajectories};
pub use em::EulerMaruyama;
pub use error::SchemeError;
pub use formula::{Explicit, Implicit};
pub use heun::Heun;
pub use heun_levy::HeunLevy;
pub use increment::{Increment, Vector};
pub use listing::{Listing, Sweeps};
pub use method::{About, Method, Stepper};
pub use midpoint::Midpoint;
pub use nv::{Nv, Sweep};
/// Numbers that formulas are written for: an implementor needs no second dependency.
pub use real;
pub use scheme::Scheme;
pub use sexp::Sexp;
pub use sexp_levy::SexpLevy;
pub use sexp_li::SexpLi;
pub use split::Split;
pub use split_h::{SexpH, SplitH};
pub use step::{Step, StepError};
pub use with_solver::WithSolver;
