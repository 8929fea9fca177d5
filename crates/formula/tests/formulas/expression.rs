//! Random expressions with their text and their values in any numbers, independent of the crate.

use formula::{Formula, Tape};
use num_dual::DualNum;
use real::{Bounded, Real};

/// A generator of random numbers (xorshift64*, Vigna 2016).
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1)
    }

    pub fn next(&mut self) -> u64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        self.0.wrapping_mul(0x2545_f491_4f6c_dd1d)
    }

    pub fn below(&mut self, n: usize) -> usize {
        (self.next() >> 33) as usize % n
    }

    /// Uniform in (−2, 2).
    pub fn number(&mut self) -> f64 {
        4.0 * ((self.next() >> 11) as f64 / (1_u64 << 53) as f64) - 2.0
    }
}

/// ∇²f·u, from all variables and u.
pub fn hessian(formula: &Formula) -> Tape {
    let (mut graph, count) = (formula.graph.clone(), formula.variables.len());
    let one = graph.constant(1.0);
    let gradient = graph.reverse(&[(formula.root, one)], &Vec::from_iter(0..count));
    let along: Vec<_> = (0..count).map(|k| graph.input(count + k)).collect();
    let product = graph.forward(&gradient, |k| along.get(k).copied());
    Tape::new(&graph, &product, &[0..count, count..2 * count])
}

