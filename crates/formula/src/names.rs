//! The names that a formula may use.

use std::{collections::HashMap, sync::Arc};

use expression::{Binary, Unary};

/// Meaning of a name.
#[derive(Clone, Debug)]
pub(crate) enum Meaning {
    /// Input number k.
    Variable(usize),
    /// A constant.
    Value(f64),
    /// A function of one number.
    Unary(Unary),
    /// A function of two numbers.
    Binary(Binary),
    /// Inputs that make a vector.
    Vector(Vec<usize>),
    /// A function of vectors.
    OfVectors(OfVectors),
    /// Σ of an expression over an index.
    Sum,
    /// A number for a condition, and another if it is false.
    If,
    /// A word between conditions.
    Word,
}

impl Meaning {
    /// Whether the name is a function or another word, neither a number nor a vector.
    fn is_function(&self) -> bool {
        !matches!(self, Self::Variable(_) | Self::Value(_) | Self::Vector(_))
    }
}

/// A function of vectors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum OfVectors {
    /// a × b.
    Cross,
    /// a·b.
    Dot,
    /// |a|.
    Norm,
}

/// Variables in their order, and parameters with their values, which become constants.
///
/// A name is a letter or `_`, then letters, digits and `_`, of any alphabet. `pi` and the names of
/// functions are taken.
#[derive(Clone, Debug)]
pub struct Names {
    pub(crate) variables: Arc<Vec<String>>,
    meanings: HashMap<String, Meaning>,
}

/// A name that cannot be given, or a parameter that is not finite: what is wrong with it.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{0}")]
pub struct NameError(pub String);

impl Default for Names {
    fn default() -> Self {
        let unary = Unary::NAMED.map(|function| (function.to_string(), Meaning::Unary(function)));
        let more = [
            ("min", Meaning::Binary(Binary::Min)),
            ("max", Meaning::Binary(Binary::Max)),
            ("pi", Meaning::Value(std::f64::consts::PI)),
            ("cross", Meaning::OfVectors(OfVectors::Cross)),
            ("dot", Meaning::OfVectors(OfVectors::Dot)),
            ("norm", Meaning::OfVectors(OfVectors::Norm)),
            ("sum", Meaning::Sum),
            ("if", Meaning::If),
            ("and", Meaning::Word),
            ("or", Meaning::Word),
            ("not", Meaning::Word),
        ];
        let more = more.map(|(name, meaning)| (name.to_owned(), meaning));
        let meanings = unary.into_iter().chain(more).collect();
        Self { variables: Arc::default(), meanings }
    }
}

impl Names {
    /// Names of `pi` and the functions only.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// The variables, input 0 first.
    ///
    /// # Errors
    /// [`NameError`].
    pub fn with_variables<S: AsRef<str>>(variables: &[S]) -> Result<Self, NameError> {
        let mut names = Self::new();
        for variable in variables {
            names.variable(variable.as_ref())?;
        }
        Ok(names)
    }

    /// Adds a variable, the next input.
    ///
    /// # Errors
    /// [`NameError`].
    pub fn variable(&mut self, name: &str) -> Result<(), NameError> {
        self.insert(name, Meaning::Variable(self.variables.len()))?;
        Arc::make_mut(&mut self.variables).push(name.to_owned());
        Ok(())
    }

    /// Adds a parameter.
    ///
    /// # Errors
    /// [`NameError`].
    pub fn parameter(&mut self, name: &str, value: f64) -> Result<(), NameError> {
        if !value.is_finite() {
            return Err(NameError(format!("the parameter `{name}` must be finite, got {value}")));
        }
        self.insert(name, Meaning::Value(value))
    }

    /// Adds a vector of existing variables.
    ///
    /// # Errors
    /// [`NameError`].
    pub fn vector(&mut self, name: &str, of: &[String]) -> Result<(), NameError> {
        let component = |of: &String| match self.meaning(of) {
            Some(Meaning::Variable(k)) => Ok(*k),
            _ => Err(NameError(format!("`{of}` in the vector `{name}` is no variable"))),
        };
        let components = of.iter().map(component).collect::<Result<_, _>>()?;
        self.insert(name, Meaning::Vector(components))
    }

    fn insert(&mut self, name: &str, meaning: Meaning) -> Result<(), NameError> {
        let wrong = match self.meanings.get(name) {
            _ if !crate::parse::is_name(name) => {
                "is no name: a name is a letter, then letters, digits and _"
            }
            Some(known) if !known.is_function() => "is given twice, or a constant",
            Some(_) => "is a word of formulas: choose another name",
            None => {
                self.meanings.insert(name.to_owned(), meaning);
                return Ok(());
            }
        };
        Err(NameError(format!("`{name}` {wrong}")))
    }

    /// The names of the variables, input 0 first.
    #[must_use]
    pub fn variables(&self) -> &[String] {
        &self.variables
    }

    pub(crate) fn meaning(&self, name: &str) -> Option<&Meaning> {
        self.meanings.get(name)
    }

    /// Words for the nearest name of a function, or of anything else unless `of_function`.
    pub(crate) fn nearest(&self, name: &str, of_function: bool) -> String {
        let known =
            self.meanings.iter().filter(|(_, meaning)| meaning.is_function() == of_function);
        nearest(name, known.map(|(name, _)| name))
    }
}

/// Largest length of a name that has a nearest name.
const LONGEST: usize = 40;

/// "; the nearest is `…`" for messages about an unknown name: the known one with the fewest changed
/// characters, at most a third of them or one, where small and capital letters are the same; the
/// first in the alphabet of several. Empty if none is near.
pub fn nearest<S: AsRef<str>>(name: &str, known: impl IntoIterator<Item = S>) -> String {
    let (length, lower) = (name.chars().count(), name.to_lowercase());
    let near = |known: S| {
        let known = known.as_ref();
        let short = length <= LONGEST && known.len() <= 4 * LONGEST;
        let distance = short.then(|| strsim::damerau_levenshtein(&lower, &known.to_lowercase()))?;
        (distance <= (length / 3).max(1)).then(|| (distance, known.to_owned()))
    };
    let nearest = known.into_iter().filter_map(near).min();
    nearest.map_or(String::new(), |(_, known)| format!("; the nearest is `{known}`"))
}
