//! **The averaged discrete gradient, exact where mathematics allows and to a stated accuracy
//! everywhere else.**
//!
//! ∇̄H(a, b) = ∫₀¹ ∇H((1−η)a + ηb) dη satisfies ∇̄H(a, b)·(b − a) = H(b) − H(a) for every H. An
//! integrator built on it keeps H exactly when the integral is exact, so each closed form here is
//! exact to round-off and the quadrature says how far it is off.
//!
//! ```
//! use dgrad::{GradientField, averaged, averaged_with_error};
//! use real::Real;
//!
//! /// H(y) = e^{y₁} y₂, a Hamiltonian nobody foresaw.
//! struct Mine;
//! impl GradientField<2> for Mine {
//!     fn gradient<R: Real>(&self, y: [R; 2]) -> [R; 2] {
//!         [y[0].exp() * y[1], y[0].exp()]
//!     }
//! }
//!
//! let (a, b) = ([0.1, 1.0], [0.4, 0.8]);
//! let mean: [f64; 2] = averaged::<8, _, _, 2>(&Mine, a, b);
//! let work = mean[0] * (b[0] - a[0]) + mean[1] * (b[1] - a[1]);
//! assert!((work - (0.4f64.exp() * 0.8 - 0.1f64.exp())).abs() < 1e-15);
//!
//! let (_, error) = averaged_with_error(&Mine, a, b, 8)?;
//! assert!(error < 1e-14);
//! # Ok::<(), dgrad::QuadratureError>(())
//! ```
//!
//! | item | job |
//! |---|---|
//! | [`midpoint`] | quadratic H: ∇H at the midpoint |
//! | [`mean_cosine`], [`mean_sine`] | separable sines: cos(mid)·sinc(half difference), no cancellation |
//! | [`ShortMean`] | the same over short steps, with slopes and rough guesses, in fewer operations |
//! | [`averaged`] | N Gauss–Legendre nodes known at compile time, for block kernels; exact up to degree 2N − 1 |
//! | [`averaged_with_error`] | any number of nodes, with an error estimate |
//! | [`Rule`], [`nodes_for_degree`] | Gauss–Legendre rules on [0, 1] with computed nodes |

mod average;
mod closed;
mod legendre;
mod short;

pub use average::{GradientField, averaged, averaged_with_error};
pub use closed::{mean_cosine, mean_sine, midpoint};
pub use legendre::{MAX_NODES, QuadratureError, Rule, nodes_for_degree};
pub use short::ShortMean;
