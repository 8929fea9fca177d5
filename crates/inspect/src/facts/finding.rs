//! Whether an identity holds.

use serde::Serialize;

use super::largest;

/// The answer to whether a property holds, from the worst to the best.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Status {
    /// Fails: there is a counterexample beyond round-off.
    Fails,
    /// Undecided: round-off hides the answer, or a value is not finite.
    Unknown,
    /// Holds to round-off at every point that was checked, of which there may be none yet.
    #[default]
    Holds,
}

impl Status {
    /// Whether the property holds at every point that was checked.
    #[must_use]
    pub fn holds(self) -> bool {
        self == Self::Holds
    }

    /// The answer in words, from those for all three, the worst first.
    pub(crate) fn words(self, [fails, unknown, holds]: [&str; 3]) -> &str {
        match self {
            Self::Fails => fails,
            Self::Unknown => unknown,
            Self::Holds => holds,
        }
    }
}

/// Result of checking an identity at points: the answer and the largest relative defect. By default
/// at no points yet: the identity holds.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Finding {
    /// The answer.
    pub status: Status,
    /// Largest defect relative to the terms of the identity, among the points with this answer.
    pub defect: f64,
    /// The point of the defect.
    pub at: Vec<f64>,
    /// The number of points.
    pub points: usize,
    #[serde(skip)]
    kind: Tolerance,
}

/// Rule for a defect that is far below the largest terms, though not below its own.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
enum Tolerance {
    /// Counts the defect as rounding.
    #[default]
    Usual,
    /// Leaves the defect undecided, since a rounded constant may cause it.
    Strict,
    /// Counts the defect as rounding, and allows for errors of fitted coefficients.
    Fitted,
}

/// Number of states of a cluster: a point and others at the relative distance [`APART`]. A defect
/// that is not about the same at all of them is round-off.
pub const CLUSTER: usize = 4;
/// The distance of the states of a cluster, relative to each component.
pub const APART: f64 = 1e-9;
/// The ratio of defects in a cluster that are about the same.
const ALIKE: f64 = 1.5;
/// Part of its own terms below which a defect is round-off: some tens of ε.
const ROUNDING: f64 = 1e-14;
/// Part of its terms above which a defect that is the same in the whole cluster is not due to
/// rounded constants.
const DEFECT: f64 = 1e-12;
/// Part of the terms above which round-off leaves an identity undecided.
const COARSE: f64 = 1e-11;
/// Part of the largest terms below which a defect may be due to rounded constants.
const FAINT: f64 = 2.0 * f64::EPSILON;

/// Defect with the size of the terms whose sum it is.
pub type Term = (f64, f64);

impl Finding {
    /// Starts a finding on an identity that decides an order: a defect that larger terms hide is
    /// undecided.
    pub(crate) fn strict() -> Self {
        Self { kind: Tolerance::Strict, ..Self::default() }
    }

    /// Starts a finding on an identity whose coefficients were fitted.
    pub(crate) fn fitted() -> Self {
        Self { kind: Tolerance::Fitted, ..Self::default() }
    }

    /// Records the identity at the states of a cluster around `at`, component by component. `wide`
    /// is the size of terms that are not among those given.
    pub(crate) fn record(&mut self, at: &[f64], cluster: &[Vec<Term>], wide: f64) {
        self.points += 1;
        let sizes = cluster.iter().flatten().map(|term| &term.1);
        let wide = largest(sizes.chain([&wide]));
        for i in 0..cluster.first().map_or(0, Vec::len) {
            let own = largest(cluster.iter().map(|terms| &terms[i].1));
            let defects: Vec<f64> = cluster.iter().map(|terms| terms[i].0).collect();
            let high = largest(&defects);
            let low = defects.iter().fold(f64::INFINITY, |low, x| low.min(x.abs()));
            let signs = defects.iter().all(|x| (*x < 0.0) == (defects[0] < 0.0));
            let strict = self.kind == Tolerance::Strict;
            let [rounding, defect] = match self.kind {
                Tolerance::Fitted => [DEFECT, 2.0 * DEFECT],
                _ => [ROUNDING, DEFECT],
            };
            let hidden = |holds| if holds { Status::Holds } else { Status::Unknown };
            let status = if !(high.is_finite() && wide.is_finite()) {
                Status::Unknown
            } else if high <= (rounding * own).max(f64::MIN_POSITIVE) {
                Status::Holds
            } else if !(signs && high <= ALIKE * low) {
                hidden(high <= COARSE * wide)
            } else if low <= if strict { FAINT } else { 8.0 * FAINT } * wide {
                hidden(!strict)
            } else if low <= defect * own {
                Status::Unknown
            } else {
                Status::Fails
            };
            let size = if status == Status::Fails { own } else { wide };
            let relative = if high == 0.0 { 0.0 } else { high / size };
            if status < self.status
                || self.at.is_empty()
                || (status == self.status && relative > self.defect)
            {
                (self.status, self.defect, self.at) = (status, relative, at.to_vec());
            }
        }
    }

    /// Whether the identity holds at every point.
    #[must_use]
    pub fn holds(&self) -> bool {
        self.status.holds()
    }

    /// Whether there is a counterexample to the identity.
    #[must_use]
    pub fn fails(&self) -> bool {
        self.status == Status::Fails
    }
}

/// Term of a sum that should be zero: the sum and the sum of absolute values.
pub fn sum(addends: impl IntoIterator<Item = f64>) -> Term {
    addends.into_iter().fold((0.0, 0.0), |(sum, size), x| (sum + x, size + x.abs()))
}

/// Term of the identity aᵀb = 0.
pub fn product(a: &[f64], b: &[f64]) -> Term {
    sum(a.iter().zip(b).map(|(a, b)| a * b))
}

/// The terms of a = b, component by component.
pub fn differences(a: &[f64], b: &[f64]) -> Vec<Term> {
    a.iter().zip(b).map(|(a, b)| sum([*a, -b])).collect()
}

/// Componentwise sum of two lists of terms.
pub fn combined(a: &[Term], b: &[Term]) -> Vec<Term> {
    a.iter().zip(b).map(|(a, b)| (a.0 + b.0, a.1 + b.1)).collect()
}
