//! From a graph to instructions: operations joined with those that they feed alone, rows given out
//! by liveness.

use crate::{
    Id,
    graph::{Binary, Graph, Node, Unary},
    instruction::{Instruction, OUT, Operation, Place, SCRATCH},
};

/// The instructions for `outputs`, and the number of scratch rows. Input k is at `inputs[k]`.
pub fn compile(
    graph: &Graph,
    outputs: &[Id],
    inputs: &[Option<Place>],
) -> (Vec<Instruction>, usize) {
    let (graph, outputs) = lowered(graph, outputs);
    let steps = joined(&graph, &outputs);
    let mut rows = Rows::new(&graph, &outputs, &steps, inputs);
    for (index, id) in graph.ids().enumerate() {
        if let Some(step) = steps[index] {
            rows.emit(id, step);
        }
    }
    rows.copy_repeated_outputs(&outputs);
    (rows.code, rows.count as usize)
}

/// The same expressions with powers written out as products.
fn lowered(graph: &Graph, outputs: &[Id]) -> (Graph, Vec<Id>) {
    let needed = graph.needed(outputs);
    let mut lower = Graph::new();
    let mut copies: Vec<Option<Id>> = vec![None; graph.len()];
    for id in graph.ids().filter(|id| needed[id.index()]) {
        let of = |id: Id| copies[id.index()].unwrap_or_else(|| unreachable!("operands come first"));
        let node = match graph.node(id) {
            node @ (Node::Constant(_) | Node::Input(_)) => node,
            Node::Unary(function, a) => Node::Unary(function, of(a)),
            Node::Binary(function, a, b) => Node::Binary(function, of(a), of(b)),
            Node::Where(all) => Node::Where(all.map(of)),
            Node::Power(a, n) => {
                copies[id.index()] = Some(product(&mut lower, of(a), n));
                continue;
            }
        };
        copies[id.index()] = Some(lower.intern(node));
    }
    let outputs = outputs.iter().filter_map(|output| copies[output.index()]).collect();
    (lower, outputs)
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

/// An operation with the expressions that are its operands.
#[derive(Clone, Copy)]
struct Step {
    operation: Operation,
    operands: [Id; 4],
    count: usize,
    numbers: [f64; 2],
}

impl Step {
    fn new<const N: usize>(operation: Operation, operands: [Id; N], numbers: &[f64]) -> Self {
        let mut step = Self { operation, operands: [Id::FIRST; 4], count: N, numbers: [0.0; 2] };
        step.operands[..N].copy_from_slice(&operands);
        step.numbers[..numbers.len()].copy_from_slice(numbers);
        step
    }

    fn operands(&self) -> &[Id] {
        &self.operands[..self.count]
    }
}

/// For every expression that needs an instruction, its step. A product that one sum or product uses
/// alone becomes part of that.
fn joined(graph: &Graph, outputs: &[Id]) -> Vec<Option<Step>> {
    let mut uses = vec![0_u32; graph.len()];
    outputs.iter().for_each(|output| uses[output.index()] += 2);
    for id in graph.ids() {
        graph.node(id).operands().for_each(|operand| uses[operand.index()] += 1);
    }
    let mut wanted = vec![false; graph.len()];
    outputs.iter().for_each(|output| wanted[output.index()] = true);
    let mut steps = vec![None; graph.len()];
    let join = Join { graph, uses };
    for id in graph.ids().rev().filter(|id| id.index() < graph.len()) {
        if wanted[id.index()] {
            let step = join.step(id);
            step.iter().flat_map(Step::operands).for_each(|x| wanted[x.index()] = true);
            steps[id.index()] = step;
        }
    }
    steps
}

struct Join<'a> {
    graph: &'a Graph,
    uses: Vec<u32>,
}

/// An operand of a sum.
enum Term {
    Number(f64),
    Product(Id, Id),
    Scaled(Id, f64),
    Other,
}

