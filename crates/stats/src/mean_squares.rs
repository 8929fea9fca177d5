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
    rate::{Model, Rate},
};

/// Correlation between neighbouring levels in the working weights.
const WORKING_CORRELATION: f64 = 0.5;
/// Relative error of a mean square for which the model, two powers of an expansion, is not
/// answerable.
const MODEL_ERROR: f64 = 0.01;
/// Gauss–Newton ends when b moves by less than this; it converges linearly, with a rate of the
/// size of the residuals.
const STANDSTILL: f64 = 1e-9;
/// Or after this many steps.
const GAUSS_NEWTON_STEPS: u32 = 50;
/// The corrections may take away this much of the leading term, and no more: 1 − 1/50.
const LEAST_FACTOR: f64 = 0.02;

/// The factor (1 + bτ^c)^k of a mean square by the next order of the error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bend {
    power: i32,
    exponent: f64,
}

impl Bend {
    /// 1 + bτ: errors of successive orders that are independent, or the next term of either.
    pub const LINEAR: Self = Self { power: 1, exponent: 1.0 };
    /// (1 + bτ)²: errors of successive orders that are in proportion on every path.
    pub const SQUARED: Self = Self { power: 1, exponent: 2.0 };
    /// 1 + bτ²: the next order but one.
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
    /// Its standard error √(gᵀVg).
    pub se: f64,
    /// The weights g.
    pub gain: Vec<f64>,
}

impl<'a> LogMeanSquares<'a> {
    /// The levels of that number among `taus`, which are the components of `squares`; `None` if a
    /// mean is not positive.
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
            values: means.iter().map(|mean| mean.ln()).collect(),
            covariance,
        })
    }

    /// The same with the levels taken for independent, which they are not: what an interval is
    /// worth without their covariance.
    #[must_use]
    pub fn independent(mut self) -> Self {
        let known = self.covariance;
        self.covariance = matrix(known.len(), |i, j| if i == j { known[i][i] } else { 0.0 });
        self
    }

    /// Fits the order with the working weights, and χ² with those of the estimated covariance; b
    /// is fitted if there is a `bend`. `None` if the covariance is singular.
    pub fn fit(&self, bend: Option<Bend>) -> Option<Estimate> {
        let levels = self.levels.len();
        let correlation = |l: usize, m: usize| WORKING_CORRELATION.powi(l.abs_diff(m) as i32);
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
            model: Model::MeanSquares,
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

    /// √(gᵀVg).
    fn standard_error(&self, gain: &[f64]) -> f64 {
        let rows = self.covariance.iter().map(|row| dot(row, gain));
        gain.iter().zip(rows).map(|(g, row)| g * row).sum::<f64>().sqrt()
    }

    /// The model linearised about the last b until it stands still. Steps are halved while the
    /// argument of the logarithm would fall below [`LEAST_FACTOR`].
    fn gauss_newton<'w>(&self, weighting: &'w Weighting, bend: Option<Bend>) -> Option<Fit<'w>> {
        let Bend { power, exponent } = bend.unwrap_or(Bend::LINEAR);
        let taus = &self.taus;
        let x: Vec<f64> = taus.iter().map(|tau| (tau / taus[0]).powi(power)).collect();
        let factors = |b: f64| x.iter().map(|x| 1.0 + b * x).collect::<Vec<f64>>();
        let mut b = 0.0;
        let mut left = GAUSS_NEWTON_STEPS;
        loop {
            let now = factors(b);
            let mut design = vec![vec![1.0; taus.len()], taus.iter().map(|tau| tau.ln()).collect()];
            if bend.is_some() {
                design.push(x.iter().zip(&now).map(|(x, f)| exponent * x / f).collect());
            }
            let known = now.iter().map(|f| exponent * (f.ln() - (f - 1.0) / f));
            let target: Vec<f64> = self.values.iter().zip(known).map(|(y, k)| y - k).collect();
            let fit = weighting.fit(&design, &target)?;
            let mut step = bend.map_or(0.0, |_| fit.parameters[2] - b);
            while factors(b + step).iter().any(|&factor| factor < LEAST_FACTOR) {
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
