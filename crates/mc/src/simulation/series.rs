//! What is kept of one path.

use serde::Serialize;
use systems::{Invariant, PoissonSystem};

use super::SimulationError;

/// One path as a table, with where it comes from.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TimeSeries {
    /// Name of the system.
    pub system: String,
    /// γ in words.
    pub damping: String,
    /// Identifier of the scheme.
    pub scheme: String,
    /// Step size.
    pub tau: f64,
    /// Where the increments come from.
    pub noise: NoiseOrigin,
    /// Why the path ends before the final time, if it does.
    pub halted: Option<String>,
    /// `t`, `y1` … `yD`, the observables, and for each invariant its value and its defect.
    /// Invariants that share a name are numbered. The defect is (F − F₀)/|F₀| with F₀ =
    /// e^{−p∫γ}F(y₀), and F itself where F(y₀) = 0.
    pub columns: Vec<Column>,
}

/// Where increments come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum NoiseOrigin {
    /// Drawn, and drawn again by the same three numbers.
    Drawn {
        /// Master seed.
        seed: u64,
        /// Number of the experiment.
        experiment: u64,
        /// Number of the path.
        path: u64,
    },
    /// Given as a recording.
    Recorded,
}

/// One quantity at the saved times.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Column {
    /// Its name.
    pub name: String,
    /// Its values; in JSON `null` stands for what is not finite.
    pub values: Vec<f64>,
}

impl TimeSeries {
    /// The values of a column.
    #[must_use]
    pub fn column(&self, name: &str) -> Option<&[f64]> {
        self.columns
            .iter()
            .find(|column| column.name == name)
            .map(|column| column.values.as_slice())
    }

    /// The saved times.
    #[must_use]
    pub fn times(&self) -> &[f64] {
        self.column("t").unwrap_or_default()
    }

    pub(super) fn add_column(&mut self, name: String) -> Result<(), SimulationError> {
        if self.column(&name).is_some() {
            return Err(SimulationError::Column { name });
        }
        self.columns.push(Column { name, values: Vec::new() });
        Ok(())
    }
}

/// An invariant with the name of its column and its value at the start.
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

    /// How far `value` is from the conformal law after damping by `damped` = ∫γ.
    pub(super) fn defect(&self, value: f64, damped: f64) -> f64 {
        let law = (-self.degree * damped).exp() * self.initial;
        if self.initial == 0.0 { value } else { (value - law) / law.abs() }
    }
}
