//! Integrals of sums of lines, sines, cosines and exponentials.

use real::elementary::{cos, exp, sin, sinc};

use crate::{
    Formula, Id,
    graph::{Graph, Node, Unary},
    terms::terms,
};

/// A term of a function of t.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Term {
    /// c₀ + c₁t.
    Line([f64; 2]),
    /// A·f(φ + ωt) with the function f, the factor A, and φ and ω.
    Wave(Unary, f64, [f64; 2]),
}

/// A function of t whose integral has a closed form without cancellation.
#[derive(Clone, Debug, PartialEq)]
pub struct ClosedIntegral(Vec<Term>);

impl ClosedIntegral {
    /// That of a formula in one variable, if each of its terms is of degree 1, or a constant times
    /// sin, cos or exp of what is.
    pub fn of(formula: &Formula) -> Option<Self> {
        let mut graph = formula.graph.clone();
        let one = graph.constant(1.0);
        let parts = terms(&mut graph, &[(formula.root, one)]);
        let mut closed = Vec::new();
        for (part, weight) in parts {
            let weight = graph.as_constant(weight)?;
            closed.push(match (line(&mut graph, part), graph.node(part)) {
                (Some(line), _) => Term::Line(line.map(|c| weight * c)),
                (None, Node::Unary(f @ (Unary::Sin | Unary::Cos | Unary::Exp), angle)) => {
                    Term::Wave(f, weight, line(&mut graph, angle)?)
                }
                _ => return None,
            });
        }
        Some(Self(closed))
    }

    /// The integral from a to b.
    pub fn integral(&self, a: f64, b: f64) -> f64 {
        let (middle, length) = (0.5 * (a + b), b - a);
        let mean = |term: &Term| match *term {
            Term::Line([c0, c1]) => c0 + c1 * middle,
            Term::Wave(f, factor, [phase, rate]) => {
                let (angle, half) = (phase + rate * middle, 0.5 * rate * length);
                factor
                    * match f {
                        Unary::Sin => sin(angle) * sinc(half),
                        Unary::Cos => cos(angle) * sinc(half),
                        _ => exp(angle) * sinhc(half),
                    }
            }
        };
        length * self.0.iter().map(mean).sum::<f64>()
    }
}

/// c₀ and c₁ of what is c₀ + c₁t.
fn line(graph: &mut Graph, root: Id) -> Option<[f64; 2]> {
    graph.degree(root, &[0]).filter(|degree| *degree <= 1)?;
    let one = graph.constant(1.0);
    let slope = graph.forward(&[root], &[(0, one)])[0];
    let values = graph.values(&[root, slope], &[0.0]);
    let [c0, c1] = [root, slope].map(|id| values[id.index()]);
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
