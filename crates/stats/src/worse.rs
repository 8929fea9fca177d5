//! The larger of two measurements.

/// Larger of two measurements, NaN if either is: a NaN must not be lost on the way to a verdict.
pub fn worse(a: f64, b: f64) -> f64 {
    if a.is_nan() || a > b { a } else { b }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_worse_of_two_numbers_is_the_larger_and_nan_stays() {
        assert_eq!((worse(1.0, 2.0), worse(2.0, 1.0), worse(1.0, 1.0)), (2.0, 2.0, 1.0));
        assert!(worse(f64::NAN, 1.0).is_nan() && worse(1.0, f64::NAN).is_nan());
    }
}
