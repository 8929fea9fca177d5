//! The result: estimates, levels and warnings.

use super::settings::Coupling;

/// P(|N(0, 1)| ≤ this) = 95 %.
pub const QUANTILE: f64 = 1.959_963_984_540_054;

/// Expectations of all test functions, with the levels that were sampled and warnings.
#[derive(Clone, Debug, PartialEq)]
pub struct Expectation {
    /// One for each test function, in their order.
    pub estimates: Vec<Estimate>,
    /// The requested half-width.
    pub accuracy: f64,
    /// Path-steps of everything that was computed, pilots and failed paths included.
    pub cost: u64,
    /// The levels that were sampled.
    pub levels: Vec<Level>,
    /// Assumptions of the intervals that do not hold, and limits that were reached; usually none.
    pub warnings: Vec<Warning>,
}

impl Expectation {
    /// Whether every half-width is at most the accuracy.
    pub fn reached(&self) -> bool {
        self.estimates.iter().all(|estimate| estimate.half_width() <= self.accuracy)
    }
}

/// E[φ(y(T))] for one φ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Name of φ.
    pub name: &'static str,
    /// The estimate.
    pub value: f64,
    /// Standard error of the estimate, without bias.
    pub standard_error: f64,
    /// Estimate of E[φ(y(T))] − E[φ(y_τ)] at the finest step: d/(2^α − 1) from the last difference
    /// d. It is not added to the estimate.
    pub bias: f64,
    /// Bound on its absolute value: the largest of
    /// (|d_l| + 1.96 standard errors)·2^{−α(L−l)}/(2^α − 1) over the last three levels l.
    pub bias_bound: f64,
    /// Observed α in E[φ(y_τ)] − E[φ(y_{2τ})] ∝ τ^α, from the differences that exceed four standard
    /// errors; `None` with fewer than two of them.
    pub alpha: Option<Rate>,
    /// Observed β in Var ∝ τ^β of the differences; `None` where they do not vary.
    pub beta: Option<Rate>,
}

impl Estimate {
    /// Half of the 95 % interval: 1.96 standard errors and the bound on the bias.
    pub fn half_width(&self) -> f64 {
        QUANTILE * self.standard_error + self.bias_bound
    }

    /// The 95 % interval, from and to. It covers more often when the bias is below its bound.
    pub fn interval(&self) -> (f64, f64) {
        (self.value - self.half_width(), self.value + self.half_width())
    }
}

/// An exponent with its 95 % interval, which is widened when the points do not lie on a line.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("{value:.2} ({lower:.2} to {upper:.2})")]
pub struct Rate {
    /// The slope.
    pub value: f64,
    /// Lower end.
    pub lower: f64,
    /// Upper end.
    pub upper: f64,
}

/// The samples of one level.
#[derive(Clone, Debug, PartialEq)]
pub struct Level {
    /// Its number.
    pub level: usize,
    /// Step size of the fine path.
    pub tau: f64,
    /// How it is coupled with the level below; `None` for φ itself on single paths.
    pub coupling: Option<Coupling>,
    /// Paths that count.
    pub samples: u64,
    /// Paths that failed.
    pub failed: u64,
    /// Path-steps of one sample.
    pub cost_per_path: u64,
    /// One for each test function.
    pub values: Vec<LevelValue>,
}

/// The samples of one test function on one level.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LevelValue {
    /// Their mean.
    pub mean: f64,
    /// Their variance.
    pub variance: f64,
    /// Their kurtosis, three for normals; NaN where they do not vary.
    pub kurtosis: f64,
    /// How far the coarse mean lies from the fine mean of the level below, which has the same
    /// expectation, in standard errors of the difference; zero without a level below.
    pub deviation: f64,
}

/// An assumption that does not hold, or a limit that was reached.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Warning {
    /// Paths without a solution were left out: the estimate is conditional on survival.
    #[error(
        "{failed} paths failed on level {level} and were left out, which may bias the estimate"
    )]
    FailedPaths {
        /// The level.
        level: usize,
        /// How many.
        failed: u64,
    },
    /// The kurtosis is above 100 and above a sixteenth of the samples, so that the variance is not
    /// known to a quarter, nor the standard error of the level to an eighth.
    #[error("{observable}: kurtosis {kurtosis:.0} on level {level}, its variance is not reliable")]
    Kurtosis {
        /// Name of φ.
        observable: &'static str,
        /// The level.
        level: usize,
        /// Its kurtosis.
        kurtosis: f64,
    },
    /// Variances fall more slowly than costs grow, so the cost is not of order ε⁻²: wrong coupling,
    /// or an order of strong convergence below ½.
    #[error("{observable}: variances fall with exponent {beta}, below the exponent 1 of the cost")]
    VarianceDecay {
        /// Name of φ.
        observable: &'static str,
        /// Observed exponent, significantly below one.
        beta: Rate,
    },
    /// The differences fall more slowly than the weak order says; the bias is judged by the upper
    /// end of the observed interval then, but by no order below ½.
    #[error(
        "{observable}: differences fall with exponent {alpha}, the weak order given is {assumed}"
    )]
    WeakOrder {
        /// Name of φ.
        observable: &'static str,
        /// Observed exponent.
        alpha: Rate,
        /// Weak order of the settings.
        assumed: f64,
    },
    /// The coarse mean of a level contradicts the fine mean of the level below: the sum over the
    /// levels does not telescope.
    #[error(
        "{observable}: the coarse mean of level {level} is {deviation:.1} standard errors from the \
         fine mean of level {}, the levels do not telescope",
        level - 1
    )]
    Inconsistent {
        /// Name of φ.
        observable: &'static str,
        /// The level of the coarse mean.
        level: usize,
        /// Distance in standard errors.
        deviation: f64,
    },
    /// With this number of coarsest steps the same accuracy would have cost less.
    #[error("{steps} coarsest steps would have cost less")]
    CoarsestSteps {
        /// The better number.
        steps: u64,
    },
    /// The cost reached its limit before the accuracy.
    #[error("the accuracy was not reached with the {max_cost} path-steps allowed")]
    CostLimit {
        /// Path-steps allowed.
        max_cost: u64,
    },
    /// The bias is too large on the finest level allowed.
    #[error("the bias is too large on the finest level allowed, {level}")]
    LevelLimit {
        /// That level.
        level: usize,
    },
}
