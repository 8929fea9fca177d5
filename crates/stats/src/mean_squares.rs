//! The order of mean squares that share paths: ln m = a + 2p ln τ + k ln(1 + bτ^c).
//!
//! m_l are mean squares of the differences of runs at τ_l and τ_l/2 on the same noise, or of errors
//! against an exact solution. Differences of successive runs need no reference, whose own error
//! would bend the points. The last term is a higher order of the error, by one of three laws
//! ([`Bend`]), or left out.
//!
//! **Weights.** Weighting by the inverse of the *estimated* covariance V would be efficient if V
//! were known. Estimated from the same few hundred skewed squares it is not independent of the
//! means: large means come with large variances and are weighted down, and 95 % intervals cover 90
//! to 94 %. The weights here come from a fixed working covariance, equal variances with correlation
//! ½ between neighbours, so the estimate is linear in ln m: p = Σ g_l ln m_l. Its variance gᵀVg
//! uses the estimated V (Liang and Zeger, *Biometrika* 73, 1986). The quantile is Student's, with
//! degrees of freedom from the kurtosis of the paths' influences. V's own weights serve χ² alone.

use crate::{
    bootstrap,
    least_squares::{Fit, Weighting, dot, matrix},
    moments::CrossMoments,
    quantile::{CONFIDENCE, hotelling_p_value, two_sided},
    rate::Rate,
};
use real::elementary;

/// Correlation between neighbouring levels in the working weights.
const WORKING_CORRELATION: f64 = 0.5;
/// Relative error of a mean square that the model, two powers of an expansion, need not explain.
const MODEL_ERROR: f64 = 0.01;
/// Change of b below which the Gauss–Newton iteration ends; it converges linearly, with a rate of
/// the size of the residuals.
const STANDSTILL: f64 = 1e-9;
/// Largest number of Gauss–Newton steps.
const GAUSS_NEWTON_STEPS: u32 = 50;
/// Least factor of the leading term that corrections may leave: they take away at most 1 − 1/50.
const MIN_FACTOR: f64 = 0.02;

/// The factor (1 + bτ^c)^k of a mean square by the next order of the error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bend {
    power: i32,
    exponent: f64,
}

impl Bend {
    /// Factor 1 + bτ: errors of successive orders that are independent, or the next term of either.
    pub const LINEAR: Self = Self { power: 1, exponent: 1.0 };
    /// Factor (1 + bτ)²: errors of successive orders that are in proportion on every path.
    pub const SQUARED: Self = Self { power: 1, exponent: 2.0 };
    /// Factor 1 + bτ²: the order after the next one.
    pub const QUADRATIC: Self = Self { power: 2, exponent: 1.0 };
}

/// Logarithms of mean squares at some levels, with their estimated covariance.
pub struct LogMeanSquares<'a> {
    squares: &'a CrossMoments,
    levels: Vec<usize>,
    taus: Vec<f64>,
    values: Vec<f64>,
    covariance: Vec<Vec<f64>>,
}

/// A fitted order.
pub struct Estimate {
    /// The order with its interval by the delta method, and χ².
    pub rate: Rate,
    /// Standard error √(gᵀVg) of the order.
    pub se: f64,
    /// Weights g of the levels in the order.
    pub gain: Vec<f64>,
}

impl<'a> LogMeanSquares<'a> {
    /// Takes the `levels` given by their numbers among `taus`, which are the components of
    /// `squares`; `None` if a mean is not positive.
    pub fn new(taus: &[f64], squares: &'a CrossMoments, levels: Vec<usize>) -> Option<Self> {
        let means: Vec<f64> = levels.iter().map(|&l| squares.mean(l)).collect();
        if means.iter().any(|mean| !(mean.is_finite() && *mean > 0.0)) {
            return None;
        }
        // Delta method: Cov(ln m, ln m′) = Cov(m, m′)/(m m′).
        let covariance = matrix(levels.len(), |i, j| {
            let model = if i == j { MODEL_ERROR * MODEL_ERROR } else { 0.0 };
            squares.covariance_of_means(levels[i], levels[j]) / (means[i] * means[j]) + model
        });
        Some(Self {
            squares,
            taus: levels.iter().map(|&l| taus[l]).collect(),
            levels,
            values: means.iter().map(|mean| elementary::ln(*mean)).collect(),
            covariance,
        })
    }

