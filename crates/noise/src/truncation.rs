//! Truncated Wiener increments.

use real::{Row, WIDTH, elementary};

use crate::NoiseError;

/// Truncation of Wiener increments (Milstein, Repin and Tretyakov 2002; Bréhier, Cohen and Komori
/// 2025): ΔŴ = √τ χ(ΔW/√τ), where χ clips to [−A, A] with A = √(2k|log τ|).
///
/// Implicit steps with bounded increments have a solution for every outcome of the noise. The bias
/// of the variance is E\[ΔW²\] − E\[ΔŴ²\] ≤ (1 + A) τ^{k+1}.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Truncation {
    order: Option<u32>,
    wide: bool,
}

/// Standard deviations below which a [wide](Truncation::wide) truncation clips nothing: a normal
/// number exceeds them with probability 2·10⁻⁹.
const WIDE: f64 = 6.0;

impl Truncation {
    /// Truncation of order k ≥ 1. The theorems on `sexp` need k ≥ 2.
    ///
    /// # Errors
    /// [`NoiseError`] for k = 0.
    pub fn new(k: u32) -> Result<Self, NoiseError> {
        if k == 0 {
            let needs = "must be at least 1 (the theorems ask k >= 2)";
            return Err(NoiseError(format!("the truncation order k {needs}, got k = 0")));
        }
        Ok(Self { order: Some(k), ..Self::none() })
    }

    /// No truncation: for explicit schemes, and for experiments without it.
    pub fn none() -> Self {
        Self { order: None, wide: false }
    }

    /// Truncation with the threshold max(A, 6), for any step size. At long steps A is a few
    /// standard deviations and shows in the results: 2.35 for k = 4 and τ = ½. As τ → 0 both are
    /// the same.
    #[must_use]
    pub fn wide(self) -> Self {
        Self { wide: true, ..self }
    }

    /// The order k; `None` for [`Truncation::none`].
    pub fn order(self) -> Option<u32> {
        self.order
    }

    /// The largest |ΔŴ| at step `tau`: √τ·√(2k|log τ|). Infinite for [`Truncation::none`].
    ///
    /// # Errors
    /// [`NoiseError`] unless 0 < τ < 1, or 0 < τ < ∞ for a wide
    /// truncation. For τ ≥ 1 the threshold A is zero or increases with τ.
    pub fn bound(self, tau: f64) -> Result<f64, NoiseError> {
        let Some(k) = self.order else { return Ok(f64::INFINITY) };
        let (least, longest) = if self.wide { (WIDE, f64::INFINITY) } else { (0.0, 1.0) };
        if !(tau > 0.0 && tau < longest) {
            return Err(NoiseError(format!(
                "truncated increments need a step size with 0 < tau < 1, got tau = {tau}"
            )));
        }
        let threshold = (2.0 * f64::from(k) * elementary::ln(tau.min(1.0)).abs()).sqrt();
        Ok(tau.sqrt() * threshold.max(least))
    }
}

real::kernel! {
    /// Writes increments or areas, clipped to ±`bound`, into `clipped`, which has equally many
    /// rows. Returns how many are changed. Infinities and NaN stay, so that their paths fail.
    pub fn clip(dw: &'a [Row], bound: f64, clipped: &'a mut [Row]) -> u64 {
        // The counter has the width of the lanes. It wraps, since an overflow check is a branch.
        let mut count = 0u64;
        for (dw, clipped) in dw.iter().zip(&mut *clipped) {
            for p in 0..WIDTH {
                let w = dw[p];
                // Comparisons with NaN are false, so that it stays.
                let below = if bound < w { bound } else { w };
                clipped[p] = if below < -bound { -bound } else { below };
                count = count.wrapping_add(if clipped[p] != w { 1 } else { 0 });
            }
        }
        if count > 0 {
            // Rare: infinities are put back, and neither they nor NaN are counted.
            for (dw, clipped) in dw.as_flattened().iter().zip(clipped.as_flattened_mut()) {
                if !dw.is_finite() {
                    *clipped = *dw;
                    count -= 1;
                }
            }
        }
        count
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::StepNoise;
    use real::Block;

    #[test]
    fn bad_requests_name_the_value() {
        assert!(Truncation::new(0).unwrap_err().to_string().ends_with("got k = 0"));
        for tau in [0.0, -0.5, 1.0, 2.0, f64::NAN, f64::INFINITY] {
            let error = Truncation::new(2).unwrap().bound(tau).unwrap_err();
            assert!(error.to_string().contains(&format!("tau = {tau}")), "{error}");
        }
        assert_eq!(Truncation::none().bound(3.0), Ok(f64::INFINITY));
        assert_eq!(Truncation::none().area_bound(0.5), Ok(f64::INFINITY));
    }

    #[test]
    fn a_wide_truncation_leaves_six_deviations_at_any_step() {
        let (plain, wide) = (Truncation::new(4).unwrap(), Truncation::new(4).unwrap().wide());
        for tau in [0.5, 1.0, 3.0, 1e6] {
            assert_eq!(wide.bound(tau), Ok(tau.sqrt() * 6.0), "{tau}");
        }
        assert_eq!(wide.bound(0.01), plain.bound(0.01));
        assert!(plain.bound(0.5).unwrap() < 2.36 * 0.5f64.sqrt());
        for tau in [0.0, -0.5, f64::NAN, f64::INFINITY] {
            assert!(wide.bound(tau).is_err(), "{tau}");
        }
    }

    #[test]
    fn clipping_keeps_signs_and_counts() {
        let mut dw = Block::<2>::zero();
        dw.0[0][3] = 5.0;
        dw.0[1][4] = -7.0;
        dw.0[1][5] = 0.5;
        let mut clipped = Block::<2>::zero();
        assert_eq!(clip(&dw.0, 1.0, &mut clipped.0), 2);
        assert_eq!((clipped.0[0][3], clipped.0[1][4], clipped.0[1][5]), (1.0, -1.0, 0.5));
        assert_eq!(clip(&dw.0, f64::INFINITY, &mut clipped.0), 0);
        assert_eq!(clipped, dw);
        // What is not finite stays, and is not counted as clipped.
        let wrong = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY];
        dw.0[1][5..8].copy_from_slice(&wrong);
        assert_eq!(clip(&dw.0, 1.0, &mut clipped.0), 2);
        assert_eq!(format!("{:?}", &clipped.0[1][5..8]), format!("{wrong:?}"));
        // Areas above the diagonal, with a bound (k/π) τ|log τ|.
        let mut noise = StepNoise::with_areas(2);
        noise.areas[1] = dw.0[1];
        let mut clipped = StepNoise::with_areas(2);
        clip(&noise.areas, 1.0, &mut clipped.areas);
        assert_eq!((clipped.areas[1][4], clipped.path::<2>(4).areas[1][0]), (-1.0, 1.0));
        let (tau, truncation) = (1.0 / 512.0, Truncation::new(2).unwrap());
        let expected = 2.0 / std::f64::consts::PI * tau * f64::ln(tau).abs();
        assert!((truncation.area_bound(tau).unwrap() / expected - 1.0).abs() < 1e-15);
        assert!(truncation.area_bound(1.0).is_err());
    }
}
