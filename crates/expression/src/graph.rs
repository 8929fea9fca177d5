//! Expressions as a graph: every subexpression once, operands before the expressions that use them.

use std::{
    collections::{BinaryHeap, HashMap},
    fmt::{self, Display},
    ops::Range,
};

use real::{Degree, Real};

use crate::values::Values;
use {Binary::*, Unary::*};

/// An expression of a [`Graph`].
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct Id(u32);

impl Id {
    /// The expression of this number in its graph.
    pub fn at(index: usize) -> Self {
        Self(index as u32)
    }

    /// Number of the expression in its graph.
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// A function of one number.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Unary {
    /// −x.
    Neg,
    /// |x|.
    Abs,
    /// √x.
    Sqrt,
    /// eˣ.
    Exp,
    /// The natural logarithm.
    Ln,
    /// sin x.
    Sin,
    /// cos x.
    Cos,
    /// tan x = sin x/cos x.
    Tan,
    /// sinh x.
    Sinh,
    /// cosh x.
    Cosh,
    /// tanh x.
    Tanh,
    /// sin x/x, and 1 at 0.
    Sinc,
}

impl Unary {
    /// The functions that a formula may name.
    pub const NAMED: [Self; 11] = [Abs, Sqrt, Exp, Ln, Sin, Cos, Tan, Sinh, Cosh, Tanh, Sinc];

    /// The value at x, as a tape computes it.
    #[inline(always)]
    pub fn value<R: Real>(self, x: R) -> R {
        match self {
            Neg => -x,
            Abs => Real::abs(x),
            Sqrt => x.sqrt(),
            Exp => x.exp(),
            Ln => x.ln(),
            Sin => x.sin(),
            Cos => x.cos(),
            Tan => Real::tan(x),
            Sinh => Real::sinh(x),
            Cosh => Real::cosh(x),
            Tanh => Real::tanh(x),
            Sinc => x.sinc(),
        }
    }
}

impl Display for Unary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&format!("{self:?}").to_lowercase())
    }
}

/// A function of two numbers.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Binary {
    /// a + b.
    Add,
    /// a − b.
    Sub,
    /// a·b.
    Mul,
    /// a/b.
    Div,
    /// The smaller number; NaN if either is.
    Min,
    /// The larger number; NaN if either is.
    Max,
}

impl Binary {
    /// The value at (a, b).
    pub fn value<R: Real>(self, a: R, b: R) -> R {
        match self {
            Add => a + b,
            Sub => a - b,
            Mul => a * b,
            Div => a / b,
            Min => Real::min(a, b),
            Max => Real::max(a, b),
        }
    }
}

/// Content of an expression: a number, an input, or a function of other expressions.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Node {
    /// The number with these bits.
    Constant(u64),
    /// The input of this number.
    Input(u32),
    /// A function of one expression.
    Unary(Unary, Id),
    /// A function of two expressions.
    Binary(Binary, Id, Id),
    /// xⁿ with n ≥ 2, by repeated squaring as [`real::elementary::powi`].
    Power(Id, u32),
    /// The third where the first is less than the second, else the fourth.
    Where([Id; 4]),
}

impl Node {
    /// The operands.
    pub fn operands(self) -> impl Iterator<Item = Id> {
        let (all, count) = match self {
            Self::Constant(_) | Self::Input(_) => ([Id(0); 4], 0),
            Self::Unary(_, a) | Self::Power(a, _) => ([a; 4], 1),
            Self::Binary(_, a, b) => ([a, b, a, a], 2),
            Self::Where(all) => (all, 4),
        };
        all.into_iter().take(count)
    }

    /// The node with other operands, without any identity.
    pub fn with_operands(self, mut of: impl FnMut(Id) -> Id) -> Self {
        match self {
            Self::Constant(_) | Self::Input(_) => self,
            Self::Unary(function, a) => Self::Unary(function, of(a)),
            Self::Binary(function, a, b) => Self::Binary(function, of(a), of(b)),
            Self::Power(a, n) => Self::Power(of(a), n),
            Self::Where(all) => Self::Where(all.map(of)),
        }
    }

