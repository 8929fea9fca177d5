//! Linear, quadratic and logarithmic Casimirs of B, each evaluated at all points.

use real::WIDTH;
use serde::Serialize;

use super::{
    algebra::{Matrix, dot, moved, norm, null_space},
    finding::{CLUSTER, Finding, products},
    form::{Form, readable, sum_of_terms},
    points::Points,
    search::{Candidates, UNKNOWNS, ZERO, casimirs, equations},
    shape::Minimum,
    sight::Sight,
    spectrum::smallest_eigenvalue,
};

/// A Casimir that follows from B alone.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FoundCasimir {
    /// The formula with the coefficients of this system, to six digits.
    pub formula: String,
    /// C.
    #[serde(flatten)]
    pub form: Form,
    /// B∇C = 0, with these coefficients.
    pub casimir: Finding,
    /// m(C).
    pub minimum: Minimum,
}

impl FoundCasimir {
    fn new(form: Form, sight: &Sight<'_>, matrices: &[Matrix]) -> Self {
        let mut casimir = Finding::fitted();
        let at = sight.states.iter().zip(matrices);
        sight.record(&mut casimir, at.map(|(y, b)| products(b, &form.gradient(y))));
        let minimum = Minimum::of(&form, sight.points.are_positive());
        Self { formula: form.formula(), minimum, form, casimir }
    }
}

/// A Casimir Σ cᵢ ln|yᵢ|, as B of Lotka–Volterra systems has, with bᵢⱼyᵢyⱼ in row i and column j.
///
/// Exact flows keep it, see `schemes::Split`; schemes that keep quadratic Casimirs do not.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LogarithmicCasimir {
    /// The formula with the coefficients of this system, to six digits: `ln y1` where y₁ > 0 at
    /// every point, else `ln|y1|`.
    pub formula: String,
    /// c.
    pub coefficients: Vec<f64>,
    /// B∇C = 0, with these coefficients, times the product of the coordinates that occur.
    pub casimir: Finding,
}

/// The Casimirs of B.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Casimirs {
    /// A basis of the linear ones, then one of the quadratic ones that are no products of these. A
    /// scheme that preserves these preserves their linear combinations.
    pub found: Vec<FoundCasimir>,
    /// Whether it is clear that there are no other linear or quadratic ones.
    pub complete: bool,
    /// A positive definite quadratic Casimir, which bounds all paths: the projection of ½‖y‖² onto
    /// the quadratic Casimirs, if it is positive definite.
    pub definite: Option<FoundCasimir>,
    /// Whether quadratic Casimirs were searched for: where B joins no more than 23 components.
    pub quadratic_sought: bool,
    /// A basis of those that are sums of logarithms of coordinates.
    pub logarithmic: Vec<LogarithmicCasimir>,
}

impl Casimirs {
    pub(super) fn of(sight: &mut Sight<'_>) -> Self {
        let matrices: Vec<Matrix> = match sight.locals[..] {
            [] => sight.probe.matrix(&sight.states),
            _ => sight.locals.iter().map(|local| local.b.clone()).collect(),
        };
        let mut chunks = sight.points.for_suprema.chunks(WIDTH);
        let Candidates { forms, complete, quadratic } = casimirs(&mut sight.probe, |_| {
            chunks.next().map(<[Vec<f64>]>::to_vec).unwrap_or_default()
        });
        let evaluated = |form| FoundCasimir::new(form, sight, &matrices);
        let candidates = forms.into_iter().map(evaluated);
        let (found, others): (Vec<_>, Vec<_>) = candidates.partition(|c| c.casimir.holds());
        let definite = definite(&found).map(evaluated).filter(|c| c.casimir.holds());
        Self {
            // The others being Casimirs, one that fails is in no combination that is one.
            complete: complete
                && others.iter().filter(|c| c.casimir.fails()).count() == others.len().min(1),
            found,
            definite,
            quadratic_sought: quadratic,
            logarithmic: LogarithmicCasimir::all(sight, &matrices),
        }
    }
}

