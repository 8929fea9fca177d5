//! Operations joined with those that they feed alone.

use crate::{
    Id,
    graph::{Binary, Graph, Node},
    instruction::Operation::{self, *},
    uniform::Number,
};

/// An operation with the expressions that are its operands.
#[derive(Clone)]
pub struct Joined {
    pub operation: Operation,
    pub operands: Vec<Id>,
    /// Numbers of the operation; a missing one is 1.
    pub numbers: [Option<Number>; 2],
}

impl Operation {
    fn on<const N: usize>(self, operands: [Id; N], numbers: &[Number]) -> Joined {
        let numbers = [0, 1].map(|k| numbers.get(k).copied());
        Joined { operation: self, operands: operands.to_vec(), numbers }
    }
}

impl Joined {
    /// Multiplies the operation by a number, if it has such a factor.
    fn times(mut self, k: Number) -> Option<Self> {
        let factor = match self.operation {
            Add | Sub | Mul | MulAdd | MulSub | SubMul | MulAddMul | MulSubMul => 0,
            AddNumber | ScaleAdd => 1,
            _ => return None,
        };
        self.numbers[factor] = Some(k);
        Some(self)
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

use Term::{Other, Product, Scaled};

/// An operand of a sum.
enum Term {
    Number(Number),
    Product(Id, Id),
    Scaled(Id, Number),
    Other,
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
            (Some((a, b)), ..) => Some(self.sum(a, b)),
            (_, Some((a, b)), _) => Some(self.difference(a, b)),
            (.., Some((a, b))) if self.scaled(a, b).is_none() => Some(self.product(a, b)),
            _ => None,
        }
    }

    fn number(&self, id: Id) -> Option<Number> {
        self.uniform[id.index()].then_some(Number { id, negative: false })
    }

    /// The factors, if one of them is a number.
    fn scaled(&self, a: Id, b: Id) -> Option<(Id, Number)> {
        self.number(b).map(|k| (a, k)).or_else(|| self.number(a).map(|k| (b, k)))
    }

    fn term(&self, id: Id) -> Term {
        match (self.number(id), self.alone(id, Binary::Mul)) {
            (Some(k), _) => Term::Number(k),
            (_, Some((a, b))) => match self.scaled(a, b) {
                Some((x, k)) => Scaled(x, k),
                None => Product(a, b),
            },
            _ => Other,
        }
    }

    /// The step for an expression; none for an input.
    fn step(&self, id: Id) -> Option<Joined> {
        if let Some(k) = self.number(id) {
            return Some(Fill.on([], &[k]));
        }
        Some(match self.graph.node(id) {
            Node::Input(_) => return None,
            Node::Unary(function, a) => Of(function).on([a], &[]),
            Node::Binary(Binary::Add, a, b) => self.sum(a, b),
            Node::Binary(Binary::Sub, a, b) => self.difference(a, b),
            Node::Binary(Binary::Mul, a, b) => self.product(a, b),
            Node::Binary(Binary::Div, a, b) => match (self.number(a), self.number(b)) {
                (Some(k), _) => NumberDiv.on([b], &[k]),
                (_, Some(k)) => DivNumber.on([a], &[k]),
                _ => Div.on([a, b], &[]),
            },
            Node::Binary(Binary::Min, a, b) => Min.on([a, b], &[]),
            Node::Binary(Binary::Max, a, b) => Max.on([a, b], &[]),
            Node::Where(all) => Where.on(all, &[]),
            Node::Constant(_) => unreachable!("constants are numbers"),
            Node::Power(..) => unreachable!("powers are written out"),
        })
    }

    fn sum(&self, a: Id, b: Id) -> Joined {
        self.sum_of((a, self.term(a)), (b, self.term(b)))
    }

    fn sum_of(&self, (a, left): (Id, Term), (b, right): (Id, Term)) -> Joined {
        // a + b = b + a to the bit.
        if let Term::Number(_) = left {
            return self.sum_of((b, right), (a, left));
        }
        match (left, right) {
            (Product(a, b), Product(c, d)) => MulAddMul.on([a, b, c, d], &[]),
            (Product(a, b), Term::Number(k)) => MulAddNumber.on([a, b], &[k]),
            (Product(x, y), _) => MulAdd.on([x, y, b], &[]),
            (_, Product(x, y)) => MulAdd.on([x, y, a], &[]),
            (Scaled(a, k), Scaled(b, l)) => ScaleAddScale.on([a, b], &[k, l]),
            (Scaled(a, k), Term::Number(l)) => ScaleAddNumber.on([a], &[k, l]),
            (Scaled(x, k), _) => ScaleAdd.on([x, b], &[k]),
            (_, Scaled(x, k)) => ScaleAdd.on([x, a], &[k]),
            (_, Term::Number(k)) => AddNumber.on([a], &[k]),
            _ => Add.on([a, b], &[]),
        }
    }

    fn difference(&self, a: Id, b: Id) -> Joined {
        match (self.term(a), self.term(b)) {
            (Product(a, b), Product(c, d)) => MulSubMul.on([a, b, c, d], &[]),
            (Term::Number(k), Product(a, b)) => NumberSubMul.on([a, b], &[k]),
            (term, Term::Number(k)) => self.sum_of((a, term), (b, Term::Number(-k))),
            (Product(x, y), _) => MulSub.on([x, y, b], &[]),
            (_, Product(x, y)) => SubMul.on([x, y, a], &[]),
            (term, Scaled(x, k)) => self.sum_of((a, term), (b, Scaled(x, -k))),
            (Term::Number(k), _) => NumberSub.on([b], &[k]),
            _ => Sub.on([a, b], &[]),
        }
    }

    fn product(&self, a: Id, b: Id) -> Joined {
        let Some((x, k)) = self.scaled(a, b) else { return Mul.on([a, b], &[]) };
        let inner = self.inner(x).and_then(|step| step.times(k));
        inner.unwrap_or_else(|| Scale.on([x], &[k]))
    }
}
