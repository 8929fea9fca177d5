//! The result: estimates, levels and warnings.

use super::{settings::Coupling, tails::UNSEEN};

/// P(|N(0, 1)| ≤ this) = 95 %.
pub const QUANTILE: f64 = 1.959_963_984_540_054;

/// Expectations of all test functions, with the levels that were sampled and warnings.
#[derive(Clone, Debug, PartialEq)]
pub struct Expectation {
    /// The identifier of the scheme.
    pub scheme: &'static str,
    /// One for each test function, in their order.
    pub estimates: Vec<Estimate>,
    /// The requested half-width.
    pub accuracy: f64,
    /// Path-steps of everything that was computed, pilots and failed paths included.
    pub cost: u64,
    /// The levels that were sampled.
    pub levels: Vec<Level>,
    /// What was decided, and why, in words; empty where nothing was.
    pub decisions: Vec<String>,
    /// Assumptions of the intervals that do not hold, and limits that were reached; usually none.
    /// What is not [`Judged`] good is named here.
    pub warnings: Vec<Warning>,
}

impl Expectation {
    /// Whether every half-width is at most the accuracy, and variance, bias and resolution are
    /// judged good for every φ. If not, the intervals may fail to cover, and the warnings say why.
    pub fn reached(&self) -> bool {
        let reached =
            |estimate: &Estimate| estimate.half_width() <= self.accuracy && estimate.judged.all();
        self.estimates.iter().all(reached)
    }
}

/// What the samples say about the three assumptions of an interval; each `false` has a
/// [`Warning`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Judged {
    /// The samples show how φ varies: it is not the same to the bit on every path of a level
    /// ([`Warning::Constant`]), and thirty single paths or more carry its variance, or all events
    /// are of one size ([`Warning::HeavyTail`]).
    pub variance: bool,
    /// Differences of three levels or more fall by an order that can be extrapolated, and the
    /// levels telescope ([`Warning::FewLevels`], [`Warning::WeakOrder`],
    /// [`Warning::Inconsistent`]).
    pub bias: bool,
    /// The finest paths follow the motion and the damping, and φ the same events on fine and coarse
    /// paths ([`Warning::Unresolved`], [`Warning::Damping`], [`Warning::StrongDamping`],
    /// [`Warning::UnresolvedFunction`], [`Warning::Uncoupled`]).
    pub resolution: bool,
}

impl Judged {
    /// Whether all three are good.
    pub fn all(self) -> bool {
        self.variance && self.bias && self.resolution
    }
}

/// E[φ(y(T))] for one φ.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimate {
    /// Name of φ.
    pub name: String,
    /// The estimate.
    pub value: f64,
    /// Standard error of the estimate, without bias.
    pub standard_error: f64,
    /// How many standard errors the 95 % interval has on each side: 1.96, or Student's quantile.
    pub quantile: f64,
    /// Estimate of E[φ(y(T))] − E[φ(y_τ)] at the finest step, from the last differences d:
    /// d/(2^α − 1). Sobol points: it is in the value, by extrapolation. Random points: it is not.
    pub bias: f64,
    /// Bound on the error that the steps leave in the estimate. Sobol points: what extrapolation
    /// leaves, from the next power of τ, with a half-width from standard errors added. Random
    /// points: with the half-width from standard errors and missed events added, the largest of
    /// |d_l|·2^{−α(L−l)}/(2^α − 1) over the last three levels l, where d_l is the difference that
    /// level l adds, and of |u/(2^α − 1) + v/(2^{α+1} − 1)|, where v = (d_{L−1} − 2^α d_L)/2^α and
    /// u = d_L − v, which is the bias Aτ^α + Bτ^{α+1} for any A and B.
    pub bias_bound: f64,
    /// What events that the samples missed may add: the root of the sum of squares of 3.69·R/N over
    /// the levels where fewer than thirty of N samples carry the variance (N/κ < 30 with the
    /// kurtosis κ); R is the largest event that was seen, and 3.69 = −ln 0.025.
    pub missed: f64,
    /// Observed α in E[φ(y_τ)] − E[φ(y_{2τ})] ∝ τ^α, from the differences that exceed four standard
    /// errors; `None` with fewer than two of them, or if their signs differ.
    pub alpha: Option<Rate>,
    /// Observed β in Var ∝ τ^β of the differences; `None` where they do not vary.
    pub beta: Option<Rate>,
    /// Failed paths of the levels that make the estimate: they are in none of its means.
    pub failed: u64,
    /// Whether the interval may be believed.
    pub judged: Judged,
}

