//! Operations joined with those that they feed alone.

use crate::{
    Id,
    graph::{Binary, Graph, Node},
    instruction::{MOST_NUMBERS, Operation},
    uniform::Number,
};

/// An operation with the expressions that are its operands.
#[derive(Clone)]
pub struct Joined {
    pub operation: Operation,
    pub operands: Vec<Id>,
    pub numbers: [Number; MOST_NUMBERS],
}

impl Joined {
    /// Numbers that are not given are one.
    fn new<const N: usize>(operation: Operation, operands: [Id; N], given: &[Number]) -> Self {
        let mut numbers = [Number::ONE; MOST_NUMBERS];
        numbers[..given.len()].copy_from_slice(given);
        Self { operation, operands: operands.to_vec(), numbers }
    }
}

/// For every expression that needs an instruction, its step. A product that one sum uses alone
/// becomes part of that.
pub fn joined(graph: &Graph, outputs: &[Id], uniform: &[bool]) -> Vec<Option<Joined>> {
    let mut uses = vec![0_u32; graph.len()];
    outputs.iter().for_each(|output| uses[output.index()] += 2);
    for id in graph.ids() {
        graph.node(id).operands().for_each(|operand| uses[operand.index()] += 1);
    }
    let mut wanted = vec![false; graph.len()];
    outputs.iter().for_each(|output| wanted[output.index()] = true);
    let mut steps = vec![None; graph.len()];
    let join = Join { graph, uses, uniform };
    for id in graph.ids().rev() {
        if wanted[id.index()] {
            let step = join.step(id);
            step.iter().flat_map(|step| &step.operands).for_each(|x| wanted[x.index()] = true);
            steps[id.index()] = step;
        }
    }
    steps
}

struct Join<'a> {
    graph: &'a Graph,
    uses: Vec<u32>,
    uniform: &'a [bool],
}

/// An operand of a sum: a number, or a row or a product of rows times a number.
enum Term {
    Number(Number),
    Row(Id, Number),
    Product(Id, Id, Number),
}

impl Join<'_> {
    /// The operands of a function that is used here alone.
    fn alone(&self, id: Id, function: Binary) -> Option<(Id, Id)> {
        match self.graph.node(id) {
            Node::Binary(found, a, b)
                if found == function && self.uses[id.index()] == 1 && !self.uniform[id.index()] =>
            {
                Some((a, b))
            }
            _ => None,
        }
    }

    /// The step for a sum, or a product of rows, that is used here alone.
    fn inner(&self, id: Id) -> Option<Joined> {
        let of = |function| self.alone(id, function);
        match (of(Binary::Add), of(Binary::Sub), of(Binary::Mul)) {
            (Some((a, b)), ..) => Some(self.sum(a, b, Number::ONE)),
            (_, Some((a, b)), _) => Some(self.sum(a, b, -Number::ONE)),
            (.., Some((a, b))) if self.scaled(a, b).is_none() => Some(self.product(a, b)),
            _ => None,
        }
    }

    fn number(&self, id: Id) -> Option<Number> {
        self.uniform[id.index()].then_some(Number { id: Some(id), negative: false })
    }

    /// The factors, if one of them is a number.
    fn scaled(&self, a: Id, b: Id) -> Option<(Id, Number)> {
        self.number(b).map(|k| (a, k)).or_else(|| self.number(a).map(|k| (b, k)))
    }

    /// An operand with a sign, which is one or minus one.
    fn term(&self, id: Id, sign: Number) -> Term {
        let signed = |k: Number| if sign.negative { -k } else { k };
        match (self.number(id), self.alone(id, Binary::Mul)) {
            (Some(k), _) => Term::Number(signed(k)),
            (_, Some((a, b))) => match self.scaled(a, b) {
                Some((x, k)) => Term::Row(x, signed(k)),
                None => Term::Product(a, b, sign),
            },
            _ => Term::Row(id, sign),
        }
    }

    /// The step for an expression; none for an input.
    fn step(&self, id: Id) -> Option<Joined> {
        if let Some(k) = self.number(id) {
            return Some(Joined::new(Operation::Fill, [], &[k]));
        }
        Some(match self.graph.node(id) {
            Node::Input(_) => return None,
            Node::Unary(function, a) => Joined::new(Operation::Of(function), [a], &[]),
            Node::Binary(Binary::Add, a, b) => self.sum(a, b, Number::ONE),
            Node::Binary(Binary::Sub, a, b) => self.sum(a, b, -Number::ONE),
            Node::Binary(Binary::Mul, a, b) => self.product(a, b),
            Node::Binary(Binary::Div, a, b) => match (self.number(a), self.number(b)) {
                (Some(k), _) => Joined::new(Operation::NumberDiv, [b], &[k]),
                (_, Some(k)) => Joined::new(Operation::DivNumber, [a], &[k]),
                _ => Joined::new(Operation::Div, [a, b], &[]),
            },
            Node::Binary(Binary::Min, a, b) => Joined::new(Operation::Min, [a, b], &[]),
            Node::Binary(Binary::Max, a, b) => Joined::new(Operation::Max, [a, b], &[]),
            Node::Where(all) => Joined::new(Operation::Where, all, &[]),
            Node::Constant(_) => unreachable!("constants are numbers"),
            Node::Power(..) => unreachable!("powers are written out"),
        })
    }

    /// a + b, or a − b if the sign is minus one. The order of terms does not change a bit.
    fn sum(&self, a: Id, b: Id, sign: Number) -> Joined {
        use {
            Operation::*,
            Term::{Product, Row},
        };
        match (self.term(a, Number::ONE), self.term(b, sign)) {
            (Product(a, b, k), Product(c, d, l)) => Joined::new(MulAddMul, [a, b, c, d], &[k, l]),
            (Product(a, b, k), Row(c, l)) | (Row(c, l), Product(a, b, k)) => {
                Joined::new(MulAdd, [a, b, c], &[k, l])
            }
            (Product(a, b, k), Term::Number(l)) | (Term::Number(l), Product(a, b, k)) => {
                Joined::new(MulAddNumber, [a, b], &[k, l])
            }
            (Row(a, k), Row(b, l)) => Joined::new(Add, [a, b], &[k, l]),
            (Row(a, k), Term::Number(l)) | (Term::Number(l), Row(a, k)) => {
                Joined::new(AddNumber, [a], &[k, l])
            }
            (Term::Number(_), Term::Number(_)) => unreachable!("a sum of numbers is a number"),
        }
    }

    fn product(&self, a: Id, b: Id) -> Joined {
        match self.scaled(a, b) {
            Some((x, k)) => match self.inner(x) {
                Some(step) => {
                    let [first, second, _] = step.numbers;
                    Joined { numbers: [first, second, k], ..step }
                }
                None => Joined::new(Operation::Scale, [x], &[k]),
            },
            None => Joined::new(Operation::Mul, [a, b], &[]),
        }
    }
}