    /// Drops the covariances between levels, which are not zero: shows the effect of ignoring them
    /// on an interval.
    #[must_use]
    pub fn independent(mut self) -> Self {
        let known = self.covariance;
        self.covariance = matrix(known.len(), |i, j| if i == j { known[i][i] } else { 0.0 });
        self
    }

    /// Fits the order with the working weights, and χ² with the weights of the estimated
    /// covariance; b is fitted if there is a `bend`. `None` if the covariance is singular.
    pub fn fit(&self, bend: Option<Bend>) -> Option<Estimate> {
        let levels = self.levels.len();
        let correlation =
            |l: usize, m: usize| elementary::powi(WORKING_CORRELATION, l.abs_diff(m) as i32);
        let working = Weighting::new(&matrix(levels, correlation))?;
        let fit = self.gauss_newton(&working, bend)?;
        let chi_square = self.gauss_newton(&Weighting::new(&self.covariance)?, bend)?.chi_square;
        let parameters = fit.parameters.len();
        let degrees = levels - parameters;
        let gain: Vec<f64> = fit.gain(1).iter().map(|g| 0.5 * g).collect();
        let (order, se) = (0.5 * fit.parameters[1], self.standard_error(&gain));
        let student_degrees =
            Some(bootstrap::degrees_of_freedom(self.squares, &self.levels, &gain));
        let half_width = two_sided(CONFIDENCE, student_degrees) * se;
        let rate = Rate {
            estimate: order,
            lo: order - half_width,
            hi: order + half_width,
            confidence: CONFIDENCE,
            student_degrees,
            chi_square,
            degrees,
            p_value: hotelling_p_value(chi_square, degrees, self.squares.count()),
            curvature_t: bend.map(|_| fit.parameters[2] / self.standard_error(&fit.gain(2))),
            ..Rate::default()
        };
        Some(Estimate { rate, se, gain })
    }

    /// The bootstrap-t interval of the order.
    pub(crate) fn bootstrap(&self, estimate: &Estimate) -> Option<(f64, f64)> {
        let Estimate { rate, se, gain } = estimate;
        let (below, above) = bootstrap::reach(self.squares, &self.levels, gain)?;
        Some((rate.estimate - below * se, rate.estimate + above * se))
    }

    /// Standard error √(gᵀVg).
    fn standard_error(&self, gain: &[f64]) -> f64 {
        let rows = self.covariance.iter().map(|row| dot(row, gain));
        gain.iter().zip(rows).map(|(g, row)| g * row).sum::<f64>().sqrt()
    }