impl Estimate {
    /// Half of the 95 % interval: √((q standard errors)² + missed²), with the
    /// [`quantile`](Self::quantile) q, and the bound on the bias.
    pub fn half_width(&self) -> f64 {
        let Self { quantile, standard_error, missed, .. } = self;
        let variance = quantile * quantile * (standard_error * standard_error);
        (variance + missed * missed).sqrt() + self.bias_bound
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
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
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
    /// φ is the same to the bit on every path of a level, so that nothing is known about how it
    /// varies. The interval supposes that it changes by no more than on other levels, or by one if
    /// it is the same on all. Blocks [`Judged::variance`].
    #[error(
        "{observable} is the same on all {samples} paths of level {level}: an event of probability \
         up to {:.1e} may have been missed, or the noise be too weak for these steps",
        UNSEEN / *samples as f64
    )]
    Constant {
        /// Name of φ.
        observable: String,
        /// The level.
        level: usize,
        /// Its paths.
        samples: u64,
    },
    /// Fewer than three differences were sampled, so that the bias is not known. Blocks
    /// [`Judged::bias`].
    #[error("the bias is not known from {differences} differences, three are needed")]
    FewLevels {
        /// Their number.
        differences: usize,
    },
    /// A component of the state differs between fine and coarse paths by more than half of its
    /// motion, or by no less than on coarser levels: a fast motion that the steps do not resolve
    /// looks like a slow one. Blocks [`Judged::resolution`].
    #[error(
        "the steps do not resolve y{component}: on level {level} fine and coarse paths differ by \
         {difference:.1e} of its motion, below by {before:.1e}; take more coarsest steps, or a \
         higher finest level"
    )]
    Unresolved {
        /// Number of the component, from one.
        component: usize,
        /// The last level.
        level: usize,
        /// Root mean square of fine minus coarse over that of y − y(0), over all coarse times.
        difference: f64,
        /// The larger one of the two levels below.
        before: f64,
    },
    /// The damping that the scheme reads, summed over the steps, differs from ∫γ and does not
    /// converge to it: it oscillates or has pulses within the steps, or rate and integral
    /// contradict each other. Blocks [`Judged::resolution`].
    #[error(
        "the steps do not resolve the damping: on level {level} its sums over the steps differ \
         from the integral of the rate by {defect:.1e}; take more coarsest steps, or a higher \
         finest level"
    )]
    Damping {
        /// The last level.
        level: usize,
        /// The largest difference from ∫₀ᵗγ.
        defect: f64,
    },
    /// The damping of one step is strong: what noise and forces do within the step is not resolved,
    /// and step sizes that all forget it agree. Blocks [`Judged::resolution`].
    #[error(
        "the steps do not resolve the damping: on level {level} it is e^-{exponent:.1} in one \
         step; take more coarsest steps, or a higher finest level"
    )]
    StrongDamping {
        /// The last level.
        level: usize,
        /// The largest ∫|γ| that each of three steps in a row has, above one.
        exponent: f64,
    },
    /// φ differs between fine and coarse paths by more than 0.7 of its motion: it multiplies phases
    /// that the states resolve. Blocks [`Judged::resolution`].
    #[error(
        "the steps do not resolve {observable}: on level {level} it differs between fine and \
         coarse paths by {difference:.1e} of its motion; take more coarsest steps"
    )]
    UnresolvedFunction {
        /// Name of φ.
        observable: String,
        /// The last level.
        level: usize,
        /// Root mean square of φ(fine) − φ(coarse) over that of φ − φ(y(0)), at eight times.
        difference: f64,
    },
    /// φ varies on coarse paths in another way than on fine ones: the difference has more than a
    /// quarter of both variances. Blocks [`Judged::resolution`].
    #[error(
        "the steps do not resolve {observable}: on level {level} the variance of the difference is \
         {share:.2} of those of the fine and the coarse paths together"
    )]
    Uncoupled {
        /// Name of φ.
        observable: String,
        /// The last level.
        level: usize,
        /// The quotient.
        share: f64,
    },
    /// On the level the sum begins with, fewer than thirty samples carry the variance, or the largest deviations x
    /// are as frequent as x^{−α} with α below two: events larger than all that were seen may be
    /// missing, and the variance is not known. Blocks [`Judged::variance`], unless φ has two
    /// values.
    #[error(
        "{observable}: on level {level} a few large samples make the variance; deviations above x \
         have probability x^-{index:.1}"
    )]
    HeavyTail {
        /// Name of φ.
        observable: String,
        /// The level.
        level: usize,
        /// Hill's estimate of α.
        index: f64,
    },
    /// The differences fall more slowly than the weak order says; the bias is extrapolated by the
    /// upper end of the observed interval then, but by no order below ½ or half of the one given.
    /// An upper end below that blocks [`Judged::bias`].
    #[error(
        "{observable}: differences fall with exponent {alpha}, the weak order given is {assumed}"
    )]
    WeakOrder {
        /// Name of φ.
        observable: String,
        /// Observed exponent.
        alpha: Rate,
        /// Weak order of the settings.
        assumed: f64,
    },
    /// The coarse mean of a level contradicts the fine mean of the level below: the sum over the
    /// levels does not telescope. Blocks [`Judged::bias`].
    #[error(
        "{observable}: the coarse mean of level {level} is {deviation:.1} standard errors from the \
         fine mean of level {}, the levels do not telescope",
        level - 1
    )]
    Inconsistent {
        /// Name of φ.
        observable: String,
        /// The level of the coarse mean.
        level: usize,
        /// Distance in standard errors.
        deviation: f64,
    },
    /// The cost reached its limit before the accuracy.
    #[error("the accuracy was not reached with the {max_cost} path-steps allowed")]
    CostLimit {
        /// Path-steps allowed.
        max_cost: u64,
    },
    /// The accuracy takes more path-steps than are allowed; no more samples were drawn.
    #[error(
        "the accuracy is out of reach: it takes {least:.0e} path-steps or more, {max_cost:.0e} are \
         allowed"
    )]
    OutOfReach {
        /// Path-steps that are not enough.
        least: f64,
        /// Path-steps allowed.
        max_cost: f64,
    },
    /// The computation was stopped; see [`Job::giving_what_is_done`](crate::parts::Job).
    #[error("stopped before the accuracy was reached")]
    Stopped,
    /// The bias is too large on the finest level allowed.
    #[error("the bias is too large on the finest level allowed, {level}")]
    LevelLimit {
        /// That level.
        level: usize,
    },
}

impl Warning {
    /// The φ that is concerned; `None` if all are.
    pub fn observable(&self) -> Option<&str> {
        match self {
            Self::Constant { observable, .. }
            | Self::UnresolvedFunction { observable, .. }
            | Self::Uncoupled { observable, .. }
            | Self::HeavyTail { observable, .. }
            | Self::WeakOrder { observable, .. }
            | Self::Inconsistent { observable, .. } => Some(observable),
            _ => None,
        }
    }
}
