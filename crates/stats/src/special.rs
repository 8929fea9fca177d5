//! The incomplete gamma and beta functions, by series and continued fractions (Olver et al., *NIST
//! Handbook of Mathematical Functions*, 2010, §8.9 and §8.17), of the elementary functions of
//! `real` alone: the same bits on every machine.

use std::f64::consts::TAU;

use real::elementary::{exp, ln};

/// Largest number of terms of a series or fraction; a million degrees of freedom take hundreds.
const MAX_TERMS: u32 = 100_000;
/// Relative change below which a series or fraction ends.
const UNCHANGED: f64 = 4.0 * f64::EPSILON;

/// Logarithm ln Γ(x) for x > 0 by Stirling's series, whose error is below 1e-16 from x = 16 on.
pub fn ln_gamma(x: f64) -> f64 {
    let (mut x, mut product) = (x, 1.0);
    while x < 16.0 {
        product *= x;
        x += 1.0;
    }
    let z = 1.0 / (x * x);
    let series = 1.0 / 12.0 - z * (1.0 / 360.0 - z * (1.0 / 1260.0 - z * (1.0 / 1680.0)));
    (x - 0.5) * ln(x) - x + 0.5 * ln(TAU) + series / x - ln(product)
}

/// Continued fraction 1/(1 + a₁/(1 + a₂/(1 + …))) by the method of Lentz, with a_k = `a(k)`.
fn fraction(a: impl Fn(u32) -> f64) -> f64 {
    let (mut value, mut c, mut d) = (1.0, 1.0, 0.0);
    for k in 1..=MAX_TERMS {
        let a = a(k);
        d = 1.0 / (1.0 + a * d);
        c = 1.0 + a / c;
        value *= c * d;
        if (c * d - 1.0).abs() < UNCHANGED {
            break;
        }
    }
    1.0 / value
}

/// Upper incomplete gamma ratio Q(a, x) = Γ(a, x)/Γ(a) for a > 0: the probability that a χ² with 2a
/// degrees of freedom exceeds 2x.
pub fn gamma_above(a: f64, x: f64) -> f64 {
    if x <= 0.0 || x == f64::INFINITY {
        return f64::from(u8::from(x <= 0.0));
    }
    let factor = exp(a * ln(x) - x - ln_gamma(a));
    if x > a + 1.0 {
        // Γ(a, x) = e^{−x}x^{a−1}/(1 + ((1 − a)/x)/(1 + (1/x)/(1 + ((2 − a)/x)/(1 + …)))).
        let up = |k: u32, m| if k.is_multiple_of(2) { m } else { m + 1.0 - a };
        return factor / x * fraction(|k| up(k, f64::from(k / 2)) / x);
    }
    let (mut term, mut sum) = (1.0 / a, 1.0 / a);
    for k in 1..=MAX_TERMS {
        term *= x / (a + f64::from(k));
        sum += term;
        if term < UNCHANGED * sum {
            break;
        }
    }
    1.0 - factor * sum
}

/// Incomplete beta ratio I_x(a, b) for a, b > 0 and x + y = 1.
pub fn beta_below(a: f64, b: f64, [x, y]: [f64; 2]) -> f64 {
    if x <= 0.0 || y <= 0.0 {
        return f64::from(u8::from(y <= 0.0));
    }
    if x > (a + 1.0) / (a + b + 2.0) {
        return 1.0 - beta_below(b, a, [y, x]);
    }
    let ln_beta = ln_gamma(a) + ln_gamma(b) - ln_gamma(a + b);
    let term = |k: u32| {
        let (m, n) = (f64::from(k / 2), f64::from(k));
        let up = if k.is_multiple_of(2) { m * (b - m) } else { -(a + m) * (a + b + m) };
        up * x / ((a + n - 1.0) * (a + n))
    };
    exp(a * ln(x) + b * ln(y) - ln_beta) / a * fraction(term)
}

#[cfg(test)]
mod tests {
    use super::*;
    use statrs::function::{beta::beta_reg, gamma};

    #[test]
    fn functions_are_those_of_another_library() {
        let close = |a: f64, b: f64, error: f64| (a - b).abs() <= error * b.abs().max(1e-200);
        for n in 1..400 {
            let x = 0.05 * f64::from(n * n);
            let (found, known) = (ln_gamma(x), gamma::ln_gamma(x));
            assert!((found - known).abs() < 2e-14 * known.abs().max(1.0), "{x}: {found} {known}");
        }
        for a in [0.5, 1.0, 1.5, 4.0, 30.0, 500.0] {
            for part in [1e-3, 0.3, 0.9, 1.0, 1.1, 1.5, 3.0] {
                let (found, known) = (gamma_above(a, a * part), gamma::gamma_ur(a, a * part));
                assert!(close(found, known, 1e-11), "{a} {part}: {found} {known}");
            }
            for b in [0.5, 1.0, 2.5, 40.0, 2e4] {
                for share in [1e-3, 0.3, 0.9, 1.0, 1.1, 2.0] {
                    let x = (share * a / (a + b)).min(0.999);
                    let (found, known) = (beta_below(a, b, [x, 1.0 - x]), beta_reg(a, b, x));
                    assert!(close(found, known, 1e-9), "{a} {b} {x}: {found} {known}");
                }
            }
        }
        // Q(1, x) = e^{−x}, Q(2, x) = (1 + x)e^{−x}, I_x(1, b) = 1 − (1 − x)^b, I_x(2, 2) = x²(3 −
        // 2x).
        for x in [1e-9, 0.1, 0.7, 1.9, 2.1, 40.0] {
            assert!(close(gamma_above(1.0, x), exp(-x), 1e-13), "{x}");
            assert!(close(gamma_above(2.0, x), (1.0 + x) * exp(-x), 1e-13), "{x}");
            let y: f64 = x.min(0.9);
            let b: f64 = beta_below(1.0, 3.0, [y, 1.0 - y]);
            assert!((b - (1.0 - (1.0 - y).powi(3))).abs() < 1e-14, "{y}");
            assert!(close(beta_below(2.0, 2.0, [y, 1.0 - y]), y * y * (3.0 - 2.0 * y), 1e-14));
        }
        assert_eq!([0.0, f64::INFINITY].map(|x| gamma_above(0.5, x)), [1.0, 0.0]);
        assert_eq!([[0.0, 1.0], [1.0, 0.0]].map(|xy| beta_below(2.0, 3.0, xy)), [0.0, 1.0]);
    }
}
