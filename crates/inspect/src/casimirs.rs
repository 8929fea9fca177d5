//! Linear, quadratic and logarithmic Casimirs of B, each evaluated at all points.

use real::WIDTH;
use serde::Serialize;

use super::{Sight, shape::Minimum};
use crate::facts::{Candidates, Finding, Form, Matrix, casimirs, moved, product};

/// A Casimir that follows from B alone.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FoundCasimir {
    /// The formula with the coefficients of this system, to six digits.
    pub formula: String,
    /// Casimir C as a form.
    #[serde(flatten)]
    pub form: Form,
    /// Finding on B∇C = 0 with these coefficients.
    pub casimir: Finding,
    /// Minimum m(C) over the unit sphere.
    pub minimum: Minimum,
}

impl FoundCasimir {
    fn new(form: Form, sight: &Sight<'_>, matrices: &[Matrix]) -> Self {
        let mut casimir = Finding::fitted();
        let terms = |n: usize| {
            let gradient = form.gradient(&sight.states[n]);
            matrices[n].iter().map(|row| product(row, &gradient)).collect()
        };
        sight.record(&mut casimir, terms, 0.0);
        let are_positive = sight.points.for_suprema.iter().flatten().all(|y| *y > 0.0);
        let minimum = Minimum::of(&form, are_positive);
        Self { formula: form.formula(), minimum, form, casimir }
    }
}

/// The Casimirs of B.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Casimirs {
    /// Basis of the linear Casimirs, then one of the quadratic ones that are not products of these.
    /// A scheme that preserves these preserves their linear combinations.
    pub found: Vec<FoundCasimir>,
    /// Whether other linear or quadratic Casimirs are excluded. Quadratic ones are sought where B
    /// joins no more than 24 components.
    pub complete: bool,
    /// Sum of the quadratic Casimirs, which bounds all paths, if it is positive definite.
    pub definite: Option<FoundCasimir>,
    /// Sums of logarithms, as B of Lotka–Volterra systems has. Exact flows keep them, see
    /// `schemes::Split`; schemes that keep quadratic Casimirs do not.
    pub logarithmic: Vec<FoundCasimir>,
}

impl Casimirs {
    pub(super) fn of(sight: &mut Sight<'_>) -> Self {
        let matrices: Vec<Matrix> = match sight.matrices[..] {
            [] => sight.probe.matrix(&sight.states),
            _ => sight.matrices.clone(),
        };
        let mut chunks = sight.points.for_suprema.chunks(WIDTH);
        let Candidates { forms, complete } =
            casimirs(&mut sight.probe, |_| chunks.next().unwrap_or_default().to_vec());
        let evaluated = |form| FoundCasimir::new(form, sight, &matrices);
        let holds = |c: &FoundCasimir| c.casimir.holds();
        let (mut found, others): (Vec<_>, Vec<_>) =
            forms.into_iter().map(evaluated).partition(holds);
        let logarithmic = found.extract_if(.., |c| c.form.degree == 0).collect();
        let definite = definite(&found).map(evaluated).filter(holds);
        // The others being Casimirs, one that fails is in no combination that is one.
        let others = others.iter().filter(|c| c.form.degree > 0);
        let failing = others.clone().filter(|c| c.casimir.fails()).count();
        let complete = complete && failing == others.count().min(1);
        Self { found, complete, definite, logarithmic }
    }
}

/// Sum of the quadratic forms, if it is positive definite, for example Σ½|sᵢ|² of parts sᵢ of y.
fn definite(found: &[FoundCasimir]) -> Option<Form> {
    let quadratic = found.iter().map(|c| c.form.clone()).filter(|form| form.degree == 2);
    let sum = quadratic
        .reduce(|a, b| Form { coefficients: moved(&a.coefficients, 1.0, &b.coefficients), ..a })?;
    Minimum::of(&sum, false).positive.holds().then_some(sum)
}