#[derive(Clone, Debug)]
pub enum Expression {
    Number(String),
    Variable(usize),
    Neg(Box<Self>),
    Function(&'static str, Box<Self>),
    Binary(char, Box<Self>, Box<Self>),
    Pair(&'static str, Box<Self>, Box<Self>),
    Power(Box<Self>, i32),
}

pub const VARIABLES: [&str; 3] = ["x", "y_1", "γ"];
const NUMBERS: [&str; 8] = ["0", "1", "2", "0.37", "1e-3", ".5", "3.", "2.5E+0"];
const FUNCTIONS: [&str; 11] =
    ["sin", "cos", "tan", "exp", "ln", "sqrt", "abs", "sinh", "cosh", "tanh", "sinc"];
const OPERATORS: [char; 5] = ['+', '-', '*', '/', '^'];

use Expression::*;

impl Expression {
    /// A random expression with at most `depth` nested operations.
    pub fn random(random: &mut Random, depth: usize) -> Self {
        if depth == 0 {
            return match random.below(3) {
                0 => Number(NUMBERS[random.below(NUMBERS.len())].to_owned()),
                _ => Variable(random.below(VARIABLES.len())),
            };
        }
        let mut next = || Box::new(Self::random(random, depth - 1));
        let (a, b) = (next(), next());
        match random.below(12) {
            0 => Neg(a),
            1 | 2 => Function(FUNCTIONS[random.below(FUNCTIONS.len())], a),
            3 => Pair(["min", "max"][random.below(2)], a, b),
            4 => Power(a, random.below(9) as i32 - 3),
            _ => Binary(OPERATORS[random.below(10) % 5], a, b),
        }
    }

    /// How tightly the outermost operation binds.
    fn level(&self) -> u32 {
        match self {
            Binary('+' | '-', ..) => 1,
            Binary('*' | '/', ..) => 2,
            Neg(_) => 3,
            Binary(..) | Power(..) => 4,
            Number(_) | Variable(_) | Function(..) | Pair(..) => 5,
        }
    }

    /// The text in an operation that needs at least this level: brackets only where they are
    /// needed.
    fn text_at(&self, level: u32) -> String {
        let text = self.text();
        if self.level() < level { format!("({text})") } else { text }
    }

    /// The text.
    pub fn text(&self) -> String {
        match self {
            Number(text) => text.clone(),
            Variable(k) => VARIABLES[*k].to_owned(),
            Neg(a) => format!("-{}", a.text_at(3)),
            Function(name, a) => format!("{name}({})", a.text()),
            Pair(name, a, b) => format!("{name} ( {}, {} )", a.text(), b.text()),
            Power(a, n) => format!("{}^{n}", a.text_at(5)),
            Binary('^', a, b) => format!("{}^{}", a.text_at(5), b.text_at(3)),
            Binary(operator, a, b) => {
                let level = self.level();
                format!("{} {operator} {}", a.text_at(level), b.text_at(level + 1))
            }
        }
    }

    /// The exponent, if it is a constant that makes a power a product or a root.
    fn constant(&self) -> Option<f64> {
        (!self.varies()).then(|| self.value(&[0.0; 3]))
    }

    fn varies(&self) -> bool {
        match self {
            Number(_) => false,
            Variable(_) => true,
            Neg(a) | Function(_, a) | Power(a, _) => a.varies(),
            Pair(_, a, b) | Binary(_, a, b) => a.varies() || b.varies(),
        }
    }

    /// The value in dual numbers of another project, with the host's functions.
    pub fn oracle<D: DualNum<Primitive = f64> + Copy>(&self, x: &[D]) -> D {
        match self {
            Number(text) => D::from(text.parse::<f64>().unwrap()),
            Variable(k) => x[*k],
            Neg(a) => -a.oracle(x),
            Power(a, n) => a.oracle(x).powi(*n),
            Function(name, a) => {
                let a = a.oracle(x);
                match *name {
                    "sin" => a.sin(),
                    "cos" => a.cos(),
                    "tan" => a.tan(),
                    "exp" => a.exp(),
                    "ln" => a.ln(),
                    "sqrt" => a.sqrt(),
                    "sinh" => a.sinh(),
                    "cosh" => a.cosh(),
                    "tanh" => a.tanh(),
                    "sinc" => a.sph_j0(),
                    _ => {
                        if a < 0.0 {
                            -a
                        } else {
                            a
                        }
                    }
                }
            }
            Pair(name, a, b) => {
                let (a, b) = (a.oracle(x), b.oracle(x));
                let first = if *name == "min" { a < b } else { b < a };
                if first { a } else { b }
            }
            Binary(operator, a, b) => {
                let (a, power) = (a.oracle(x), b.constant());
                let b = b.oracle(x);
                match (operator, power) {
                    ('+', _) => a + b,
                    ('-', _) => a - b,
                    ('*', _) => a * b,
                    ('/', _) => a / b,
                    (_, Some(n)) if n == n.trunc() && n.abs() < 1e9 => a.powi(n as i32),
                    (_, Some(0.5)) => a.sqrt(),
                    _ => (a.ln() * b).exp(),
                }
            }
        }
    }

    /// The value in the numbers of `real`.
    pub fn value<R: Real>(&self, x: &[R]) -> R {
        match self {
            Number(text) => R::constant(text.parse().unwrap()),
            Variable(k) => x[*k],
            Neg(a) => -a.value(x),
            Power(a, n) => a.value(x).powi(*n),
            Function(name, a) => {
                let a = a.value(x);
                match *name {
                    "sin" => a.sin(),
                    "cos" => a.cos(),
                    "tan" => a.sin() / a.cos(),
                    "exp" => a.exp(),
                    "ln" => a.ln(),
                    "sqrt" => a.sqrt(),
                    "sinh" => (a.exp() - (-a).exp()) * 0.5,
                    "cosh" => (a.exp() + (-a).exp()) * 0.5,
                    "sinc" => a.sinc(),
                    "tanh" => (a.exp() - (-a).exp()) / (a.exp() + (-a).exp()),
                    _ => R::where_less(a, R::zero(), -a, a),
                }
            }
            Pair(name, a, b) => {
                let (a, b) = (a.value(x), b.value(x));
                let (low, high) = if *name == "min" { (a, b) } else { (b, a) };
                R::where_less(low, high, a, b)
            }
            Binary(operator, a, b) => {
                let (a, power) = (a.value(x), b.constant());
                let b = b.value(x);
                match (operator, power) {
                    ('+', _) => a + b,
                    ('-', _) => a - b,
                    ('*', _) => a * b,
                    ('/', _) => a / b,
                    (_, Some(n)) if n == n.trunc() && n.abs() < 1e9 => a.powi(n as i32),
                    (_, Some(0.5)) => a.sqrt(),
                    _ => (a.ln() * b).exp(),
                }
            }
        }
    }

    /// Whether rounding may choose the other piece of abs, min or max somewhere, or an angle is
    /// too large or too small.
    pub fn is_at_an_edge(&self, x: &[Bounded]) -> bool {
        let near = |a: Bounded, b: Bounded| {
            let distance = (a.value - b.value).abs();
            distance <= 16.0 * (a.error + b.error) || distance.is_nan()
        };
        match self {
            Number(_) | Variable(_) => false,
            Neg(a) => a.is_at_an_edge(x),
            // The sign of a zero below is not kept.
            Power(a, _) => a.is_at_an_edge(x) || a.value(x).value == 0.0,
            Function(name, a) => {
                let at = a.value(x);
                let outside = match *name {
                    "abs" => near(at, Bounded::exact(0.0)),
                    // Beyond it sine and cosine of `real` are not accurate.
                    "sin" | "cos" | "tan" => at.value.abs() > 1_048_576.0,
                    // The derivatives of the oracle cancel for small ones.
                    "sinc" => !(1.0..1_048_576.0).contains(&at.value.abs()),
                    _ => false,
                };
                outside || a.is_at_an_edge(x)
            }
            Pair(_, a, b) => {
                a.is_at_an_edge(x) || b.is_at_an_edge(x) || near(a.value(x), b.value(x))
            }
            Binary(operator, a, b) => {
                let pole = *operator == '/' && b.value(x).value == 0.0;
                // The oracle overflows.
                let high = *operator == '^' && b.constant().is_some_and(|n| n.abs() > 1000.0);
                high || pole || a.is_at_an_edge(x) || b.is_at_an_edge(x)
            }
        }
    }
}
