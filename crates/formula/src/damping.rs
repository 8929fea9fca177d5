//! A damping rate from a text.

use dgrad::{Rule, nodes_for_degree};
use real::{
    Row, WIDTH,
    elementary::{cos, exp, sin, sinc},
};
use systems::Damping;

use crate::Formula;
use expression::{Graph, Id, Node, Unary, terms};

/// Nodes of the quadrature of a rate that is not a polynomial: both halves of an interval fit into
/// a row.
const NODES: usize = WIDTH / 2;
/// Halvings of an interval on which the quadrature has not converged: down to neighbouring times.
const HALVINGS: u32 = 60;
/// Most intervals that are halved.
const BUDGET: u32 = 4096;
/// An integral has converged if halves change it by no more than this part of ∫|γ|: above the
/// rounding of the sums, and where the rate is smooth the halves are better by 2³² or more. Or if
/// no more than rounding of the times: εt times the change of the rate, which ends at a jump, too.
const TOLERANCE: f64 = 1e-14;

/// Least jump at the end of an interval that is seen, as a part of the largest rate.
const JUMP: f64 = 1e-5;

/// Weights of the values at the nodes in the value at the end of the interval [0, 1], of the
/// polynomial through them, in barycentric form.
fn extrapolation(rule: &Rule) -> Vec<f64> {
    let nodes = rule.nodes().iter().zip(rule.weights()).enumerate();
    let terms = nodes.map(|(k, (x, w))| {
        let sign = if k.is_multiple_of(2) { 1.0 } else { -1.0 };
        sign * (x * (1.0 - x) * w).sqrt() / (1.0 - x)
    });
    let terms: Vec<f64> = terms.collect();
    let sum: f64 = terms.iter().sum();
    terms.into_iter().map(|term| term / sum).collect()
}

/// The damping rate γ(t) as a formula in t, in 1/time.
///
/// The integral is exact to round-off for polynomials in t up to degree 31, and for sums of lines
/// and sines, cosines and exponentials of lines, which also take the least time. Otherwise it is
/// that of 16 Gauss–Legendre nodes, on intervals that are halved until both halves together agree
/// with it to round-off, that of the times included, and 4096 intervals at most.
///
/// ```
/// use formula::{Formula, FormulaDamping, Names};
/// use systems::Damping;
///
/// let rate = Formula::parse("0.2 + sin(2*t)/10", &Names::with_variables(&["t"])?)?;
/// let damping = FormulaDamping::new(rate);
/// assert!((damping.integral(0.0, 1.0) - (0.2 + 0.05 * (1.0 - 2f64.cos()))).abs() < 1e-15);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct FormulaDamping {
    formula: Formula,
    rule: Rule,
    /// Whether the rule is exact.
    exact: bool,
    /// Weights of the nodes in the value at the end of the interval, where the rate has conditions:
    /// nodes do not see a jump beside the ends.
    at_end: Option<Vec<f64>>,
    /// The terms, if the integral has a closed form without cancellation.
    closed: Option<Vec<Term>>,
}

impl FormulaDamping {
    /// The rate from a formula in t.
    ///
    /// # Panics
    /// If the formula has other variables than one.
    #[must_use]
    pub fn new(formula: Formula) -> Self {
        assert_eq!(formula.variables.len(), 1, "variables of a damping rate");
        let degree = formula.degree(&[0]).map(|degree| nodes_for_degree(degree as usize));
        let exact = degree.filter(|&nodes| nodes <= NODES);
        let rule = Rule::new(exact.unwrap_or(NODES).max(1)).expect("a rule has a node or more");
        let at_end = formula.has_conditions().then(|| extrapolation(&rule));
        let closed = closed_terms(&formula);
        Self { formula, rule, exact: exact.is_some(), at_end, closed }
    }

