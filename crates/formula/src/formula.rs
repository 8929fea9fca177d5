//! One formula with its text.

use std::{collections::BTreeSet, slice::from_ref, sync::Arc};

use expression::Values;
use real::Row;

use crate::{Binary, FormulaError, Graph, Id, Names, Node, Tape, Unary, parse};

/// A formula in named variables.
///
/// ```
/// use formula::{Formula, Names};
///
/// let mut names = Names::with_variables(&["y1", "y2"])?;
/// names.parameter("k", 0.5)?;
/// let h = Formula::parse("y1^2/2 + k*ln(y2)", &names)?;
/// assert_eq!(h.value(&[2.0, 1.0]), 2.0);
/// assert_eq!((h.degree(&[0]), h.degree(&[1])), (Some(2), None));
/// let reason = h.explain(&[2.0, -0.3]).unwrap();
/// assert_eq!((reason.message.as_str(), reason.column), ("this is NaN for -0.3", 12));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Formula {
    /// The text.
    pub text: String,
    /// The names of the variables, in their order.
    pub variables: Arc<Vec<String>>,
    /// The graph of the formula, with the variables as inputs.
    pub graph: Graph,
    /// The formula in its graph.
    pub root: Id,
    /// The formula as a tape, with the variables as the one group of inputs.
    pub tape: Tape,
}

impl Formula {
    /// The formula that the text means.
    ///
    /// # Errors
    /// [`FormulaError`] with the place in the text and what would be right.
    pub fn parse(text: &str, names: &Names) -> Result<Self, FormulaError> {
        let mut graph = Graph::new();
        let root = parse(text, names, &mut graph)?;
        let variables = names.variables.clone();
        let tape = on_variables(&graph, &[root], &variables);
        Ok(Self { text: text.to_owned(), variables, graph, root, tape })
    }

    /// The value at a point.
    ///
    /// # Panics
    /// Unless the point has a number for each variable.
    #[must_use]
    pub fn value(&self, point: &[f64]) -> f64 {
        let mut value = [0.0];
        self.tape.evaluate_one(&[point], &mut value);
        value[0]
    }

    /// Why the formula has no finite value at a point: its first operation that is not finite
    /// although its operands are, as `this is NaN for -0.3`. None if it has one: an infinite
    /// operand that is divided by does no harm.
    ///
    /// # Panics
    /// Unless the point has a number for each variable.
    #[must_use]
    pub fn explain(&self, point: &[f64]) -> Option<FormulaError> {
        assert_eq!(point.len(), self.variables.len(), "numbers of a point");
        let values = self.graph.all_values(&[self.root], |k| point[k]);
        if values[self.root].is_finite() {
            return None;
        }
        let id = *values.ids().iter().find(|&&id| !values[id].is_finite())?;
        let operands = self.graph.node(id).operands().map(|operand| values[operand].to_string());
        let operands = operands.collect::<Vec<_>>().join(" and ");
        let of_them = if operands.is_empty() { "" } else { " for " };
        Some(self.error_at(id, format!("this is {}{of_them}{operands}", values[id])))
    }

    /// The values at 32 points, with a row for each variable. For formulas that are evaluated now
    /// and then: memory is allocated, which a [`tape`](field@Self::tape) does not.
    ///
    /// # Panics
    /// Unless there is a row for each variable.
    #[must_use]
    pub fn values(&self, points: &[Row]) -> Row {
        self.tape.rows(&[points])[0]
    }

    /// The derivatives with respect to the variables of these numbers, as a tape on the variables.
    #[must_use]
    pub fn gradient(&self, variables: &[usize]) -> Tape {
        let mut graph = self.graph.clone();
        let one = graph.constant(1.0);
        let gradient = graph.reverse(&[(self.root, one)], variables);
        on_variables(&graph, &gradient, &self.variables)
    }

    /// A bound of the degree as a polynomial in the variables of these numbers; none if the formula
    /// does not show a polynomial.
    #[must_use]
    pub fn degree(&self, variables: &[usize]) -> Option<u32> {
        self.graph.degree(self.root, |k| variables.contains(&k))
    }

