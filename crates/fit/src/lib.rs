//! **Parameters from moments of data, with intervals that have the Monte Carlo error and the bias
//! of the step in them.**
//!
//! The method of generalised moments (Hansen, *Econometrica* 50, 1982): θ̂ is where the means,
//! variances and quantiles of a model are nearest to those of the data, in the norm of the inverse
//! covariance of the data. Moments of the model are means over simulated paths, the same noise at
//! every θ (McFadden, *Econometrica* 57, 1989): their squares are a smooth function, and no
//! optimiser is stochastic. The likelihood of single observed paths is another subject.
//!
//! ```
//! use fit::{Data, FitSettings, Moment, Replicate, Statistic, fit};
//!
//! // x = a + b t, measured at three times.
//! let at = |time, value| Moment { time, of: 0, statistic: Statistic::Mean, value };
//! let moments = vec![at(0.0, 1.1), at(1.0, 2.9), at(2.0, 5.1)];
//! let data = Data::with_errors(moments, &[0.1, 0.1, 0.1])?;
//! let mut line = |theta: &[f64], _: &_| {
//!     let times = [0.0, 1.0, 2.0];
//!     let values = times.map(|t| theta[0] + theta[1] * t).to_vec();
//!     let slopes = vec![vec![1.0; 3], times.to_vec()];
//!     let (coarse, covariance) = (values.clone(), vec![]);
//!     Ok::<_, String>(vec![Replicate { values, coarse, slopes, covariance, failed: 0 }])
//! };
//! let start = [("a".into(), 0.0), ("b".into(), 1.0)];
//! let found = fit(&data, &start, &FitSettings::default(), &mut line)?;
//! assert!((found.values[1] - 2.0).abs() < 1e-9);
//! // σ/√Σ(t − 1)² and the quantile of 95 %.
//! assert!((found.half_width(1) - 1.96 * 0.1 / 2f64.sqrt()).abs() < 1e-4);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! **Intervals.** With the linear map L from moments to θ̂, 1.96 √(LΣLᵀ + M) plus a bound on the
//! bias: Σ is the covariance of the data; M is that of the errors of the model's moments and
//! derivatives, propagated to θ̂ for each of 32 replicates; the bound is L of the difference to
//! half as many steps. Paths are doubled until M widens no interval by more than a tenth, steps
//! until the bound is below a tenth of it. χ² has all three in its covariance.
//!
//! The errors of samples are those of the model at θ̂.
//!
//! **Identifiability.** A singular direction of the derivatives, in units of the errors of the
//! data, that is zero or less than twice its Monte Carlo error is named:
//! [`FitError::Unidentified`].
//!
//! | file | contents |
//! |---|---|
//! | `data` | moments, and those of samples with their covariance |
//! | `paths` | [`Paths`]: moments of a problem and derivatives on common noise |
//! | `solve` | [`fit`]: Gauss, Newton, Levenberg and Marquardt; intervals and χ² |
//! | `linear` | covariances and singular values, by `faer` |

mod data;
mod linear;
mod paths;
mod solve;

pub use data::{Data, DataError, Moment, Statistic};
pub use paths::{Effort, NearbySetup, Paths, Replicate};
pub use solve::{Fit, FitError, FitSettings, Model, fit};
