//! Straight lines by least squares.

use stats::{CONFIDENCE, two_sided};

use crate::results::Slope;

/// The slope of y over x by least squares, all points alike, with a 95 % interval from the scatter
/// of the points about the line. `None` with fewer than three points.
pub fn slope(points: &[(f64, f64)]) -> Option<Slope> {
    let count = points.len();
    if count < 3 {
        return None;
    }
    let mean = |of: fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / count as f64;
    let (x, y) = (mean(|point| point.0), mean(|point| point.1));
    let square: f64 = points.iter().map(|point| (point.0 - x) * (point.0 - x)).sum();
    let value = points.iter().map(|point| (point.0 - x) * (point.1 - y)).sum::<f64>() / square;
    let residual = |point: &(f64, f64)| (point.1 - y - value * (point.0 - x)).powi(2);
    let degrees = (count - 2) as f64;
    let scatter = points.iter().map(residual).sum::<f64>() / (degrees * square);
    let quantile = two_sided(CONFIDENCE, Some(degrees));
    Some(Slope::within(value, quantile * scatter.sqrt()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_has_its_slope_and_scatter_widens_the_interval() {
        let line = |shift: f64| [(0.0, 1.0), (1.0, 3.0 + shift), (2.0, 5.0)];
        let exact = slope(&line(0.0)).unwrap();
        assert!((exact.value - 2.0).abs() < 1e-15 && exact.half_width() < 1e-12);
        // Residuals −1/30, 2/30, −1/30: s² = 6/900, of the slope s²/2.
        let off = slope(&line(0.1)).unwrap();
        assert!((off.half_width() - 12.7062 * (6.0f64 / 1800.0).sqrt()).abs() < 1e-4);
        assert!(slope(&line(0.0)[..2]).is_none());
    }
}