    /// ∫γ and ∫|γ| over both halves of an interval, by the nodes, by how much γ changes, and
    /// whether γ at the ends of both is what follows from the nodes.
    fn halves(&self, a: f64, b: f64) -> ([(f64, f64); 2], f64, bool) {
        let (nodes, weights) = (self.rule.nodes(), self.rule.weights());
        let half = 0.5 * (b - a);
        let mut times: Row = [a; WIDTH];
        for (k, node) in nodes.iter().enumerate() {
            times[k] = a + half * node;
            times[k + NODES] = a + half + half * node;
        }
        let mut rates = self.formula.tape.rows(&[&[times]]);
        // About a time at which it is infinite a rate may have an integral.
        rates[0].iter_mut().filter(|rate| rate.is_infinite()).for_each(|rate| *rate = 0.0);
        let used = [0, NODES].map(|first| &rates[0][first..first + nodes.len()]);
        let all = || used.into_iter().flatten().copied();
        let change = all().fold(-f64::INFINITY, f64::max) - all().fold(f64::INFINITY, f64::min);
        let sums = used.map(|rates| {
            let terms = weights.iter().zip(rates).map(|(w, rate)| half * (w * rate));
            terms.fold((0.0, 0.0), |(net, size), term| (net + term, size + term.abs()))
        });
        let fits = self.at_end.as_ref().is_none_or(|weights| {
            let size = all().fold(0.0, |most: f64, rate| most.max(rate.abs()));
            [(used[0], a, a + half), (used[1], a + half, b)].into_iter().all(|(rates, a, b)| {
                let [last, first]: [f64; 2] = [
                    weights.iter().zip(rates).map(|(w, rate)| w * rate).sum(),
                    weights.iter().rev().zip(rates).map(|(w, rate)| w * rate).sum(),
                ];
                [(a, first), (b, last)].into_iter().all(|(t, expected)| {
                    let rate = self.rate(t);
                    !rate.is_finite() || (rate - expected).abs() <= JUMP * size
                })
            })
        });
        (sums, change, fits)
    }

    /// ∫γ over an interval of which `whole` is an approximation.
    fn refined(&self, a: f64, b: f64, whole: f64, halvings: u32, budget: &mut u32) -> f64 {
        let ([first, second], change, fits) = self.halves(a, b);
        let sum = first.0 + second.0;
        let size = first.1 + second.1;
        let rounding = TOLERANCE * size + f64::EPSILON * a.abs().max(b.abs()) * change;
        let converged = (sum - whole).abs() <= rounding && fits;
        let done = converged || self.exact || !sum.is_finite();
        if done || halvings == 0 || *budget == 0 {
            return sum;
        }
        *budget -= 1;
        let middle = 0.5 * (a + b);
        self.refined(a, middle, first.0, halvings - 1, budget)
            + self.refined(middle, b, second.0, halvings - 1, budget)
    }
}

impl Damping for FormulaDamping {
    fn rate(&self, t: f64) -> f64 {
        self.formula.value(&[t])
    }

    fn integral(&self, a: f64, b: f64) -> f64 {
        match &self.closed {
            Some(terms) => {
                let (middle, length) = (0.5 * (a + b), b - a);
                length * terms.iter().map(|term| term.mean(middle, length)).sum::<f64>()
            }
            // Nothing is known of the whole.
            None => self.refined(a, b, f64::NAN, HALVINGS + 1, &mut (BUDGET + 1)),
        }
    }

    fn describe(&self) -> String {
        format!("γ = {}", self.formula.text)
    }
}

/// A term of a function of t.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Term {
    /// c₀ + c₁t.
    Line([f64; 2]),
    /// A·f(φ + ωt) with the function f, the factor A, and φ and ω.
    Wave(Unary, f64, [f64; 2]),
}

impl Term {
    /// The mean over an interval.
    fn mean(&self, middle: f64, length: f64) -> f64 {
        match *self {
            Self::Line([c0, c1]) => c0 + c1 * middle,
            Self::Wave(f, factor, [phase, rate]) => {
                let (angle, half) = (phase + rate * middle, 0.5 * rate * length);
                factor
                    * match f {
                        Unary::Sin => sin(angle) * sinc(half),
                        Unary::Cos => cos(angle) * sinc(half),
                        _ => exp(angle) * sinhc(half),
                    }
            }
        }
    }
}

/// The terms of a formula in one variable, if each is of degree 1, or a constant times sin, cos or
/// exp of such a term.
fn closed_terms(formula: &Formula) -> Option<Vec<Term>> {
    let mut graph = formula.graph.clone();
    let one = graph.constant(1.0);
    let parts = terms(&mut graph, &[(formula.root, one)]).into_iter();
    let term = |(part, weight)| {
        let weight = graph.as_constant(weight)?;
        match (line(&mut graph, part), graph.node(part)) {
            (Some(line), _) => Some(Term::Line(line.map(|c| weight * c))),
            (None, Node::Unary(f @ (Unary::Sin | Unary::Cos | Unary::Exp), angle)) => {
                Some(Term::Wave(f, weight, line(&mut graph, angle)?))
            }
            _ => None,
        }
    };
    parts.map(term).collect()
}

/// Coefficients c₀ and c₁ of an expression c₀ + c₁t.
fn line(graph: &mut Graph, root: Id) -> Option<[f64; 2]> {
    graph.degree(root, |_| true).filter(|degree| *degree <= 1)?;
    let one = graph.constant(1.0);
    let slope = graph.forward(&[root], |_| Some(one))[0];
    let [c0, c1] = graph.values(&[root, slope], |_| 0.0)[..] else { return None };
    (c0.is_finite() && c1.is_finite()).then_some([c0, c1])
}

