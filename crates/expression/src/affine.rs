//! Expressions that are affine in some inputs, with their numbers.

use std::collections::BTreeMap;

use crate::{
    Id,
    graph::{
        Binary::{Add, Div, Mul, Sub},
        Graph, Node,
        Unary::Neg,
    },
    values::Values,
};

/// c + Σ aₖyₖ. Slopes that are zero are left out.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Affine {
    /// c.
    pub constant: f64,
    /// The numbers aₖ that are not zero, by k.
    pub slopes: BTreeMap<usize, f64>,
}

/// Rounding of a sum relative to its terms: some operations of 2⁻⁵³ each.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

impl Affine {
    /// The input k.
    pub fn input(k: usize) -> Self {
        Self { constant: 0.0, slopes: BTreeMap::from([(k, 1.0)]) }
    }

    /// Whether it is zero everywhere.
    #[must_use]
    pub fn is_zero(&self) -> bool {
        self.constant == 0.0 && self.slopes.is_empty()
    }

    /// Adds `factor` times another. What cancels up to rounding is zero.
    pub fn add(&mut self, factor: f64, other: &Self) {
        self.constant = sum(self.constant, factor * other.constant);
        for (&k, &slope) in &other.slopes {
            match sum(self.slopes.get(&k).copied().unwrap_or(0.0), factor * slope) {
                0.0 => self.slopes.remove(&k),
                slope => self.slopes.insert(k, slope),
            };
        }
    }

    /// The multiple of this one.
    pub fn times(&self, factor: f64) -> Self {
        let mut product = Self::default();
        product.add(factor, self);
        product
    }

    /// c with self = c·other up to rounding.
    pub fn over(&self, other: &Self) -> Option<f64> {
        let of = |form: &Self, key: &Option<usize>| match key {
            None => form.constant,
            Some(k) => form.slopes.get(k).copied().unwrap_or(0.0),
        };
        let keys = other.slopes.keys().copied().map(Some).chain([None]);
        let largest = keys.max_by(|a, b| of(other, a).abs().total_cmp(&of(other, b).abs()))?;
        let ratio = of(self, &largest) / of(other, &largest);
        (ratio.is_finite() && self.is_multiple(ratio, other)).then_some(ratio)
    }

    /// Whether self = c·other up to rounding.
    #[must_use]
    pub fn is_multiple(&self, c: f64, other: &Self) -> bool {
        let mut rest = self.clone();
        rest.add(-c, other);
        rest.is_zero()
    }

    /// The value where input k is `of(k)`, as an expression.
    pub fn expression(&self, graph: &mut Graph, of: &[Id]) -> Id {
        let mut sum = graph.constant(self.constant);
        for (&k, &slope) in &self.slopes {
            graph.add_to(&mut sum, of[k], slope);
        }
        sum
    }
}

/// a + b, zero where they cancel up to rounding.
fn sum(a: f64, b: f64) -> f64 {
    let sum = a + b;
    if sum.abs() <= ROUNDING * a.abs().max(b.abs()) { 0.0 } else { sum }
}

/// Forms with more inputs are not looked for.
const MAX_INPUTS: usize = 1000;

/// For each expression that `roots` use its form in the first `count` inputs, if it is affine with
/// constant numbers. An expression without these inputs that is not a number has none.
pub fn forms(graph: &Graph, roots: &[Id], count: usize) -> Values<Option<Affine>> {
    Values::new(graph.needed(roots), |id, forms: &Values<Option<Affine>>| {
        let of = |id: Id| forms[id].as_ref();
        let number =
            |id: Id| of(id).filter(|form| form.slopes.is_empty()).map(|form| form.constant);
        let form = match graph.node(id) {
            Node::Constant(bits) => {
                Some(Affine { constant: f64::from_bits(bits), ..Affine::default() })
            }
            Node::Input(k) if (k as usize) < count => Some(Affine::input(k as usize)),
            Node::Unary(Neg, a) => of(a).map(|a| a.times(-1.0)),
            Node::Binary(sign @ (Add | Sub), a, b) => of(a).zip(of(b)).map(|(a, b)| {
                let mut sum = a.clone();
                sum.add(if sign == Add { 1.0 } else { -1.0 }, b);
                sum
            }),
            Node::Binary(Mul, a, b) => {
                let scaled = |a, b| Some(of(a)?.times(number(b)?));
                scaled(a, b).or_else(|| scaled(b, a))
            }
            Node::Binary(Div, a, b) => of(a).zip(number(b)).map(|(a, b)| a.times(1.0 / b)),
            _ => None,
        };
        form.filter(|form| form.slopes.len() <= MAX_INPUTS)
    })
}