    /// Fits the model by Gauss–Newton: it is linearised about the last b until b converges. Steps
    /// are halved while the argument of the logarithm would fall below [`MIN_FACTOR`].
    fn gauss_newton<'w>(&self, weighting: &'w Weighting, bend: Option<Bend>) -> Option<Fit<'w>> {
        let Bend { power, exponent } = bend.unwrap_or(Bend::LINEAR);
        let taus = &self.taus;
        let x: Vec<f64> = taus.iter().map(|tau| elementary::powi(tau / taus[0], power)).collect();
        let factors = |b: f64| x.iter().map(|x| 1.0 + b * x).collect::<Vec<f64>>();
        let (mut b, mut left) = (0.0, GAUSS_NEWTON_STEPS);
        loop {
            let now = factors(b);
            let mut design =
                vec![vec![1.0; taus.len()], taus.iter().map(|tau| elementary::ln(*tau)).collect()];
            if bend.is_some() {
                design.push(x.iter().zip(&now).map(|(x, f)| exponent * x / f).collect());
            }
            let known = now.iter().map(|f| exponent * (elementary::ln(*f) - (f - 1.0) / f));
            let target: Vec<f64> = self.values.iter().zip(known).map(|(y, k)| y - k).collect();
            let fit = weighting.fit(&design, &target)?;
            let mut step = bend.map_or(0.0, |_| fit.parameters[2] - b);
            while factors(b + step).iter().any(|&factor| factor < MIN_FACTOR) {
                step *= 0.5;
            }
            left -= 1;
            if left == 0 || step.abs() < STANDSTILL {
                return Some(fit);
            }
            b += step;
        }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::LN_2;

    use super::*;

    const PATHS: u64 = 64;
    /// Relative variance of a mean of 64 squares that scatter by 0.1 to both sides, and that of the
    /// model.
    const VARIANCE: f64 = 0.01 / 63.0 + 1e-4;

    /// Squares with these means: each scatters by ±0.1 of it, independently of the others.
    fn scattered(means: &[f64]) -> CrossMoments {
        let mut squares = CrossMoments::new(means.len());
        for path in 0..PATHS {
            let sign = |l: usize| if path >> l & 1 == 0 { 1.1 } else { 0.9 };
            let values = means.iter().enumerate().map(|(l, m)| m * sign(l));
            squares.add(&values.collect::<Vec<f64>>());
        }
        squares
    }

    /// Step sizes that halve, and the means 3τ^{2p}(1 + b(τ/τ₀)^c)^k.
    fn bent(levels: usize, p: f64, b: f64, bend: Bend) -> (Vec<f64>, CrossMoments) {
        let taus: Vec<f64> = (0..levels).map(|l| 0.5f64.powi(l as i32 + 3)).collect();
        let factor = |tau: f64| (1.0 + b * (tau / taus[0]).powi(bend.power)).powf(bend.exponent);
        let means: Vec<f64> = taus.iter().map(|t| 3.0 * t.powf(2.0 * p) * factor(*t)).collect();
        let squares = scattered(&means);
        (taus, squares)
    }

    fn fit(taus: &[f64], squares: &CrossMoments, bend: Option<Bend>) -> Estimate {
        let levels = (0..taus.len()).collect();
        LogMeanSquares::new(taus, squares, levels).unwrap().fit(bend).unwrap()
    }

    #[test]
    fn an_order_is_recovered_behind_the_bend_that_is_fitted() {
        for bend in [Bend::LINEAR, Bend::SQUARED, Bend::QUADRATIC] {
            for (p, b) in [(0.5, 2.0), (1.0, -0.6), (1.0, -0.95), (2.0, 0.3)] {
                let (taus, squares) = bent(6, p, b, bend);
                let Estimate { rate, .. } = fit(&taus, &squares, Some(bend));
                assert!((rate.estimate - p).abs() < 1e-7, "{bend:?} {p} {b}: {rate:?}");
                assert!(rate.chi_square < 1e-9 && rate.degrees == 3, "{bend:?} {p} {b}: {rate:?}");
                assert_eq!(rate.curvature_t.unwrap() > 0.0, b > 0.0, "{bend:?} {p} {b}");
                // The twin: without the bend the points do not lie on the line.
                let line = fit(&taus, &squares, None).rate;
                assert!((line.estimate - p).abs() > 0.01 && line.degrees == 4, "{line:?}");
                assert_eq!(line.curvature_t, None);
            }
        }
    }

    #[test]
    fn a_line_has_the_weights_of_neighbours_half_correlated() {
        // The inverse of the correlations 2^−|l − m| is proportional to the tridiagonal matrix with
        // 1, 5/4, 5/4, 1 and −½ beside; it takes ln τ = ln 2·(3, 1, −1, −3)/2 to a multiple of
        // (10, 1, −1, −10), and a slope of one has the order ½.
        let (taus, squares) = bent(4, 1.0, 0.0, Bend::LINEAR);
        let logarithms = LogMeanSquares::new(&taus, &squares, (0..4).collect()).unwrap();
        let estimate = logarithms.fit(None).unwrap();
        let (low, high) = logarithms.bootstrap(&estimate).unwrap();
        let Estimate { rate, se, gain } = estimate;
        let (below, above) = bootstrap::reach(&squares, &[0, 1, 2, 3], &gain).unwrap();
        assert!((low - (1.0 - below * se)).abs() < 1e-12 && low < 1.0);
        assert!((high - (1.0 + above * se)).abs() < 1e-12 && high > 1.0);
        for (g, exact) in gain.iter().zip([10.0, 1.0, -1.0, -10.0]) {
            assert!((g - exact / (62.0 * LN_2)).abs() < 1e-12, "{gain:?}");
        }
        let exact = (202.0 * VARIANCE).sqrt() / (62.0 * LN_2);
        assert!((se / exact - 1.0).abs() < 1e-9, "{se} {exact}");
        // The influences ±0.1g add up to sixteen values, of each sign pattern four: their kurtosis
        // is 3 − 2Σg⁴/(Σg²)².
        let kurtosis = 3.0 - 2.0 * 20_002.0 / (202.0 * 202.0);
        let degrees = rate.student_degrees.unwrap();
        assert!((degrees - 2.0 * PATHS as f64 / (kurtosis - 1.0)).abs() < 1e-6, "{degrees}");
        let half_width = two_sided(0.95, Some(degrees)) * se;
        for width in [rate.hi - rate.estimate, rate.estimate - rate.lo] {
            assert!((width / half_width - 1.0).abs() < 1e-9, "{rate:?}");
        }
        assert_eq!(rate.confidence, 0.95);
    }

    #[test]
    fn residuals_and_bends_are_measured_in_their_errors() {
        // Three points leave one residual, along w = (1, −2, 1)/√6.
        let bend = |y: [f64; 3]| y[0] - 2.0 * y[1] + y[2];
        let (taus, squares) = bent(3, 1.0, 0.8, Bend::LINEAR);
        let x = [1.0, 0.5, 0.25];
        let line = fit(&taus, &squares, None).rate;
        let residual = bend(x.map(|x| f64::ln(1.0 + 0.8 * x)));
        let chi_square = residual * residual / (6.0 * VARIANCE);
        assert!((line.chi_square / chi_square - 1.0).abs() < 1e-9, "{line:?} {chi_square}");
        assert_eq!(line.p_value, hotelling_p_value(line.chi_square, 1, PATHS));
        // The bend b moves w·y by b·w·x/(1 + bx).
        let bent = fit(&taus, &squares, Some(Bend::LINEAR)).rate;
        let slope = bend(x.map(|x| x / (1.0 + 0.8 * x)));
        let t = 0.8 * slope / (6.0 * VARIANCE).sqrt();
        assert!((bent.curvature_t.unwrap() / t - 1.0).abs() < 1e-6, "{bent:?} {t}");
        assert_eq!((bent.degrees, bent.p_value), (0, None));
    }

    #[test]
    fn levels_are_chosen_by_number_and_their_means_must_be_positive() {
        let (taus, squares) = (
            [0.5, 0.25, 0.125, 0.0625, 0.03125],
            scattered(&[0.25, 0.0, 0.015625, 0.00390625, 0.0009765625]),
        );
        let of = |levels: Vec<usize>| LogMeanSquares::new(&taus, &squares, levels);
        assert!(of((0..5).collect()).is_none());
        let rate = of(vec![0, 2, 3, 4]).unwrap().fit(None).unwrap().rate;
        assert!((rate.estimate - 1.0).abs() < 1e-9, "{rate:?}");
        for squares in [scattered(&[f64::INFINITY]), CrossMoments::new(1)] {
            assert!(LogMeanSquares::new(&[0.5], &squares, vec![0]).is_none());
        }
    }
}
