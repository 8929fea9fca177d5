//! Every linear and quadratic Casimir of B, found and not asked for.

use serde::Serialize;

use super::algebra::{eigenvalues, largest, null_space, times};
use super::finding::Finding;
use super::points::Points;
use super::probe::{Matrix, Probe, matrix};
use super::shape::{Function, Minimum};

/// A Casimir that follows from B alone.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FoundCasimir {
    /// The formula, in the numbers of this system.
    pub formula: String,
    /// 1 for βᵀy, 2 for ½yᵀQy.
    pub degree: u32,
    /// β, or the rows of Q one after the other.
    pub coefficients: Vec<f64>,
    /// m(C).
    pub minimum: Minimum,
}

impl FoundCasimir {
    /// C(y).
    #[must_use]
    pub fn value(&self, y: &[f64]) -> f64 {
        if self.degree == 1 {
            return super::algebra::dot(&self.coefficients, y);
        }
        let rows = self.coefficients.chunks(y.len());
        0.5 * rows.zip(y).map(|(row, x)| x * super::algebra::dot(row, y)).sum::<f64>()
    }
}

/// The linear and quadratic Casimirs of B.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Casimirs {
    /// A basis of the linear ones, then of the quadratic ones. What a scheme keeps of them it keeps
    /// of their sums.
    pub found: Vec<FoundCasimir>,
    /// A positive definite quadratic Casimir, if the projection of ½‖y‖² onto the quadratic
    /// Casimirs is one: it bounds all paths.
    pub definite: Option<FoundCasimir>,
    /// Whether quadratic Casimirs were looked for: their coefficients are D(D+1)/2 unknowns, of
    /// which no more than 300 are solved for.
    pub quadratic_sought: bool,
}

/// Unknowns of an elimination that takes milliseconds.
const UNKNOWNS: usize = 300;

impl Casimirs {
    /// Solves B(y)∇C = 0 at half of the points for the coefficients of C, and keeps what holds at
    /// the other half.
    pub(super) fn of(system: &dyn Probe, points: &Points) -> Self {
        let d = system.dimension();
        let (solve, check) = points.few.split_at(points.few.len() / 2);
        let structures: Vec<Matrix> = solve.iter().map(|y| scaled(matrix(system, y))).collect();
        let holds = |form: &Form| {
            let mut casimir = Finding::new();
            for y in check {
                let (b, gradient) = (matrix(system, y), form.gradient(y));
                let scale =
                    largest(&b) * gradient.iter().fold(0.0, |m: f64, x| m.max(x.abs())) * d as f64;
                for x in times(&b, &gradient) {
                    casimir.see(x, scale, y);
                }
            }
            // The elimination divides by pivots of any size, and loses what they are smaller than
            // one.
            casimir.defect <= COEFFICIENTS
        };
        let describe = |form: Form| {
            let minimum = match &form {
                Form::Quadratic(q) if points.everywhere => Minimum::of_form(q.clone()),
                _ => Minimum::by_search(&form, system, points),
            };
            form.described(minimum)
        };

        let linear = null_space(structures.iter().flatten().cloned().collect(), d);
        let mut forms: Vec<Form> =
            linear.into_iter().map(|beta| Form::Linear(readable(beta))).collect();
        let pairs: Vec<(usize, usize)> = (0..d).flat_map(|a| (a..d).map(move |b| (a, b))).collect();
        let quadratic_sought = pairs.len() <= UNKNOWNS;
        if quadratic_sought {
            let rows = solve.iter().zip(&structures).flat_map(|(y, b)| {
                let entry = |row: &Vec<f64>, (a, c): (usize, usize)| {
                    if a == c { row[a] * y[a] } else { row[a] * y[c] + row[c] * y[a] }
                };
                b.iter()
                    .map(|row| pairs.iter().map(|&pair| entry(row, pair)).collect())
                    .collect::<Matrix>()
            });
            for solution in null_space(rows.collect(), pairs.len()) {
                let mut q = vec![vec![0.0; d]; d];
                for (&(a, b), x) in pairs.iter().zip(readable(solution)) {
                    (q[a][b], q[b][a]) = (x, x);
                }
                forms.push(Form::Quadratic(q));
            }
        }
        forms.retain(holds);
        let definite = definite(&forms, d).map(describe);
        Self { found: forms.into_iter().map(describe).collect(), definite, quadratic_sought }
    }
}

/// What remains of the digits of a coefficient after an elimination.
const COEFFICIENTS: f64 = 1e-9;

/// βᵀy or ½yᵀQy.
#[derive(Clone)]
enum Form {
    Linear(Vec<f64>),
    Quadratic(Matrix),
}

