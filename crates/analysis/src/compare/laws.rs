//! Conformal laws of Casimirs, and how far final states are from them.

use mc::Problem;
use real::elementary;

use crate::facts::Form;

/// A function of the state.
pub type Value<'a> = Box<dyn Fn(&[f64]) -> f64 + Sync + 'a>;

/// For each Casimir C of degree p that the system names or that was found, the relative defect
/// (C(y) − c)/c of a final state, with c = e^{−p∫γ}C(y₀); relative to e^{−p∫γ} where c is zero.
pub fn defects<'a>(problem: &'a Problem<'a>, found: &'a [Form]) -> Vec<Value<'a>> {
    let integrals = problem.dampings().map(|damping| damping.integral(0.0, problem.t_end));
    let integrals: Vec<f64> = integrals.collect();
    let named = problem.laws.iter().filter(|law| law.casimir);
    let named = named.map(|law| {
        let value: Value<'a> = Box::new(|y| (law.value)(y));
        (law.decay(&integrals), value)
    });
    // With friction those that still hold are among the laws of the problem.
    let found = found.iter().filter(|_| problem.friction.is_empty()).map(|casimir| {
        let value: Value<'a> = Box::new(move |y| casimir.value(y));
        (elementary::exp(-f64::from(casimir.degree) * integrals[0]), value)
    });
    let defect = |(decay, value): (f64, Value<'a>)| -> Value<'a> {
        let at_end = decay * value(&problem.y0);
        let scale = if at_end == 0.0 { decay } else { at_end };
        Box::new(move |y| (value(y) - at_end) / scale)
    };
    named.chain(found).map(defect).collect()
}
