//! The table of one path, and tables as a file.

use std::io::{self, Write};

use serde::Serialize;

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
    /// Stream of the noise, unless the noise was given.
    pub noise: NoiseOrigin,
    /// Failure of the path, or a note that it was stopped, if it ends before the final time.
    pub halted: Option<String>,
    /// Columns `t`, `y1` … `yD`, the observables, and for each invariant its value and its defect.
    /// Invariants with the same name are numbered. The defect of F is (F − F₀)/|F₀| with F₀ =
    /// e^{−p∫γ}F(y₀), or F itself if F(y₀) = 0.
    pub columns: Vec<Column>,
}

/// The stream of the noise of a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct NoiseOrigin {
    /// Master seed.
    pub seed: u64,
    /// Number of the experiment.
    pub experiment: u64,
    /// Number of the path.
    pub path: u64,
}

/// One quantity at the saved times.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Column {
    /// Name of the quantity.
    pub name: String,
    /// Role of the quantity.
    #[serde(skip)]
    pub role: Role,
    /// Values at the saved times. In JSON a value that is not finite is `null`.
    pub values: Vec<f64>,
}

/// The role of a column.
#[derive(Clone, Debug, PartialEq)]
pub enum Role {
    /// The time t.
    Time,
    /// A component of the state.
    Component,
    /// An observable.
    Observable,
    /// A function that has a conformal law.
    Conserved,
    /// The relative defect from the conformal law of a function.
    Defect {
        /// Name of the column of the function.
        of: String,
        /// Values of the law.
        law: Vec<f64>,
    },
}

impl TimeSeries {
    /// The values of the column with this name, if there is one.
    pub fn column(&self, name: &str) -> Option<&[f64]> {
        self.columns.iter().find(|column| column.name == name).map(|column| &column.values[..])
    }

    /// The saved times.
    pub fn times(&self) -> &[f64] {
        let column = self.columns.iter().find(|column| column.role == Role::Time);
        column.map_or(&[], |column| &column.values)
    }
}

/// Writes the tables of all paths as one CSV table with the columns `scheme`, `path` and those of
/// the tables. `path` is the number of the path. Numbers are written in the shortest
/// form that is read back to the same bits.
///
/// # Errors
/// Those of the writer. [`io::ErrorKind::InvalidInput`] if the columns of the paths differ.
pub fn write_csv(series: &[TimeSeries], out: &mut impl Write) -> io::Result<()> {
    let Some(first) = series.first() else { return Ok(()) };
    let names = |series: &TimeSeries| {
        let names: Vec<_> = series.columns.iter().map(|column| quoted(&column.name)).collect();
        names.join(",")
    };
    let header = names(first);
    writeln!(out, "scheme,path,{header}")?;
    for one in series {
        let found = names(one);
        if found != header {
            let message = format!("all paths must have the columns {header}, got {found}");
            return Err(io::Error::new(io::ErrorKind::InvalidInput, message));
        }
        for row in 0..one.times().len() {
            write!(out, "{},{}", quoted(&one.scheme), one.noise.path)?;
            for column in &one.columns {
                write!(out, ",{:?}", column.values[row])?;
            }
            writeln!(out)?;
        }
    }
    Ok(())
}

/// The entry in quotes if it contains a comma, a quote or a line break (RFC 4180).
pub fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.into()
    }
}
