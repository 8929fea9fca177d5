//! Averages of sine and cosine over short differences.

use real::elementary;

/// w∫₀¹ g(a + ηh) dη for g = sin or cos as a function of h, for |a| ≤ 2²⁰ and h² ≤ ½; NaN beyond.
///
/// It is w g(a)·sin(h)/h + w g′(a)·(1 − cos h)/h, where sine and cosine are those of a alone: an
/// iteration for h takes them once, and the rest is two polynomials.
#[derive(Clone, Copy, Debug)]
pub struct ShortMean {
    /// w g(a).
    value: f64,
    /// w g′(a).
    derivative: f64,
}

impl ShortMean {
    /// The average of sine from a, times a weight.
    #[inline(always)]
    #[must_use]
    pub fn of_sine(a: f64, weight: f64) -> Self {
        let (sin, cos) = elementary::sin_cos_absolute(a);
        Self { value: sin * weight, derivative: cos * weight }
    }

    /// The average of cosine from a, times a weight.
    #[inline(always)]
    #[must_use]
    pub fn of_cosine(a: f64, weight: f64) -> Self {
        let (sin, cos) = elementary::sin_cos_absolute(a);
        Self { value: cos * weight, derivative: -(sin * weight) }
    }

    /// The average over h, to round-off.
    #[inline(always)]
    #[must_use]
    pub fn value(&self, h: f64) -> f64 {
        let (deficit, versine) = elementary::deficit_versine(h);
        // sin(h)/h = 1 − h²·deficit and (1 − cos h)/h = h·versine.
        (self.value - (self.value * (h * h)) * deficit) + (self.derivative * h) * versine
    }

    /// The average over h and its derivative by h, with errors of at most w|h|⁹/3.5·10⁶ and w
    /// h⁸/2.8·10⁶, for all h² ≤ ½: [`value`](ShortMean::value) with four terms of Taylor's series
    /// of the deficit and of the versine.
    #[inline(always)]
    #[must_use]
    pub fn estimate_with_slope(&self, h: f64) -> (f64, f64) {
        let z = h * h;
        let zz = z * z;
        let deficit = (1.0 / 6.0 - z * (1.0 / 120.0)) + zz * (1.0 / 5040.0 - z * (1.0 / 362_880.0));
        let versine = (0.5 - z * (1.0 / 24.0)) + zz * (1.0 / 720.0 - z * (1.0 / 40320.0));
        let (value_h, derivative_h, sinc) =
            (self.value * h, self.derivative * h, 1.0 - z * deficit);
        (
            self.value * sinc + derivative_h * versine,
            value_h * (deficit - versine) + self.derivative * (sinc - versine),
        )
    }

    /// For h = 0.
    #[inline(always)]
    #[must_use]
    pub fn constant(&self) -> f64 {
        self.value
    }

    /// Taylor's polynomial up to h², with an error of wg‴h³/24: a first guess.
    #[inline(always)]
    #[must_use]
    pub fn quadratic(&self, h: f64) -> f64 {
        self.value + h * (self.derivative * (1.0 / 2.0) - h * (self.value * (1.0 / 6.0)))
    }

    /// Taylor's polynomial up to h³, with an error of wg⁗h⁴/120: a second guess.
    #[inline(always)]
    #[must_use]
    pub fn cubic(&self, h: f64) -> f64 {
        let inner = self.value * (1.0 / 6.0) + h * (self.derivative * (1.0 / 24.0));
        self.value + h * (self.derivative * (1.0 / 2.0) - h * inner)
    }

    /// [`cubic`](ShortMean::cubic) and its derivative by h.
    #[inline(always)]
    #[must_use]
    pub fn cubic_with_slope(&self, h: f64) -> (f64, f64) {
        let inner = self.value * (1.0 / 3.0) + h * (self.derivative * (1.0 / 8.0));
        (self.cubic(h), self.derivative * (1.0 / 2.0) - h * inner)
    }
}
