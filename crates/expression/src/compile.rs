//! From a graph to instructions: powers written out, operations joined, rows allocated by liveness.

use std::{
    collections::{HashMap, HashSet},
    ops::Range,
};

use crate::{
    Id,
    graph::{
        Binary, Graph, Node,
        Unary::{Cos, Sin},
        place,
    },
    instruction::{Instruction, MAX_ROWS, OUT, Operation, Place, SCRATCH},
    join::{Joined, joined},
    uniform::{Numbers, ONE, uniform},
};

/// Expressions whose values, 256 bytes each, fit into the cache of a core.
const SHORT: usize = 4000;

/// The instructions for `outputs`, their numbers, and the rows of scratch that they need. Input k
/// is at `input(k)`, unless it is one of the `uniform_inputs`, which are the same at all points.
pub fn compile(
    graph: &Graph,
    outputs: &[Id],
    input: impl Fn(usize) -> Option<Place>,
    uniform_inputs: &Range<usize>,
) -> (Vec<Instruction>, Numbers, usize) {
    let (graph, outputs) = lowered(graph, outputs);
    let uniform = uniform(&graph, uniform_inputs);
    let mut steps = joined(&graph, &outputs, &uniform);
    let taken = steps.iter().flatten().flat_map(|step| step.numbers);
    let taken: Vec<Id> = taken.filter_map(|number| number.id).collect();
    let (numbers, places) = Numbers::new(&graph, uniform_inputs, &taken);
    // Few values stay in the cache in any order. As made, neighbours seldom wait for one another.
    let is_short = graph.size() <= SHORT;
    let order = if is_short { graph.ids().collect() } else { by_results(&steps, &outputs) };
    let order = sines_beside_cosines(&mut steps, order);
    let mut last_use = vec![0; graph.size()];
    for (n, &id) in order.iter().enumerate() {
        let operands = steps[id.index()].iter().flat_map(|step| &step.operands);
        operands.for_each(|x| last_use[x.index()] = n);
    }
    // Where each value is.
    let mut homes = vec![Place::default(); graph.size()];
    let (mut code, mut free, mut rows) = (Vec::new(), Vec::new(), 0);
    // The first row of each result.
    let results: HashMap<Id, usize> =
        outputs.iter().enumerate().rev().map(|(row, &output)| (output, row)).collect();
    for (n, &id) in order.iter().enumerate() {
        let index = id.index();
        let Some(step) = &steps[index] else {
            if let (Node::Input(k), false) = (graph.node(id), uniform[index]) {
                let place = input(k as usize);
                homes[index] = place.unwrap_or_else(|| panic!("input {k} is in no group"));
            }
            continue;
        };
        let mut from = [Place::default(); MAX_ROWS];
        for (k, operand) in step.operands.iter().enumerate() {
            from[k] = homes[operand.index()];
            // A row that is not used after this instruction may be written by it.
            let is_last = last_use[operand.index()] == n;
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
        homes[index] = match results.get(&id) {
            Some(&row) => Place { bank: OUT, row: row as u32 },
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

/// Order of the expressions by the results that need them, and of the operands of each step the
/// longest chain first: few values wait for others, so that those of a long tape stay in the cache.
fn by_results(steps: &[Option<Joined>], outputs: &[Id]) -> Vec<Id> {
    let operands = |id: Id| steps[id.index()].iter().flat_map(|step| &step.operands).copied();
    let mut lengths: Vec<u32> = Vec::with_capacity(steps.len());
    for n in 0..steps.len() {
        let longest = operands(Id::at(n)).map(|operand| lengths[operand.index()]).max();
        lengths.push(longest.map_or(0, |longest| longest + 1));
    }
    let (mut order, mut seen) = (Vec::new(), vec![false; steps.len()]);
    for &output in outputs {
        // Expressions, and whether their operands are there.
        let mut open = vec![(output, false)];
        while let Some((id, is_ready)) = open.pop() {
            if seen[id.index()] {
                continue;
            }
            if is_ready {
                seen[id.index()] = true;
                order.push(id);
                continue;
            }
            open.push((id, true));
            let first = open.len();
            open.extend(operands(id).map(|operand| (operand, false)));
            open[first..].sort_by_key(|(operand, _)| lengths[operand.index()]);
        }
    }
    order
}

/// The order with every cosine after the sine of the same expression, if there is one, both where
/// the first of them was.
fn sines_beside_cosines(steps: &mut [Option<Joined>], order: Vec<Id>) -> Vec<Id> {
    let mut pairs: HashMap<Id, [Option<Id>; 2]> = HashMap::new();
    for (n, step) in steps.iter().enumerate() {
        if let Some(Joined { operation: Operation::Of(function @ (Sin | Cos)), operands, .. }) =
            step
        {
            let pair = pairs.entry(operands[0]).or_default();
            pair[usize::from(*function == Cos)] = Some(Id::at(n));
        }
    }
    let mut pair_of = HashMap::new();
    for pair in pairs.into_values() {
        if let [Some(sine), Some(cosine)] = pair {
            pair_of.extend([sine, cosine].map(|id| (id, [sine, cosine])));
            if let Some(step) = &mut steps[sine.index()] {
                step.operation = Operation::SinBesideCos;
            }
        }
    }
    let (mut beside, mut seen) = (Vec::with_capacity(order.len()), HashSet::new());
    for id in order {
        match pair_of.get(&id) {
            None => beside.push(id),
            Some(pair) if seen.insert(pair[0]) => beside.extend(pair),
            Some(_) => {}
        }
    }
    beside
}

/// The expressions in a new graph, with powers written out as products.
fn lowered(graph: &Graph, outputs: &[Id]) -> (Graph, Vec<Id>) {
    let needed = graph.needed(outputs);
    let mut lower = Graph::new();
    let mut copies: Vec<Id> = Vec::with_capacity(needed.len());
    for &id in &needed {
        let of = |id: Id| copies[place(&needed, id)];
        copies.push(match graph.node(id) {
            Node::Power(a, n) => product(&mut lower, of(a), n),
            node => lower.intern(node.with_operands(of)),
        });
    }
    let results = outputs.iter().map(|&output| copies[place(&needed, output)]).collect();
    (lower, results)
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