/// sinh(x)/x.
fn sinhc(x: f64) -> f64 {
    if x.abs() > 1.0 {
        return (exp(x) - exp(-x)) / (2.0 * x);
    }
    // Σ x²ᵏ/(2k + 1)! up to k = 8: the next term is below 10⁻¹⁷.
    let square = x * x;
    (1..=8).rev().fold(1.0, |sum, k| 1.0 + sum * square / f64::from(2 * k * (2 * k + 1)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Names;

    fn damping(text: &str) -> FormulaDamping {
        let names = Names::with_variables(&["t"]).unwrap();
        FormulaDamping::new(Formula::parse(text, &names).unwrap())
    }

    #[test]
    fn integrals_of_formulas() {
        let integral = |text: &str, a: f64, b: f64| damping(text).integral(a, b);
        for (text, a, b, exact) in [
            ("0", 0.0, 5.0, 0.0),
            ("0.3", 0.0, 5.0, 1.5),
            ("t^3 - t", -1.0, 2.0, 3.75 - 1.5),
            ("0.2 + 0.1*sin(t)", 0.0, 40.0, 8.0 + 0.1 * (1.0 - 40f64.cos())),
            ("exp(-t^2)", -8.0, 8.0, std::f64::consts::PI.sqrt()),
            ("abs(t - 1/3)", 0.0, 1.0, (1.0 / 9.0 + 4.0 / 9.0) / 2.0),
            ("1/(1 + 100*t^2)", -1.0, 1.0, 0.2 * 10f64.atan()),
        ] {
            let error = integral(text, a, b) - exact;
            assert!(error.abs() < 4e-15 * (1.0 + exact.abs()), "{text}: {error:e}");
        }
        // In closed form where each term is a line, or a wave of a line.
        type Antiderivative = fn(f64) -> f64;
        let cases: [(&str, Antiderivative); 4] = [
            ("0.2 + 0.1*sin(t)", |t| 0.2 * t - 0.1 * t.cos()),
            ("0.5*cos(2*t) - t/4", |t| 0.25 * (2.0 * t).sin() - t * t / 8.0),
            ("3*exp(-t)", |t| -3.0 * (-t).exp()),
            ("-(cos(1 - 3*t) + 2)/2", |t| -((3.0 * t - 1.0).sin() / 3.0 + 2.0 * t) / 2.0),
        ];
        for (text, antiderivative) in cases {
            assert!(damping(text).closed.is_some());
            for (a, b) in [(0.0, 1.0), (-2.0, 7.5), (3.0, 3.0 + 1.0 / 1024.0)] {
                let [from, to] = [a, b].map(antiderivative);
                let error = integral(text, a, b) - (to - from);
                let most = 8.0 * f64::EPSILON * (from.abs() + to.abs());
                assert!(error.abs() <= most, "{text} {a} {b}: {error:e}");
            }
        }
        for text in ["t^2", "t*sin(t)", "sin(t^2)", "sin(t)^2", "abs(t)", "1/t"] {
            assert!(damping(text).closed.is_none(), "{text}");
        }
        // Short steps add up.
        let damping = damping("0.5*cos(2*t)");
        let sum: f64 = (0..4096)
            .map(|n| {
                let t = f64::from(n) / 512.0;
                damping.integral(t, t + 1.0 / 512.0)
            })
            .sum();
        assert!((sum - 0.25 * 16f64.sin()).abs() < 1e-14);
        assert_eq!(damping.describe(), "γ = 0.5*cos(2*t)");
        // Jumps anywhere in a step, nearer to its ends than any node, too; on a wave.
        for n in 0..400 {
            let part = f64::from(n % 20 + 1) * 4e-4;
            let from = f64::from(n / 20) / 20.0 + if n % 2 == 0 { part } else { 1.0 - part } / 20.0;
            let jump = self::damping(&format!("if(t > {from:?}, 9, 0) + sin(3*t)^2"));
            let sum: f64 =
                (0..20).map(|n| jump.integral(f64::from(n) / 20.0, f64::from(n + 1) / 20.0)).sum();
            let exact = 9.0 * (1.0 - from) + 0.5 - 6f64.sin() / 12.0;
            assert!((sum - exact).abs() < 1e-12, "{from}: {:e}", sum - exact);
        }
        // What does not converge ends.
        assert!(integral("sin(1e9*t)", 0.0, 1.0).abs() < 1.0);
        assert!(!integral("1/(t - 0.5)^2", 0.0, 1.0).is_nan());
    }
}
