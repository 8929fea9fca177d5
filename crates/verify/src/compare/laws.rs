//! Conformal laws, and how far final states are from them.

use systems::{Damping, InvariantKind, PoissonSystem, Problem};

use crate::inspect::FoundCasimir;

/// The value of a function of the state.
type Value<'a, const D: usize> = Box<dyn Fn([f64; D]) -> f64 + Sync + 'a>;

/// F(y(T)) = e^{−p∫γ}F(y₀).
pub struct Law<'a, const D: usize> {
    /// The name of F, or its formula.
    pub name: String,
    /// Whether F is a Casimir.
    pub casimir: bool,
    value: Value<'a, D>,
    /// e^{−p∫γ}F(y₀).
    at_end: f64,
    /// What defects are relative to: that, or e^{−p∫γ} where it is zero.
    scale: f64,
}

impl<'a, const D: usize> Law<'a, D> {
    /// The laws of the invariants that the system names, then of Casimirs that were found.
    pub fn all<S: PoissonSystem<D, M>, G: Damping, const M: usize>(
        problem: &'a Problem<S, G, D>,
        found: &'a [FoundCasimir],
    ) -> Vec<Self> {
        let system = problem.system();
        let named = system.invariants().into_iter().enumerate().map(|(index, invariant)| {
            let value: Value<'a, D> = Box::new(move |y| system.invariant(index, y));
            let casimir = invariant.kind == InvariantKind::Casimir;
            (invariant.name.to_owned(), casimir, invariant.degree, value)
        });
        let found = found.iter().map(|casimir| {
            let value: Value<'a, D> = Box::new(move |y| form(casimir, y));
            (casimir.formula.clone(), true, f64::from(casimir.degree), value)
        });
        let law = |(name, casimir, degree, value): (String, bool, f64, Value<'a, D>)| {
            let decay = (-degree * problem.damping().integral(0.0, problem.t_end())).exp();
            let at_end = decay * value(problem.y0());
            let scale = if at_end == 0.0 { decay } else { at_end };
            Self { name, casimir, value, at_end, scale }
        };
        named.chain(found).map(law).collect()
    }

    /// (F(y) − e^{−p∫γ}F(y₀))/(e^{−p∫γ}F(y₀)).
    pub fn defect(&self, y: [f64; D]) -> f64 {
        ((self.value)(y) - self.at_end) / self.scale
    }
}

/// βᵀy, or ½yᵀQy.
fn form<const D: usize>(casimir: &FoundCasimir, y: [f64; D]) -> f64 {
    let dot = |row: &[f64]| row.iter().zip(y).map(|(c, y)| c * y).sum::<f64>();
    match casimir.degree {
        1 => dot(&casimir.coefficients),
        _ => {
            let rows = casimir.coefficients.chunks_exact(D).zip(y);
            0.5 * rows.map(|(row, y)| y * dot(row)).sum::<f64>()
        }
    }
}
