//! All linear and quadratic Casimirs of B, from B alone.

use std::fmt;

use serde::Serialize;

use super::algebra::{Matrix, dot, eigenvalues, largest, null_space, times};
use super::erased::{ErasedSystem, Function};
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
    #[serde(skip)]
    form: Form,
}

impl FoundCasimir {
    fn of(form: Form, system: &dyn ErasedSystem, points: &Points) -> Self {
        let minimum = match &form {
            Form::Quadratic(q) if points.everywhere => Minimum::of_form(q.clone()),
            _ => Minimum::by_search(&form, system, points),
        };
        let (degree, coefficients) = match &form {
            Form::Linear(beta) => (1, beta.clone()),
            Form::Quadratic(q) => (2, q.concat()),
        };
        Self { formula: form.to_string(), degree, coefficients, minimum, form }
    }

    /// C(y).
    #[must_use]
    pub fn value(&self, y: &[f64]) -> f64 {
        self.form.value(y)
    }
}

/// The linear and quadratic Casimirs of B.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
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
    pub(super) fn of(system: &dyn ErasedSystem, points: &Points) -> Self {
        let d = system.dimension();
        let (solve, check) = points.for_identities.split_at(points.for_identities.len() / 2);
        let equations: Vec<(&[f64], Matrix)> =
            solve.iter().map(|y| (y.as_slice(), normalized(system.matrix(y)))).collect();
        let mut forms = linear_forms(&equations, d);
        let quadratic_sought = d * (d + 1) / 2 <= UNKNOWNS;
        if quadratic_sought {
            forms.extend(quadratic_forms(&equations, d));
        }
        forms.retain(|form| is_casimir(form, system, check));
        let describe = |form| FoundCasimir::of(form, system, points);
        let definite = definite(&forms, d).map(describe);
        Self { found: forms.into_iter().map(describe).collect(), definite, quadratic_sought }
    }
}

/// The β with Bβ = 0.
fn linear_forms(equations: &[(&[f64], Matrix)], d: usize) -> Vec<Form> {
    let rows = equations.iter().flat_map(|(_, b)| b).cloned().collect();
    null_space(rows, d).into_iter().map(|beta| Form::Linear(readable(beta))).collect()
}

/// The symmetric Q with BQy = 0.
fn quadratic_forms(equations: &[(&[f64], Matrix)], d: usize) -> Vec<Form> {
    let pairs: Vec<(usize, usize)> = (0..d).flat_map(|i| (i..d).map(move |j| (i, j))).collect();
    let equation = |y: &[f64], row: &[f64]| {
        let factor = |&(i, j): &(usize, usize)| {
            if i == j { row[i] * y[i] } else { row[i] * y[j] + row[j] * y[i] }
        };
        pairs.iter().map(factor).collect()
    };
    let rows = equations.iter().flat_map(|(y, b)| b.iter().map(|row| equation(y, row))).collect();
    let form = |solution: Vec<f64>| {
        let mut q = vec![vec![0.0; d]; d];
        for (&(i, j), x) in pairs.iter().zip(readable(solution)) {
            (q[i][j], q[j][i]) = (x, x);
        }
        Form::Quadratic(q)
    };
    null_space(rows, pairs.len()).into_iter().map(form).collect()
}

fn is_casimir(form: &Form, system: &dyn ErasedSystem, points: &[Vec<f64>]) -> bool {
    let mut casimir = Finding::new();
    for y in points {
        let (b, gradient) = (system.matrix(y), form.gradient(y));
        let size = largest(b.iter().flatten()) * largest(&gradient) * y.len() as f64;
        for x in times(&b, &gradient) {
            casimir.record(x, size, y);
        }
    }
    casimir.defect <= ACCURACY
}

/// βᵀy or ½yᵀQy.
#[derive(Clone, Debug, PartialEq)]
enum Form {
    Linear(Vec<f64>),
    Quadratic(Matrix),
}

impl Function for Form {
    fn value(&self, y: &[f64]) -> f64 {
        let slope = dot(&self.gradient(y), y);
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

/// `2 y1 + y2 − 0.5 y3`, coefficients to six digits.
impl fmt::Display for Form {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let terms: Vec<(f64, String)> = match self {
            Self::Linear(beta) => {
                beta.iter().enumerate().map(|(i, &b)| (b, format!("y{}", i + 1))).collect()
            }
            Self::Quadratic(q) => {
                let square = |i: usize| (0.5 * q[i][i], format!("y{}²", i + 1));
                let pairs = (0..q.len()).flat_map(|i| (i + 1..q.len()).map(move |j| (i, j)));
                let mixed = pairs.map(|(i, j)| (q[i][j], format!("y{} y{}", i + 1, j + 1)));
                (0..q.len()).map(square).chain(mixed).collect()
            }
        };
        let nonzero = terms.into_iter().filter(|(coefficient, _)| *coefficient != 0.0);
        for (n, (coefficient, symbol)) in nonzero.enumerate() {
            f.write_str(match (n, coefficient < 0.0) {
                (0, false) => "",
                (0, true) => "−",
                (_, false) => " + ",
                (_, true) => " − ",
            })?;
            let size = (coefficient.abs() * 1e6).round() / 1e6;
            if size != 1.0 {
                write!(f, "{size} ")?;
            }
            f.write_str(&symbol)?;
        }
        Ok(())
    }
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
fn definite(forms: &[Form], d: usize) -> Option<Form> {
    let add = |sum: &mut [f64], factor: f64, q: &[f64]| {
        sum.iter_mut().zip(q).for_each(|(x, y)| *x += factor * y);
    };
    // An orthonormal basis by Gram and Schmidt.
    let mut basis: Vec<Vec<f64>> = Vec::new();
    let mut projection = vec![0.0; d * d];
    for form in forms {
        let Form::Quadratic(q) = form else { continue };
        let mut q = q.concat();
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
    let square = |flat: Vec<f64>| -> Matrix { flat.chunks(d).map(<[f64]>::to_vec).collect() };
    let smallest = eigenvalues(square(projection.clone())).first().copied()?;
    (smallest > ACCURACY).then(|| Form::Quadratic(square(readable(projection))))
}
