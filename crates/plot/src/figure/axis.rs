//! From a value to a position on the page: linear and logarithmic axes and the ranges they cover.

/// How values are spaced.
#[derive(Clone, Copy)]
pub enum Scale {
    /// Equal differences are equally far apart.
    Linear,
    /// Equal ratios are equally far apart.
    Logarithmic,
}

/// The range of values an axis covers, `lo < hi`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// Smallest value.
    pub lo: f64,
    /// Largest value.
    pub hi: f64,
}

/// Magnitudes beyond these are left to the clipping: sums with a margin or products with one could
/// leave the range of `f64`.
const SMALLEST: f64 = 1e-300;
const LARGEST: f64 = 1e300;

impl Range {
    /// Smallest range that holds every positive finite value, or `otherwise` when there is none.
    pub fn of_positive(values: impl IntoIterator<Item = f64>, otherwise: Self) -> Self {
        let positive = values.into_iter().filter(|v| *v > 0.0);
        Self::of(positive.map(|v| v.max(SMALLEST)), otherwise)
    }

    /// Smallest range that holds every finite value, or `otherwise` when there is none.
    pub fn of(values: impl IntoIterator<Item = f64>, otherwise: Self) -> Self {
        let (lo, hi) = values
            .into_iter()
            .filter(|v| v.is_finite())
            .map(|v| v.clamp(-LARGEST, LARGEST))
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), v| (lo.min(v), hi.max(v)));
        if lo <= hi { Self { lo, hi } } else { otherwise }
    }

    /// Widened by the factor `margin` at both ends.
    pub fn times(self, margin: f64) -> Self {
        Self { lo: self.lo / margin, hi: self.hi * margin }
    }

    /// Widened by `share` of its length at both ends; a single value gets a range of its own
    /// magnitude.
    pub fn padded(self, share: f64) -> Self {
        let length = self.hi - self.lo;
        let pad = match self.hi.abs() {
            _ if length > 0.0 => share * length,
            0.0 => 1.0,
            size => 0.1 * size,
        };
        Self { lo: self.lo - pad, hi: self.hi + pad }
    }

    /// Padded if it is a single value.
    pub fn or_padded(self) -> Self {
        if self.lo < self.hi { self } else { self.padded(0.1) }
    }

    /// Widened until it holds two powers of ten, because one labelled tick does not define a scale.
    pub fn with_two_decades(self) -> Self {
        let (lo, hi) = (self.lo.log10(), self.hi.log10());
        if hi.floor() - lo.ceil() >= 1.0 {
            return self;
        }
        Self { lo: self.lo.min(10f64.powf(lo.floor())), hi: self.hi.max(10f64.powf(hi.ceil())) }
    }
}

/// An axis: a range of values laid over a stretch of the page.
#[derive(Clone, Copy)]
pub struct Axis {
    /// Spacing of the values.
    pub scale: Scale,
    /// Values covered.
    pub range: Range,
    /// Position of `range.lo` on the page.
    pub start: f64,
    /// Position of `range.hi` on the page.
    pub end: f64,
}

impl Axis {
    /// Position of a value on the page; what is not positive sits at the start of a logarithmic
    /// axis.
    pub fn position(&self, value: f64) -> f64 {
        let Range { lo, hi } = self.range;
        // Differences of logarithms, because the ratio of two values may overflow.
        let [value, lo, hi] = match self.scale {
            Scale::Linear => [value, lo, hi],
            Scale::Logarithmic if value <= 0.0 => return self.start,
            Scale::Logarithmic => [value, lo, hi].map(f64::ln),
        };
        self.start + (value - lo) / (hi - lo) * (self.end - self.start)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNIT: Range = Range { lo: 1.0, hi: 100.0 };

    fn axis(scale: Scale) -> Axis {
        Axis { scale, range: UNIT, start: 200.0, end: 0.0 }
    }

    #[test]
    fn ends_and_middle() {
        let log = axis(Scale::Logarithmic);
        assert_eq!(log.position(1.0), 200.0);
        assert!((log.position(10.0) - 100.0).abs() < 1e-12);
        assert_eq!(log.position(100.0), 0.0);
        assert_eq!(axis(Scale::Linear).position(50.5), 100.0);
    }

    #[test]
    fn zero_and_negative_values_sit_at_the_floor() {
        let log = axis(Scale::Logarithmic);
        assert_eq!(log.position(0.0), 200.0);
        assert_eq!(log.position(-3.0), 200.0);
        assert!(log.position(f64::NAN).is_nan());
    }

    #[test]
    fn ranges_ignore_what_cannot_be_drawn() {
        let values = [f64::NAN, 3.0, -1.0, 0.0, f64::INFINITY, 7.0];
        assert_eq!(Range::of_positive(values, UNIT), Range { lo: 3.0, hi: 7.0 });
        assert_eq!(Range::of_positive([0.0, -1.0], UNIT), UNIT);
        assert_eq!(Range::of([], UNIT), UNIT);
    }

    #[test]
    fn a_narrow_range_is_widened_to_two_decades() {
        let narrow = Range { lo: 2.0, hi: 3.0 }.with_two_decades();
        assert!((narrow.lo - 1.0).abs() < 1e-12 && (narrow.hi - 10.0).abs() < 1e-12);
        let wide = Range { lo: 0.5, hi: 20.0 };
        assert_eq!(wide.with_two_decades(), wide);
    }

    #[test]
    fn a_single_value_gets_a_range() {
        for value in [0.0, 3.0, -1e9] {
            let range = Range { lo: value, hi: value }.padded(0.05);
            assert!(range.lo < value && value < range.hi);
        }
    }
}
