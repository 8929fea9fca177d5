//! **Means, orders of convergence and their intervals, from errors of sampled paths.**
//!
//! [`fit_strong`] and [`fit_weak`] fit orders with intervals from any errors with a covariance;
//! [`Moments`] and [`CrossMoments`] collect them.
//!
//! ```
//! use stats::{CrossMoments, fit_strong};
//!
//! // Squared errors of 200 paths at four step sizes, exactly of order one but for the scatter from path to path.
//! let taus = [0.1, 0.05, 0.025, 0.0125];
//! let mut squares = CrossMoments::new(4);
//! for path in 0..200 {
//!     let scatter = |l: usize| 1.0 + 0.3 * ((path * (l + 7)) as f64).sin();
//!     let errors: Vec<f64> = taus.iter().enumerate().map(|(l, tau)| tau * tau * scatter(l)).collect();
//!     squares.add(&errors);
//! }
//! let order = fit_strong(&taus, None, &squares).expect("four levels are enough");
//! assert!(order.lo < 1.0 && 1.0 < order.hi && order.hi - order.lo < 0.1, "{order:?}");
//! ```
//!
//! | item | job |
//! |---|---|
//! | [`Moments`], [`CrossMoments`] | means and covariances |
//! | [`fit_strong`], [`fit_weak`], [`fit_weak_differences`], [`fit_weak_against`], [`fit_independent`] | orders with intervals |
//! | [`root_mean_squares`], [`root_mean_square_interval`] | root-mean-square errors with intervals |
//! | [`Rate`], [`StraightLine`], [`Point`] | what a fit says, and what was measured |
//! | [`misfits`], [`normal_quantile`], [`student_quantile`] | what a verdict on an order needs |
//! | [`Logarithms`], [`Terms`], [`Estimate`] | the fit of [`fit_strong`] with a model of one's own |

mod least_squares;
mod moments;
mod order;
mod point;
mod rate;

pub use moments::{BATCHES, CrossMoments, Moments};
pub use order::{
    Estimate, Logarithms, Terms, fit_independent, fit_strong, fit_weak, fit_weak_against,
    fit_weak_differences, misfits, normal_quantile, root_mean_square_interval, student_quantile,
};
pub use point::{Point, root_mean_squares};
pub use rate::{Rate, StraightLine};
