//! All linear and quadratic Casimirs of B, from B alone.

use serde::Serialize;

use super::{
    algebra::{Matrix, dot, eigenvalues, largest, norm, null_space, times},
    erased::System,
    function::Minimum,
    points::Points,
};

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
    pub fn value(&self, y: &[f64]) -> f64 {
        value(self.degree, &self.coefficients, y)
    }
}

fn value(degree: u32, coefficients: &[f64], y: &[f64]) -> f64 {
    match degree {
        1 => dot(coefficients, y),
        _ => 0.5 * dot(&times(&square(coefficients, y.len()), y), y),
    }
}

/// The places (i, j), i ≤ j, of a symmetric matrix.
fn places(d: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..d).flat_map(move |i| (i..d).map(move |j| (i, j)))
}

/// `2 y1 + y2 − 0.5 y3`, coefficients to six digits.
fn formula(degree: u32, coefficients: &[f64], d: usize) -> String {
    let (squares, products): (Vec<_>, Vec<_>) = places(d).partition(|(i, j)| i == j);
    let term = |(i, j): (usize, usize)| match (degree, i == j) {
        (1, _) => (coefficients[i], format!("y{}", i + 1)),
        (_, true) => (0.5 * coefficients[i * d + i], format!("y{}²", i + 1)),
        (_, false) => (coefficients[i * d + j], format!("y{} y{}", i + 1, j + 1)),
    };
    let terms = squares.into_iter().chain(products.into_iter().filter(|_| degree == 2)).map(term);
    let mut formula = String::new();
    for (coefficient, symbol) in terms.filter(|(coefficient, _)| *coefficient != 0.0) {
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
        let points_and_matrices: Vec<_> =
            points.for_identities.iter().map(|y| (y, normalized(system.matrix(y)))).collect();
        let quadratic_sought = d * (d + 1) / 2 <= UNKNOWNS;
        let mut found = Vec::new();
        for degree in 1..=if quadratic_sought { 2 } else { 1 } {
            // bᵀ∇C(y) = 0 for every row b of B(y).
            let equation = |y: &[f64], b: &Vec<f64>| match degree {
                1 => b.clone(),
                _ => places(d)
                    .map(|(i, j)| if i == j { b[i] * y[i] } else { b[i] * y[j] + b[j] * y[i] })
                    .collect(),
            };
            let equations: Matrix = points_and_matrices
                .iter()
                .flat_map(|(y, matrix)| matrix.iter().map(|row| equation(y, row)))
                .collect();
            let (solve, check) = equations.split_at(equations.len() / 2);
            for x in null_space(solve.to_vec(), solve[0].len()).into_iter().map(readable) {
                let holds = |row: &Vec<f64>| dot(row, &x).abs() <= ACCURACY * norm(row) * norm(&x);
                if check.iter().all(holds) {
                    let coefficients = if degree == 1 { x } else { symmetric(&x, d) };
                    found.push(FoundCasimir::new(degree, coefficients, system, points));
                }
            }
        }
        let definite = definite(&found, d).map(|q| FoundCasimir::new(2, q, system, points));
        Self { found, definite, quadratic_sought }
    }
}

/// The rows of the symmetric matrix with x at [`places`].
fn symmetric(x: &[f64], d: usize) -> Vec<f64> {
    let mut q = vec![0.0; d * d];
    for ((i, j), &x) in places(d).zip(x) {
        (q[i * d + j], q[j * d + i]) = (x, x);
    }
    q
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
