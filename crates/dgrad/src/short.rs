//! Averages of sine and cosine over short intervals.

use real::elementary;

/// The average w∫₀¹ g(a + ηh) dη for g = sin or cos as a function of h, for |a| ≤ 2²⁰ and h² ≤ ½.
/// For any other a or h it is NaN.
///
/// It equals w g(a)·sin(h)/h + w g′(a)·(1 − cos h)/h. Only a enters sine and cosine, so an
/// iteration for h evaluates them once. The rest are two polynomials in h.
#[derive(Clone, Copy, Debug)]
pub struct ShortMean {
    /// w g(a).
    value: f64,
    /// w g′(a).
    derivative: f64,
}

impl ShortMean {
    /// The average of the sine from `a` on; w = `weight`.
    #[inline(always)]
    pub fn of_sine(a: f64, weight: f64) -> Self {
        let (sin, cos) = elementary::sin_cos_absolute(a);
        Self { value: sin * weight, derivative: cos * weight }
    }

    /// The average of the cosine from `a` on; w = `weight`.
    #[inline(always)]
    pub fn of_cosine(a: f64, weight: f64) -> Self {
        let (sin, cos) = elementary::sin_cos_absolute(a);
        Self { value: cos * weight, derivative: -(sin * weight) }
    }

    /// The average over an interval of length h, exact to round-off.
    #[inline(always)]
    pub fn value(&self, h: f64) -> f64 {
        let (deficit, versine) = elementary::deficit_versine(h);
        // sin(h)/h = 1 − h²·deficit and (1 − cos h)/h = h·versine.
        (self.value - (self.value * (h * h)) * deficit) + (self.derivative * h) * versine
    }

    /// The average and its derivative with respect to h, with errors of at most w|h|⁹/(3.5·10⁶) and
    /// w h⁸/(2.8·10⁶) for h² ≤ ½. This is [`value`](ShortMean::value) with four terms of each
    /// Taylor series.
    #[inline(always)]
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

    /// The average for h = 0.
    #[inline(always)]
    pub fn constant(&self) -> f64 {
        self.value
    }

    /// The Taylor polynomial up to h², with the error wg‴h³/24.
    #[inline(always)]
    pub fn quadratic(&self, h: f64) -> f64 {
        self.value + h * (self.derivative * (1.0 / 2.0) - h * (self.value * (1.0 / 6.0)))
    }

    /// The Taylor polynomial up to h³, with the error wg⁗h⁴/120.
    #[inline(always)]
    pub fn cubic(&self, h: f64) -> f64 {
        let inner = self.value * (1.0 / 6.0) + h * (self.derivative * (1.0 / 24.0));
        self.value + h * (self.derivative * (1.0 / 2.0) - h * inner)
    }

    /// [`cubic`](ShortMean::cubic) and its derivative with respect to h.
    #[inline(always)]
    pub fn cubic_with_slope(&self, h: f64) -> (f64, f64) {
        let inner = self.value * (1.0 / 3.0) + h * (self.derivative * (1.0 / 8.0));
        (self.cubic(h), self.derivative * (1.0 / 2.0) - h * inner)
    }
}
