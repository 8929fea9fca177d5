//! From a value to a position on the page: linear and logarithmic axes and the ranges they cover.

use real::elementary::{ln, log10, powf};

use super::*;

/// The range of values an axis covers, `lo < hi`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// Smallest value.
    pub lo: f64,
    /// Largest value.
    pub hi: f64,
}

/// The range of an axis without data.
pub const UNIT: Range = Range { lo: 0.0, hi: 1.0 };

/// Magnitudes beyond which values are left to the clipping: sums or products with a margin could
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

    /// Widens the range by the factor `margin` at both ends.
    pub fn times(self, margin: f64) -> Self {
        Self { lo: self.lo / margin, hi: self.hi * margin }
    }

    /// Widens the range by `share` of its length at both ends; a single value gets a range of its
    /// own magnitude, whatever the share.
    pub fn padded(self, share: f64) -> Self {
        let length = self.hi - self.lo;
        let pad = match self.hi.abs() {
            _ if length > 0.0 => share * length,
            0.0 => 1.0,
            size => 0.1 * size,
        };
        Self { lo: self.lo - pad, hi: self.hi + pad }
    }

    /// Widens the range until it holds two powers of ten: one labelled tick defines no scale.
    pub fn with_two_decades(self) -> Self {
        let (lo, hi) = (log10(self.lo), log10(self.hi));
        if hi.floor() - lo.ceil() >= 1.0 {
            return self;
        }
        Self { lo: self.lo.min(powf(10f64, lo.floor())), hi: self.hi.max(powf(10f64, hi.ceil())) }
    }
}

/// An axis: a range of values laid over a stretch of the page.
#[derive(Clone, Copy)]
pub struct Axis {
    /// Whether the axis is logarithmic: equal ratios, not equal differences, are equally far apart.
    pub logarithmic: bool,
    /// Values covered.
    pub range: Range,
    /// Position of `range.lo` on the page.
    pub start: f64,
    /// Position of `range.hi` on the page.
    pub end: f64,
}

impl Axis {
    /// A linear axis that is not yet laid over the page.
    pub fn linear(range: Range) -> Self {
        Self { logarithmic: false, range, start: 0.0, end: 0.0 }
    }

    /// A linear axis of values, widened by `share` of its length at both ends.
    pub fn of(values: impl IntoIterator<Item = f64>, share: f64) -> Self {
        Self::linear(Range::of(values, UNIT).padded(share))
    }

    /// The axis laid over a stretch of the page.
    pub fn over(self, start: f64, end: f64) -> Self {
        Self { start, end, ..self }
    }

    /// Marks of the axis, about `most` of them.
    pub fn ticks(&self, most: usize) -> Ticks {
        match self.logarithmic {
            true if self.range.hi >= 100.0 * self.range.lo => Ticks::decades(self.range, most),
            _ => Ticks::decimal(self.range, most),
        }
    }

    /// Position of a value on the page; a value that is not positive sits at the start of a
    /// logarithmic axis.
    pub fn position(&self, value: f64) -> f64 {
        let Range { lo, hi } = self.range;
        if self.logarithmic && value <= 0.0 {
            return self.start;
        }
        // Differences of logarithms, because the ratio of two values may overflow.
        let scale = if self.logarithmic { ln } else { |value| value };
        let [value, lo, hi] = [value, lo, hi].map(scale);
        self.start + (value - lo) / (hi - lo) * (self.end - self.start)
    }
}
