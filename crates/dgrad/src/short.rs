//! Averages of sine and cosine over short differences.

use real::elementary;

/// w∫₀¹ g(a + ηh) dη for g = sin or cos as a function of h, for |a| ≤ 2²⁰ and h² ≤ ½; NaN beyond.
///
/// It is w g(a)·sin(h)/h + w g′(a)·(1 − cos h)/h, where sine and cosine are those of a alone: an iteration for h takes them once,
/// and the rest is two polynomials.
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
        self.with_slope(h).0
    }

    /// The average over h and its derivative by h, to round-off.
    #[inline(always)]
    #[must_use]
    pub fn with_slope(&self, h: f64) -> (f64, f64) {
        let (deficit, versine) = elementary::deficit_versine(h);
        // sin(h)/h = 1 − h²·deficit and (1 − cos h)/h = h·versine; products with h first, since they need not wait.
        let (value_h, derivative_h) = (self.value * h, self.derivative * h);
        let mean = (self.value - (value_h * h) * deficit) + derivative_h * versine;
        let slope = value_h * (deficit - versine) + self.derivative * ((1.0 - versine) - (h * h) * deficit);
        (mean, slope)
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
}
