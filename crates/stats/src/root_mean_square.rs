//! Root-mean-square errors with intervals.

use crate::{bootstrap, describe::few_paths, moments::CrossMoments, point::Point};

/// √m at every step size, where m is the mean of the squared errors: with a standard error by the
/// delta method, se(√m) = se(m)/(2√m), a bootstrap-t interval, and a warning where a few paths
/// carry the mean. A step size without samples has no point.
pub fn root_mean_squares(taus: &[f64], squares: &CrossMoments) -> Vec<Point> {
    let point = |(l, &tau): (usize, &f64)| {
        let value = squares.mean(l).sqrt();
        let se_of_square = squares.covariance_of_means(l, l).sqrt();
        let se = if value > 0.0 { se_of_square / (2.0 * value) } else { 0.0 };
        let (lo, hi) = root_mean_square_interval(squares, l).unzip();
        let warning = few_paths(squares.effective_samples(l));
        let finite = value.is_finite() && se.is_finite();
        finite.then_some(Point::Error { tau, value, se, lo, hi, warning })
    };
    taus.iter().enumerate().filter_map(point).collect()
}

/// A 95 % interval for the root of the mean square of component `l`, by bootstrap-t for its
/// logarithm (Efron and Tibshirani 1993). It leans upwards, as it must for skewed squares, where
/// value ± 1.96 standard errors covers too rarely. `None` with fewer than 32 paths.
pub fn root_mean_square_interval(squares: &CrossMoments, l: usize) -> Option<(f64, f64)> {
    let mean = squares.mean(l);
    let se = 0.5 * squares.covariance_of_means(l, l).sqrt() / mean;
    let (below, above) = bootstrap::reach(squares, &[l], &[0.5])?;
    Some((mean.sqrt() * (-below * se).exp(), mean.sqrt() * (above * se).exp()))
}
