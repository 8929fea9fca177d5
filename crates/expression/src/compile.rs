//! From a graph to instructions: powers written out, operations joined, rows allocated by liveness.

use std::ops::Range;

use crate::{
    Id,
    graph::{Binary, Graph, Node},
    instruction::{Instruction, MAX_ROWS, OUT, Operation, Place, SCRATCH},
    join::joined,
    uniform::{Numbers, ONE, uniform},
};

/// The instructions for `outputs`, their numbers, and the rows of scratch that they need. Input k
/// is at `inputs[k]`, unless it is one of the `uniform_inputs`, which are the same at all points.
pub fn compile(
    graph: &Graph,
    outputs: &[Id],
    inputs: &[Option<Place>],
    uniform_inputs: &Range<usize>,
) -> (Vec<Instruction>, Numbers, usize) {
    let (graph, outputs) = lowered(graph, outputs);
    let uniform = uniform(&graph, uniform_inputs);
    let steps = joined(&graph, &outputs, &uniform);
    let taken = steps.iter().flatten().flat_map(|step| step.numbers);
    let taken: Vec<Id> = taken.filter_map(|number| number.id).collect();
    let (numbers, places) = Numbers::new(&graph, uniform_inputs, &taken);
    let mut last_use = vec![0; graph.size()];
    for (index, step) in steps.iter().enumerate() {
        step.iter().flat_map(|step| &step.operands).for_each(|x| last_use[x.index()] = index);
    }
    // Where each value is.
    let mut homes = vec![Place::default(); graph.size()];
    let (mut code, mut free, mut rows) = (Vec::new(), Vec::new(), 0);
    for (index, id) in graph.ids().enumerate() {
        if let (Node::Input(k), false) = (graph.node(id), uniform[index]) {
            let place = inputs.get(k as usize).copied().flatten();
            homes[index] = place.unwrap_or_else(|| panic!("input {k} is in no group"));
        }
        let Some(step) = &steps[index] else { continue };
        let mut from = [Place::default(); MAX_ROWS];
        for (k, operand) in step.operands.iter().enumerate() {
            from[k] = homes[operand.index()];
            // A row that is not used after this instruction may be written by it.
            let is_last = last_use[operand.index()] == index;
            if is_last && from[k].bank == SCRATCH && !from[..k].contains(&from[k]) {
                free.push(from[k].row);
            }
        }
        let mut scratch_row = || {
            free.pop().unwrap_or_else(|| {
                rows += 1;
                rows - 1
            })
        };
        homes[index] = match outputs.iter().position(|&output| output == id) {
            Some(row) => Place { bank: OUT, row: row as u32 },
            None => Place { bank: SCRATCH, row: scratch_row() },
        };
        let place = |id: Id| places[id.index()];
        let numbers = step.numbers.map(|k| k.id.map_or(ONE, place) + u32::from(k.negative));
        code.push(Instruction { operation: step.operation, to: homes[index], from, numbers });
    }
    // Results that are inputs, and results that are there already.
    for (row, output) in outputs.iter().enumerate() {
        let mut from = [Place::default(); MAX_ROWS];
        from[0] = homes[output.index()];
        let to = Place { bank: OUT, row: row as u32 };
        if to != from[0] {
            code.push(Instruction { operation: Operation::Copy, to, from, numbers: [ONE; 3] });
        }
    }
    (code, numbers, rows as usize)
}

/// The expressions in a new graph, with powers written out as products.
fn lowered(graph: &Graph, outputs: &[Id]) -> (Graph, Vec<Id>) {
    let needed = graph.needed(outputs);
    let mut lower = Graph::new();
    let mut copies = vec![Id::FIRST; graph.size()];
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
