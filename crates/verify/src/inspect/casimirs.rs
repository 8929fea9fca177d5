//! All linear and quadratic Casimirs of B, from B alone.

use serde::Serialize;

use super::algebra::{Matrix, dot, eigenvalues, largest, null_space, times};
use super::erased::System;
use super::finding::Finding;
use super::function::Minimum;
use super::points::Points;

/// A Casimir that follows from B alone.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FoundCasimir {
    /// The formula with the coefficients of this system.
    pub formula: String,
    /// 1 for βᵀy, 2 for ½yᵀQy.
    pub degree: u32,
    /// β, or the rows of Q one after the other.
    pub coefficients: Vec<f64>,
    /// m(C).
    pub minimum: Minimum,
}

impl FoundCasimir {
    fn new(degree: u32, coefficients: Vec<f64>, system: &dyn System, points: &Points) -> Self {
        let d = system.dimension();
        let minimum = if degree == 2 && points.everywhere {
            Minimum::of_form(square(&coefficients, d))
        } else {
            Minimum::by_search(&|y| value(degree, &coefficients, y), system, points)
        };
        Self { formula: formula(degree, &coefficients, d), degree, coefficients, minimum }
    }

    /// C(y).
    #[must_use]
    pub fn value(&self, y: &[f64]) -> f64 {
        value(self.degree, &self.coefficients, y)
    }

    /// Whether B∇C = 0 to the accuracy of the coefficients.
    fn holds(&self, system: &dyn System, points: &[Vec<f64>]) -> bool {
        let mut casimir = Finding::default();
        for y in points {
            let (b, gradient) = (system.matrix(y), gradient(self.degree, &self.coefficients, y));
            let size = largest(b.iter().flatten()) * largest(&gradient) * y.len() as f64;
            casimir.compare(&times(&b, &gradient), &vec![0.0; y.len()], size, y);
        }
        casimir.defect <= ACCURACY
    }
}

fn gradient(degree: u32, coefficients: &[f64], y: &[f64]) -> Vec<f64> {
    match degree {
        1 => coefficients.to_vec(),
        _ => coefficients.chunks(y.len()).map(|row| dot(row, y)).collect(),
    }
}

fn value(degree: u32, coefficients: &[f64], y: &[f64]) -> f64 {
    dot(&gradient(degree, coefficients, y), y) / f64::from(degree)
}

/// `2 y1 + y2 − 0.5 y3`, coefficients to six digits.
fn formula(degree: u32, coefficients: &[f64], d: usize) -> String {
    let linear = (0..d).map(|i| (coefficients[i], format!("y{}", i + 1)));
    let terms: Vec<(f64, String)> = if degree == 1 {
        linear.collect()
    } else {
        let squares = (0..d).map(|i| (0.5 * coefficients[i * d + i], format!("y{}²", i + 1)));
        let pairs = (0..d).flat_map(|i| (i + 1..d).map(move |j| (i, j)));
        let products =
            pairs.map(|(i, j)| (coefficients[i * d + j], format!("y{} y{}", i + 1, j + 1)));
        squares.chain(products).collect()
    };
    let mut formula = String::new();
    for (coefficient, symbol) in terms.into_iter().filter(|(coefficient, _)| *coefficient != 0.0) {
        let sign = match (formula.is_empty(), coefficient < 0.0) {
            (true, false) => "",
            (true, true) => "−",
            (false, false) => " + ",
            (false, true) => " − ",
        };
        let size = (coefficient.abs() * 1e6).round() / 1e6;
        let size = if size == 1.0 { String::new() } else { format!("{size} ") };
        formula += &format!("{sign}{size}{symbol}");
    }
    formula
}

/// The linear and quadratic Casimirs of B.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Casimirs {
    /// A basis of the linear ones, then one of the quadratic ones. A scheme that preserves these
    /// preserves their linear combinations.
    pub found: Vec<FoundCasimir>,
    /// A positive definite quadratic Casimir, which bounds all paths: the projection of ½‖y‖² onto
    /// the quadratic Casimirs, if it is positive definite.
    pub definite: Option<FoundCasimir>,
    /// Whether quadratic Casimirs were searched for: only where their D(D+1)/2 coefficients are no
    /// more than 300.
    pub quadratic_sought: bool,
}

/// Most unknowns of an elimination: it takes milliseconds.
const UNKNOWNS: usize = 300;
/// Relative accuracy of the coefficients after an elimination.
const ACCURACY: f64 = 1e-9;

