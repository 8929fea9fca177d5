//! All linear and quadratic Casimirs of B, from B alone.

use real::{Bounded, Real};
use serde::Serialize;

use super::{
    algebra::{
        Matrix, backward_error, dot, echelon, error_norm, largest, norm, singular_vectors, size,
        smallest_eigenvalue, times, values,
    },
    erased::System,
    finding::{Finding, Status},
    function::Minimum,
    points::Points,
};

/// A Casimir that follows from B alone.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FoundCasimir {
    /// The formula with the coefficients of this system, to six digits.
    pub formula: String,
    /// 1 for βᵀy, 2 for ½yᵀQy.
    pub degree: u32,
    /// β, or the rows of Q one after the other.
    pub coefficients: Vec<f64>,
    /// A bound of the error of each coefficient.
    pub coefficient_error: f64,
    /// B∇C = 0, with these coefficients.
    pub casimir: Finding,
    /// m(C).
    pub minimum: Minimum,
}

impl FoundCasimir {
    fn new(degree: u32, x: Coefficients, system: &dyn System, points: &Points) -> Self {
        let Coefficients { values: coefficients, error: coefficient_error } = x;
        let d = system.dimension();
        let bounded: Vec<_> =
            coefficients.iter().map(|&c| coefficient(c, coefficient_error)).collect();
        let mut casimir = Finding::default();
        for y in &points.for_identities {
            let state: Vec<_> = y.iter().map(|&x| Bounded::variable(x)).collect();
            let gradient =
                if degree == 1 { bounded.clone() } else { times(&square(&bounded, d), &state) };
            for row in system.matrix(y) {
                casimir.record(dot(&row, &gradient), size(&row, &gradient), y);
            }
        }
        let at = |y: &[f64]| value(degree, &bounded, y);
        let search = || Minimum::by_search(&at, system, points);
        let minimum = if degree == 2 {
            Minimum::of_form(&square(&bounded, d), Status::Shown).everywhere_or(search, points)
        } else {
            search()
        };
        let formula = formula(degree, &coefficients, d);
        Self { formula, degree, coefficients, coefficient_error, casimir, minimum }
    }

    /// C(y).
    pub fn value(&self, y: &[f64]) -> f64 {
        let coefficients: Vec<_> = self.coefficients.iter().map(|&c| Bounded::exact(c)).collect();
        value(self.degree, &coefficients, y).value
    }
}

/// Coefficients with a bound of the error of each.
struct Coefficients {
    values: Vec<f64>,
    error: f64,
}

/// A coefficient; zeros and integers were recognised and are exact.
fn coefficient(value: f64, error: f64) -> Bounded {
    let exact = value == value.round();
    let rounded = Bounded::constant(value);
    Bounded { error: if exact { 0.0 } else { error.max(rounded.error) }, ..rounded }
}

