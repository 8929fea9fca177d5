//! Where a formula has no value.

use std::{
    fmt::{self, Display},
    ops::Range,
};

use crate::{
    Id,
    error::{Excerpt, line_column},
    graph::{Binary, Graph, Node, Unary},
};

/// The first operation of a formula that is not finite at a point although its operands are.
///
/// [`Display`] names it and shows its place in the text.
#[derive(Clone, Debug, PartialEq)]
pub struct DomainError {
    /// The operation and its operands, as `ln of -0.3`.
    pub operation: String,
    /// Its value: infinite or NaN.
    pub value: f64,
    /// The place in bytes of the text.
    pub span: Range<usize>,
    /// The line of the place, counted from 1.
    pub line: usize,
    /// Its column in characters, counted from 1.
    pub column: usize,
    excerpt: Box<Excerpt>,
}

impl Display for DomainError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { operation, value, line, column, excerpt, .. } = self;
        write!(f, "line {line}, column {column}: {operation} is {value}\n{excerpt}")
    }
}

impl std::error::Error for DomainError {}

/// The first operation that is not finite at the inputs; none if the root is finite.
///
/// An infinite operand that is divided by does no harm: the root decides.
pub(crate) fn explain(
    graph: &Graph,
    root: Id,
    text: &str,
    names: &[String],
    inputs: &[f64],
) -> Option<DomainError> {
    let values = graph.values(&[root], inputs);
    if values[root.index()].is_finite() {
        return None;
    }
    let needed = graph.needed(&[root]);
    let id = graph.ids().find(|id| needed[id.index()] && !values[id.index()].is_finite())?;
    let span = graph.place(id).unwrap_or(0..text.len());
    let (line, column) = line_column(text, span.start);
    Some(DomainError {
        operation: described(graph.node(id), &values, names),
        value: values[id.index()],
        line,
        column,
        excerpt: Box::new(Excerpt::new(text, &span)),
        span,
    })
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
            let (a, b) = (of(a), of(b));
            match function {
                Binary::Add => format!("the sum of {a} and {b}"),
                Binary::Sub => format!("the difference of {a} and {b}"),
                Binary::Mul => format!("the product of {a} and {b}"),
                Binary::Div => format!("the quotient of {a} and {b}"),
                Binary::Min => format!("the minimum of {a} and {b}"),
                Binary::Max => format!("the maximum of {a} and {b}"),
            }
        }
        Node::Power(a, n) => format!("power {n} of {}", of(a)),
        Node::Where([x, y, ..]) => format!("the choice between {} and {}", of(x), of(y)),
    }
}
