//! A Poisson system as texts, and errors in them.

use std::fmt::{self, Display};

use crate::{Formula, FormulaError, NameError, Names};

/// The texts of a Poisson system dy = B∇H₀ dt + Σₘ B∇Hₘ ∘ dWₘ.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Definition {
    /// The name of the system in reports.
    pub name: String,
    /// The names of the components of y.
    pub state: Vec<String>,
    /// Vectors of components: their names and the names of their components.
    pub vectors: Vec<(String, Vec<String>)>,
    /// Names and values of parameters.
    pub parameters: Vec<(String, f64)>,
    /// B, row by row: all D×D entries, or the entries above the diagonal, in rows of D − 1, …, 1.
    pub structure: Vec<Vec<String>>,
    /// H₀.
    pub energy: String,
    /// H₁, …, one for each noise.
    pub noises: Vec<String>,
}

/// The faulty part of a [`Definition`], or its initial value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Which {
    /// The names of components and parameters.
    State,
    /// The initial value.
    InitialValue,
    /// The rows of B.
    Matrix,
    /// The entry of B in this row and column, counted from 1.
    Structure(usize, usize),
    /// H₀.
    Energy,
    /// Hₘ for m = 1, ….
    Noise(usize),
}

impl Display for Which {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::State => f.write_str("the state"),
            Self::InitialValue => f.write_str("the initial value"),
            Self::Matrix => f.write_str("B"),
            Self::Structure(row, column) => write!(f, "B, row {row}, column {column}"),
            Self::Energy => f.write_str("H0"),
            Self::Noise(m) => write!(f, "H, noise {m}"),
        }
    }
}

/// A [`Definition`] that is not a Poisson system, or has no values at its initial value.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{message}")]
pub struct DefinitionError {
    /// Faulty part of the definition.
    pub which: Which,
    /// Description of the mistake.
    pub message: String,
    /// Error in a text that is not a formula, or has no finite value at the initial value.
    pub formula: Option<Box<FormulaError>>,
}

impl DefinitionError {
    pub(super) fn new(which: Which, message: impl Into<String>) -> Self {
        Self { which, message: message.into(), formula: None }
    }
}

impl From<NameError> for DefinitionError {
    fn from(NameError(message): NameError) -> Self {
        Self::new(Which::State, message)
    }
}

/// The formulas of a definition, B by its entries above the diagonal.
pub(super) struct Formulas {
    pub names: Names,
    /// Row i has the entries i + 1, … of that row of B.
    pub structure: Vec<Vec<Formula>>,
    /// H₀, H₁, …, whose last variable is the time.
    pub hamiltonians: Vec<Formula>,
}

impl Formulas {
    pub fn new(definition: &Definition, y0: &[f64]) -> Result<Self, DefinitionError> {
        let Definition { state, vectors, parameters, structure, energy, noises, .. } = definition;
        let mut names = Names::with_variables(state)?;
        for (name, components) in vectors {
            names.vector(name, components)?;
        }
        for (name, value) in parameters {
            names.parameter(name, *value)?;
        }
        let (mut timed, start) = (names.clone(), [y0, &[0.0]].concat());
        timed.variable("t")?;
        let parsed = |which: Which, text: &str| -> Result<Formula, DefinitionError> {
            let is_entry = matches!(which, Which::Structure(..));
            let names = if is_entry { &names } else { &timed };
            let formula = Formula::parse(text, names).and_then(|formula| {
                let reason = formula.explain(&start[..formula.variables.len()]);
                let at_y0 = |message| format!("{message} at the initial value");
                let wrong = |e: FormulaError| FormulaError { message: at_y0(e.message), ..e };
                let reason = formula.condition().or(reason.map(wrong));
                reason.map_or(Ok(formula), Err)
            });
            formula.map_err(|error| DefinitionError {
                formula: Some(Box::new(error.clone())),
                ..DefinitionError::new(which, format!("{which}: {error}"))
            })
        };
        let hamiltonian = |(m, text): (usize, &String)| {
            let which = if m == 0 { Which::Energy } else { Which::Noise(m) };
            let formula = parsed(which, text)?;
            has_gradient(which, &formula, &start)?;
            Ok(formula)
        };
        check_initial_value(state, y0)?;
        let structure = upper(structure, y0, parsed)?;
        let hamiltonians = std::iter::once(energy).chain(noises).enumerate().map(hamiltonian);
        let hamiltonians = hamiltonians.collect::<Result<_, DefinitionError>>()?;
        Ok(Self { structure, hamiltonians, names })
    }
}