    /// The value, from those of its operands, of what is no input.
    pub fn value<R: Real>(self, of: impl Fn(Id) -> R) -> R {
        match self {
            Self::Constant(bits) => R::constant(f64::from_bits(bits)),
            Self::Input(_) => unreachable!("an input has a value of its own"),
            Self::Unary(function, a) => function.value(of(a)),
            Self::Binary(function, a, b) => function.value(of(a), of(b)),
            Self::Power(a, n) => of(a).powi(n as i32),
            Self::Where([x, y, a, b]) => R::where_less(of(x), of(y), of(a), of(b)),
        }
    }
}

/// Expressions in some inputs, numbered from zero.
///
/// Equal expressions are one. Constants are folded with the functions that evaluate a tape. These
/// identities are applied, and no others; they are exact, up to the sign of a zero, an overflow,
/// and an operand that is not finite:
/// - x + 0 = x, 1·x = x, −1·x = −x, 0·x = 0/x = 0, x − x = 0, x + x = 2x, x·x = x²;
/// - −(−x) = x, −(a − b) = b − a, |−x| = |x|, min(x, x) = max(x, x) = x;
/// - x/2ⁿ = 2⁻ⁿ·x, and c·(d·x) = (c·d)·x if c or d is a power of two;
/// - a sign moves out of sums, products, quotients and powers, and into a constant factor.
///
/// The operands of + and · are put in order. Zero has no sign.
#[derive(Clone, Debug, Default)]
pub struct Graph {
    nodes: Vec<Node>,
    /// The bytes of a text where each of the first expressions was made first.
    places: Vec<Option<Range<usize>>>,
    ids: HashMap<Node, Id>,
    place: Option<Range<usize>>,
}

impl Graph {
    /// A graph without expressions.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Content of an expression.
    #[must_use]
    pub fn node(&self, id: Id) -> Node {
        self.nodes[id.index()]
    }

    /// The number of expressions.
    pub fn size(&self) -> usize {
        self.nodes.len()
    }

    /// The expressions, operands first.
    pub fn ids(&self) -> impl DoubleEndedIterator<Item = Id> + use<> {
        (0..self.nodes.len() as u32).map(Id)
    }

    /// Sets the place in the text of expressions made from now on.
    pub fn set_place(&mut self, place: Range<usize>) {
        self.place = Some(place);
    }

    /// The place where an expression was made first.
    pub fn place(&self, id: Id) -> Option<Range<usize>> {
        self.places.get(id.index()).cloned().flatten()
    }

    /// Makes an expression as it stands, without any identity.
    pub fn intern(&mut self, node: Node) -> Id {
        *self.ids.entry(node).or_insert_with(|| {
            self.nodes.push(node);
            if let Some(place) = &self.place {
                self.places.resize(self.nodes.len(), None);
                self.places[self.nodes.len() - 1] = Some(place.clone());
            }
            Id(self.nodes.len() as u32 - 1)
        })
    }

    /// The number x.
    pub fn constant(&mut self, x: f64) -> Id {
        // Zero has no sign.
        self.intern(Node::Constant((x + 0.0).to_bits()))
    }

    /// Input number k.
    pub fn input(&mut self, k: usize) -> Id {
        self.intern(Node::Input(k as u32))
    }

    /// The inputs of these numbers.
    pub fn inputs(&mut self, numbers: Range<usize>) -> Vec<Id> {
        numbers.map(|k| self.input(k)).collect()
    }

    /// The number of the input that an expression is.
    pub fn as_input(&self, id: Id) -> Option<usize> {
        match self.node(id) {
            Node::Input(k) => Some(k as usize),
            _ => None,
        }
    }

