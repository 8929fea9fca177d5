//! Numbers, steps, durations and counts as HTML.

use super::prose::prose;

/// A number with `decimals` digits after the point of its mantissa, as a power of ten where that is
/// shorter.
pub fn scientific(value: f64, decimals: usize) -> String {
    if value == 0.0 { "0".into() } else { prose(&format!("{value:.decimals$e}")) }
}

/// A step size, as a power of two if it is one.
pub fn step(tau: f64) -> String {
    let exponent = tau.log2();
    let is_power = exponent == exponent.round() && exponent.abs() > 3.0;
    if is_power && tau > 0.0 { prose(&format!("2^{exponent}")) } else { tau.to_string() }
}

/// A wall time.
pub fn duration(seconds: f64) -> String {
    match seconds {
        s if s < 0.01 => format!("{:.1} ms", 1e3 * s),
        s if s < 1.0 => format!("{:.0} ms", 1e3 * s),
        s if s < 99.5 => format!("{s:.1} s"),
        s => match s.round() as u64 {
            s if s < 3600 => format!("{} min {} s", s / 60, s % 60),
            s => format!("{} h {} min", s / 3600, s / 60 % 60),
        },
    }
}

/// A count with thin spaces between groups of three digits.
pub fn count(n: u64) -> String {
    let mut digits = n.to_string();
    let length = digits.len();
    for behind in (3..length).step_by(3) {
        digits.insert(length - behind, '\u{202f}');
    }
    digits
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_typeset() {
        assert_eq!(scientific(-0.00123, 1), "−1.2·10<sup>−3</sup>");
        assert_eq!(scientific(2.345, 1), "2.3");
        assert_eq!(scientific(0.0, 2), "0");
        assert_eq!(scientific(f64::NAN, 2), "NaN");
        assert_eq!(step(2f64.powi(-14)), "2<sup>−14</sup>");
        assert_eq!(step(0.1), "0.1");
        assert_eq!(count(500_000), "500\u{202f}000");
        assert_eq!(count(17), "17");
    }

    #[test]
    fn durations_keep_two_units() {
        assert_eq!(duration(0.0042), "4.2 ms");
        assert_eq!(duration(71.34), "71.3 s");
        assert_eq!(duration(125.0), "2 min 5 s");
        assert_eq!(duration(3_725.0), "1 h 2 min");
    }
}
