//! The contract of `work-precision.json`.

use analysis::{
    compare::{Cost, Curve, Series, Strong, StrongPoint, Weak, WeakPoint},
    results::Provenance,
};
use serde::Serialize;
use verify::setups::Kind;

/// Raised whenever a reader of an older version would misread a newer one.
pub const SCHEMA: u32 = 2;

/// Everything measured.
#[derive(Serialize)]
pub struct Measurements {
    /// [`SCHEMA`].
    pub schema: u32,
    /// Where it comes from.
    pub provenance: Provenance,
    /// What the times are, in words.
    pub clock: &'static str,
    /// The cases.
    pub cases: Vec<Case>,
}

/// One problem.
#[derive(Serialize)]
pub struct Case {
    /// Identifier, for example `rigid-body-3`.
    pub id: &'static str,
    /// What it is called on a figure.
    pub title: &'static str,
    /// Parameters in words.
    pub setup: String,
    /// What the schemes are, in the order of the series.
    #[serde(skip)]
    pub kinds: Vec<Kind>,
    /// The invariants whose conformal defect is measured, in the order of the system; none where it
    /// has none.
    pub invariants: Vec<&'static str>,
    /// Strong errors.
    pub strong: Strong,
    /// Weak errors.
    pub weak: Weak,
    /// What estimates cost, of every test function by every scheme in the order of the weak errors.
    pub costs: Vec<Vec<Costs>>,
}

/// What estimates of several accuracies cost by one scheme, the least accurate first.
#[derive(Serialize)]
pub struct Costs {
    /// The scheme.
    pub scheme: String,
    /// The costs.
    pub costs: Vec<Cost>,
}

impl Costs {
    /// Of a scheme.
    pub fn of(series: &Series<WeakPoint>) -> Self {
        Self { scheme: series.scheme.clone(), costs: series.costs() }
    }
}

impl Case {
    /// The strong errors of the schemes of some kind, from the first on.
    pub fn series(
        &self,
        kind: impl Fn(Kind) -> bool,
    ) -> impl Iterator<Item = &Series<StrongPoint>> {
        let kinds = self.strong.series.iter().zip(&self.kinds);
        kinds.filter(move |(_, of)| kind(**of)).map(|(series, _)| series)
    }

    /// (error, microseconds of a path) of all schemes.
    pub fn curves(&self) -> Vec<Curve> {
        self.strong.series.iter().map(in_microseconds).collect()
    }
}

/// (error, microseconds of a path).
pub fn in_microseconds(series: &Series<StrongPoint>) -> Curve {
    let mut curve = series.curve();
    curve.points.iter_mut().for_each(|(_, cost)| *cost *= 1e6);
    curve
}
