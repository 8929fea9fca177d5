//! Where a formula has no value.

use crate::{
    Formula, FormulaError, Id,
    graph::{Binary, Node, Unary},
};

impl Formula {
    /// Why the formula has no finite value at a point: its first operation that is not finite
    /// although its operands are, as `ln of -0.3 is NaN`. None if it has one: an infinite operand
    /// that is divided by does no harm.
    ///
    /// # Panics
    /// Unless the point has a number for each variable.
    #[must_use]
    pub fn explain(&self, point: &[f64]) -> Option<FormulaError> {
        assert_eq!(point.len(), self.variables().len(), "numbers of a point");
        let (graph, root, text) = (self.graph(), self.root(), self.text());
        let values = graph.values(&[root], point);
        if values[root.index()].is_finite() {
            return None;
        }
        let needed = graph.needed(&[root]);
        let id = graph.ids().find(|id| needed[id.index()] && !values[id.index()].is_finite())?;
        let operation = described(graph.node(id), &values, self.variables());
        let message = format!("{operation} is {}", values[id.index()]);
        Some(FormulaError::new(message, text, graph.place(id).unwrap_or(0..text.len())))
    }
}

/// An operation with the values of its operands.
fn described(node: Node, values: &[f64], names: &[String]) -> String {
    let of = |id: Id| values[id.index()];
    match node {
        Node::Constant(_) => "the constant".to_owned(),
        Node::Input(k) => names.get(k as usize).map_or("an input".to_owned(), |x| format!("`{x}`")),
        Node::Unary(Unary::Neg, a) => format!("minus {}", of(a)),
        Node::Unary(function, a) => format!("{function} of {}", of(a)),
        Node::Binary(function, a, b) => {
            let name = match function {
                Binary::Add => "sum",
                Binary::Sub => "difference",
                Binary::Mul => "product",
                Binary::Div => "quotient",
                Binary::Min => "minimum",
                Binary::Max => "maximum",
            };
            format!("the {name} of {} and {}", of(a), of(b))
        }
        Node::Power(a, n) => format!("power {n} of {}", of(a)),
        Node::Where([x, y, ..]) => format!("the choice between {} and {}", of(x), of(y)),
    }
}
