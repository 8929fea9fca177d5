//! Where a formula has no value.

use crate::{
    FormulaError, Id,
    graph::{Binary, Graph, Node, Unary},
};

/// The first operation of a formula that is not finite at the inputs although its operands are, as
/// `ln of -0.3 is NaN`; none if the root is finite.
///
/// An infinite operand that is divided by does no harm: the root decides.
pub(crate) fn explain(
    graph: &Graph,
    root: Id,
    text: &str,
    names: &[String],
    inputs: &[f64],
) -> Option<FormulaError> {
    let values = graph.values(&[root], inputs);
    if values[root.index()].is_finite() {
        return None;
    }
    let needed = graph.needed(&[root]);
    let id = graph.ids().find(|id| needed[id.index()] && !values[id.index()].is_finite())?;
    let operation = described(graph.node(id), &values, names);
    let message = format!("{operation} is {}", values[id.index()]);
    Some(FormulaError::new(message, text, graph.place(id).unwrap_or(0..text.len())))
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
