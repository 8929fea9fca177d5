//! The result: estimates, levels and warnings, and all of it in words.

use real::elementary::{hypot, log10};
use std::fmt;

use serde::Serialize;
use stats::Warning as Message;

/// Quantile q of the normal law for 95 %: P(|N(0, 1)| ≤ q) = 95 %.
pub const QUANTILE: f64 = 1.959_963_984_540_054;

/// Expectations of all test functions, with the levels that were sampled and warnings.
#[derive(Clone, Debug, PartialEq)]
pub struct Expectation {
    /// The identifier of the scheme.
    pub scheme: &'static str,
    /// Estimate of each test function, in their order.
    pub estimates: Vec<Estimate>,
    /// Derivatives with respect to parameters: the name of each, and the estimate for each test
    /// function.
    pub gradient: Vec<(String, Vec<Estimate>)>,
    /// The requested half-width.
    pub accuracy: f64,
    /// Steps of the single paths that are taken because levels do not help: differences of fine and
    /// coarse paths vary about as much as φ. Two coarser levels bound the bias.
    pub single_steps: Option<u64>,
    /// Path-steps of everything that was computed, pilots and failed paths included.
    pub cost: u64,
    /// The levels that were sampled.
    pub levels: Vec<Level>,
    /// Assumptions of the intervals that do not hold, and limits that were reached; usually none.
    /// What is not [`Judged`] good is named here.
    pub warnings: Vec<Warning>,
}

impl Expectation {
    /// Whether every half-width is at most the accuracy, and variance, bias and resolution are
    /// judged good for every φ. If not, the intervals may fail to cover, and the warnings say why.
    pub fn reached(&self) -> bool {
        self.all().all(|one| one.half_width() <= self.accuracy && one.judged.all())
    }

    /// All estimates, those of derivatives last.
    pub fn all(&self) -> impl Iterator<Item = &Estimate> {
        self.estimates.iter().chain(self.gradient.iter().flat_map(|(_, estimates)| estimates))
    }
}

/// Verdict of the samples on the three assumptions of an interval; each `false` has a [`Warning`],
/// whose kind names the assumption.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Judged {
    /// Whether thirty samples or more carry the variance, and no heavy [tail](stats::Tail) is seen.
    pub variance: bool,
    /// Whether the bias falls from level to level by an order that can be extrapolated, and the
    /// levels telescope.
    pub bias: bool,
    /// Whether the finest steps follow the motion, the damping and φ.
    pub resolution: bool,
}

impl Judged {
    /// Whether all three are good.
    pub fn all(self) -> bool {
        self.variance && self.bias && self.resolution
    }
}

/// Estimate of E[φ(y(T))] for one φ.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Estimate {
    /// Name of φ.
    #[serde(rename = "of")]
    pub name: String,
    /// The estimate, extrapolated to τ → 0; NaN where the [tail](stats::Tail) of φ says that there
    /// may be no mean.
    pub value: f64,
    /// Standard error of the estimate, from the spread over replicates, without bias.
    pub standard_error: f64,
    /// Number of standard errors on each side of the 95 % interval: Student's quantile, with a
    /// correction for skewness.
    pub quantile: f64,
    /// Amount that extrapolation added to the mean at the finest step: an estimate of E[φ(y(T))] −
    /// E[φ(y_τ)].
    pub bias: f64,
    /// Bound on the error that the steps leave in the estimate after extrapolation, from the next
    /// power of τ, with a half-width from standard errors added; and what failed paths may add,
    /// their share times the range of φ.
    pub bias_bound: f64,
    /// Half-width for events that the samples missed: the root of the sum of squares of 3.69·R/N
    /// over the levels where fewer than thirty of N samples carry the variance (N/κ < 30 with the
    /// kurtosis κ); R is the largest event that was seen, and 3.69 = −ln 0.025. Infinite where the
    /// tail of φ says that there may be no variance.
    pub missed: f64,
    /// Observed α in E[φ(y_τ)] − E[φ(y_{2τ})] ∝ τ^α, from the differences that exceed four standard
    /// errors; `None` with fewer than two of them, or if their signs differ.
    pub alpha: Option<Rate>,
    /// Observed β in Var ∝ τ^β of the differences; `None` where they do not vary.
    pub beta: Option<Rate>,
    /// Failed paths of the levels that make the estimate: they are in none of its means.
    #[serde(rename = "failed_paths")]
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
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Rate {
    /// The exponent.
    pub value: f64,
    /// Lower end of the interval.
    pub lower: f64,
    /// Upper end of the interval.
    pub upper: f64,
}

/// The samples of one level: φ itself on level 0, differences to the level below on others.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Level {
    /// Number of the level.
    pub level: usize,
    /// Step size of the fine path.
    pub tau: f64,
    /// Number of paths that have not failed.
    pub samples: u64,
    /// Number of paths that failed.
    pub failed: u64,
    /// Path-steps of one sample.
    #[serde(rename = "path_steps_each")]
    pub cost_per_path: u64,
    /// The variance of the samples of each test function.
    pub variances: Vec<f64>,
}

/// An assumption that does not hold, or a limit that was reached.
#[derive(Clone, Debug, PartialEq)]
pub struct Warning {
    /// Kind of the warning.
    pub kind: WarningKind,
    /// Names of the φ that are concerned; none if all are.
    pub observables: Vec<String>,
    /// Message, with the numbers of the first φ.
    pub message: Message,
}

