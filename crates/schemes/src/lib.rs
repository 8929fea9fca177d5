//! **The conformal exponential integrator, with and without Lévy areas, and the schemes it is
//! compared with.**
//!
//! A [`Scheme`] advances one path or a block of 32 by one step, with the same arithmetic: a block
//! is 32 paths and nothing else. [`Sexp`] keeps quadratic Casimirs, and with one noise homogeneous
//! Hamiltonians, exactly on their damped law; [`EulerMaruyama`], [`Heun`] and [`Midpoint`] do not.
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
//! let y1 = Sexp::default().step(&body, &step, &Noise::increments([0.2, -0.3, 0.1]), y0);
//!
//! // One step damps the Casimir ½|y|² by exp(−2∫γ), whatever the noise was.
//! let law = (-2.0 * step.damping_integral()).exp();
//! let ratio = body.invariant(0, y1.z) / body.invariant(0, y0);
//! assert!((ratio / law - 1.0).abs() < 1e-15);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! | scheme | kind | strong order, one noise / several | keeps |
//! |---|---|---|---|
//! | [`Sexp`] | implicit, exponential | 1 / ½ | conformal quadratic Casimirs; one noise: conformal homogeneous energy |
//! | [`SexpLevy`] | the same with Lévy areas | 1 / 1 | the same |
//! | [`Midpoint`] | implicit | 1 / ½ | quadratic Casimirs when undamped |
//! | [`Heun`] | explicit, no derivatives | 1 / ½ | nothing |
//! | [`EulerMaruyama`] | explicit | ½ / ½ | nothing |

mod em;
mod formula;
mod heun;
mod increment;
mod kernel;
mod midpoint;
mod scheme;
mod sexp;
mod sexp_levy;
mod step;

pub use em::EulerMaruyama;
pub use formula::{Explicit, Implicit};
pub use heun::Heun;
pub use increment::{Increment, Vector};
pub use midpoint::Midpoint;
pub use scheme::Scheme;
pub use sexp::Sexp;
pub use sexp_levy::SexpLevy;
pub use step::{Step, StepError};