impl Join<'_> {
    /// The operands of a function that is used here alone.
    fn alone(&self, id: Id, function: Binary) -> Option<(Id, Id)> {
        match self.graph.node(id) {
            Node::Binary(found, a, b) if found == function && self.uses[id.index()] == 1 => {
                Some((a, b))
            }
            _ => None,
        }
    }

    fn term(&self, id: Id) -> Term {
        match (self.graph.as_constant(id), self.alone(id, Binary::Mul)) {
            (Some(x), _) => Term::Number(x),
            (_, Some((a, b))) => match self.graph.as_constant(b) {
                Some(c) => Term::Scaled(a, c),
                None => Term::Product(a, b),
            },
            _ => Term::Other,
        }
    }

    /// The step for an expression; none for an input.
    fn step(&self, id: Id) -> Option<Step> {
        Some(match self.graph.node(id) {
            Node::Input(_) => return None,
            Node::Constant(bits) => Step::new(Operation::Fill, [], &[f64::from_bits(bits)]),
            Node::Unary(Unary::Neg, a) => match self.term(a) {
                Term::Product(a, b) => Step::new(Operation::NegMul, [a, b], &[]),
                _ => Step::new(Operation::Neg, [a], &[]),
            },
            Node::Unary(function, a) => Step::new(unary(function), [a], &[]),
            Node::Binary(Binary::Add, a, b) => self.sum(a, b),
            Node::Binary(Binary::Sub, a, b) => self.difference(a, b),
            Node::Binary(Binary::Mul, a, b) => self.product(a, b),
            Node::Binary(Binary::Div, a, b) => {
                match (self.graph.as_constant(a), self.graph.as_constant(b)) {
                    (Some(k), _) => Step::new(Operation::NumberDiv, [b], &[k]),
                    (_, Some(k)) => Step::new(Operation::DivNumber, [a], &[k]),
                    _ => Step::new(Operation::Div, [a, b], &[]),
                }
            }
            Node::Binary(Binary::Min, a, b) => Step::new(Operation::Min, [a, b], &[]),
            Node::Binary(Binary::Max, a, b) => Step::new(Operation::Max, [a, b], &[]),
            Node::Where(all) => Step::new(Operation::Where, all, &[]),
            Node::Power(..) => unreachable!("powers are written out"),
        })
    }

    fn sum(&self, a: Id, b: Id) -> Step {
        use Operation::*;
        match (self.term(a), self.term(b)) {
            (Term::Product(a, b), Term::Product(c, d)) => Step::new(MulAddMul, [a, b, c, d], &[]),
            (Term::Product(a, b), Term::Number(k)) => Step::new(MulAddNumber, [a, b], &[k]),
            (Term::Product(x, y), _) => Step::new(MulAdd, [x, y, b], &[]),
            (_, Term::Product(x, y)) => Step::new(MulAdd, [x, y, a], &[]),
            (Term::Scaled(a, k), Term::Scaled(b, l)) => Step::new(ScaleAddScale, [a, b], &[k, l]),
            (Term::Scaled(a, k), Term::Number(l)) => Step::new(ScaleAddNumber, [a], &[k, l]),
            (Term::Scaled(x, k), _) => Step::new(ScaleAdd, [x, b], &[k]),
            (_, Term::Scaled(x, k)) => Step::new(ScaleAdd, [x, a], &[k]),
            (_, Term::Number(k)) => Step::new(AddNumber, [a], &[k]),
            _ => Step::new(Add, [a, b], &[]),
        }
    }

    fn difference(&self, a: Id, b: Id) -> Step {
        use Operation::*;
        match (self.term(a), self.term(b)) {
            (Term::Product(a, b), Term::Product(c, d)) => Step::new(MulSubMul, [a, b, c, d], &[]),
            (Term::Number(k), Term::Product(a, b)) => Step::new(NumberSubMul, [a, b], &[k]),
            (Term::Product(x, y), _) => Step::new(MulSub, [x, y, b], &[]),
            (_, Term::Product(x, y)) => Step::new(SubMul, [x, y, a], &[]),
            (Term::Scaled(a, k), Term::Scaled(b, l)) => Step::new(ScaleAddScale, [a, b], &[k, -l]),
            (Term::Number(l), Term::Scaled(a, k)) => Step::new(ScaleAddNumber, [a], &[-k, l]),
            (Term::Scaled(x, k), _) => Step::new(ScaleSub, [x, b], &[k]),
            (_, Term::Scaled(x, k)) => Step::new(ScaleAdd, [x, a], &[-k]),
            (Term::Number(k), _) => Step::new(NumberSub, [b], &[k]),
            _ => Step::new(Sub, [a, b], &[]),
        }
    }

    fn product(&self, a: Id, b: Id) -> Step {
        use Operation::*;
        if let Some(k) = self.graph.as_constant(b) {
            return Step::new(Scale, [a], &[k]);
        }
        for (a, b) in [(a, b), (b, a)] {
            match self.term(a) {
                Term::Product(x, y) => return Step::new(MulMul, [x, y, b], &[]),
                Term::Scaled(x, k) => return Step::new(ScaleMul, [x, b], &[k]),
                _ => {}
            }
            let plain = |x: Id, y: Id| {
                let is_plain = |id| matches!(self.term(id), Term::Other);
                is_plain(x) && is_plain(y)
            };
            match (self.alone(a, Binary::Add), self.alone(a, Binary::Sub)) {
                (Some((x, y)), _) if plain(x, y) => return Step::new(AddMul, [x, y, b], &[]),
                (_, Some((x, y))) if plain(x, y) => {
                    return Step::new(DifferenceMul, [x, y, b], &[]);
                }
                _ => {}
            }
        }
        Step::new(Mul, [a, b], &[])
    }
}

