//! What a graph shows of its expressions: degree as a polynomial, dependence, pieces.

use crate::{
    Id,
    graph::{Binary, Graph, Node, Unary},
};

impl Graph {
    /// A bound of the degree of an expression as a polynomial in `inputs`, as in [`real::Degree`];
    /// none if it does not show a polynomial. An expression made of pieces is none.
    #[must_use]
    pub fn degree(&self, root: Id, inputs: &[usize]) -> Option<u32> {
        self.degrees(inputs)[root.index()]
    }

    /// The [`degree`](Self::degree) of every expression.
    pub(crate) fn degrees(&self, inputs: &[usize]) -> Vec<Option<u32>> {
        let mut degrees: Vec<Option<u32>> = Vec::with_capacity(self.len());
        for id in self.ids() {
            let of = |id: Id| degrees[id.index()];
            let node = self.node(id);
            let degree = match node {
                Node::Constant(_) => Some(0),
                Node::Input(k) => Some(u32::from(inputs.contains(&(k as usize)))),
                Node::Unary(Unary::Neg, a) => of(a),
                Node::Binary(Binary::Add | Binary::Sub, a, b) => {
                    of(a).zip(of(b)).map(|(a, b)| a.max(b))
                }
                Node::Binary(Binary::Mul, a, b) => {
                    of(a).zip(of(b)).map(|(a, b)| a.saturating_add(b))
                }
                Node::Binary(Binary::Div, a, b) if of(b) == Some(0) => of(a),
                Node::Power(a, n) => of(a).map(|degree| degree.saturating_mul(n)),
                _ => node.operands().all(|operand| of(operand) == Some(0)).then_some(0),
            };
            degrees.push(degree);
        }
        degrees
    }

    /// Whether an expression uses input number k.
    #[must_use]
    pub fn depends_on(&self, root: Id, k: usize) -> bool {
        let needed = self.needed(&[root]);
        self.ids().any(|id| needed[id.index()] && self.node(id) == Node::Input(k as u32))
    }

    /// Whether an expression is made of pieces: it uses abs, min or max of what is not constant.
    #[must_use]
    pub fn is_piecewise(&self, root: Id) -> bool {
        let needed = self.needed(&[root]);
        self.ids().filter(|id| needed[id.index()]).any(|id| {
            matches!(
                self.node(id),
                Node::Unary(Unary::Abs, _)
                    | Node::Binary(Binary::Min | Binary::Max, _, _)
                    | Node::Where(_)
            )
        })
    }
}
