//! From a graph to instructions: powers written out, operations joined, rows given out by liveness.

use std::ops::Range;

use crate::{
    Id,
    graph::{Binary, Graph, Node},
    instruction::{Instruction, MOST_ROWS, OUT, Operation, Place, SCRATCH},
    join::{Joined, joined},
    uniform::{Collector, Numbers, ONE, uniform},
};

/// The instructions for `outputs`, their numbers, and the rows of scratch that they need. Input k
/// is at `inputs[k]`, unless it is one of the `uniform_inputs`, which are the same at all points.
pub fn compile(
    graph: &Graph,
    outputs: &[Id],
    inputs: &[Option<Place>],
    uniform_inputs: Range<usize>,
) -> (Vec<Instruction>, Numbers, usize) {
    let (graph, outputs) = lowered(graph, outputs);
    let uniform = uniform(&graph, &uniform_inputs);
    let steps = joined(&graph, &outputs, &uniform);
    let taken = steps.iter().flatten().flat_map(|step| step.numbers).flatten();
    let taken: Vec<Id> = taken.map(|number| number.id).collect();
    let numbers = Collector::new(&graph, uniform_inputs, &taken);
    let mut rows = RowAllocator::new(&graph, &outputs, &steps, inputs, &uniform, numbers);
    for (index, id) in graph.ids().enumerate() {
        if let Some(step) = &steps[index] {
            rows.emit(id, step);
        }
    }
    rows.copy_repeated_outputs(&outputs);
    (rows.code, rows.numbers.finish(), rows.count as usize)
}

/// The same expressions with powers written out as products.
fn lowered(graph: &Graph, outputs: &[Id]) -> (Graph, Vec<Id>) {
    let needed = graph.needed(outputs);
    let mut lower = Graph::new();
    let mut copies = vec![Id::FIRST; graph.len()];
    for id in graph.ids().filter(|id| needed[id.index()]) {
        let of = |id: Id| copies[id.index()];
        copies[id.index()] = match graph.node(id) {
            Node::Power(a, n) => product(&mut lower, of(a), n),
            node => lower.intern(node.with_operands(of)),
        };
    }
    (lower, outputs.iter().map(|output| copies[output.index()]).collect())
}

/// xⁿ for n ≥ 2, the products of [`real::elementary::powi`] in their order.
fn product(graph: &mut Graph, x: Id, n: u32) -> Id {
    let (mut power, mut square, mut rest) = (None, x, n);
    loop {
        if rest & 1 == 1 {
            power = Some(match power {
                None => square,
                Some(power) => graph.intern(Node::Binary(Binary::Mul, power, square)),
            });
        }
        rest >>= 1;
        match power {
            Some(power) if rest == 0 => return power,
            _ => square = graph.intern(Node::Binary(Binary::Mul, square, square)),
        }
    }
}

/// Gives out rows for values, from the first instruction to the last.
struct RowAllocator {
    numbers: Collector,
    /// Where a value is.
    homes: Vec<Option<Place>>,
    /// The row of a value that is a result.
    results: Vec<Option<u32>>,
    last_use: Vec<usize>,
    free: Vec<u32>,
    count: u32,
    code: Vec<Instruction>,
}

impl RowAllocator {
    fn new(
        graph: &Graph,
        outputs: &[Id],
        steps: &[Option<Joined>],
        inputs: &[Option<Place>],
        uniform: &[bool],
        numbers: Collector,
    ) -> Self {
        let mut results = vec![None; graph.len()];
        for (k, output) in outputs.iter().enumerate().rev() {
            if steps[output.index()].is_some() {
                results[output.index()] = Some(k as u32);
            }
        }
        let mut last_use = vec![0; graph.len()];
        for (index, step) in steps.iter().enumerate() {
            step.iter().flat_map(|step| &step.operands).for_each(|x| last_use[x.index()] = index);
        }
        let home = |id: Id| match graph.node(id) {
            Node::Input(k) if !uniform[id.index()] => {
                let place = inputs.get(k as usize).copied().flatten();
                Some(place.unwrap_or_else(|| panic!("input {k} is in no group")))
            }
            _ => None,
        };
        let homes = graph.ids().map(home).collect();
        Self { numbers, homes, results, last_use, free: Vec::new(), count: 0, code: Vec::new() }
    }

    fn home(&self, id: Id) -> Place {
        self.homes[id.index()].unwrap_or_else(|| unreachable!("operands come first"))
    }

    fn emit(&mut self, id: Id, step: &Joined) {
        let mut from = [Place::default(); MOST_ROWS];
        for (k, &operand) in step.operands.iter().enumerate() {
            from[k] = self.home(operand);
            // A row that is not used after this instruction may be written by it.
            let is_last = self.last_use[operand.index()] == id.index();
            if is_last && from[k].bank == SCRATCH && !from[..k].contains(&from[k]) {
                self.free.push(from[k].row);
            }
        }
        let to = match self.results[id.index()] {
            Some(row) => Place { bank: OUT, row },
            None => Place { bank: SCRATCH, row: self.free_row() },
        };
        let numbers = step.numbers.map(|k| k.map_or(ONE, |k| self.numbers.place(k)));
        self.code.push(Instruction { operation: step.operation, to, from, numbers });
        self.homes[id.index()] = Some(to);
    }

    fn free_row(&mut self) -> u32 {
        self.free.pop().unwrap_or_else(|| {
            self.count += 1;
            self.count - 1
        })
    }

    /// Results that are inputs, and results that are there already.
    fn copy_repeated_outputs(&mut self, outputs: &[Id]) {
        for (k, &output) in outputs.iter().enumerate() {
            let (to, from) = (Place { bank: OUT, row: k as u32 }, self.home(output));
            if to != from {
                let mut rows = [Place::default(); MOST_ROWS];
                rows[0] = from;
                let (operation, from, numbers) = (Operation::Copy, rows, [ONE; 2]);
                self.code.push(Instruction { operation, to, from, numbers });
            }
        }
    }
}
