//! Derivatives from graph to graph. What does not vary is left out, not multiplied by zero.

use std::collections::{BTreeMap, BTreeSet};

use crate::{
    Id,
    graph::{
        Binary::*,
        Graph, Node,
        Unary::{self, *},
    },
    values::Values,
};

/// Terms of the series of sinc′: the first omitted one is below half an ulp at x = 1.
const SINC_SLOPE_TERMS: i32 = 9;

impl Graph {
    /// Σ wᵢ ∂fᵢ/∂x for every input x in `inputs`, by reverse accumulation: one pass for any number
    /// of inputs. `weighted` are the pairs (fᵢ, wᵢ). The weights are not differentiated.
    ///
    /// With one weight 1 it is a gradient. The derivative of a piece that abs, min or max does not
    /// choose is multiplied by zero, and so must be finite.
    pub fn reverse(&mut self, weighted: &[(Id, Id)], inputs: &[usize]) -> Vec<Id> {
        let inputs: Vec<Id> = inputs.iter().map(|&k| self.input(k)).collect();
        self.reverse_at(weighted, &inputs)
    }

    /// [`reverse`](Self::reverse) with expressions in the place of inputs, as if each were an
    /// input.
    pub fn reverse_at(&mut self, weighted: &[(Id, Id)], inputs: &[Id]) -> Vec<Id> {
        let wanted = BTreeSet::from_iter(inputs);
        let slopes = self.adjoints(weighted, |_, id| wanted.contains(&id));
        let zero = self.constant(0.0);
        inputs.iter().map(|x| slopes.get(x).copied().unwrap_or(zero)).collect()
    }

    /// The derivatives of [`reverse`](Self::reverse) that are not zero, by inputs that are
    /// variables.
    pub fn slopes(
        &mut self,
        weighted: &[(Id, Id)],
        is_variable: impl Fn(usize) -> bool,
    ) -> BTreeMap<usize, Id> {
        let number = |graph: &Self, id| graph.as_input(id).filter(|&k| is_variable(k));
        let slopes = self.adjoints(weighted, |graph, id| number(graph, id).is_some());
        slopes.into_iter().filter_map(|(id, slope)| Some((number(self, id)?, slope))).collect()
    }

    /// The derivatives by what is an input; zeros are left out.
    fn adjoints(
        &mut self,
        weighted: &[(Id, Id)],
        is_input: impl Fn(&Self, Id) -> bool,
    ) -> BTreeMap<Id, Id> {
        let needed = self.needed(&weighted.iter().map(|(f, _)| *f).collect::<Vec<_>>());
        let varies = Values::new(needed.clone(), |id, varies| {
            is_input(self, id) || self.node(id).operands().any(|operand| varies[operand])
        });
        let mut adjoints = Values::new(needed, |_, _| None);
        for &(f, weight) in weighted.iter().filter(|(f, _)| varies[*f]) {
            self.accumulate(&mut adjoints[f], weight);
        }
        for &id in varies.ids().iter().rev() {
            let Some(weight) = adjoints[id].filter(|_| !is_input(self, id)) else { continue };
            let varying = self.node(id).operands().enumerate().filter(|(_, of)| varies[*of]);
            let part = |(k, operand)| Some((operand, self.part(id, k, weight)?));
            let parts: Vec<(Id, Id)> = varying.filter_map(part).collect();
            parts.into_iter().for_each(|(to, part)| self.accumulate(&mut adjoints[to], part));
        }
        let inputs = varies.ids().iter().filter(|&&id| is_input(self, id));
        inputs.filter_map(|&id| Some((id, adjoints[id]?))).collect()
    }

    fn accumulate(&mut self, adjoint: &mut Option<Id>, part: Id) {
        if !self.is_zero(part) {
            *adjoint = Some(match *adjoint {
                Some(sum) => self.add(sum, part),
                None => part,
            });
        }
    }

    /// weight·∂f/∂a for operand number k of f.
    fn part(&mut self, f: Id, k: usize, weight: Id) -> Option<Id> {
        let (is_first, if_at) = (k == 0, |n| (n == k).then_some(weight));
        Some(match self.node(f) {
            Node::Constant(_) | Node::Input(_) => return None,
            Node::Unary(Neg, _) => self.neg(weight),
            Node::Unary(Abs, a) => {
                let (zero, other) = (self.constant(0.0), self.neg(weight));
                self.where_less(a, zero, other, weight)
            }
            Node::Unary(Sqrt, a) => {
                let twice = self.scale(f, 2.0);
                let part = self.div(weight, twice);
                let Node::Binary(Max, ..) = self.node(a) else { return Some(part) };
                // √max(x, 0) is constant where it is zero, but for x = 0.
                let [least, huge] = [f64::MIN_POSITIVE, f64::MAX].map(|x| self.constant(x));
                let steep = self.mul(weight, huge);
                self.where_less(f, least, steep, part)
            }
            Node::Unary(Ln, a) => self.div(weight, a),
            Node::Unary(function, a) => {
                let slope = self.slope(function, f, a);
                self.mul(weight, slope)
            }
            Node::Binary(Add, ..) => weight,
            Node::Binary(Sub, ..) if is_first => weight,
            Node::Binary(Sub, ..) => self.neg(weight),
            Node::Binary(Mul, a, b) => self.mul(weight, if is_first { b } else { a }),
            Node::Binary(Div, _, b) => {
                let part = self.div(weight, b);
                if is_first {
                    return Some(part);
                }
                let part = self.mul(part, f);
                self.neg(part)
            }
            Node::Binary(Min, a, b) => self.chosen(a, b, if_at(0), if_at(1))?,
            Node::Binary(Max, a, b) => self.chosen(b, a, if_at(0), if_at(1))?,
            Node::Power(a, n) => {
                let power = self.power_of_size(a, n - 1);
                let weight = self.scale(weight, f64::from(n));
                self.mul(weight, power)
            }
            Node::Where([x, y, ..]) => self.chosen(x, y, if_at(2), if_at(3))?,
        })
    }