impl Function for Form {
    fn value(&self, y: &[f64]) -> f64 {
        let slope = super::algebra::dot(&self.gradient(y), y);
        if matches!(self, Self::Linear(_)) { slope } else { 0.5 * slope }
    }
    fn gradient(&self, y: &[f64]) -> Vec<f64> {
        match self {
            Self::Linear(beta) => beta.clone(),
            Self::Quadratic(q) => times(q, y),
        }
    }
    fn hessian(&self, y: &[f64]) -> Matrix {
        match self {
            Self::Linear(_) => vec![vec![0.0; y.len()]; y.len()],
            Self::Quadratic(q) => q.clone(),
        }
    }
}

impl Form {
    fn described(self, minimum: Minimum) -> FoundCasimir {
        match self {
            Self::Linear(beta) => {
                let terms = beta.iter().enumerate().map(|(i, &b)| (b, format!("y{}", i + 1)));
                FoundCasimir { formula: sum(terms), degree: 1, minimum, coefficients: beta }
            }
            Self::Quadratic(q) => {
                let square = |i: usize| (0.5 * q[i][i], format!("y{}²", i + 1));
                let products = (0..q.len()).flat_map(|i| (i + 1..q.len()).map(move |j| (i, j)));
                let mixed = products.map(|(i, j)| (q[i][j], format!("y{} y{}", i + 1, j + 1)));
                let formula = sum((0..q.len()).map(square).chain(mixed));
                FoundCasimir { formula, degree: 2, minimum, coefficients: q.concat() }
            }
        }
    }
}

/// `2 y1 + y2 − 0.5 y3`, coefficients to six digits.
fn sum(terms: impl Iterator<Item = (f64, String)>) -> String {
    let mut text = String::new();
    for (coefficient, symbol) in terms.filter(|(coefficient, _)| *coefficient != 0.0) {
        let sign = match (text.is_empty(), coefficient < 0.0) {
            (true, false) => "",
            (true, true) => "−",
            (false, false) => " + ",
            (false, true) => " − ",
        };
        let size = (coefficient.abs() * 1e6).round() / 1e6;
        let size = if size == 1.0 { String::new() } else { format!("{size} ") };
        text = format!("{text}{sign}{size}{symbol}");
    }
    text
}

/// Rows that are no larger at one point than at another.
fn scaled(mut b: Matrix) -> Matrix {
    let size = largest(&b);
    if size > 0.0 {
        b.iter_mut().flatten().for_each(|x| *x /= size);
    }
    b
}

/// The same solution with its smallest coefficient ±1 and the first one positive; what is zero or
/// an integer to the accuracy of the elimination is made so.
fn readable(mut x: Vec<f64>) -> Vec<f64> {
    let largest = x.iter().fold(0.0, |m: f64, c| m.max(c.abs()));
    x.iter_mut().filter(|c| c.abs() < COEFFICIENTS * largest).for_each(|c| *c = 0.0);
    let smallest = x.iter().filter(|c| **c != 0.0).fold(f64::INFINITY, |m, c| m.min(c.abs()));
    let sign = x.iter().find(|c| **c != 0.0).map_or(1.0, |c| c.signum());
    for c in &mut x {
        *c *= sign / smallest;
        if (*c - c.round()).abs() < COEFFICIENTS * c.abs() {
            *c = c.round();
        }
    }
    x
}

/// The projection of the identity onto the span of the quadratic forms, if it is positive definite:
/// an average over all symmetries of the span, and for Casimirs ½|sᵢ|² of parts of y their sum.
fn definite(forms: &[Form], d: usize) -> Option<Form> {
    let inner = |a: &Matrix, b: &Matrix| -> f64 {
        a.iter().flatten().zip(b.iter().flatten()).map(|(a, b)| a * b).sum()
    };
    let mut basis: Vec<Matrix> = Vec::new();
    let mut projection = vec![vec![0.0; d]; d];
    for form in forms {
        let Form::Quadratic(q) = form else { continue };
        let mut q = q.clone();
        for known in &basis {
            let share = inner(&q, known);
            q.iter_mut().flatten().zip(known.iter().flatten()).for_each(|(x, k)| *x -= share * k);
        }
        let length = inner(&q, &q).sqrt();
        q.iter_mut().flatten().for_each(|x| *x /= length);
        let trace: f64 = (0..d).map(|i| q[i][i]).sum();
        projection.iter_mut().flatten().zip(q.iter().flatten()).for_each(|(x, k)| *x += trace * k);
        basis.push(q);
    }
    let smallest = eigenvalues(projection.clone()).first().copied()?;
    if smallest <= COEFFICIENTS {
        return None;
    }
    let flat = readable(projection.concat());
    Some(Form::Quadratic(flat.chunks(d).map(<[f64]>::to_vec).collect()))
}
