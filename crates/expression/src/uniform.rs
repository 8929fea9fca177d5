//! The numbers of a tape: what is the same at all points.

use std::{collections::HashSet, ops::Range};

use crate::{
    Id,
    graph::{Graph, Node},
    values::Values,
};

/// Constants, uniform inputs, and what is computed from these alone: once, and not at every point.
/// The functions are those that compute rows, and so are the bits.
#[derive(Clone, Debug)]
pub struct Numbers {
    /// One, the inputs, and then what is computed, each followed by its negative.
    values: Vec<f64>,
    /// Numbers that depend on the inputs, with their places. Operands are places.
    computed: Vec<(usize, Node)>,
    /// Number of inputs.
    inputs: usize,
}

/// The place of one among the numbers.
pub const ONE: usize = 0;

impl Numbers {
    /// Takes these expressions of a graph, and what they are computed from. Also gives the place of
    /// each expression.
    pub fn new(graph: &Graph, inputs: &Range<usize>, taken: &[Id]) -> (Self, Values<usize>) {
        let values = [1.0, -1.0].repeat(1 + inputs.len());
        let mut numbers = Self { values, computed: Vec::new(), inputs: inputs.len() };
        let mut varies = HashSet::new();
        let places = Values::new(graph.needed(taken), |id, places| {
            let (node, place) = (graph.node(id), numbers.values.len());
            if let Node::Input(k) = node {
                varies.insert(id);
                return 2 * (1 + k as usize - inputs.start);
            }
            let computed = node.with_operands(|operand| Id::at(places[operand]));
            numbers.values.extend([0.0; 2]);
            numbers.compute(place, computed);
            if node.operands().any(|operand| varies.contains(&operand)) {
                varies.insert(id);
                numbers.computed.push((place, computed));
            }
            place
        });
        (numbers, places)
    }

    fn compute(&mut self, place: usize, node: Node) {
        let value = node.value(|id| self.values[id.index()]);
        (self.values[place], self.values[place + 1]) = (value, -value);
    }

    /// Sets the inputs, and computes what depends on them.
    pub fn set(&mut self, inputs: impl Iterator<Item = f64>) {
        let places = self.values[2..].chunks_exact_mut(2);
        places.zip(inputs).for_each(|(place, input)| place.copy_from_slice(&[input, -input]));
        for n in 0..self.computed.len() {
            let (place, node) = self.computed[n];
            self.compute(place, node);
        }
    }

    /// The numbers.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// Whether the number at a place depends on the inputs.
    pub fn varies(&self, place: usize) -> bool {
        let inputs = 2..2 * (1 + self.inputs);
        let first = place & !1;
        inputs.contains(&first) || self.computed.iter().any(|(of, _)| *of == first)
    }
}

/// For every expression, whether it is a constant or computed from these inputs alone.
pub fn uniform(graph: &Graph, inputs: &Range<usize>) -> Values<bool> {
    Values::new(graph.ids().collect(), |id, uniform| match graph.node(id) {
        Node::Input(k) => inputs.contains(&(k as usize)),
        node => node.operands().all(|operand| uniform[operand]),
    })
}

/// An expression, or one, as a number of a tape, or minus this.
#[derive(Clone, Copy, Debug)]
pub struct Number {
    pub id: Option<Id>,
    pub negative: bool,
}

impl Number {
    pub const ONE: Self = Self { id: None, negative: false };
}
