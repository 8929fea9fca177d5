//! Where an axis is marked and what the marks say.

use super::axis::Range;
use crate::label::Label;

/// Where a logarithmic axis is marked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Spacing {
    /// At powers of ten.
    Decades,
    /// At powers of two, for step sizes and numbers of steps.
    Doublings,
}

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
        let decades = (range.hi / range.lo).log10();
        if decades <= most.min(6) as f64 {
            let [first, last] = [range.lo, range.hi].map(|value| value.log10().floor() as i32);
            let multiples = |k| (2..10).map(move |m| f64::from(m) * 10f64.powi(k));
            let minor = (first..=last).flat_map(multiples);
            ticks.minor.extend(minor.filter(|value| (range.lo..=range.hi).contains(value)));
        }
        ticks
    }

    /// Powers of a base, at most `most` of them labelled.
    pub fn powers(base: u32, range: Range, most: usize) -> Self {
        // More marks than this along a side run into each other.
        const MOST_MARKS: usize = 40;
        // A range that ends on a power must keep it in spite of the rounding of the logarithm.
        const ROUNDING: f64 = 1e-9;
        let exponent = |v: f64| v.log10() / f64::from(base).log10();
        let first = (exponent(range.lo) - ROUNDING).ceil() as i32;
        let last = (exponent(range.hi) + ROUNDING).floor() as i32;
        let count = usize::try_from(last - first + 1).unwrap_or(0);
        let stride = count.div_ceil(most.max(1)).max(1) as i32;
        let mut ticks = Self::default();
        for k in first..=last {
            let value = f64::from(base).powi(k);
            if k % stride == 0 {
                ticks.major.push((value, Label::new(&format!("{base}^{k}"))));
            } else if count <= MOST_MARKS {
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
        let magnitude = rough.log10().floor() as i32;
        let (mantissa, magnitude) = match rough / 10f64.powi(magnitude) {
            ..=1.0 => (1, magnitude),
            ..=2.0 => (2, magnitude),
            ..=5.0 => (5, magnitude),
            _ => (1, magnitude + 1),
        };
        let step = f64::from(mantissa) * 10f64.powi(magnitude);
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
            v => v.log10().floor() as i32,
        };
        let decimals = usize::try_from(power - magnitude).unwrap_or(0);
        let unit = 10f64.powi(magnitude - power);
        let major = (0..=(last - first) as usize)
            .map(|i| {
                let integer = f64::from(mantissa) * (first + i as f64);
                let decimals = if integer == 0.0 { 0 } else { decimals };
                let text = format!("{:.decimals$}", integer * unit);
                (integer * 10f64.powi(magnitude), Label::new(&text))
            })
            .collect();
        let factor = (power != 0).then(|| Label::new(&format!("×10^{power}")));
        Self { major, minor: Vec::new(), factor }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn values(ticks: &Ticks) -> Vec<f64> {
        ticks.major.iter().map(|(v, _)| *v).collect()
    }

    fn bases(ticks: &Ticks) -> Vec<&str> {
        ticks.major.iter().map(|(_, l)| l.base.as_str()).collect()
    }

    #[test]
    fn decades_are_labelled_with_minor_multiples() {
        let ticks = Ticks::decades(Range { lo: 0.05, hi: 20.0 }, 6);
        assert_eq!(values(&ticks), [0.1, 1.0, 10.0]);
        assert_eq!(ticks.major[0].1, Label::new("10^-1"));
        assert_eq!(ticks.minor.len(), 5 + 8 + 8 + 1);
    }

    #[test]
    fn decades_at_the_ends_are_kept() {
        let ticks = Ticks::decades(Range { lo: 1e-17, hi: 1e-3 }, 20);
        assert_eq!(ticks.major.len(), 15);
    }

    #[test]
    fn many_decades_are_thinned_to_a_common_stride() {
        let ticks = Ticks::decades(Range { lo: 1e-300, hi: 1e300 }, 6);
        assert!((3..=6).contains(&ticks.major.len()));
        let few = Ticks::decades(Range { lo: 1e-17, hi: 1.0 }, 6);
        assert_eq!(
            few.major.iter().map(|(_, l)| l.exponent.as_str()).collect::<Vec<_>>(),
            ["−15", "−12", "−9", "−6", "−3", "0"]
        );
    }

    #[test]
    fn powers_of_two_cover_the_steps() {
        let range = Range { lo: 2f64.powi(-14), hi: 2f64.powi(-5) };
        assert_eq!(Ticks::powers(2, range, 12).major.len(), 10);
        let thinned = Ticks::powers(2, range, 8);
        assert_eq!(values(&thinned), [-14, -12, -10, -8, -6].map(|k| 2f64.powi(k)));
        assert_eq!(thinned.minor.len(), 5);
    }

    #[test]
    fn decimal_steps_are_one_two_or_five() {
        let ticks = Ticks::decimal(Range { lo: 0.0, hi: 10.0 }, 6);
        assert_eq!(bases(&ticks), ["0", "2", "4", "6", "8", "10"]);
        let ticks = Ticks::decimal(Range { lo: -0.03, hi: 0.09 }, 4);
        assert_eq!(bases(&ticks), ["0.00", "0.05"].map(|s| if s == "0.00" { "0" } else { s }));
    }

    #[test]
    fn large_and_small_numbers_share_a_factor() {
        let ticks = Ticks::decimal(Range { lo: 0.0, hi: 3e7 }, 4);
        assert_eq!(bases(&ticks), ["0", "1", "2", "3"]);
        assert_eq!(ticks.factor, Some(Label::new("×10^7")));
        let ticks = Ticks::decimal(Range { lo: -1.2e-5, hi: 0.0 }, 4);
        assert_eq!(bases(&ticks), ["−1.0", "−0.5", "0"]);
        assert_eq!(ticks.factor, Some(Label::new("×10^-5")));
    }

    #[test]
    fn hopeless_ranges_have_no_ticks() {
        assert!(Ticks::decimal(Range { lo: 1.0, hi: 1.0 }, 5).major.is_empty());
        assert!(Ticks::decimal(Range { lo: -f64::MAX, hi: f64::MAX }, 5).major.is_empty());
        assert!(Ticks::decimal(Range { lo: 1e17, hi: 1e17 + 16.0 }, 5).major.is_empty());
        assert!(Ticks::decades(Range { lo: 2.0, hi: 3.0 }, 5).major.is_empty());
    }
}
