//! Conformal laws, and how far final states are from them.

use mc::Problem;

use crate::inspect::Form;

/// The value of a function of the state.
type Value<'a> = Box<dyn Fn(&[f64]) -> f64 + Sync + 'a>;

/// F(y(T)) = e^{−p∫γ}F(y₀).
pub struct Law<'a> {
    /// The name of F, or its formula.
    pub name: String,
    /// Whether F is a Casimir.
    pub casimir: bool,
    value: Value<'a>,
    /// e^{−p∫γ}F(y₀).
    at_end: f64,
    /// What defects are relative to: that, or e^{−p∫γ} where it is zero.
    scale: f64,
}

impl<'a> Law<'a> {
    /// The laws of the invariants that the system names, then of Casimirs that were found.
    pub fn all(problem: &'a Problem<'a>, found: &'a [Form]) -> Vec<Self> {
        let named = problem.laws.iter().enumerate().map(|(index, law)| {
            let value: Value<'a> = Box::new(move |y| problem.formulas.law(index, y));
            (law.name.clone(), law.casimir, law.degree, value)
        });
        let found = found.iter().map(|casimir| {
            let value: Value<'a> = Box::new(move |y| casimir.value(y));
            (casimir.formula(), true, f64::from(casimir.degree), value)
        });
        let law = |(name, casimir, degree, value): (String, bool, f64, Value<'a>)| {
            let decay = (-degree * problem.damping.integral(0.0, problem.t_end)).exp();
            let at_end = decay * value(&problem.y0);
            let scale = if at_end == 0.0 { decay } else { at_end };
            Self { name, casimir, value, at_end, scale }
        };
        named.chain(found).map(law).collect()
    }

    /// (F(y) − e^{−p∫γ}F(y₀))/(e^{−p∫γ}F(y₀)).
    pub fn defect(&self, y: &[f64]) -> f64 {
        ((self.value)(y) - self.at_end) / self.scale
    }
}
