//! The table of one path.

use serde::Serialize;
use systems::{Invariant, PoissonSystem};

/// The table of one path, with everything needed to compute it again.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TimeSeries {
    /// Name of the system.
    pub system: String,
    /// Formula of γ.
    pub damping: String,
    /// Identifier of the scheme.
    pub scheme: String,
    /// Step size.
    pub tau: f64,
    /// Origin of the increments.
    pub noise: NoiseOrigin,
    /// The failure of the path, if it ends before the final time.
    pub halted: Option<String>,
    /// `t`, `y1` … `yD`, the observables, and for each invariant its value and its defect.
    /// Invariants with the same name are numbered. The defect of F is (F − F₀)/|F₀| with F₀ =
    /// e^{−p∫γ}F(y₀), or F itself if F(y₀) = 0.
    pub columns: Vec<Column>,
}

/// The origin of the increments of a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum NoiseOrigin {
    /// Drawn from a stream.
    Drawn {
        /// Master seed.
        seed: u64,
        /// Number of the experiment.
        experiment: u64,
        /// Number of the path.
        path: u64,
    },
    /// From a recording.
    Recorded,
}

/// One quantity at the saved times.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Column {
    /// Its name.
    pub name: String,
    /// Its values. In JSON a value that is not finite is `null`.
    pub values: Vec<f64>,
}

impl TimeSeries {
    /// The values of the column with this name, if there is one.
    pub fn column(&self, name: &str) -> Option<&[f64]> {
        let column = self.columns.iter().find(|column| column.name == name)?;
        Some(&column.values)
    }

    /// The saved times.
    pub fn times(&self) -> &[f64] {
        self.column("t").unwrap_or_default()
    }
}

/// An invariant with the name of its column and its initial value.
pub(super) struct InvariantColumn {
    pub(super) name: String,
    degree: f64,
    initial: f64,
}

impl InvariantColumn {
    pub(super) fn of<S: PoissonSystem<D, M>, const D: usize, const M: usize>(
        system: &S,
        y0: [f64; D],
    ) -> Vec<Self> {
        let known = system.invariants();
        let column = |(index, invariant): (usize, &Invariant)| {
            let shares = |other: &&Invariant| other.name == invariant.name;
            let name = if known.iter().filter(shares).count() > 1 {
                format!("{}{}", invariant.name, 1 + known[..index].iter().filter(shares).count())
            } else {
                invariant.name.to_owned()
            };
            Self { name, degree: invariant.degree, initial: system.invariant(index, y0) }
        };
        known.iter().enumerate().map(column).collect()
    }

    /// The relative defect of `value` from the conformal law, where `damped` = ∫γ.
    pub(super) fn defect(&self, value: f64, damped: f64) -> f64 {
        let law = (-self.degree * damped).exp() * self.initial;
        if self.initial == 0.0 { value } else { (value - law) / law.abs() }
    }
}
