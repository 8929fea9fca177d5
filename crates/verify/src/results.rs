//! The `results.json` contract: the results of a reproduction run, as data.
//!
//! # For other languages
//!
//! `cargo xtask reproduce` writes `results.json`. Everything but `provenance` has the same bits for
//! the same seed, mode and schemes. `schema` (now 2) is raised when a reader of an older version
//! would misread a newer one; fields may be added without. Numbers that are not finite are `null`.
//!
//! - `provenance`: `version`, `git`, `rustc`, `day`, `folder`, `cpu`, `simd`, `threads`, `seed`,
//!   `mode`, `command`, `wall_s`, …
//! - `panels`, and `supplements` that are not in the paper: `id`, `kind` (`strong`, `weak`,
//!   `invariant`, `cost`), `title`, `setup`, `paper`, `samples`, `reference`, `failures` and
//!   `series`; where increments were clipped, `clipped`.
//! - A series: `scheme`, `quantity`, `points`, `rate`, `max_relative_defect`. A point of `strong`
//!   has `tau`, `value`, `se`, `lo`, `hi`; of `weak` `tau`, `value`, `se`; of `invariant` `t`,
//!   `value`, `exact`; of `cost` `accuracy`, `path_steps`.
//! - A rate: `estimate`, `lo`, `hi`, `confidence`, `model`, `chi_square`, `degrees`, `p_value` and,
//!   where the interval is not known to cover, `warning`.
//! - `claims`: `id`, `panel`, `scheme`, `statement`, `verdict` (`holds`, `refuted`, `undecided`),
//!   `evidence` in words, `proven`, and `erratum` where the statement has a misprint. The verdict
//!   follows from the numbers in `measured`, whose `kind` is one of
//!
//! | `kind` | holds when |
//! |---|---|
//! | `order` | the interval, widened to 99.9 %, contains `order` and lies within ¼ of it |
//! | `defect` | `largest` ≤ `tolerance` where the scheme `obeys` the law, else above |
//! | `approach` | `order` − `half_width` > `least`: the scheme returns to the law as τ → 0 |
//! | `deviation` | `value` is within 4.42 `standard_error` and `bias` of `expected` |
//! | `bounds` | all `quantities` are within their bounds and no path `failed` |
//! | `undecided` | never; `reason` says why |
//!
//! The exit code is 0 unless a proven claim without an erratum is refuted (1) or the command line
//! is wrong (2).

use serde::Serialize;

pub use plot::{Kind, Provenance, Series};
pub use stats::{Point, Rate};

pub use crate::evidence::{Bounded, DEVIATIONS, Evidence};
pub use crate::verdict::{ORDER_MARGIN, Verdict, order_verdict};

/// Version of the contract. 2: claims have [`Claim::measured`], and the sentences of
/// [`Claim::evidence`] are worded anew.
pub const SCHEMA: u32 = 2;

/// Results of a whole run.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Results {
    /// Version of the contract, [`SCHEMA`].
    pub schema: u32,
    /// Place, time and manner of the run; the only part that may differ between two runs with the
    /// same seed.
    pub provenance: Provenance,
    /// The panels, in the order of the paper.
    pub panels: Vec<Panel>,
    /// Figures that are not in the paper, for example the effect of the truncation order.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub supplements: Vec<Panel>,
    /// The statements of the paper, each with a verdict.
    pub claims: Vec<Claim>,
}

impl Results {
    /// The panels, then the supplements.
    pub fn figures(&self) -> impl Iterator<Item = &Panel> {
        self.panels.iter().chain(&self.supplements)
    }
}

/// One figure of the paper.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Panel {
    /// Identifier, for example `pendulum-strong`.
    pub id: String,
    /// Kind of the curves.
    pub kind: Kind,
    /// Title in words.
    pub title: String,
    /// System, damping, initial value, final time, steps: the set-up in one line of plain text.
    pub setup: String,
    /// Statement of the paper about this figure.
    pub paper: String,
    /// Number of sample paths; for a weak panel, of the coarsest difference.
    pub samples: u64,
    /// The reference solution, in words.
    pub reference: String,
    /// Paths left out because a step had no solution or its state was not finite: for each, path,
    /// seed, experiment, scheme, step size, step, time and reason in words.
    pub failures: Vec<String>,
    /// The curves.
    pub series: Vec<Series>,
    /// Clipped increments: their numbers, and their share in the errors. Empty where none was
    /// clipped.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub clipped: Vec<Clipped>,
    /// Numbers of sample paths of each difference between neighbouring step sizes of a weak panel,
    /// coarsest first.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub differences: Vec<DifferenceSamples>,
}

/// The sample paths of one difference of a weak panel.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DifferenceSamples {
    /// The coarser step size; the finer one is half of it.
    pub tau: f64,
    /// Number of sample paths.
    pub samples: u64,
}

/// Clipped increments of one curve at one step size.
#[derive(Clone, Debug, Serialize)]
pub struct Clipped {
    /// Scheme id, as that of the curve.
    pub scheme: String,
    /// Step size.
    pub tau: f64,
    /// Number of clipped increments of this step size, over all paths.
    pub increments: u64,
    /// Share of the paths with clipped increments in the mean-square error at the final time.
    pub share: f64,
}

/// Statement, the measurement about it, and the verdict.
#[derive(Clone, Debug, Serialize)]
pub struct Claim {
    /// Identifier, for example `strong-one`.
    pub id: String,
    /// Panel that the statement was measured on; empty when it was measured on its own.
    pub panel: String,
    /// Scheme that the statement is about; empty when it is about none.
    pub scheme: String,
    /// The statement in words.
    pub statement: String,
    /// Verdict that follows from the measurement, see [`Evidence::verdict`].
    pub verdict: Verdict,
    /// The measurement as a sentence.
    pub evidence: String,
    /// The measurement as data.
    pub measured: Evidence,
    /// Whether the paper proves the statement: a refuted proven claim fails the run.
    pub proven: bool,
    /// The documented reason why a refutation is expected (a misprint in the statement), or empty.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub erratum: String,
}

impl Claim {
    /// Creates a claim that the paper proves, about no panel and no scheme; the verdict and the
    /// sentence follow from the measurement.
    pub fn new(id: &str, statement: impl Into<String>, measured: Evidence) -> Self {
        Self {
            id: id.into(),
            panel: String::new(),
            scheme: String::new(),
            statement: statement.into(),
            verdict: measured.verdict(),
            evidence: measured.sentence(),
            measured,
            proven: true,
            erratum: String::new(),
        }
    }

    /// The verdict in a word: a refutation that a documented misprint explains is
    /// set apart.
    pub fn outcome(&self) -> &'static str {
        match self.verdict {
            Verdict::Refuted if self.erratum.is_empty() => "refuted",
            Verdict::Undecided => "undecided",
            Verdict::Holds => "holds",
            Verdict::Refuted => "misprint",
        }
    }

    /// Sets the panel and the scheme that the claim is about; either may be empty.
    #[must_use]
    pub fn about(self, panel: &str, scheme: &str) -> Self {
        Self { panel: panel.into(), scheme: scheme.into(), ..self }
    }

    /// Sets whether the paper proves the claim.
    #[must_use]
    pub fn proven(self, proven: bool) -> Self {
        Self { proven, ..self }
    }
}
