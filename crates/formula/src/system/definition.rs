//! A Poisson system as texts, and what can be wrong with them.

use std::fmt::{self, Display};

use crate::{Formula, FormulaError, NameError, Names};

/// The texts of a Poisson system dy = B∇H₀ dt + Σₘ B∇Hₘ ∘ dWₘ.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Definition {
    /// The name of the system in reports.
    pub name: String,
    /// The names of the components of y.
    pub state: Vec<String>,
    /// Names and values of parameters.
    pub parameters: Vec<(String, f64)>,
    /// B, row by row: all D×D entries, or the entries above the diagonal, in rows of D − 1, …, 1.
    pub structure: Vec<Vec<String>>,
    /// H₀.
    pub energy: String,
    /// H₁, …, one for each noise.
    pub noises: Vec<String>,
}

/// One of the formulas of a [`Definition`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Which {
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
            Self::Structure(row, column) => write!(f, "B, row {row}, column {column}"),
            Self::Energy => f.write_str("H0"),
            Self::Noise(m) => write!(f, "H, noise {m}"),
        }
    }
}

/// A [`Definition`] that is no Poisson system, or has no values at its initial value.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DefinitionError {
    /// A state or a parameter has a name that it cannot have.
    #[error(transparent)]
    Name(#[from] NameError),
    /// There is no component.
    #[error("the state has no component")]
    NoState,
    /// The initial value has another number of components than the state.
    #[error("the initial value must have {dimension} components, got {components}")]
    InitialValue {
        /// The number of names in the state.
        dimension: usize,
        /// The number of components given.
        components: usize,
    },
    /// A component of the initial value is NaN or infinite.
    #[error("the initial value must be finite, got {name} = {value}")]
    NotFiniteInitialValue {
        /// The name of the component.
        name: String,
        /// Its value.
        value: f64,
    },
    /// B has rows of other lengths.
    #[error(
        "B must have {dimension} rows of {dimension} entries, or its entries above the diagonal in \
         rows of {} to 1; its rows have {rows:?}",
        dimension - 1
    )]
    StructureSize {
        /// The dimension D.
        dimension: usize,
        /// The lengths of the rows.
        rows: Vec<usize>,
    },
    /// A text is not a formula, or one without a finite value at the initial value.
    #[error("{which}: {error}")]
    Formula {
        /// Which one.
        which: Which,
        /// What is wrong with it.
        error: Box<FormulaError>,
    },
    /// B is not skew-symmetric.
    #[error(
        "B is not skew: row {row}, column {column} is {value}, and row {column}, column {row} is \
         {mirror}, at y = {point:?}"
    )]
    NotSkew {
        /// The row of an entry, counted from 1.
        row: usize,
        /// Its column.
        column: usize,
        /// Its value at a point.
        value: f64,
        /// The value of its mirror image.
        mirror: f64,
        /// The point.
        point: Vec<f64>,
    },
    /// A formula has no finite derivative at the initial value.
    #[error("the derivative of {which} by {variable} is {value} at the initial value")]
    DerivativeNotFinite {
        /// Which one.
        which: Which,
        /// The component that it is differentiated by.
        variable: String,
        /// Its value.
        value: f64,
    },
}

/// The formulas of a definition, B by its entries above the diagonal.
pub(super) struct Formulas {
    pub names: Names,
    /// Row i has the entries i + 1, … of that row of B.
    pub structure: Vec<Vec<Formula>>,
    pub energy: Formula,
    pub noises: Vec<Formula>,
}

impl Formulas {
    pub fn new(definition: &Definition, y0: &[f64]) -> Result<Self, DefinitionError> {
        let names = names(definition, y0)?;
        let parsed = |which: Which, text: &str| -> Result<Formula, DefinitionError> {
            let formula = Formula::parse(text, &names).and_then(|formula| {
                let reason = formula.explain(y0);
                let at_y0 = |message| format!("{message} at the initial value");
                let wrong = |e: FormulaError| FormulaError { message: at_y0(e.message), ..e };
                reason.map_or(Ok(formula), |error| Err(wrong(error)))
            });
            formula.map_err(|error| DefinitionError::Formula { which, error: error.into() })
        };
        let hamiltonian = |which: Which, text| -> Result<Formula, DefinitionError> {
            let formula = parsed(which.clone(), text)?;
            has_gradient(which, &formula, y0)?;
            Ok(formula)
        };
        let structure = structure(&definition.structure, y0, parsed)?;
        let energy = hamiltonian(Which::Energy, &definition.energy)?;
        let noises = definition.noises.iter().enumerate();
        let noises = noises.map(|(m, text)| hamiltonian(Which::Noise(m + 1), text));
        Ok(Self { structure, energy, noises: noises.collect::<Result<_, _>>()?, names })
    }
}

fn names(definition: &Definition, y0: &[f64]) -> Result<Names, DefinitionError> {
    let mut names = Names::with_variables(&definition.state)?;
    for (name, value) in &definition.parameters {
        names.parameter(name, *value)?;
    }
    let (dimension, components) = (definition.state.len(), y0.len());
    if dimension == 0 {
        return Err(DefinitionError::NoState);
    }
    if dimension != components {
        return Err(DefinitionError::InitialValue { dimension, components });
    }
    match y0.iter().zip(&definition.state).find(|(value, _)| !value.is_finite()) {
        Some((&value, name)) => {
            Err(DefinitionError::NotFiniteInitialValue { name: name.clone(), value })
        }
        None => Ok(names),
    }
}

/// Checks that all derivatives of a formula are finite.
fn has_gradient(which: Which, formula: &Formula, y0: &[f64]) -> Result<(), DefinitionError> {
    let all: Vec<usize> = (0..y0.len()).collect();
    let mut gradient = vec![0.0; y0.len()];
    formula.gradient(&all).evaluate_one(&[y0], &mut gradient);
    match gradient.iter().position(|slope| !slope.is_finite()) {
        Some(i) => Err(DefinitionError::DerivativeNotFinite {
            which,
            variable: formula.variables()[i].clone(),
            value: gradient[i],
        }),
        None => Ok(()),
    }
}

/// The entries of B above the diagonal.
fn structure(
    texts: &[Vec<String>],
    y0: &[f64],
    parsed: impl Fn(Which, &str) -> Result<Formula, DefinitionError>,
) -> Result<Vec<Vec<Formula>>, DefinitionError> {
    let dimension = y0.len();
    let rows: Vec<usize> = texts.iter().map(Vec::len).collect();
    let is_full = rows.len() == dimension && rows.iter().all(|&length| length == dimension);
    let is_upper = rows.iter().copied().eq((1..dimension).rev());
    if !is_full && !is_upper {
        return Err(DefinitionError::StructureSize { dimension, rows });
    }
    let mut entries = Vec::new();
    for (i, texts) in texts.iter().enumerate() {
        let first = if is_full { 0 } else { i + 1 };
        let entry =
            |(k, text): (usize, &String)| parsed(Which::Structure(i + 1, first + k + 1), text);
        entries.push(texts.iter().enumerate().map(entry).collect::<Result<Vec<_>, _>>()?);
    }
    if is_full {
        super::skew::check(&entries, y0)?;
        entries.iter_mut().enumerate().for_each(|(i, row)| drop(row.drain(..=i)));
    } else {
        // The last row has no entry above the diagonal.
        entries.push(Vec::new());
    }
    Ok(entries)
}
