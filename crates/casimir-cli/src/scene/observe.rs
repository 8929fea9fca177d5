//! Functions of the state that are of interest.

use std::sync::Arc;

use casimir::{
    formula::{Formula, Names},
    mc::Observe,
    real::{PathMask, Row},
};

use super::{
    source::{Read, Source},
    values::{At, Text},
};

/// A function of the states of 32 paths; row i is component i.
pub type OfRows = dyn Fn(&[Row], &mut Row) + Send + Sync;

/// A function of the state.
#[derive(Clone)]
pub enum Quantity {
    /// A component.
    Component(usize),
    /// A formula, or a function of the system such as its energy.
    Function(Arc<OfRows>),
}

/// A function of the state with its name.
#[derive(Clone)]
pub struct Observable {
    /// Its name.
    pub name: String,
    quantity: Quantity,
}

impl From<Formula> for Quantity {
    fn from(formula: Formula) -> Self {
        Self::Function(Arc::new(move |y: &[Row], values: &mut Row| formula.values(y, values)))
    }
}

impl Observable {
    /// A quantity with a name.
    pub fn new(name: impl Into<String>, quantity: Quantity) -> Self {
        Self { name: name.into(), quantity }
    }

    /// Whether it is a component of the state.
    pub fn is_component(&self) -> bool {
        matches!(self.quantity, Quantity::Component(_))
    }
}

impl Observe for Observable {
    fn name(&self) -> &str {
        &self.name
    }

    fn evaluate(&self, y: &[Row], _: PathMask, values: &mut Row) {
        match &self.quantity {
            Quantity::Component(i) => *values = y[*i],
            Quantity::Function(function) => function(y, values),
        }
    }
}

/// The quantity of a formula, which must have a value at the initial value; `H0` is the energy.
pub fn quantity(
    source: &Source,
    text: &At<Text>,
    (names, energy): (&Names, &Quantity),
    y0: &[f64],
) -> Read<Quantity> {
    if text.0.trim() == "H0" {
        return Ok(energy.clone());
    }
    let formula = Formula::parse(&text.0, names);
    let formula = formula.map_err(|error| source.formula_error(text, &error))?;
    match formula.explain(y0) {
        Some(error) => {
            let message = format!("{} at the initial value", error.message);
            Err(source.error_in(text, &error, message))
        }
        None => Ok(formula.into()),
    }
}