    /// The value of an expression without inputs.
    #[must_use]
    pub fn as_constant(&self, id: Id) -> Option<f64> {
        match self.node(id) {
            Node::Constant(bits) => Some(f64::from_bits(bits)),
            _ => None,
        }
    }

    /// Whether the expression is the number zero.
    pub fn is_zero(&self, id: Id) -> bool {
        self.as_constant(id) == Some(0.0)
    }

    /// x, if the expression is −x.
    fn negated(&self, id: Id) -> Option<Id> {
        match self.node(id) {
            Node::Unary(Neg, x) => Some(x),
            _ => None,
        }
    }

    /// (x, c), if the expression is c·x.
    #[must_use]
    pub fn scaled(&self, id: Id) -> Option<(Id, f64)> {
        match self.node(id) {
            Node::Binary(Mul, x, c) => Some((x, self.as_constant(c)?)),
            _ => None,
        }
    }

    /// −a.
    pub fn neg(&mut self, a: Id) -> Id {
        if let Some(x) = self.as_constant(a) {
            return self.constant(-x);
        }
        if let Some((x, c)) = self.scaled(a) {
            return self.scale(x, -c);
        }
        match self.node(a) {
            Node::Unary(Neg, x) => x,
            Node::Binary(Sub, x, y) => self.sub(y, x),
            Node::Binary(Add, x, y) if self.as_constant(y).is_some() => {
                let y = self.neg(y);
                self.sub(y, x)
            }
            _ => self.intern(Node::Unary(Neg, a)),
        }
    }

    /// A function of a.
    pub fn unary(&mut self, function: Unary, a: Id) -> Id {
        match (function, self.as_constant(a), self.negated(a)) {
            (Neg, _, _) => self.neg(a),
            (_, Some(x), _) => self.constant(function.value(x)),
            (Abs, _, Some(x)) => self.unary(function, x),
            _ => self.intern(Node::Unary(function, a)),
        }
    }

    /// A function of a and b.
    pub fn binary(&mut self, function: Binary, a: Id, b: Id) -> Id {
        let (x, y) = (self.as_constant(a), self.as_constant(b));
        match (function, x, y, (self.negated(a), self.negated(b))) {
            (_, Some(x), Some(y), _) => self.constant(function.value(x, y)),
            (Add, Some(0.0), ..) => b,
            (Add, _, Some(0.0), _) => a,
            (Add, ..) if a == b => self.scale(a, 2.0),
            (Add, .., (_, Some(y))) => self.sub(a, y),
            (Add, .., (Some(x), _)) => self.sub(b, x),
            (Sub, Some(0.0), ..) => self.neg(b),
            (Sub, _, Some(y), _) => {
                let y = self.constant(-y);
                self.add(a, y)
            }
            (Sub, ..) if a == b => self.constant(0.0),
            (Sub, .., (_, Some(y))) => self.add(a, y),
            (Sub, .., (Some(x), _)) => {
                let sum = self.add(x, b);
                self.neg(sum)
            }
            (Mul, Some(x), ..) => self.scale(b, x),
            (Mul, _, Some(y), _) => self.scale(a, y),
            (Mul, ..) if a == b => self.power(a, 2),
            (Div, Some(0.0), ..) | (Div, _, Some(1.0), _) => a,
            (Div, _, Some(y), _) if is_power_of_two(y) && (1.0 / y).is_normal() => {
                self.scale(a, 1.0 / y)
            }
            (Div, _, Some(y), _) if y < 0.0 => {
                let (a, b) = (self.neg(a), self.constant(-y));
                self.div(a, b)
            }
            (Mul | Div, .., (Some(x), Some(y))) => self.binary(function, x, y),
            (Mul | Div, .., (x, y)) if x.or(y).is_some() => {
                let unsigned = self.binary(function, x.unwrap_or(a), y.unwrap_or(b));
                self.neg(unsigned)
            }
            (Min | Max, ..) if a == b => a,
            (Add | Mul, ..) => {
                // A constant is the second, others are in the order in which they were made.
                let mut operands = [a, b];
                operands.sort_by_key(|&id| (self.as_constant(id).is_some(), id));
                self.intern(Node::Binary(function, operands[0], operands[1]))
            }
            _ => self.intern(Node::Binary(function, a, b)),
        }
    }

