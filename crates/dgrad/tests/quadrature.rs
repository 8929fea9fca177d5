//! The rules behind the averages: which one is taken, and what it integrates.

use dgrad::{GradientField, Rule, averaged_with_error};
use real::Real;

/// H = ln(1 + y²): no polynomial, so that every rule gives another value.
struct Logarithm;

impl GradientField<1> for Logarithm {
    fn gradient<R: Real>(&self, [y]: [R; 1]) -> [R; 1] {
        [y * 2.0 / (y * y + 1.0)]
    }
}

#[test]
fn the_error_compares_n_nodes_with_2n_plus_1() {
    let (a, b) = (0.3, 2.8);
    for n in [3, 4] {
        let mean =
            |n: usize| Rule::new(n).unwrap().integrate(a, b, |y| 2.0 * y / (1.0 + y * y)) / (b - a);
        let ([fine], error) = averaged_with_error(&Logarithm, [a], [b], n).unwrap();
        assert!((fine - mean(2 * n + 1)).abs() < 4.0 * f64::EPSILON, "{n}");
        assert!((error - (mean(n) - mean(2 * n + 1)).abs()).abs() < 4.0 * f64::EPSILON, "{n}");
        // Neighbouring rules are further away than that.
        assert!((mean(2 * n) - mean(2 * n + 1)).abs() > 1e-10, "{n}");
    }
}

#[test]
fn an_interval_has_its_length() {
    // ∫₁³ y² = 26/3, and from right to left with the other sign.
    let rule = Rule::new(2).unwrap();
    assert!((rule.integrate(1.0, 3.0, |y| y * y) - 26.0 / 3.0).abs() < 1e-14);
    assert!((rule.integrate(3.0, 1.0, |y| y * y) + 26.0 / 3.0).abs() < 1e-14);
}
