//! Peephole fusion: a sum and the products that it uses alone are one operation.

use crate::{
    Id,
    graph::{Binary, Graph, Node},
    instruction::Operation::{self, *},
    uniform::Number,
    values::Values,
};

/// An operation with the expressions that are its operands.
#[derive(Clone)]
pub struct Joined {
    pub operation: Operation,
    pub operands: Vec<Id>,
    pub numbers: [Number; 3],
}

impl Operation {
    fn on<const N: usize>(self, operands: [Id; N]) -> Joined {
        Joined { operation: self, operands: operands.to_vec(), numbers: [Number::ONE; 3] }
    }
}

impl Joined {
    /// The operation with its first number, the factor of sums and products.
    fn times(mut self, factor: Number) -> Self {
        self.numbers[0] = factor;
        self
    }
}

/// For every expression that needs an instruction, its step. A product that one sum uses alone
/// becomes part of that.
pub fn joined(graph: &Graph, outputs: &[Id], uniform: &Values<bool>) -> Values<Option<Joined>> {
    let mut uses = Values::all(graph, 0);
    let mut wanted = Values::all(graph, false);
    for &output in outputs {
        uses[output] += 2;
        wanted[output] = true;
    }
    graph.ids().flat_map(|id| graph.node(id).operands()).for_each(|operand| uses[operand] += 1);
    let mut steps = Values::all(graph, None);
    let join = Join { graph, uses, uniform };
    for id in graph.ids().rev() {
        steps[id] = wanted[id].then(|| join.step(id)).flatten();
        steps[id].iter().flat_map(|step| &step.operands).for_each(|&x| wanted[x] = true);
    }
    steps
}

struct Join<'a> {
    graph: &'a Graph,
    uses: Values<u32>,
    uniform: &'a Values<bool>,
}

/// Whether the terms of a sum are subtracted, where they have no factor.
const PLUS: [Option<bool>; 2] = [Some(false), Some(false)];
const MINUS: [Option<bool>; 2] = [Some(false), Some(true)];
const FROM: [Option<bool>; 2] = [Some(true), Some(false)];

/// A term of a sum: the product of up to two rows and a number.
struct Term {
    rows: Vec<Id>,
    factor: Number,
}

impl Join<'_> {
    /// Whether an expression is used once, and no number.
    fn is_alone(&self, id: Id) -> bool {
        self.uses[id] == 1 && !self.uniform[id]
    }

    fn number(&self, id: Id) -> Option<Number> {
        self.uniform[id].then_some(Number { id: Some(id), negative: false })
    }

    /// The factors, if one of them is a number.
    fn scaled(&self, a: Id, b: Id) -> Option<(Id, Number)> {
        self.number(b).map(|k| (a, k)).or_else(|| self.number(a).map(|k| (b, k)))
    }

    fn term(&self, id: Id) -> Term {
        if let Some(factor) = self.number(id) {
            return Term { rows: Vec::new(), factor };
        }
        let product = |id| match self.graph.node(id) {
            Node::Binary(Binary::Mul, a, b) if self.is_alone(id) => Some((a, b)),
            _ => None,
        };
        let scaled = product(id).and_then(|(a, b)| self.scaled(a, b));
        let (id, factor) = scaled.unwrap_or((id, Number::ONE));
        let rows = match product(id) {
            Some((a, b)) if self.scaled(a, b).is_none() => vec![a, b],
            _ => vec![id],
        };
        Term { rows, factor }
    }

    /// The step for an expression; none for an input.
    fn step(&self, id: Id) -> Option<Joined> {
        if let Some(k) = self.number(id) {
            return Some(Fill.on([]).times(k));
        }
        Some(match self.graph.node(id) {
            Node::Input(_) => return None,
            Node::Unary(function, a) => Of(function).on([a]),
            Node::Binary(Binary::Add, a, b) => self.sum(a, b, false),
            Node::Binary(Binary::Sub, a, b) => self.sum(a, b, true),
            Node::Binary(Binary::Mul, a, b) => self.product(a, b),
            Node::Binary(Binary::Div, a, b) => match (self.number(a), self.number(b)) {
                (Some(k), _) => NumberDiv.on([b]).times(k),
                (_, Some(k)) => DivNumber.on([a]).times(k),
                _ => Div.on([a, b]),
            },
            Node::Binary(Binary::Min, a, b) => Min.on([a, b]),
            Node::Binary(Binary::Max, a, b) => Max.on([a, b]),
            Node::Where(all) => Where.on(all),
            Node::Constant(_) => unreachable!("constants are numbers"),
            Node::Power(..) => unreachable!("powers are written out"),
        })
    }

    fn sum(&self, a: Id, b: Id, minus: bool) -> Joined {
        let (mut first, mut second) = (self.term(a), self.term(b));
        second.factor.negative ^= minus;
        // a + b = b + a to the bit.
        let size = |term: &Term| (term.rows.len(), term.factor.id.is_none());
        if size(&first) < size(&second) {
            std::mem::swap(&mut first, &mut second);
        }
        let minus = |term: &Term| term.factor.id.is_none().then_some(term.factor.negative);
        let signs = [minus(&first), minus(&second)];
        let operation = match (first.rows.len(), second.rows.len(), signs) {
            (2, 2, PLUS) => MulAddMul,
            (2, 2, MINUS) => MulSubMul,
            (2, 2, _) => ScaledMulAddMul,
            (2, 1, PLUS) => MulAdd,
            (2, 1, MINUS) => MulSub,
            (2, 1, FROM) => SubMul,
            (2, 1, _) => ScaledMulAdd,
            (2, ..) => MulAddNumber,
            (_, 1, PLUS) => Add,
            (_, 1, MINUS) => Sub,
            (_, 1, _) => ScaledAdd,
            _ => AddNumber,
        };
        let numbers = [Number::ONE, first.factor, second.factor];
        Joined { operation, operands: [first.rows, second.rows].concat(), numbers }
    }

    fn product(&self, a: Id, b: Id) -> Joined {
        let Some((x, k)) = self.scaled(a, b) else { return Mul.on([a, b]) };
        let takes_factor = match self.graph.node(x) {
            Node::Binary(Binary::Add | Binary::Sub, ..) => true,
            Node::Binary(Binary::Mul, a, b) => self.scaled(a, b).is_none(),
            _ => false,
        };
        let inner = if takes_factor && self.is_alone(x) { self.step(x) } else { None };
        inner.unwrap_or_else(|| Scale.on([x])).times(k)
    }
}
