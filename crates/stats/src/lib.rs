//! **Means, orders of convergence and their intervals, from errors of sampled paths.**
//!
//! [`CrossMoments`] collects errors at several step sizes; [`fit_strong`] and [`fit_weak`] fit an
//! order with an interval to them, or to any errors with a covariance.
//!
//! ```
//! use stats::{CrossMoments, fit_strong};
//!
//! // Squared differences of 200 paths at four step sizes, of order one but for their scatter.
//! let taus = [0.1, 0.05, 0.025, 0.0125];
//! let mut squares = CrossMoments::new(4);
//! for path in 0..200 {
//!     let scatter = |l: usize| 1.0 + 0.3 * ((path * (l + 7)) as f64).sin();
//!     let errors = [0, 1, 2, 3].map(|l| taus[l] * taus[l] * scatter(l));
//!     squares.add(&errors);
//! }
//! let order = fit_strong(&taus, &squares).expect("four levels are enough");
//! assert!(order.covers(1.0) && order.hi - order.lo < 0.1, "{order:?}");
//! ```
//!
//! | item | job |
//! |---|---|
//! | [`CrossMoments`] | means and covariances |
//! | [`CentralMoments`] | mean with interval, variance, kurtosis and range, without cancellation |
//! | [`Tail`] | whether a law has a mean and a variance, from its largest values |
//! | [`quantile_ranks`] | order statistics that enclose a quantile |
//! | [`fit_strong`] | strong orders, from squared differences that share paths |
//! | [`fit_weak`], [`weak_errors`] | weak orders, from signed errors or differences with a covariance ([`diagonal`]) |
//! | [`lower_share`] | how much a term of lower order may hide |
//! | [`root_mean_squares`], [`root_mean_square_interval`] | root-mean-square errors with intervals |
//! | [`Warning`] | what a reader of a result must know |
//! | [`Rate`], [`Against`], [`Expansion`], [`Point`] | a fit and a measured error as data |
//! | [`LogMeanSquares`], [`Bend`], [`Estimate`] | the fit of [`fit_strong`] with other terms or levels |
//!
//! Of this workspace the crate uses only `real`, whose dispatch runs the moments of a block on the
//! widest vectors of the processor.

mod bootstrap;
mod central;
mod least_squares;
mod mean_squares;
mod moments;
mod point;
mod proportion;
mod quantile;
mod quantile_ranks;
mod rate;
mod root_mean_square;
mod special;
mod strong;
mod tail;
mod warning;
mod weak;
mod worse;

pub use central::{CentralMoments, ROUND_OFF};
pub use least_squares::diagonal;
pub use mean_squares::{Bend, Estimate, LogMeanSquares};
pub use moments::{BATCHES, CrossMoments, FEW_SAMPLES};
pub use point::Point;
pub use proportion::proportion;
pub use quantile::{CONFIDENCE, chi_square_p_value, two_sided};
pub use quantile_ranks::quantile_ranks;
pub use rate::{Against, Expansion, Rate};
pub use root_mean_square::{root_mean_square_interval, root_mean_squares};
pub use strong::fit_strong;
pub use tail::Tail;
pub use warning::Warning;
pub use weak::{fit_weak, lower_share, weak_errors};
pub use worse::worse;
