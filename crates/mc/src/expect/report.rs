//! The result: estimates, levels and warnings.

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
    /// What was decided, and why, in words.
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
    /// Thirty samples or more carry the variance ([`Warning::FewSamples`]).
    pub variance: bool,
    /// The bias falls from level to level by an order that can be extrapolated, and the levels
    /// telescope ([`Warning::Bias`]).
    pub bias: bool,
    /// The finest steps follow the motion, the damping and φ ([`Warning::Unresolved`]).
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
    /// The estimate, extrapolated to τ → 0.
    pub value: f64,
    /// Standard error of the estimate, from the spread over replicates, without bias.
    pub standard_error: f64,
    /// How many standard errors the 95 % interval has on each side: Student's quantile, with a
    /// correction for skewness.
    pub quantile: f64,
    /// What extrapolation added to the mean at the finest step: an estimate of E[φ(y(T))] −
    /// E[φ(y_τ)].
    pub bias: f64,
    /// Bound on the error that the steps leave in the estimate after extrapolation, from the next
    /// power of τ, with a half-width from standard errors added; and what failed paths may add,
    /// their share times the range of φ.
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

/// The samples of one level: φ itself on level 0, differences to the level below on others.
#[derive(Clone, Debug, PartialEq)]
pub struct Level {
    /// Its number.
    pub level: usize,
    /// Step size of the fine path.
    pub tau: f64,
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
}

/// An assumption that does not hold, or a limit that was reached.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Warning {
    /// A few samples decide, so that nobody can tell how φ varies: fewer than thirty carry its
    /// variance, or the largest are too frequent for one (Hill's estimate of the exponent of their
    /// tail is below two), and events larger than all that were seen may be missing; or none does,
    /// since φ is the same to the bit on all of them. Blocks [`Judged::variance`].
    #[error(
        "{observable}: {effective:.0} of {samples} samples carry the variance on level {level}: a \
         few large ones decide, or the noise is too weak for these steps"
    )]
    FewSamples {
        /// Name of φ.
        observable: String,
        /// The level.
        level: usize,
        /// How many samples carry the variance: N/κ with the kurtosis κ.
        effective: f64,
        /// The number N of all samples.
        samples: u64,
    },
    /// The steps of the finest level do not resolve the motion, the damping or φ. Blocks
    /// [`Judged::resolution`].
    #[error(
        "the steps do not resolve {what}: on level {level} {}; take more coarsest steps, or a \
         higher finest level",
        what.defect(*defect)
    )]
    Unresolved {
        /// What they do not resolve.
        what: Unresolved,
        /// The finest level.
        level: usize,
        /// By how much; [`Unresolved`] says of what.
        defect: f64,
    },
    /// The bias of the steps is not bounded, or with a lower order than the scheme should have.
    #[error("{observable}: {why}")]
    Bias {
        /// Name of φ.
        observable: String,
        /// Why.
        why: Unbounded,
    },
    /// A limit was reached before the accuracy.
    #[error(transparent)]
    Limit(#[from] Limit),
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
}

/// What steps do not resolve.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Unresolved {
    /// A component of the state, counted from one. Fine and coarse paths differ by more than half
    /// of its motion, or by no less than on coarser levels: a fast motion that the steps do not
    /// resolve looks like a slow one. The defect is the root mean square of fine minus coarse over
    /// that of y − y(0).
    #[error("y{0}")]
    Component(usize),
    /// A test function: it multiplies phases that the states resolve, or has other events on fine
    /// paths than on coarse ones. The defect is the root mean square of the difference over that of
    /// its motion or variation.
    #[error("{0}")]
    Function(String),
    /// The damping: it oscillates or has pulses within the steps, or rate and integral contradict
    /// each other. The defect is the largest difference of its sums over the steps from ∫₀ᵗγ.
    #[error("the damping")]
    Damping,
    /// Noise and forces within a step of strong damping, which step sizes that all forget them
    /// agree on. The defect is the largest ∫|γ| that each of three steps in a row has, above one.
    #[error("the damping")]
    StrongDamping,
}

impl Unresolved {
    fn defect(&self, defect: f64) -> String {
        match self {
            Self::Component(_) | Self::Function(_) => {
                format!("fine and coarse paths differ by {defect:.1e} of its motion")
            }
            Self::Damping => {
                format!("its sums over the steps differ from the integral by {defect:.1e}")
            }
            Self::StrongDamping => format!("it is e^-{defect:.1} in one step"),
        }
    }
}

/// Why the bias is not bounded as it should be.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Unbounded {
    /// The differences fall more slowly than the weak order says; the bias is extrapolated by the
    /// observed order then, but by none below ½ or half of the one given. An upper end below that
    /// blocks [`Judged::bias`].
    #[error("differences fall with exponent {alpha}, the weak order given is {assumed}")]
    Order {
        /// Observed exponent.
        alpha: Rate,
        /// The weak order assumed.
        assumed: f64,
    },
    /// The coarse mean of a level contradicts the fine mean of the level below, which has the same
    /// expectation. Blocks [`Judged::bias`].
    #[error(
        "the coarse mean of level {level} is {deviation:.1} standard errors from the fine mean of \
         level {}, the levels do not telescope",
        level - 1
    )]
    Telescope {
        /// The level of the coarse mean.
        level: usize,
        /// Distance in standard errors.
        deviation: f64,
    },
}

/// A limit that was reached before the accuracy.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Limit {
    /// The cost.
    #[error("the accuracy was not reached with the {max_cost} path-steps allowed")]
    Cost {
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
    /// The bias is too large on the finest level allowed, or its steps do not resolve the motion.
    #[error("the bias is too large on the finest level allowed, {level}")]
    Level {
        /// That level.
        level: usize,
    },
    /// The computation was stopped; see [`Job::giving_what_is_done`](crate::parts::Job).
    #[error("stopped before the accuracy was reached")]
    Stopped,
}

impl Warning {
    /// The φ that is concerned; `None` if all are.
    pub fn observable(&self) -> Option<&str> {
        match self {
            Self::FewSamples { observable, .. }
            | Self::Unresolved { what: Unresolved::Function(observable), .. }
            | Self::Bias { observable, .. } => Some(observable),
            _ => None,
        }
    }
}
