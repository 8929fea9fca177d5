//! Root-mean-square errors with intervals.

use crate::{
    bootstrap,
    moments::{CrossMoments, FEW_SAMPLES},
    point::Point,
};
use real::elementary;

/// Root-mean-square errors √m at every step size, where m is the mean of the squared errors, with a
/// standard error by the delta method, se(√m) = se(m)/(2√m), a bootstrap-t interval, and a warning
/// where a few paths carry the mean. A step size without samples has no point.
pub fn root_mean_squares(taus: &[f64], squares: &CrossMoments) -> Vec<Point> {
    let point = |(l, &tau): (usize, &f64)| {
        let value = squares.mean(l).sqrt();
        let se_of_square = squares.covariance_of_means(l, l).sqrt();
        let se = if value > 0.0 { se_of_square / (2.0 * value) } else { 0.0 };
        let (lo, hi) = root_mean_square_interval(squares, l).unzip();
        let effective = squares.effective_samples(l);
        let warning = (effective < FEW_SAMPLES).then(|| {
            format!(
                "only {effective:.0} effective paths carry the error; the interval may be too narrow"
            )
        });
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
    Some((mean.sqrt() * elementary::exp(-below * se), mean.sqrt() * elementary::exp(above * se)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Squares 1 + (n mod 7), exact zeros, and one that a single path carries.
    fn squares() -> CrossMoments {
        let carried = |path| if path == 3 { 700.0 } else { 1.0 };
        CrossMoments::of((0..70).map(|path| [1.0 + f64::from(path % 7), 0.0, carried(path)]))
    }

    #[test]
    fn roots_have_the_errors_of_the_delta_method() {
        let points = root_mean_squares(&[0.5, 0.25, 0.125], &squares());
        let [Point::Error { tau, value, se, lo, hi, warning }, zero, carried] = &points[..] else {
            panic!("{points:?}")
        };
        // Ten times the numbers 1 to 7: mean 4, variance 4·70/69 about it.
        let of_square = (4.0 / 69.0f64).sqrt();
        assert_eq!((*tau, *value, warning), (0.5, 2.0, &None));
        assert!((se / (of_square / 4.0) - 1.0).abs() < 1e-12, "{se}");
        // ln √m has the standard error se(m)/(2m).
        let (below, above) = bootstrap::reach(&squares(), &[0], &[0.5]).unwrap();
        let end = |reach: f64| 2.0 * (reach * of_square / 8.0).exp();
        assert!((lo.unwrap() / end(-below) - 1.0).abs() < 1e-12);
        assert!((hi.unwrap() / end(above) - 1.0).abs() < 1e-12);
        assert_eq!(root_mean_square_interval(&squares(), 0), lo.zip(*hi));
        let zero_is_known = matches!(zero, Point::Error { value: 0.0, se: 0.0, lo: None, .. });
        let warned = matches!(carried, Point::Error { warning: Some(_), .. });
        assert!(zero_is_known && warned, "{points:?}");
        // A step without samples has no point.
        assert!(root_mean_squares(&[0.5, 0.25], &CrossMoments::new(2)).is_empty());
    }
}