    /// a + b.
    pub fn add(&mut self, a: Id, b: Id) -> Id {
        self.binary(Add, a, b)
    }

    /// a − b.
    pub fn sub(&mut self, a: Id, b: Id) -> Id {
        self.binary(Sub, a, b)
    }

    /// a·b.
    pub fn mul(&mut self, a: Id, b: Id) -> Id {
        self.binary(Mul, a, b)
    }

    /// a/b.
    pub fn div(&mut self, a: Id, b: Id) -> Id {
        self.binary(Div, a, b)
    }

    /// sum + a·b.
    pub fn add_product(&mut self, sum: Id, a: Id, b: Id) -> Id {
        let product = self.mul(a, b);
        self.add(sum, product)
    }

    /// sum − a·b.
    pub fn sub_product(&mut self, sum: Id, a: Id, b: Id) -> Id {
        let product = self.mul(a, b);
        self.sub(sum, product)
    }

    /// Adds weight·a to a sum.
    pub fn add_to(&mut self, sum: &mut Id, a: Id, weight: f64) {
        let weighted = self.scale(a, weight);
        *sum = self.add(*sum, weighted);
    }

    /// c·a.
    pub fn scale(&mut self, a: Id, c: f64) -> Id {
        match (self.as_constant(a), self.negated(a)) {
            (Some(x), _) => return self.constant(x * c),
            _ if c == 0.0 => return self.constant(0.0),
            _ if c == 1.0 => return a,
            (_, Some(x)) => return self.scale(x, -c),
            _ if c == -1.0 => return self.neg(a),
            _ => {}
        }
        if let Some((x, inner)) = self.scaled(a)
            && (is_power_of_two(c) || is_power_of_two(inner))
            && (c * inner).is_normal()
        {
            return self.scale(x, c * inner);
        }
        let c = self.constant(c);
        self.intern(Node::Binary(Mul, a, c))
    }

    /// aⁿ by repeated squaring, with the bits of [`real::elementary::powi`].
    pub fn power(&mut self, a: Id, n: i32) -> Id {
        let power = self.power_of_size(a, n.unsigned_abs());
        if n < 0 {
            let one = self.constant(1.0);
            return self.div(one, power);
        }
        power
    }

    /// aⁿ by repeated squaring.
    pub fn power_of_size(&mut self, a: Id, n: u32) -> Id {
        match (n, self.as_constant(a), self.negated(a)) {
            (0, _, _) => self.constant(1.0),
            (1, _, _) => a,
            (_, Some(x), _) => self.constant(Real::powi(x, n as i32)),
            (_, _, Some(x)) => {
                let power = self.power_of_size(x, n);
                if n % 2 == 1 { self.neg(power) } else { power }
            }
            _ => self.intern(Node::Power(a, n)),
        }
    }

    /// `a` where x < y, else `b`.
    pub fn where_less(&mut self, x: Id, y: Id, a: Id, b: Id) -> Id {
        match (self.as_constant(x), self.as_constant(y)) {
            (Some(x), Some(y)) if x < y => a,
            (Some(_), Some(_)) => b,
            _ if a == b => a,
            _ => self.intern(Node::Where([x, y, a, b])),
        }
    }

    /// Makes an expression, with the identities applied.
    fn make(&mut self, node: Node) -> Id {
        match node {
            Node::Constant(_) | Node::Input(_) => self.intern(node),
            Node::Unary(function, a) => self.unary(function, a),
            Node::Binary(function, a, b) => self.binary(function, a, b),
            Node::Power(a, n) => self.power_of_size(a, n),
            Node::Where([x, y, a, b]) => self.where_less(x, y, a, b),
        }
    }

