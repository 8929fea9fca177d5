//! The contract of `stability.json`; documented for other languages in `docs/results.md`.

use std::fmt::Display;

use serde::Serialize;
use verify::results::Provenance;

use crate::cases::Case;

/// Raised whenever a reader of an older version would misread a newer one.
pub const SCHEMA: u32 = 1;

/// Everything that was tried.
#[derive(Serialize)]
pub struct Stability {
    /// [`SCHEMA`].
    pub schema: u32,
    /// Where it comes from.
    pub provenance: Provenance,
    /// The hard cases.
    pub cases: Vec<CaseResult>,
    /// The conformal law over long times.
    pub growth: Vec<Growth>,
    /// What was fuzzed.
    pub fuzz: Vec<Fuzzed>,
}

impl Stability {
    /// How many guarantees were refuted, by a case, by a long run or by fuzzing.
    pub fn refuted(&self) -> usize {
        let rows = self.cases.iter().flat_map(|case| &case.rows).map(|row| row.verdict);
        let verdicts = rows.chain(self.growth.iter().map(|run| run.verdict));
        verdicts.filter(|verdict| *verdict == Verdict::Refuted).count()
            + self.fuzz.iter().filter(|fuzzed| fuzzed.failures > 0).count()
    }
}

/// What became of a guarantee.
#[derive(Clone, Copy, Default, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// The stated bound was kept.
    Holds,
    /// Theory predicts that the scheme fails here, and it does.
    FailsAsItMust,
    /// Nothing is guaranteed; the figure is what was measured.
    #[default]
    Observed,
    /// A stated bound was broken, or a scheme that must fail did not.
    Refuted,
}

/// One family of hard inputs.
#[derive(Serialize)]
pub struct CaseResult {
    /// What the case is about.
    #[serde(flatten)]
    pub case: &'static Case,
    /// Every setting with every scheme.
    pub rows: Vec<Row>,
}

/// One scheme in one setting of a case.
#[derive(Default, Serialize)]
pub struct Row {
    /// What is set, in words.
    pub setting: String,
    /// As a number, where it is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub x: Option<f64>,
    /// `sexp`, `sexp-newton`, `sexp-levy`, `midpoint`, `heun`, `em`; or the discrete gradient that
    /// is tested.
    pub scheme: &'static str,
    /// The measured figure; none where it is not finite.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub measured: Option<f64>,
    /// The exact value of the figure, where there is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub exact: Option<f64>,
    /// The bound that is guaranteed, or that a scheme that must fail has to break.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bound: Option<f64>,
    /// The typed error that ended the run, if one did.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error: Option<String>,
    /// What became of the guarantee.
    pub verdict: Verdict,
    /// Whether Newton's method came first: not drawn, since it looks like the fixed point.
    #[serde(skip)]
    pub newton: bool,
}

impl Row {
    /// A row without a figure, of which nothing is guaranteed.
    pub fn new(
        setting: impl Display,
        x: Option<f64>,
        scheme: &'static str,
        error: Option<String>,
    ) -> Self {
        Self { setting: setting.to_string(), x, scheme, error, ..Self::default() }
    }

    /// With a figure, which must be a number unless there is an error.
    pub fn with_figure(self, figure: f64) -> Self {
        let measured = Some(figure).filter(|figure| figure.is_finite());
        let seen = measured.is_some() || self.error.is_some();
        let verdict = if seen { self.verdict } else { Verdict::Refuted };
        Self { measured, verdict, ..self }
    }

    /// A guarantee that was kept or not, with its bound where that is one of the figure.
    pub fn guaranteed(self, kept: bool, bound: impl Into<Option<f64>>) -> Self {
        let verdict = if kept { Verdict::Holds } else { Verdict::Refuted };
        Self { bound: bound.into(), verdict, ..self }
    }

    /// A guarantee that the figure is at most `bound`, up to the end.
    pub fn at_most(self, bound: f64) -> Self {
        let kept = self.error.is_none() && self.measured.is_some_and(|figure| figure <= bound);
        self.guaranteed(kept, bound)
    }

    /// The scheme must exceed `bound` or stop with an error.
    pub fn must_exceed(self, bound: f64) -> Self {
        let fails = self.error.is_some() || self.measured.is_some_and(|figure| figure > bound);
        let verdict = if fails { Verdict::FailsAsItMust } else { Verdict::Refuted };
        Self { bound: Some(bound).filter(|bound| bound.is_finite()), verdict, ..self }
    }
}

/// How the distance from the conformal law grows over a long time.
#[derive(Serialize)]
pub struct Growth {
    /// Identifier.
    pub id: &'static str,
    /// System, damping and step in words.
    pub setup: String,
    /// The scheme.
    pub scheme: &'static str,
    /// The invariant.
    pub invariant: &'static str,
    /// Independent paths.
    pub paths: usize,
    /// The relative defect over the paths.
    pub points: Vec<GrowthPoint>,
    /// The exponent q of the root mean square ∝ n^q.
    pub exponent: f64,
    /// Lower end of its 95 % interval.
    pub lo: f64,
    /// Upper end.
    pub hi: f64,
    /// n·ε: what the defect would be if every step added one ε in the same direction.
    pub linear: f64,
    /// What became of the guarantee.
    pub verdict: Verdict,
    /// Whether the figure shows it.
    #[serde(skip)]
    pub drawn: bool,
}

/// The defect d = F(y_n)e^{pΓ}/F(y₀) − 1 after n steps.
#[derive(Serialize)]
pub struct GrowthPoint {
    /// n.
    pub steps: u64,
    /// Root mean square of d.
    pub rms: f64,
    /// Mean of d.
    pub mean: f64,
    /// Largest |d|.
    pub max: f64,
}

/// One target of the fuzzer.
#[derive(Default, Serialize)]
pub struct Fuzzed {
    /// What was fed.
    pub target: &'static str,
    /// What is checked.
    pub checks: &'static str,
    /// Inputs.
    pub inputs: u64,
    /// Inputs that were accepted.
    pub accepted: u64,
    /// Inputs that were refused with a typed error, or ended in one.
    pub refused: u64,
    /// The largest number of iterations of one solve, where something is solved.
    pub most_iterations: u64,
    /// Inputs that broke a check.
    pub failures: u64,
    /// The first few of them, in words.
    pub examples: Vec<String>,
}
