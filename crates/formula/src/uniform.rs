//! The numbers of a tape: what is the same at all points.

use std::ops::{Neg, Range};

use crate::{
    Id,
    graph::{Graph, Node, Unary},
};

/// Constants, uniform inputs, and what is computed from these alone: once, and not at every point.
/// The functions are those that compute rows, and so are the bits.
#[derive(Clone, Debug, Default)]
pub struct Numbers {
    /// One, the inputs, and then what is computed.
    values: Vec<f64>,
    /// What depends on the inputs, with its place. Operands are places.
    computed: Vec<(usize, Node)>,
}

impl Numbers {
    /// Sets the inputs, and computes what depends on them.
    pub fn set(&mut self, inputs: impl Iterator<Item = f64>) {
        self.values[1..].iter_mut().zip(inputs).for_each(|(value, input)| *value = input);
        for &(place, node) in &self.computed {
            self.values[place] = node.value(&[], &self.values);
        }
    }

    pub fn values(&self) -> &[f64] {
        &self.values
    }
}

/// The place of one among the numbers.
pub const ONE: u32 = 0;

/// For every expression, whether it is a constant or computed from these inputs alone.
pub fn uniform(graph: &Graph, inputs: &Range<usize>) -> Vec<bool> {
    let mut uniform = vec![false; graph.len()];
    for id in graph.ids() {
        uniform[id.index()] = match graph.node(id) {
            Node::Input(k) => inputs.contains(&(k as usize)),
            node => node.operands().all(|operand| uniform[operand.index()]),
        };
    }
    uniform
}

/// An expression, or minus this expression, as a number of a tape.
#[derive(Clone, Copy, Debug)]
pub struct Number {
    pub id: Id,
    pub negative: bool,
}

impl Neg for Number {
    type Output = Self;
    fn neg(self) -> Self {
        Self { negative: !self.negative, ..self }
    }
}

/// Takes numbers from a graph.
pub struct Collector {
    inputs: Range<usize>,
    /// The place of an expression among the numbers, and that of minus this expression.
    places: Vec<[Option<Id>; 2]>,
    /// For every place, whether it depends on an input.
    varying: Vec<bool>,
    numbers: Numbers,
}

impl Collector {
    /// Takes these expressions, and what they are computed from.
    pub fn new(graph: &Graph, inputs: Range<usize>, taken: &[Id]) -> Self {
        let (places, varying) = (vec![[None; 2]; graph.len()], vec![true; 1 + inputs.len()]);
        let mut values = vec![0.0; 1 + inputs.len()];
        values[ONE as usize] = 1.0;
        let numbers = Numbers { values, computed: Vec::new() };
        let mut new = Self { inputs, places, varying, numbers };
        let needed = graph.needed(taken);
        for id in graph.ids().filter(|id| needed[id.index()]) {
            let place = match graph.node(id) {
                Node::Input(k) => Id::at(1 + k as usize - new.inputs.start),
                node => new.push(node.with_operands(|operand| new.plain(operand))),
            };
            new.places[id.index()][0] = Some(place);
        }
        new
    }

    fn plain(&self, id: Id) -> Id {
        self.places[id.index()][0].unwrap_or_else(|| unreachable!("the expression was taken"))
    }

    fn push(&mut self, node: Node) -> Id {
        let place = self.numbers.values.len();
        let varies = node.operands().any(|operand| self.varying[operand.index()]);
        let value = if varies { 0.0 } else { node.value(&[], &self.numbers.values) };
        self.numbers.values.push(value);
        self.varying.push(varies);
        if varies {
            self.numbers.computed.push((place, node));
        }
        Id::at(place)
    }

    /// The place of a number whose expression was taken.
    pub fn place(&mut self, Number { id, negative }: Number) -> u32 {
        let place = match (negative, self.places[id.index()][1]) {
            (false, _) => self.plain(id),
            (true, Some(negated)) => negated,
            (true, None) => {
                let negated = self.push(Node::Unary(Unary::Neg, self.plain(id)));
                self.places[id.index()][1] = Some(negated);
                negated
            }
        };
        place.index() as u32
    }

    pub fn finish(self) -> Numbers {
        self.numbers
    }
}
