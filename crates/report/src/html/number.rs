//! Numbers, steps, durations and quantities as HTML.

use crate::escape::escape;
use crate::label::Label;

/// A number with `decimals` digits after the point of its mantissa, as a power of ten where that is
/// shorter.
pub fn scientific(value: f64, decimals: usize) -> String {
    if value == 0.0 || !value.is_finite() {
        return value.to_string().replace('-', "−");
    }
    let text = format!("{value:.decimals$e}");
    let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    let mantissa = mantissa.replace('-', "−");
    match exponent {
        "0" => mantissa,
        _ => format!("{mantissa}·10<sup>{}</sup>", exponent.replace('-', "−")),
    }
}

/// A step size, as a power of two if it is one.
pub fn step(tau: f64) -> String {
    let exponent = tau.log2();
    if tau > 0.0 && exponent == exponent.round() && exponent.abs() > 3.0 {
        quantity(&format!("2^{exponent}"))
    } else {
        tau.to_string()
    }
}

/// A signed number with fixed decimals and a true minus sign.
pub fn fixed(value: f64, decimals: usize) -> String {
    format!("{value:.decimals$}").replace('-', "−")
}

/// A quantity in the notation of [`Label`].
pub fn quantity(notation: &str) -> String {
    let label = Label::new(notation);
    let script = |tag: &str, text: &str| match text {
        "" => String::new(),
        text => format!("<{tag}>{}</{tag}>", escape(text)),
    };
    let (index, exponent) = (script("sub", &label.index), script("sup", &label.exponent));
    format!("{}{index}{exponent}", escape(&label.base))
}

/// A wall time.
pub fn duration(seconds: f64) -> String {
    match seconds {
        s if s < 0.01 => format!("{:.1} ms", 1e3 * s),
        s if s < 1.0 => format!("{:.0} ms", 1e3 * s),
        s if s < 99.5 => format!("{s:.1} s"),
        s => {
            let whole = s.round() as u64;
            let (hours, minutes, seconds) = (whole / 3600, whole / 60 % 60, whole % 60);
            match hours {
                0 => format!("{minutes} min {seconds} s"),
                _ => format!("{hours} h {minutes} min"),
            }
        }
    }
}

/// A count with thin spaces between groups of three digits.
pub fn count(n: u64) -> String {
    let digits = n.to_string();
    let mut grouped = String::new();
    for (place, digit) in digits.chars().enumerate() {
        if place > 0 && (digits.len() - place).is_multiple_of(3) {
            grouped.push('\u{202f}');
        }
        grouped.push(digit);
    }
    grouped
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
        assert_eq!(quantity("cos y3"), "cos y<sub>3</sub>");
        assert_eq!(quantity("y<2"), "y&lt;2");
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