    /// The derivative of f = function(a), for smooth functions other than √, ln and −.
    fn slope(&mut self, function: Unary, f: Id, a: Id) -> Id {
        match function {
            Exp => f,
            Sin => self.unary(Cos, a),
            Cos => {
                let sin = self.unary(Sin, a);
                self.neg(sin)
            }
            Sinh => self.unary(Cosh, a),
            Cosh => self.unary(Sinh, a),
            Tan | Tanh => {
                let (one, square) = (self.constant(1.0), self.power(f, 2));
                if function == Tan { self.add(square, one) } else { self.sub(one, square) }
            }
            Sinc => self.sinc_slope(f, a),
            Neg | Abs | Sqrt | Ln => {
                unreachable!("{function} has a rule of its own")
            }
        }
    }

    /// sinc′(x) = (cos x − sinc x)/x, and for x² < 1, where that cancels, the series
    /// Σ_{n≥1} (−1)ⁿ 2n x^{2n−1}/(2n+1)!, as [`real::Dual`] has it.
    fn sinc_slope(&mut self, sinc: Id, x: Id) -> Id {
        let (square, one) = (self.power(x, 2), self.constant(1.0));
        let mut series = one;
        for n in (1..SINC_SLOPE_TERMS).rev() {
            let n = f64::from(n);
            let ratio = (n + 1.0) / (n * (2.0 * n + 2.0) * (2.0 * n + 3.0));
            let scaled = self.scale(square, ratio);
            series = self.sub_product(one, scaled, series);
        }
        let product = self.mul(x, series);
        let near = self.scale(product, -1.0 / 3.0);
        // Where the series is taken, the quotient is not 0/0.
        let safe = self.where_less(square, one, one, x);
        let cos = self.unary(Cos, x);
        let difference = self.sub(cos, sinc);
        let far = self.div(difference, safe);
        self.where_less(square, one, near, far)
    }

    /// The derivatives of `roots` along a direction: input k changes at the rate `direction(k)`, or
    /// is constant. The direction is not differentiated.
    ///
    /// Along new inputs, of the gradient, it is a Hessian times a vector.
    pub fn forward(&mut self, roots: &[Id], direction: impl Fn(usize) -> Option<Id>) -> Vec<Id> {
        let tangents = Values::new(self.needed(roots), |id, tangents| match self.node(id) {
            Node::Input(k) => direction(k as usize).filter(|&rate| !self.is_zero(rate)),
            _ => self.tangent(id, |operand| tangents[operand]),
        });
        let zero = self.constant(0.0);
        roots.iter().map(|&root| tangents[root].unwrap_or(zero)).collect()
    }

    /// The derivative of f from those of its operands; none if it does not vary.
    fn tangent(&mut self, f: Id, of: impl Fn(Id) -> Option<Id>) -> Option<Id> {
        let tangent = match self.node(f) {
            Node::Constant(_) | Node::Input(_) => return None,
            Node::Unary(_, a) => {
                let rate = of(a)?;
                self.part(f, 0, rate)?
            }
            Node::Binary(Add | Sub | Mul, a, b) => {
                let mut part = |k, operand| self.part(f, k, of(operand)?);
                match (part(0, a), part(1, b)) {
                    (Some(left), Some(right)) => self.add(left, right),
                    (left, right) => left.or(right)?,
                }
            }
            Node::Binary(Div, a, b) => {
                let lower = of(b).map(|rate| self.mul(f, rate));
                let upper = match (of(a), lower) {
                    (Some(upper), Some(lower)) => self.sub(upper, lower),
                    (Some(upper), None) => upper,
                    (None, lower) => self.neg(lower?),
                };
                self.div(upper, b)
            }
            Node::Binary(Min, a, b) => self.chosen(a, b, of(a), of(b))?,
            Node::Binary(Max, a, b) => self.chosen(b, a, of(a), of(b))?,
            Node::Power(a, n) => {
                let (rate, power) = (of(a)?, self.power_of_size(a, n - 1));
                let slope = self.scale(power, f64::from(n));
                self.mul(slope, rate)
            }
            Node::Where([x, y, a, b]) => self.chosen(x, y, of(a), of(b))?,
        };
        (!self.is_zero(tangent)).then_some(tangent)
    }

    /// `a` where x < y, else `b`; none if neither varies.
    fn chosen(&mut self, x: Id, y: Id, a: Option<Id>, b: Option<Id>) -> Option<Id> {
        a.or(b)?;
        let zero = self.constant(0.0);
        Some(self.where_less(x, y, a.unwrap_or(zero), b.unwrap_or(zero)))
    }
}
