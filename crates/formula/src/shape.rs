//! What a graph shows of its expressions: degree as a polynomial, dependence, pieces.

use real::Degree;

use crate::{
    Id,
    graph::{Graph, Node},
};

impl Graph {
    /// A bound of the degree of an expression as a polynomial in `inputs`, as in [`real::Degree`];
    /// none if it does not show a polynomial. An expression made of pieces is none.
    #[must_use]
    pub fn degree(&self, root: Id, inputs: &[usize]) -> Option<u32> {
        self.degrees(&[root], inputs)[root.index()]
    }

    /// The [`degree`](Self::degree) of the `roots`, and of what they are made of.
    pub(crate) fn degrees(&self, roots: &[Id], inputs: &[usize]) -> Vec<Option<u32>> {
        let mut degrees = vec![Degree::CONSTANT; self.inputs()];
        let known = inputs.iter().filter(|&&k| k < self.inputs());
        known.for_each(|&k| degrees[k] = Degree::VARIABLE);
        self.values(roots, &degrees).into_iter().map(Degree::get).collect()
    }

    /// Whether one of the expressions that `roots` use is such a node.
    pub(crate) fn uses(&self, roots: &[Id], is: impl Fn(Node) -> bool) -> bool {
        let needed = self.needed(roots);
        self.ids().any(|id| needed[id.index()] && is(self.node(id)))
    }
}