fn unary(function: Unary) -> Operation {
    match function {
        Unary::Neg => Operation::Neg,
        Unary::Abs => Operation::Abs,
        Unary::Sqrt => Operation::Sqrt,
        Unary::Exp => Operation::Exp,
        Unary::Ln => Operation::Ln,
        Unary::Sin => Operation::Sin,
        Unary::Cos => Operation::Cos,
        Unary::Tan => Operation::Tan,
        Unary::Sinh => Operation::Sinh,
        Unary::Cosh => Operation::Cosh,
        Unary::Tanh => Operation::Tanh,
        Unary::Sinc => Operation::Sinc,
    }
}

/// Rows for values, from the first instruction to the last.
struct Rows {
    /// Where a value is.
    homes: Vec<Option<Place>>,
    /// The row of a value that is a result.
    results: Vec<Option<u32>>,
    last_use: Vec<usize>,
    free: Vec<u32>,
    count: u32,
    code: Vec<Instruction>,
}

impl Rows {
    fn new(
        graph: &Graph,
        outputs: &[Id],
        steps: &[Option<Step>],
        inputs: &[Option<Place>],
    ) -> Self {
        let mut results = vec![None; graph.len()];
        for (k, output) in outputs.iter().enumerate().rev() {
            if steps[output.index()].is_some() {
                results[output.index()] = Some(k as u32);
            }
        }
        let mut last_use = vec![0; graph.len()];
        for (index, step) in steps.iter().enumerate() {
            step.iter().flat_map(Step::operands).for_each(|x| last_use[x.index()] = index);
        }
        let home = |id| match graph.node(id) {
            Node::Input(k) => {
                let place = inputs.get(k as usize).copied().flatten();
                Some(place.unwrap_or_else(|| panic!("input {k} is in no group")))
            }
            _ => None,
        };
        let homes = graph.ids().map(home).collect();
        Self { homes, results, last_use, free: Vec::new(), count: 0, code: Vec::new() }
    }

    fn home(&self, id: Id) -> Place {
        self.homes[id.index()].unwrap_or_else(|| unreachable!("operands come first"))
    }

    fn emit(&mut self, id: Id, step: Step) {
        let mut from = [Place::default(); 4];
        for (k, &operand) in step.operands().iter().enumerate() {
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
        self.code.push(Instruction { operation: step.operation, to, from, numbers: step.numbers });
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
                let from = [from, Place::default(), Place::default(), Place::default()];
                let (operation, numbers) = (Operation::Copy, [0.0; 2]);
                self.code.push(Instruction { operation, to, from, numbers });
            }
        }
    }
}