fn check_initial_value(state: &[String], y0: &[f64]) -> Result<(), DefinitionError> {
    let (dimension, components) = (state.len(), y0.len());
    let infinite = y0.iter().zip(state).find(|(value, _)| !value.is_finite());
    let what = match infinite {
        _ if dimension == 0 => {
            return Err(DefinitionError::new(Which::State, "the state has no component"));
        }
        _ if dimension != components => format!("have {dimension} components, got {components}"),
        Some((value, name)) => format!("be finite, got {name} = {value}"),
        None => return Ok(()),
    };
    Err(DefinitionError::new(Which::InitialValue, format!("the initial value must {what}")))
}

/// Checks that all derivatives of a formula by components are finite.
fn has_gradient(which: Which, formula: &Formula, start: &[f64]) -> Result<(), DefinitionError> {
    let all: Vec<usize> = (0..start.len() - 1).collect();
    let mut gradient = vec![0.0; all.len()];
    formula.gradient(&all).evaluate_one(&[start], &mut gradient);
    match gradient.iter().zip(&*formula.variables).find(|(slope, _)| !slope.is_finite()) {
        Some((slope, variable)) => {
            let message =
                format!("the derivative of {which} by {variable} is {slope} at the initial value");
            Err(DefinitionError::new(which, message))
        }
        None => Ok(()),
    }
}

/// The entries of B above the diagonal.
fn upper(
    texts: &[Vec<String>],
    y0: &[f64],
    parsed: impl Fn(Which, &str) -> Result<Formula, DefinitionError>,
) -> Result<Vec<Vec<Formula>>, DefinitionError> {
    let dimension = y0.len();
    let rows: Vec<usize> = texts.iter().map(Vec::len).collect();
    let is_full = rows == vec![dimension; dimension];
    let is_upper = rows.iter().copied().eq((1..dimension).rev());
    if !is_full && !is_upper {
        let message = format!(
            "B must have {dimension} rows of {dimension} entries, or its entries above the \
             diagonal in rows of {} to 1; its rows have {rows:?}",
            dimension - 1
        );
        return Err(DefinitionError::new(Which::Matrix, message));
    }
    let mut entries = Vec::new();
    for (i, texts) in texts.iter().enumerate() {
        let first = if is_full { 0 } else { i + 1 };
        let entry =
            |(k, text): (usize, &String)| parsed(Which::Structure(i + 1, first + k + 1), text);
        entries.push(texts.iter().enumerate().map(entry).collect::<Result<Vec<_>, _>>()?);
    }
    if is_full {
        check_skew(&entries, y0)?;
        entries.iter_mut().enumerate().for_each(|(i, row)| drop(row.drain(..=i)));
    } else {
        // The last row has no entry above the diagonal.
        entries.push(Vec::new());
    }
    Ok(entries)
}

/// The relative difference that counts as rounding: some hundred operations of 2⁻⁵³, and a loss of
/// five digits by cancellation.
const ROUNDING: f64 = 1e-9;

/// Checks bᵢⱼ = −bⱼᵢ at the initial value and points near it at which both are finite.
fn check_skew(entries: &[Vec<Formula>], y0: &[f64]) -> Result<(), DefinitionError> {
    let points = systems::probe::around(y0, |_| true);
    for i in 0..entries.len() {
        for j in 0..=i {
            let (lower, upper) = (&entries[i][j], &entries[j][i]);
            for point in &points {
                let (value, mirror) = (upper.value(point), lower.value(point));
                if (value + mirror).abs() > ROUNDING * (value.abs() + mirror.abs()) {
                    let (row, column) = (j + 1, i + 1);
                    let message = format!(
                        "B is not skew: row {row}, column {column} is {value}, and row {column}, \
                         column {row} is {mirror}, at y = {point:?}"
                    );
                    return Err(DefinitionError::new(Which::Structure(row, column), message));
                }
            }
        }
    }
    Ok(())
}
