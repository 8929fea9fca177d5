//! Marks of an axis and their labels.

use super::*;
use real::elementary::{log10, powi};

/// The marks of an axis.
#[derive(Default)]
pub struct Ticks {
    /// Labelled marks.
    pub major: Vec<(f64, Label)>,
    /// Marks without a label.
    pub minor: Vec<f64>,
    /// A power of ten by which all labels are to be multiplied.
    pub factor: Option<Label>,
}

impl Ticks {
    /// Powers of ten, at most `most` of them labelled; multiples in between where there is room.
    pub fn decades(range: Range, most: usize) -> Self {
        let mut ticks = Self::powers(10, range, most);
        if log10(range.hi / range.lo) <= most.min(6) as f64 {
            let [first, last] = [range.lo, range.hi].map(|value| log10(value).floor() as i32);
            let minor =
                (first..=last).flat_map(|k| (2..10).map(move |m| f64::from(m) * powi(10f64, k)));
            ticks.minor.extend(minor.filter(|value| (range.lo..=range.hi).contains(value)));
        }
        ticks
    }

    /// Powers of a base, at most `most` of them labelled.
    pub fn powers(base: u32, range: Range, most: usize) -> Self {
        // More marks than this along a side run into each other.
        const MAX_MARKS: usize = 40;
        // A range that ends on a power must keep it in spite of the rounding of the logarithm.
        const ROUNDING: f64 = 1e-9;
        let exponent = |v: f64| log10(v) / log10(f64::from(base));
        let first = (exponent(range.lo) - ROUNDING).ceil() as i32;
        let last = (exponent(range.hi) + ROUNDING).floor() as i32;
        let count = usize::try_from(last - first + 1).unwrap_or(0);
        let stride = count.div_ceil(most.max(1)).max(1) as i32;
        let mut ticks = Self::default();
        for k in first..=last {
            let value = powi(f64::from(base), k);
            if k % stride == 0 {
                ticks.major.push((value, Label::new(&format!("{base}^{k}"))));
            } else if count <= MAX_MARKS {
                ticks.minor.push(value);
            }
        }
        ticks
    }

    /// Multiples of 1, 2 or 5 times a power of ten, at most `most` of them.
    pub fn decimal(range: Range, most: usize) -> Self {
        let rough = (range.hi - range.lo) / most.max(1) as f64;
        if !(rough.is_finite() && rough > 0.0) {
            return Self::default();
        }
        let magnitude = log10(rough).floor() as i32;
        let (mantissa, magnitude) = match rough / powi(10f64, magnitude) {
            ..=1.0 => (1.0, magnitude),
            ..=2.0 => (2.0, magnitude),
            ..=5.0 => (5.0, magnitude),
            _ => (1.0, magnitude + 1),
        };
        let step = mantissa * powi(10f64, magnitude);
        let (first, last) = ((range.lo / step).ceil(), (range.hi / step).floor());
        let largest = range.lo.abs().max(range.hi.abs());
        // Beyond 2^53 steps the multiples are no longer distinct, and there is nothing sensible to
        // label.
        if largest / step >= 2f64.powi(53) {
            return Self::default();
        }
        // Plain digits while they are few, otherwise the power of ten of the largest value.
        let power = match largest {
            1e-2..1e4 => 0,
            v => log10(v).floor() as i32,
        };
        let decimals = usize::try_from(power - magnitude).unwrap_or(0);
        let unit = powi(10f64, magnitude - power);
        let mut ticks = Self::default();
        for i in 0..=(last - first) as usize {
            let integer = mantissa * (first + i as f64);
            let decimals = if integer == 0.0 { 0 } else { decimals };
            let label = Label::new(&format!("{:.decimals$}", integer * unit));
            ticks.major.push((integer * powi(10f64, magnitude), label));
        }
        ticks.factor = (power != 0).then(|| Label::new(&format!("×10^{power}")));
        ticks
    }
}
