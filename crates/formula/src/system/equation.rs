//! An equation that is given by drift and noise fields, compared with a system.

use systems::run_time::System;

use super::{FormulaSystem, expressions::Expressions};
use crate::Formula;

/// dy = a dt + Σₘ bₘ dWₘ in Itô's sense, or ∘ dWₘ in Stratonovich's, damping included. The formulas
/// have the components and then the time as variables.
pub struct Equation {
    /// a, a formula for each component.
    pub drift: Vec<Formula>,
    /// b₁, …, likewise.
    pub noises: Vec<Vec<Formula>>,
    /// Whether it is Itô's.
    pub ito: bool,
}

/// Where an equation is not that of a system.
#[derive(Debug)]
pub struct Difference {
    /// The number of the noise, from 1; 0 for the drift.
    pub noise: usize,
    /// The number of the component, from 0.
    pub component: usize,
    /// What is there, and what the system has.
    pub message: String,
}

/// Times at which an equation is compared.
const TIMES: [f64; 3] = [0.0, 0.618, 2.236];
/// What differs by less of its terms is rounding.
const ROUNDING: f64 = 1e-9;

impl FormulaSystem {
    /// The first place at which an equation is not dy = (B∇H₀ − γy)dt + Σ B∇Hₘ ∘ dWₘ of this system
    /// with the rate γ(t) of damping, at points around `y0` and at several times; none if it is.
    /// Itô's drift is converted: ½Σ bₘ′bₘ is taken off.
    #[must_use]
    pub fn difference(
        &self,
        given: &Equation,
        rate: &dyn Fn(f64) -> f64,
        y0: &[f64],
    ) -> Option<Difference> {
        let mut all: Expressions = self.expressions.clone();
        let (names, variables) = (self.names().variables(), all.variables());
        let points = systems::around(y0, |y| self.check_domain(y).is_ok());
        let noises = given.noises.iter().enumerate().map(|(m, noise)| (m + 1, noise));
        for (m, formulas) in noises.chain([(0, &given.drift)]) {
            let converted = m == 0 && given.ito;
            let correction = converted.then(|| all.corrected());
            let fields = all.field_of(m).1;
            for (i, (formula, &field)) in formulas.iter().zip(&fields).enumerate() {
                let graph = &mut all.graph;
                let own = graph.copy(Some(&formula.graph), &[formula.root], &variables)[0];
                let own = correction.as_ref().map_or(own, |minus| graph.sub(own, minus[i]));
                let damping = |y: &[f64], t: f64| if m == 0 { rate(t) * y[i] } else { 0.0 };
                let differs = |y: &[f64], t: f64| {
                    let (value, damping) = (all.numbers(&[own, field], y, t), damping(y, t));
                    let size = value[0].abs() + value[1].abs() + damping.abs();
                    (value[0] - value[1] + damping).abs() > ROUNDING * size
                };
                if !points.iter().any(|y| TIMES.iter().any(|&t| differs(y, t))) {
                    continue;
                }
                let name = &names[i];
                let is_damped = TIMES.iter().any(|&t| damping(&[1.0].repeat(names.len()), t) != 0.0);
                let message = format!(
                    "the {} of {name} is {}, and B∇H{m} gives {}{}: only this form is simulated",
                    match (m, converted) {
                        (0, true) => "drift in Stratonovich's sense",
                        (0, false) => "drift",
                        _ => "noise",
                    },
                    all.text(own, names),
                    all.text(field, names),
                    if is_damped { format!(" - γ {name}") } else { String::new() }
                );
                return Some(Difference { noise: m, component: i, message });
            }
        }
        None
    }
}
