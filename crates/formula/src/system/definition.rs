//! A Poisson system as texts, and errors in them.

use std::{
    collections::BTreeMap,
    fmt::{self, Display},
    iter::once,
};

use crate::{Formula, FormulaError, NameError, Names};

/// The texts of a Poisson system dy = B∇H₀ dt + Σₘ B∇Hₘ ∘ dWₘ, and of heat baths that act on it.
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
    /// The matrix B, by rows or entries.
    pub structure: Structure,
    /// H₀.
    pub energy: String,
    /// H₁, …, one for each noise.
    pub noises: Vec<String>,
    /// Heat baths, whose noises come after these.
    pub baths: Vec<Bath>,
    /// An equation in the place of B, Hamiltonians and baths.
    pub equation: Option<Equation>,
}

/// An equation dy = f dt + Σₘ gₘ dWₘ by its fields, without B and Hamiltonians: a text for each
/// component of each field.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Equation {
    /// The drift f.
    pub drift: Vec<String>,
    /// The fields g₁, … of the noises.
    pub noises: Vec<Vec<String>>,
    /// Whether noises are in the sense of Itô; else they are in that of Stratonovich.
    pub ito: bool,
}

/// A heat bath at the temperature kT through a function Φ of the state: a noise with the
/// Hamiltonian Φ whose increments have a drift,
///
/// B∇Φ ∘ (dW + u dt) with u = −{H₀, Φ}/2kT and {F, G} = ∇FᵀB∇G.
///
/// With baths at one temperature e^{−H₀/kT} is stationary, as a density by the volume of the leaves
/// of B, whatever Φ is, and Casimirs are kept on every path (Arnaudon, De Castro and Holm,
/// *J. Nonlinear Sci.* 28, 2018). Φ = σq of a coordinate is friction σ²/2mkT and noise on its
/// momentum, Φ = σs of a spin the damping of Landau and Lifshitz.
#[derive(Clone, Debug, PartialEq)]
pub struct Bath {
    /// The function Φ.
    pub through: String,
    /// kT, positive: a formula in t and the parameters.
    pub temperature: String,
}

/// The matrix B as texts.
#[derive(Clone, Debug, PartialEq)]
pub enum Structure {
    /// All D×D entries, or the entries above the diagonal, in rows of D − 1, …, 1.
    Rows(Vec<Vec<String>>),
    /// Entries above the diagonal with their rows and columns, counted from 0; others are zero.
    Entries(BTreeMap<(usize, usize), String>),
}

impl Default for Structure {
    fn default() -> Self {
        Self::Rows(Vec::new())
    }
}

impl From<Vec<Vec<String>>> for Structure {
    fn from(rows: Vec<Vec<String>>) -> Self {
        Self::Rows(rows)
    }
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
    /// Hₘ for m = 1, …; those of baths come last.
    Noise(usize),
    /// The temperature of the bath of this number, counted from 1.
    Temperature(usize),
    /// The drift for 0, or a noise, and its component, counted from 1; 0 for all.
    Field(usize, usize),
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
            Self::Temperature(m) => write!(f, "the temperature of bath {m}"),
            Self::Field(0, i) => write!(f, "the drift of component {i}"),
            Self::Field(m, i) => write!(f, "noise {m} of component {i}"),
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

/// A part of a definition, or the error in it.
type Checked<T> = Result<T, DefinitionError>;

/// The formulas of a definition.
#[derive(Clone)]
pub(super) struct Formulas {
    pub names: Names,
    pub dimension: usize,
    /// The entries of B above the diagonal that are not zero, with their rows and columns.
    pub structure: Vec<((usize, usize), Formula)>,
    /// H₀, H₁, …, whose last variable is the time.
    pub hamiltonians: Vec<Formula>,
    /// kT of the baths of the last Hamiltonians.
    pub temperatures: Vec<Formula>,
    /// The fields f, g₁, … of an equation, whose Hamiltonians are zero; none of other systems.
    pub fields: Vec<Vec<Formula>>,
    /// Whether these are in the sense of Itô.
    pub ito: bool,
}

impl Formulas {
    pub fn new(definition: &Definition, y0: &[f64]) -> Checked<Self> {
        let Definition { state, vectors, parameters, structure, energy, equation, .. } = definition;
        let mut names = Names::with_variables(state)?;
        for (name, components) in vectors {
            names.vector(name, components)?;
        }
        for (name, value) in parameters {
            names.parameter(name, *value)?;
        }
        let (mut timed, start) = (names.clone(), [y0, &[0.0]].concat());
        timed.variable("t")?;
        let parsed = |which: Which, text: &str| -> Checked<Formula> {
            let is_entry = matches!(which, Which::Structure(..));
            let names = if is_entry { &names } else { &timed };
            let formula = Formula::parse(text, names).and_then(|formula| {
                let reason = formula.explain(&start[..formula.variables.len()]);
                let at_y0 = " at the initial value";
                let wrong = |e: FormulaError| FormulaError { message: e.message + at_y0, ..e };
                let reason = formula.condition().or(reason.map(wrong));
                reason.map_or(Ok(formula), Err)
            });
            formula.map_err(|error| DefinitionError {
                which,
                message: format!("{which}: {error}"),
                formula: Some(Box::new(error)),
            })
        };
        let hamiltonian = |(m, text): (usize, &String)| {
            let which = if m == 0 { Which::Energy } else { Which::Noise(m) };
            let formula = parsed(which, text)?;
            has_gradient(which, &formula, &start)?;
            Ok(formula)
        };
        check_initial_value(state, y0)?;
        let mut structure = match equation {
            Some(_) => Vec::new(),
            None => upper(structure, y0, parsed)?,
        };
        structure.retain(|(_, entry)| !entry.graph.is_zero(entry.root));
        let through = definition.baths.iter().map(|bath| &bath.through);
        let zero = "0".to_owned();
        let all: Vec<&String> = match equation {
            Some(equation) => vec![&zero; 1 + equation.noises.len()],
            None => once(energy).chain(&definition.noises).chain(through).collect(),
        };
        let temperature = |(m, bath): (usize, &Bath)| {
            let which = Which::Temperature(m + 1);
            let kt = parsed(which, &bath.temperature)?;
            let value = kt.value(&start);
            let wrong = match kt.reads().into_iter().find(|&k| k < y0.len()) {
                Some(k) => format!("depends on `{}`: it may depend on t alone", state[k]),
                None if value > 0.0 => return Ok(kt),
                None => format!("must be positive, got {value}"),
            };
            Err(DefinitionError::new(which, format!("{which} {wrong}")))
        };
        let ito = equation.as_ref().is_some_and(|equation| equation.ito);
        let field = |(m, texts): (usize, &Vec<String>)| {
            let (d, given) = (y0.len(), texts.len());
            if given != d {
                let what = format!("one formula for each of {d} components, got {given}");
                return Err(DefinitionError::new(Which::Field(m, 0), what));
            }
            let component = |(i, text): (usize, &String)| {
                let which = Which::Field(m, i + 1);
                let formula = parsed(which, text)?;
                // Itô's correction has derivatives of noises.
                if ito && m > 0 {
                    has_gradient(which, &formula, &start)?;
                }
                Ok(formula)
            };
            texts.iter().enumerate().map(component).collect()
        };
        let fields = equation.iter().flat_map(|of| once(&of.drift).chain(&of.noises));
        let baths = definition.baths.iter();
        // The first error is that of the first formula.
        Ok(Self {
            dimension: y0.len(),
            structure,
            hamiltonians: all.into_iter().enumerate().map(hamiltonian).collect::<Checked<_>>()?,
            temperatures: baths.enumerate().map(temperature).collect::<Checked<_>>()?,
            fields: fields.enumerate().map(field).collect::<Checked<_>>()?,
            ito,
            names,
        })
    }