    /// Expressions of another graph, or of this one, with `input(k)` in the place of input k; none
    /// is input k itself.
    pub fn copy(
        &mut self,
        other: Option<&Self>,
        roots: &[Id],
        input: impl Fn(usize) -> Option<Id>,
    ) -> Vec<Id> {
        self.place = None;
        let needed = other.unwrap_or(self).needed(roots);
        let copies = Values::new(needed, |id, copies| match other.unwrap_or(self).node(id) {
            Node::Input(k) => input(k as usize).unwrap_or_else(|| self.input(k as usize)),
            node => self.make(node.with_operands(|operand| copies[operand])),
        });
        roots.iter().map(|&root| copies[root]).collect()
    }

    /// The roots and what they are made of, operands first.
    #[must_use]
    pub fn needed(&self, roots: &[Id]) -> Vec<Id> {
        let mut open: BinaryHeap<Id> = roots.iter().copied().collect();
        let mut needed: Vec<Id> = Vec::new();
        while let Some(id) = open.pop() {
            if needed.last() != Some(&id) {
                needed.push(id);
                open.extend(self.node(id).operands());
            }
        }
        needed.reverse();
        needed
    }

    /// A bound of the degree of an expression as a polynomial in the inputs that are variables, as
    /// in [`real::Degree`]; none if it does not show a polynomial. An expression made of pieces is
    /// none.
    #[must_use]
    pub fn degree(&self, root: Id, is_variable: impl Fn(usize) -> bool) -> Option<u32> {
        self.degrees(&[root], is_variable)[0]
    }

    /// The [`degree`](Self::degree) of each root.
    pub fn degrees(&self, roots: &[Id], is_variable: impl Fn(usize) -> bool) -> Vec<Option<u32>> {
        let degree = |k| if is_variable(k) { Degree::VARIABLE } else { Degree::CONSTANT };
        self.values(roots, degree).into_iter().map(Degree::get).collect()
    }

    /// Whether one of the expressions that `roots` use satisfies `is`.
    pub fn uses(&self, roots: &[Id], is: impl Fn(Node) -> bool) -> bool {
        self.needed(roots).into_iter().any(|id| is(self.node(id)))
    }

    /// The value of each root, on numbers of any type.
    pub fn values<R: Real>(&self, roots: &[Id], input: impl Fn(usize) -> R) -> Vec<R> {
        let values = self.all_values(roots, input);
        roots.iter().map(|&root| values[root]).collect()
    }

    /// The value of each expression that `roots` use.
    pub fn all_values<R: Real>(&self, roots: &[Id], input: impl Fn(usize) -> R) -> Values<R> {
        Values::new(self.needed(roots), |id, values| match self.node(id) {
            Node::Input(k) => input(k as usize),
            node => node.value(|operand| values[operand]),
        })
    }

    /// u₁v₂ − u₂v₁.
    pub fn minor(&mut self, u: [Id; 2], v: [Id; 2]) -> Id {
        let plus = self.mul(u[0], v[1]);
        self.sub_product(plus, u[1], v[0])
    }

    /// u × v.
    pub fn cross(&mut self, u: &[Id], v: &[Id]) -> [Id; 3] {
        [(1, 2), (2, 0), (0, 1)].map(|(i, j)| self.minor([u[i], u[j]], [v[i], v[j]]))
    }

    /// The sum of products.
    pub fn sum(&mut self, products: impl IntoIterator<Item = (Id, Id)>) -> Id {
        let zero = self.constant(0.0);
        products.into_iter().fold(zero, |sum, (u, v)| self.add_product(sum, u, v))
    }

    /// Σ uᵢvᵢ.
    pub fn dot(&mut self, u: &[Id], v: &[Id]) -> Id {
        self.sum(u.iter().copied().zip(v.iter().copied()))
    }
}

/// Whether |x| is a normal power of two.
fn is_power_of_two(x: f64) -> bool {
    x.is_normal() && x.to_bits() << 12 == 0
}