impl LogarithmicCasimir {
    /// A basis of those that hold at all points. Coordinates that are Casimirs by themselves are
    /// left out: their logarithms are nothing new.
    fn all(sight: &mut Sight<'_>, matrices: &[Matrix]) -> Vec<Self> {
        let d = sight.probe.dimension();
        let moves = |j: &usize| matrices.iter().flatten().any(|row| row[*j] != 0.0);
        let moving: Vec<usize> = (0..d).filter(moves).collect();
        if moving.is_empty() || d > UNKNOWNS {
            return Vec::new();
        }
        let points = sight.states.iter().zip(matrices).step_by(CLUSTER);
        let equations = equations(&moving, points, |b, y| {
            slopes(y, &moving).iter().zip(b).map(|(s, b)| s * b).collect()
        });
        let (solutions, _) = null_space(equations, moving.len(), ZERO);
        // The coefficients were fitted to the points for identities.
        let points: &Points = sight.points;
        let others = &points.for_suprema[points.random.min(points.for_suprema.len())..];
        let other_matrices = sight.probe.matrix(others);
        let new = |x: Vec<f64>| {
            let x = readable(x, ZERO);
            let terms = |(y, b): (&Vec<f64>, &Matrix)| {
                let mut gradient = vec![0.0; d];
                let slopes = moving.iter().zip(slopes(y, &moving)).zip(&x);
                slopes.for_each(|((&j, slope), c)| gradient[j] = c * slope);
                products(b, &gradient)
            };
            let mut casimir = Finding::fitted();
            sight.record(&mut casimir, sight.states.iter().zip(matrices).map(terms));
            for at in others.iter().zip(&other_matrices) {
                casimir.record(at.0, &[terms(at)], 0.0);
            }
            let symbol = |j: usize| match points.for_identities.iter().all(|y| y[j] > 0.0) {
                true => format!("ln y{}", j + 1),
                false => format!("ln|y{}|", j + 1),
            };
            let formula = sum_of_terms(moving.iter().zip(&x).map(|(&j, &c)| (c, symbol(j))));
            let mut coefficients = vec![0.0; d];
            moving.iter().zip(&x).for_each(|(&j, &c)| coefficients[j] = c);
            Self { formula, coefficients, casimir }
        };
        solutions.into_iter().map(new).filter(|found| found.casimir.holds()).collect()
    }
}

/// ∂ ln|y_j|/∂y_j = 1/y_j for each j of `moving`, times the product of these coordinates.
fn slopes(y: &[f64], moving: &[usize]) -> Vec<f64> {
    let others = |j: usize| moving.iter().filter(move |&&k| k != j).map(|&k| y[k]).product();
    moving.iter().map(|&j| others(j)).collect()
}

/// The projection of the identity onto the span of the quadratic forms, if it is positive definite.
/// It averages over all symmetries of the span; of Casimirs ½|sᵢ|² of parts sᵢ of y it is the sum.
fn definite(found: &[FoundCasimir]) -> Option<Form> {
    let mut quadratic = found.iter().map(|c| &c.form).filter(|form| form.degree == 2).peekable();
    let d = quadratic.peek()?.coefficients.len().isqrt();
    // An orthonormal basis by Gram and Schmidt.
    let mut basis = Matrix::new();
    let mut projection = vec![0.0; d * d];
    for form in quadratic {
        let mut q = form.coefficients.clone();
        for known in &basis {
            q = moved(&q, -dot(&q, known), known);
        }
        let length = norm(&q);
        q.iter_mut().for_each(|x| *x /= length);
        let trace: f64 = (0..d).map(|i| q[i * d + i]).sum();
        projection = moved(&projection, trace, &q);
        basis.push(q);
    }
    let projection = Form { degree: 2, coefficients: projection };
    let is_definite = smallest_eigenvalue(&projection.matrix()) > 1e-12;
    let coefficients = readable(projection.coefficients, ZERO);
    is_definite.then_some(Form { degree: 2, coefficients })
}
