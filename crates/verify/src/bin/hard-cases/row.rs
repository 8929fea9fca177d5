//! A row of a case: one scheme in one setting, with its verdict.

use std::fmt::Display;

/// What became of a guarantee.
#[derive(Clone, Copy, Default, PartialEq)]
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

/// One scheme in one setting of a case.
#[derive(Clone, Default)]
pub struct Row {
    /// What is set, in words.
    pub setting: String,
    /// `sexp`, `sexp-newton`, `sexp-levy`, `sexp-li`, `split`, `nv`, `midpoint`, `heun`, `em`; or the
    /// discrete gradient that is tested.
    pub scheme: &'static str,
    /// The measured figure; none where it is not finite.
    pub measured: Option<f64>,
    /// The exact value of the figure, where there is one.
    pub exact: Option<f64>,
    /// The bound that is guaranteed, or that a scheme that must fail has to break.
    pub bound: Option<f64>,
    /// The typed error that ended the run, if one did.
    pub error: Option<String>,
    /// What became of the guarantee.
    pub verdict: Verdict,
}

impl Row {
    /// A row without a figure, of which nothing is guaranteed.
    pub fn new(setting: impl Display, scheme: &'static str, error: Option<String>) -> Self {
        Self { setting: setting.to_string(), scheme, error, ..Self::default() }
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