impl Casimirs {
    /// Solves B(y)∇C(y) = 0 for the coefficients of C at half of the points, and checks it at the
    /// other half.
    pub(super) fn of(system: &dyn System, points: &Points) -> Self {
        let d = system.dimension();
        let (solve, check) = points.for_identities.split_at(points.for_identities.len() / 2);
        let rows: Vec<(&Vec<f64>, Vec<f64>)> = solve
            .iter()
            .flat_map(|y| normalized(system.matrix(y)).into_iter().map(move |row| (y, row)))
            .collect();
        let casimir =
            |degree, coefficients| FoundCasimir::new(degree, coefficients, system, points);
        let linear = null_space(rows.iter().map(|(_, row)| row.clone()).collect(), d);
        let mut found: Vec<_> = linear.into_iter().map(|beta| casimir(1, readable(beta))).collect();
        let quadratic_sought = d * (d + 1) / 2 <= UNKNOWNS;
        if quadratic_sought {
            found.extend(quadratic_forms(&rows, d).into_iter().map(|q| casimir(2, q)));
        }
        found.retain(|casimir| casimir.holds(system, check));
        let definite = definite(&found, d).map(|q| casimir(2, q));
        Self { found, definite, quadratic_sought }
    }
}

/// The symmetric Q with bᵀQy = 0 for all given y and rows b of B(y).
fn quadratic_forms(rows: &[(&Vec<f64>, Vec<f64>)], d: usize) -> Matrix {
    let pairs: Vec<(usize, usize)> = (0..d).flat_map(|i| (i..d).map(move |j| (i, j))).collect();
    let equation = |(y, b): &(&Vec<f64>, Vec<f64>)| {
        let factor = |&(i, j): &(usize, usize)| {
            if i == j { b[i] * y[i] } else { b[i] * y[j] + b[j] * y[i] }
        };
        pairs.iter().map(factor).collect()
    };
    let form = |solution: Vec<f64>| {
        let mut q = vec![0.0; d * d];
        for (&(i, j), x) in pairs.iter().zip(readable(solution)) {
            (q[i * d + j], q[j * d + i]) = (x, x);
        }
        q
    };
    null_space(rows.iter().map(equation).collect(), pairs.len()).into_iter().map(form).collect()
}

/// The matrix divided by its largest entry, so that all points have equal weight.
fn normalized(mut b: Matrix) -> Matrix {
    let size = largest(b.iter().flatten());
    if size > 0.0 {
        b.iter_mut().flatten().for_each(|x| *x /= size);
    }
    b
}

/// The multiple of the solution whose smallest coefficient is ±1 and whose first one is positive,
/// with zeros and integers exact.
fn readable(mut x: Vec<f64>) -> Vec<f64> {
    let zero = ACCURACY * largest(&x);
    x.iter_mut().filter(|c| c.abs() < zero).for_each(|c| *c = 0.0);
    let smallest = x.iter().filter(|c| **c != 0.0).fold(f64::INFINITY, |m, c| m.min(c.abs()));
    let sign = x.iter().find(|c| **c != 0.0).map_or(1.0, |c| c.signum());
    for c in &mut x {
        *c *= sign / smallest;
        if (*c - c.round()).abs() < ACCURACY * c.abs() {
            *c = c.round();
        }
    }
    x
}

/// The projection of the identity onto the span of the quadratic forms, if it is positive definite.
/// It averages over all symmetries of the span; of Casimirs ½|sᵢ|² of parts sᵢ of y it is the sum.
fn definite(found: &[FoundCasimir], d: usize) -> Option<Vec<f64>> {
    let add = |sum: &mut [f64], factor: f64, q: &[f64]| {
        sum.iter_mut().zip(q).for_each(|(x, y)| *x += factor * y);
    };
    // An orthonormal basis by Gram and Schmidt.
    let mut basis: Matrix = Vec::new();
    let mut projection = vec![0.0; d * d];
    for casimir in found.iter().filter(|casimir| casimir.degree == 2) {
        let mut q = casimir.coefficients.clone();
        for known in &basis {
            let share = dot(&q, known);
            add(&mut q, -share, known);
        }
        let length = dot(&q, &q).sqrt();
        q.iter_mut().for_each(|x| *x /= length);
        let trace = (0..d).map(|i| q[i * d + i]).sum();
        add(&mut projection, trace, &q);
        basis.push(q);
    }
    let smallest = eigenvalues(square(&projection, d)).first().copied()?;
    (smallest > ACCURACY).then(|| readable(projection))
}

/// The matrix with these rows of length d.
fn square(coefficients: &[f64], d: usize) -> Matrix {
    coefficients.chunks(d).map(<[f64]>::to_vec).collect()
}
