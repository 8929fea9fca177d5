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
    },
    instruction::{Instruction, MAX_ROWS, OUT, Operation, Place, SCRATCH},
    join::{Joined, joined},
    uniform::{Number, Numbers, ONE, uniform},
    values::Values,
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
    let taken = graph.ids().flat_map(|id| steps[id].iter()).flat_map(|step| step.numbers);
    let taken: Vec<Id> = taken.filter_map(|number| number.id).collect();
    let (numbers, places) = Numbers::new(&graph, uniform_inputs, &taken);
    // Few values stay in the cache in any order. As made, neighbours seldom wait for one another.
    let is_short = graph.size() <= SHORT;
    let order = if is_short { graph.ids().collect() } else { by_results(&graph, &steps, &outputs) };
    let order = sines_beside_cosines(&mut steps, order);
    let mut last_use = Values::all(&graph, 0);
    for (n, &id) in order.iter().enumerate() {
        operands(&steps, id).for_each(|x| last_use[x] = n);
    }
    // Where each value is.
    let mut homes = Values::all(&graph, Place::default());
    let (mut code, mut free, mut rows) = (Vec::new(), Vec::new(), 0);
    // The first row of each result.
    let results: HashMap<Id, usize> =
        outputs.iter().enumerate().rev().map(|(row, &output)| (output, row)).collect();
    for (n, &id) in order.iter().enumerate() {
        let Some(step) = &steps[id] else {
            if let (Node::Input(k), false) = (graph.node(id), uniform[id]) {
                let place = input(k as usize);
                homes[id] = place.unwrap_or_else(|| panic!("input {k} is in no group"));
            }
            continue;
        };
        let mut from = [Place::default(); MAX_ROWS];
        for (k, &operand) in step.operands.iter().enumerate() {
            from[k] = homes[operand];
            // A row that is not used after this instruction may be written by it.
            let is_last = last_use[operand] == n;
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
        homes[id] = match results.get(&id) {
            Some(&row) => Place { bank: OUT, row: row as u32 },
            None => Place { bank: SCRATCH, row: scratch_row() },
        };
        let place = |k: Number| k.id.map_or(ONE, |id| places[id]) + usize::from(k.negative);
        let numbers = step.numbers.map(|k| place(k) as u32);
        code.push(Instruction { operation: step.operation, to: homes[id], from, numbers });
    }
    // Results that are inputs, and results that are there already.
    for (row, &output) in outputs.iter().enumerate() {
        let (to, from) = (Place { bank: OUT, row: row as u32 }, [homes[output]; MAX_ROWS]);
        if to != from[0] {
            let numbers = [ONE as u32; 3];
            code.push(Instruction { operation: Operation::Copy, to, from, numbers });
        }
    }
    (code, numbers, rows as usize)
}

/// The expressions that a step reads.
fn operands(steps: &Values<Option<Joined>>, id: Id) -> impl Iterator<Item = Id> {
    steps[id].iter().flat_map(|step| &step.operands).copied()
}

/// Order of the expressions by the results that need them, and of the operands of each step the
/// longest chain first: few values wait for others, so that those of a long tape stay in the cache.
fn by_results(graph: &Graph, steps: &Values<Option<Joined>>, outputs: &[Id]) -> Vec<Id> {
    let lengths = Values::new(graph.ids().collect(), |id, lengths| {
        operands(steps, id).map(|operand| lengths[operand] + 1).max().unwrap_or(0)
    });
    let (mut order, mut seen) = (Vec::new(), HashSet::new());
    for &output in outputs {
        // Expressions, and whether their operands are there.
        let mut open = vec![(output, false)];
        while let Some((id, is_ready)) = open.pop() {
            if seen.contains(&id) {
                continue;
            }
            if is_ready {
                seen.insert(id);
                order.push(id);
                continue;
            }
            open.push((id, true));
            let first = open.len();
            open.extend(operands(steps, id).map(|operand| (operand, false)));
            open[first..].sort_by_key(|(operand, _)| lengths[*operand]);
        }
    }
    order
}

/// The order with every cosine after the sine of the same expression, if there is one, both where
/// the first of them was.
fn sines_beside_cosines(steps: &mut Values<Option<Joined>>, order: Vec<Id>) -> Vec<Id> {
    let mut pairs: HashMap<Id, [Option<Id>; 2]> = HashMap::new();
    for &id in &order {
        if let Some(step) = &steps[id]
            && let Operation::Of(function @ (Sin | Cos)) = step.operation
        {
            let pair = pairs.entry(step.operands[0]).or_default();
            pair[usize::from(function == Cos)] = Some(id);
        }
    }
    let mut pair_of = HashMap::new();
    for pair in pairs.into_values() {
        if let [Some(sine), Some(cosine)] = pair {
            pair_of.extend([sine, cosine].map(|id| (id, [sine, cosine])));
            steps[sine].iter_mut().for_each(|step| step.operation = Operation::SinBesideCos);
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
    let mut lower = Graph::new();
    let copies = Values::new(graph.needed(outputs), |id, copies| match graph.node(id) {
        Node::Power(a, n) => product(&mut lower, copies[a], n),
        node => lower.intern(node.with_operands(|operand| copies[operand])),
    });
    let results = outputs.iter().map(|&output| copies[output]).collect();
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