/// The kind of a warning.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum WarningKind {
    /// A few samples decide, so that nobody can tell how φ varies: fewer than thirty carry its
    /// variance, and events larger than all that were seen may be missing; the tail is so heavy
    /// that there may be no variance; or none does, since φ is the same to the bit on all of them.
    /// Blocks [`Judged::variance`].
    FewSamples,
    /// The steps of the finest level do not resolve this component of the state, counted from one.
    /// Fine and coarse paths differ by more than half of its motion in root mean square, or by no
    /// less than on coarser levels: a fast motion that the steps do not resolve looks like a slow
    /// one. Blocks [`Judged::resolution`], as the next five do.
    Component(usize),
    /// The steps of the finest level do not resolve φ: it multiplies phases that the states
    /// resolve, or has other events on fine paths than on coarse ones.
    Function,
    /// The steps of the finest level do not resolve the damping: it oscillates or has pulses within
    /// the steps, or rate and integral contradict each other, so that its sums over the steps
    /// differ from ∫₀ᵗγ.
    Damping,
    /// The steps of the finest level do not resolve what changes with time, see
    /// [`DriveResolution`](mc::DriveResolution).
    Drive,
    /// The steps of the finest level do not resolve noise and forces within a step of strong
    /// damping: each of three steps in a row has an ∫|γ| above one. Step sizes that all forget
    /// noise and forces agree.
    StrongDamping,
    /// The [fastest motion](super::ExpectSettings::fastest) has more than one radian, or e-folding,
    /// in a step of the finest level. Exact flows have its phase at any step size, and the effects
    /// of noise and damping on it only where they are often enough.
    FastMotion,
    /// The differences fall more slowly than the weak order says; the bias is extrapolated by the
    /// observed order then.
    Order,
    /// The differences fall with an order below ½ and below half of the one given. Blocks
    /// [`Judged::bias`].
    Slow,
    /// The coarse mean of a level contradicts the fine mean of the level below, which has the same
    /// expectation. Blocks [`Judged::bias`].
    Telescope,
    /// Paths without a solution were left out: the estimate is conditional on survival.
    FailedPaths,
    /// The path-steps that are allowed did not reach the accuracy.
    Cost,
    /// The accuracy takes more path-steps than are allowed, or paths fail at all step sizes alike;
    /// no more samples were drawn.
    OutOfReach,
    /// The bias is too large on the finest level allowed, or its steps do not resolve the motion.
    Level,
    /// The computation was [stopped](super::ExpectSettings::stop).
    Stopped,
}

impl Warning {
    pub(super) fn of_all(kind: WarningKind, message: Message) -> Self {
        Self { kind, observables: Vec::new(), message }
    }

    /// Adds a φ to the warning of this kind, which is this one if there is none yet.
    pub(super) fn add_to(self, warnings: &mut Vec<Self>, observable: &str) {
        let known = warnings.iter().position(|warning| warning.kind == self.kind);
        let n = known.unwrap_or(warnings.len());
        if known.is_none() {
            warnings.push(self);
        }
        let names = &mut warnings[n].observables;
        if names.last().is_none_or(|last| last != observable) {
            names.push(observable.to_owned());
        }
    }

    /// Whether the warning concerns this φ.
    pub(super) fn concerns(&self, observable: &String) -> bool {
        self.observables.is_empty() || self.observables.contains(observable)
    }
    /// The message with the names of the φ that are concerned.
    pub fn told(&self) -> Message {
        match &self.observables[..] {
            [] => self.message.clone(),
            names => self.message.clone().about(names.join(", ")),
        }
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.told().fmt(f)
    }
}

/// Each expectation with its interval and the parts of it, what it cost, and warnings.
impl fmt::Display for Expectation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { scheme, accuracy, single_steps, cost, levels, warnings, .. } = self;
        let longest = self.all().map(|one| one.name.chars().count()).max().unwrap_or(0);
        for estimate in self.all() {
            let name = format!("E[{}]", estimate.name);
            writeln!(f, "{name:width$} = {estimate}", width = longest + 3)?;
        }
        let finest = levels.iter().map(|level| level.tau).fold(f64::INFINITY, f64::min);
        writeln!(f, "{scheme} with steps down to {finest:.2e}, {:.2e} path-steps", *cost as f64)?;
        if let Some(steps) = single_steps {
            writeln!(f, "levels do not help: single paths at {steps} steps")?;
        }
        warnings.iter().try_for_each(|warning| writeln!(f, "warning: {warning}"))?;
        if !self.reached() {
            writeln!(f, "the accuracy {accuracy:.1e} was NOT reached")?;
        }
        Ok(())
    }
}

/// A number to two digits of its error, with a power of ten where both are small or it is large.
pub fn written(x: f64, error: f64) -> String {
    let place = |x: f64| match x {
        0.0 => -9,
        _ if x.is_finite() => log10(x.abs()).floor() as i32,
        _ => -9,
    };
    let digits = |n: i32| n.clamp(0, 16) as usize;
    if x == 0.0 || (1e-3..1e6).contains(&x.abs().max(error.abs())) {
        format!("{x:.*}", digits(1 - place(error)))
    } else {
        format!("{x:.*e}", digits(1 + place(x) - place(error)))
    }
}

/// A number in three digits.
pub fn short(x: f64) -> String {
    written(x, 0.1 * x)
}

/// The value to two digits of the half-width, and the parts of that.
impl fmt::Display for Estimate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let half_width = self.half_width();
        if half_width == f64::INFINITY {
            let value = if self.value.is_nan() { "no mean".into() } else { short(self.value) };
            return write!(f, "{value}, no interval; NOT to be believed");
        }
        let value = written(self.value, half_width);
        let sampling = hypot(self.quantile * self.standard_error, self.missed);
        let believed = if self.judged.all() { "" } else { "; NOT to be believed" };
        write!(
            f,
            "{value} ± {half_width:.1e} (95 %): sampling {sampling:.1e}, bias at most \
             {:.1e}{believed}",
            self.bias_bound
        )
    }
}
