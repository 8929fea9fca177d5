//! **The averaged discrete gradient: closed forms exact to round-off, and quadrature.**
//!
//! ∇̄H(a, b) = ∫₀¹ ∇H((1−η)a + ηb) dη satisfies ∇̄H(a, b)·(b − a) = H(b) − H(a) for every H
//! (Harten, Lax and van Leer 1983; McLachlan, Quispel and Robidoux 1999). An integrator with ∇̄H
//! therefore keeps H as exactly as the integral is computed.
//!
//! The way through the crate: `closed` and `short` have closed forms for quadratics and sines;
//! everything else goes by nodes and weights (`legendre`) to their sum (`average`).
//!
//! ```
//! use dgrad::{GradientField, averaged, real::Real};
//!
//! /// H(y) = e^{y₁} y₂.
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
//! ```
//!
//! | item | purpose |
//! |---|---|
//! | [`midpoint`] | ∇̄H for a quadratic H |
//! | [`mean_cosine`], [`mean_sine`] | ∇̄H for H = sin y and H = −cos y, without cancellation |
//! | [`ShortMean`] | the same for short steps in fewer operations, with derivatives |
//! | [`averaged`], [`averaged_by_degree`] | N Gauss–Legendre nodes, for block kernels |
//! | [`Rule`], [`nodes_for_degree`] | Gauss–Legendre rules on [0, 1] |

pub use real;

mod average;
mod closed;
mod legendre;
mod short;

pub use average::{GradientField, averaged, averaged_by_degree};
pub use closed::{mean_cosine, mean_sine, midpoint};
pub use legendre::{MAX_NODES, QuadratureError, Rule, nodes_for_degree};
pub use short::ShortMean;