fn value(degree: u32, coefficients: &[Bounded], y: &[f64]) -> Bounded {
    let y: Vec<_> = y.iter().map(|&x| Bounded::variable(x)).collect();
    match degree {
        1 => dot(coefficients, &y),
        _ => dot(&times(&square(coefficients, y.len()), &y), &y) * Bounded::exact(0.5),
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
    /// Functions that are almost Casimirs: their `casimir` is refuted, with its defect, or unknown.
    pub nearly: Vec<FoundCasimir>,
    /// How it is known that there are no others.
    pub complete: Status,
    /// A positive definite quadratic Casimir, which bounds all paths: the projection of ½‖y‖² onto
    /// the quadratic Casimirs, if it is positive definite.
    pub definite: Option<FoundCasimir>,
    /// Whether quadratic Casimirs were searched for: only where their D(D+1)/2 coefficients are no
    /// more than 300.
    pub quadratic_sought: bool,
}

/// Most unknowns of a singular value decomposition: it takes a tenth of a second.
const UNKNOWNS: usize = 300;
/// Singular values below this part of the largest one belong to almost-Casimirs.
const NEARLY: f64 = 1e-3;
/// Most almost-Casimirs that are listed.
const LISTED: usize = 3;

impl Casimirs {
    /// Solves B(y)∇C(y) = 0 for the coefficients of C at all points, by singular values: zero are
    /// those below the error of the equations. Then evaluates B∇C of each solution with its own
    /// round-off.
    pub(super) fn of(system: &dyn System, points: &Points) -> Self {
        let d = system.dimension();
        let quadratic_sought = d * (d + 1) / 2 <= UNKNOWNS;
        let complete = if quadratic_sought { Status::Shown } else { Status::Unknown };
        let (found, nearly) = (Vec::new(), Vec::new());
        let mut all = Self { found, nearly, complete, definite: None, quadratic_sought };
        for degree in 1..=if quadratic_sought { 2 } else { 1 } {
            let unknowns = if degree == 1 { d } else { d * (d + 1) / 2 };
            let Solution { sigma, vectors, error, zero } =
                Solution::of(degree, unknowns, system, points);
            let few = sigma.iter().filter(|s| **s > error && **s <= NEARLY * sigma[0]).count();
            if sigma.iter().any(|s| s.is_nan()) {
                all.complete = Status::Unknown;
            }
            // The angle of the subspace is at most the error over the gap (Wedin 1972); reduction
            // to echelon form with complete pivoting adds up one for each of the other vectors.
            let gap = sigma.iter().copied().filter(|s| *s > error).fold(f64::INFINITY, f64::min);
            let angle = (error / gap).max(f64::EPSILON) * (zero + 1) as f64;
            let candidate = |mut x: Coefficients| {
                if degree == 2 {
                    x.values = symmetric(&x.values, d);
                }
                FoundCasimir::new(degree, x, system, points)
            };
            for x in echelon(vectors[unknowns - zero..].to_vec()) {
                let casimir = candidate(readable(x, angle));
                if casimir.casimir.holds() {
                    all.found.push(casimir);
                } else {
                    all.complete = Status::Unknown;
                    all.nearly.push(casimir);
                }
            }
            let near = vectors[unknowns - zero - few..unknowns - zero].iter().rev().take(LISTED);
            // A function with just these coefficients.
            let exactly =
                |x: &Vec<f64>| Coefficients { error: 0.0, ..readable(x.clone(), NEARLY * NEARLY) };
            all.nearly.extend(near.map(|x| candidate(exactly(x))));
        }
        all.definite = definite(&all.found, d)
            .map(|x| FoundCasimir::new(2, x, system, points))
            .filter(|casimir| casimir.casimir.holds());
        all
    }
}

/// The singular values and vectors of the equations, and how many values are zero.
struct Solution {
    sigma: Vec<f64>,
    vectors: Matrix,
    error: f64,
    zero: usize,
}

impl Solution {
    /// From the points for identities; from more of them while other points contradict it. A B of
    /// low rank has few equations at a point.
    fn of(degree: u32, unknowns: usize, system: &dyn System, points: &Points) -> Self {
        let more = &points.for_suprema[points.random..];
        let mut equations = Equations::default();
        points.for_identities.iter().for_each(|y| equations.add(degree, system, y));
        let mut taken = 0;
        loop {
            let (sigma, vectors) = singular_vectors(&equations.rows, unknowns);
            let entries = (equations.rows.len() * unknowns) as f64;
            let error = equations.error + backward_error(1, 1) * entries.sqrt() * sigma[0];
            let zero = sigma.iter().filter(|s| **s <= error).count();
            let mut fresh = Equations::default();
            let next = taken + points.random.min(more.len() - taken);
            more[taken..next].iter().for_each(|y| fresh.add(degree, system, y));
            let residuals = vectors[unknowns - zero..].iter().map(|x| norm(&times(&fresh.rows, x)));
            let contradicted = residuals.fold(0.0, f64::max) > error + fresh.error;
            if !contradicted || taken == next {
                return Self { sigma, vectors, error, zero };
            }
            equations.rows.append(&mut fresh.rows);
            equations.error = equations.error.hypot(fresh.error);
            taken = next;
        }
    }
}

/// bᵀ∇C(y) = 0 for every row b of B(y), as rows of length one.
#[derive(Default)]
struct Equations {
    rows: Matrix,
    /// A bound of the Frobenius norm of the errors of the rows.
    error: f64,
}

impl Equations {
    fn add(&mut self, degree: u32, system: &dyn System, y: &[f64]) {
        let y_exact: Vec<_> = y.iter().map(|&x| Bounded::variable(x)).collect();
        for b in system.matrix(y) {
            let row: Vec<Bounded> = match degree {
                1 => b,
                _ => places(y.len())
                    .map(|(i, j)| match i == j {
                        true => b[i] * y_exact[i],
                        false => b[i] * y_exact[j] + b[j] * y_exact[i],
                    })
                    .collect(),
            };
            let (length, error) = (norm(&values(&row)), error_norm(&row));
            // A row of round-off says nothing.
            if length > error {
                self.rows.push(row.iter().map(|x| x.value / length).collect());
                self.error = self.error.hypot(error / length);
            }
        }
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

/// The multiple of the solution whose smallest coefficient is ±1 and whose first one is positive.
/// Coefficients within `error` of zero or, relatively, of an integer are made exact.
fn readable(mut x: Vec<f64>, error: f64) -> Coefficients {
    let size = largest(&x);
    x.iter_mut().filter(|c| c.abs() <= error * size).for_each(|c| *c = 0.0);
    let smallest = x.iter().filter(|c| **c != 0.0).fold(f64::INFINITY, |m, c| m.min(c.abs()));
    let sign = x.iter().find(|c| **c != 0.0).map_or(1.0, |c| c.signum());
    let error = error * size / smallest;
    for c in &mut x {
        *c *= sign / smallest;
        if (*c - c.round()).abs() <= error {
            *c = c.round();
        }
    }
    Coefficients { values: x, error }
}

/// The projection of the identity onto the span of the quadratic forms, if it is positive definite.
/// It averages over all symmetries of the span; of Casimirs ½|sᵢ|² of parts sᵢ of y it is the sum.
fn definite(found: &[FoundCasimir], d: usize) -> Option<Coefficients> {
    let add = |sum: &mut [f64], factor: f64, q: &[f64]| {
        sum.iter_mut().zip(q).for_each(|(x, y)| *x += factor * y);
    };
    // An orthonormal basis by Gram and Schmidt.
    let mut basis: Matrix = Vec::new();
    let mut projection = vec![0.0; d * d];
    let mut error = 0.0;
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
        error += (casimir.coefficient_error / length).max(f64::EPSILON) * (d * d) as f64;
    }
    let smallest = smallest_eigenvalue(&square(&projection, d));
    (!basis.is_empty() && smallest > error).then(|| readable(projection, error))
}

/// The matrix with these rows of length d.
fn square<R: Copy>(coefficients: &[R], d: usize) -> Matrix<R> {
    coefficients.chunks(d).map(<[R]>::to_vec).collect()
}