    /// All formulas of the equation: Hamiltonians, entries of B, and fields.
    pub fn all(&self) -> impl Iterator<Item = &Formula> {
        let structure = self.structure.iter().map(|(_, entry)| entry);
        self.hamiltonians.iter().chain(structure).chain(self.fields.iter().flatten())
    }
}

fn check_initial_value(state: &[String], y0: &[f64]) -> Checked<()> {
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
fn has_gradient(which: Which, formula: &Formula, start: &[f64]) -> Checked<()> {
    let all = Vec::from_iter(0..start.len() - 1);
    let mut gradient = vec![0.0; all.len()];
    formula.gradient(&all).evaluate_one(&[start], &mut gradient);
    let mut slopes = gradient.iter().zip(&*formula.variables);
    slopes.find(|(slope, _)| !slope.is_finite()).map_or(Ok(()), |(slope, variable)| {
        let what = format!("the derivative of {which} by {variable} is {slope}");
        Err(DefinitionError::new(which, format!("{what} at the initial value")))
    })
}

/// An entry of B with its row and column.
type Entry = ((usize, usize), Formula);

/// The entries of B above the diagonal, row by row.
fn upper(
    texts: &Structure,
    y0: &[f64],
    parsed: impl Fn(Which, &str) -> Checked<Formula>,
) -> Checked<Vec<Entry>> {
    let dimension = y0.len();
    let wrong = |what| Err(DefinitionError::new(Which::Matrix, what));
    let entry = |((i, j), text): ((usize, usize), &String)| {
        Ok(((i, j), parsed(Which::Structure(i + 1, j + 1), text)?))
    };
    let rows = match texts {
        Structure::Rows(rows) => rows,
        Structure::Entries(entries) => {
            if let Some((i, j)) = entries.keys().find(|&&(i, j)| i >= j || j >= dimension) {
                return wrong(format!(
                    "an entry of B has row < column < {dimension}, counted from 0, got row {i}, \
                     column {j}"
                ));
            }
            return entries.iter().map(|(&place, text)| entry((place, text))).collect();
        }
    };
    let lengths: Vec<usize> = rows.iter().map(Vec::len).collect();
    let is_full = lengths == vec![dimension; dimension];
    if !is_full && !lengths.iter().copied().eq((1..dimension).rev()) {
        return wrong(format!(
            "B must have {dimension} rows of {dimension} entries, or its entries above the \
             diagonal in rows of {} to 1; its rows have {lengths:?}",
            dimension - 1
        ));
    }
    let places = rows.iter().enumerate().flat_map(|(i, row)| {
        let first = if is_full { 0 } else { i + 1 };
        (first..).zip(row).map(move |(j, text)| ((i, j), text))
    });
    let mut entries: Vec<Entry> = places.map(entry).collect::<Checked<_>>()?;
    if is_full {
        check_skew(&entries, y0)?;
        entries.retain(|((i, j), _)| i < j);
    }
    Ok(entries)
}

/// The relative difference that counts as rounding: some hundred operations of 2⁻⁵³, and a loss of
/// five digits by cancellation.
const ROUNDING: f64 = 1e-9;

/// Checks bᵢⱼ = −bⱼᵢ at the initial value and points near it at which both are finite.
fn check_skew(entries: &[Entry], y0: &[f64]) -> Checked<()> {
    let points = systems::probe::around(y0, |_| true);
    for i in 0..y0.len() {
        for j in 0..=i {
            let [lower, upper] = [(i, j), (j, i)].map(|(i, j)| &entries[i * y0.len() + j].1);
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
