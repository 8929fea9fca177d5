//! Data: moments with the covariance of their errors.

use stats::diagonal;

use crate::linear::Whitening;

/// A statistic of an observable at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Statistic {
    /// The mean.
    Mean,
    /// The variance.
    Variance,
    /// The quantile of a level between 0 and 1.
    Quantile(f64),
}

/// A measured moment.
#[derive(Clone, Debug, PartialEq)]
pub struct Moment {
    /// The time, at least 0.
    pub time: f64,
    /// Number of the observable.
    pub of: usize,
    /// The statistic.
    pub statistic: Statistic,
    /// The measured value.
    pub value: f64,
}

impl Moment {
    pub(crate) fn is_quantile(&self) -> bool {
        matches!(self.statistic, Statistic::Quantile(_))
    }
}

/// Moments with the covariance of their errors.
pub struct Data {
    /// The moments.
    pub moments: Vec<Moment>,
    /// Covariance of the errors.
    pub covariance: Vec<Vec<f64>>,
    /// Number of independent observations of each moment; none where the covariance is given.
    pub observations: Vec<usize>,
    pub(crate) whitening: Whitening,
}

/// Data from which nothing can be fitted.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DataError {
    /// A number is out of its range.
    #[error("{what} must be {right}, got {got}")]
    Number {
        /// Name of the number.
        what: &'static str,
        /// Range of the number.
        right: &'static str,
        /// The number.
        got: f64,
    },
    /// A time has too few samples for a covariance.
    #[error("t = {time} has {got} observations, and their covariance takes {least}")]
    Few {
        /// The time.
        time: f64,
        /// Number of samples.
        got: usize,
        /// Least number.
        least: usize,
    },
    /// The covariance has no eigenvalues, or no positive one.
    #[error("the moments do not vary: there is nothing to fit")]
    Constant,
}

/// Least number of samples at a time, and for each moment.
const FEW: usize = 30;
const EACH: usize = 5;

fn demand(what: &'static str, right: &'static str, got: f64, holds: bool) -> Result<(), DataError> {
    if holds { Ok(()) } else { Err(DataError::Number { what, right, got }) }
}

impl Data {
    /// Moments whose errors have this covariance.
    ///
    /// Combinations without an error, which constants of the motion give, are left out.
    ///
    /// # Errors
    /// [`DataError`] if a number is out of its range.
    pub fn new(moments: Vec<Moment>, covariance: Vec<Vec<f64>>) -> Result<Self, DataError> {
        for &Moment { time, value, statistic, .. } in &moments {
            demand("a time", "at least 0 and finite", time, time >= 0.0 && time.is_finite())?;
            demand("a moment", "finite", value, value.is_finite())?;
            if statistic == Statistic::Variance {
                demand("a variance", "at least 0", value, value >= 0.0)?;
            }
            if let Statistic::Quantile(level) = statistic {
                demand("a level", "between 0 and 1", level, level > 0.0 && level < 1.0)?;
            }
        }
        let last = moments.iter().map(|moment| moment.time).fold(0.0, f64::max);
        demand("the last time", "above 0", last, last > 0.0)?;
        let wrong = covariance.iter().flatten().find(|x| !x.is_finite());
        demand("a covariance", "finite", *wrong.unwrap_or(&0.0), wrong.is_none())?;
        let whitening = Whitening::of(covariance.len(), |i, j| covariance[i][j]);
        let whitening = whitening.ok_or(DataError::Constant)?;
        Ok(Self { moments, covariance, observations: Vec::new(), whitening })
    }

    /// Moments with independent errors of these standard deviations.
    ///
    /// # Errors
    /// As [`new`](Self::new); each error must be positive.
    pub fn with_errors(moments: Vec<Moment>, errors: &[f64]) -> Result<Self, DataError> {
        for &error in errors {
            demand("an error", "positive and finite", error, error > 0.0 && error.is_finite())?;
        }
        let squares: Vec<f64> = errors.iter().map(|error| error * error).collect();
        Self::new(moments, diagonal(&squares))
    }

    /// Means and variances of independent observations, each a time and a value for each
    /// observable.
    ///
    /// The covariance of d moments at a time is that of their influences x − x̄ and (x − x̄)² − s²
    /// over n, times (n − 1)/(n − d − 2), by which the inverse has no bias (Hartlap, Simon and
    /// Schneider, *Astron. Astrophys.* 464, 2007).
    ///
    /// # Errors
    /// [`DataError::Few`] unless every time has 30 observations, and 5 for each moment; and those
    /// of [`new`](Self::new).
    pub fn of_samples(mut samples: Vec<(f64, Vec<f64>)>) -> Result<Self, DataError> {
        samples.sort_by(|a, b| a.0.total_cmp(&b.0));
        let wrong = samples.iter().flat_map(|sample| &sample.1).find(|x| !x.is_finite());
        demand("an observation", "finite", *wrong.unwrap_or(&0.0), wrong.is_none())?;
        let (mut moments, mut observations) = (Vec::new(), Vec::new());
        let (mut influences, mut factors) = (Vec::new(), Vec::new());
        for at_time in samples.chunk_by(|a, b| a.0 == b.0) {
            let (time, n, width) = (at_time[0].0, at_time.len(), at_time[0].1.len());
            let (d, least) = (2 * width, FEW.max(2 * EACH * width));
            if n < least {
                return Err(DataError::Few { time, got: n, least });
            }
            let size = n as f64;
            observations.extend(vec![n; d]);
            factors.extend(vec![(size - 1.0) / (size - d as f64 - 2.0) / (size * size); d]);
            for of in 0..width {
                let mean = at_time.iter().map(|(_, x)| x[of]).sum::<f64>() / size;
                let apart = at_time.iter().map(|(_, x)| x[of] - mean);
                let square = apart.clone().map(|x| x * x).sum::<f64>() / size;
                influences.push(apart.clone().collect::<Vec<_>>());
                influences.push(apart.map(|x| x * x - square).collect());
                let variance = square * size / (size - 1.0);
                for (statistic, value) in [(Statistic::Mean, mean), (Statistic::Variance, variance)]
                {
                    moments.push(Moment { time, of, statistic, value });
                }
            }
        }
        let entry = |i: usize, j: usize| {
            let products = influences[i].iter().zip(&influences[j]).map(|(a, b)| a * b);
            let is_same = moments[i].time == moments[j].time;
            if is_same { products.sum::<f64>() * factors[i] } else { 0.0 }
        };
        let all = 0..moments.len();
        let covariance = all.clone().map(|i| all.clone().map(|j| entry(i, j)).collect()).collect();
        Ok(Self { observations, ..Self::new(moments, covariance)? })
    }

    /// The last time.
    pub fn until(&self) -> f64 {
        self.moments.iter().map(|moment| moment.time).fold(0.0, f64::max)
    }

    /// Standard error of moment i.
    pub fn error(&self, i: usize) -> f64 {
        self.covariance[i][i].sqrt()
    }
}