    /// Whether the formula is a condition: one where something is true, else zero.
    #[must_use]
    pub fn is_condition(&self) -> bool {
        let needed = self.graph.needed(&[self.root]);
        let is_truth = Values::new(needed, |id, is_truth| match self.graph.node(id) {
            Node::Where([.., a, b]) => is_truth[a] && is_truth[b],
            _ => self.graph.as_constant(id).is_some_and(|value| value == 0.0 || value == 1.0),
        });
        is_truth[self.root]
    }

    /// A formula that is positive where this condition is true and negative where it is false: a −
    /// b for a > b, the smaller for `and`, the larger for `or`. None for a formula that is not a
    /// condition.
    #[must_use]
    pub fn excess(&self) -> Option<Self> {
        let mut graph = self.graph.clone();
        let root = excess(&mut graph, self.root)?;
        let tape = on_variables(&graph, &[root], &self.variables);
        Some(Self { root, tape, graph, ..self.clone() })
    }

    /// Whether the formula has `abs`, `min` or `max` of variables.
    #[must_use]
    pub fn has_kinks(&self) -> bool {
        use {Binary::*, Unary::*};
        let is_kink = |node| matches!(node, Node::Unary(Abs, _) | Node::Binary(Min | Max, ..));
        self.graph.uses(&[self.root], is_kink)
    }

    /// Whether there are conditions in the formula, so that it may jump.
    #[must_use]
    pub fn has_conditions(&self) -> bool {
        self.condition().is_some()
    }

    /// The first condition, which has no derivatives, as an error at its place.
    pub(crate) fn condition(&self) -> Option<FormulaError> {
        let mut needed = self.graph.needed(&[self.root]).into_iter();
        let id = needed.find(|&id| matches!(self.graph.node(id), Node::Where(_)))?;
        let message = "a condition is not smooth, and derivatives are needed here: take tanh(x/d) \
                       for a smooth step of width d";
        Some(self.error_at(id, message))
    }

    /// An error at the place of an expression.
    fn error_at(&self, id: Id, message: impl Into<String>) -> FormulaError {
        let place = self.graph.place(id).unwrap_or(0..self.text.len());
        FormulaError::new(message, &self.text, place)
    }

    /// Numbers of the variables that the formula uses.
    #[must_use]
    pub fn reads(&self) -> BTreeSet<usize> {
        let needed = self.graph.needed(&[self.root]).into_iter();
        needed.filter_map(|id| self.graph.as_input(id)).collect()
    }
}

/// The tape of expressions in the variables, one group of inputs.
fn on_variables(graph: &Graph, roots: &[Id], variables: &[String]) -> Tape {
    Tape::new(graph, roots, from_ref(&(0..variables.len())))
}

/// [`Formula::excess`] of an expression.
fn excess(graph: &mut Graph, id: Id) -> Option<Id> {
    let Node::Where([p, q, a, b]) = graph.node(id) else { return None };
    let truths = [a, b].map(|id| graph.as_constant(id));
    // Of `and`, `or` and `not`, p is ½ and q a condition.
    let first = (graph.as_constant(p) == Some(0.5)).then(|| excess(graph, q)).flatten();
    match (first, truths) {
        (Some(first), [Some(1.0), Some(0.0)]) => Some(first),
        (Some(first), [Some(0.0), Some(1.0)]) => Some(graph.neg(first)),
        (Some(first), [_, Some(0.0)]) => {
            let second = excess(graph, a)?;
            Some(graph.binary(Binary::Min, first, second))
        }
        (Some(first), [Some(1.0), _]) => {
            let second = excess(graph, b)?;
            Some(graph.binary(Binary::Max, first, second))
        }
        (None, [Some(1.0), Some(0.0)]) => Some(graph.sub(q, p)),
        (None, [Some(0.0), Some(1.0)]) => Some(graph.sub(p, q)),
        _ => None,
    }
}
