//! Functions that were found to obey the conformal law.

use std::sync::Arc;

use casimir::{
    analysis::facts::{Facts, Form},
    mc::{ConformalLaw, Problem},
};

/// A problem with the laws that follow from what was found: Casimirs, and the energy.
pub fn with_laws<'a>(problem: Problem<'a>, facts: &'a Facts) -> Problem<'a> {
    let casimir = |(k, form): (usize, &'a Form)| ConformalLaw {
        name: format!("C{}", k + 1),
        degree: f64::from(form.degree),
        casimir: true,
        value: Arc::new(|y| form.value(y)),
    };
    let (formulas, no_noise) = (problem.formulas.clone(), vec![0.0; problem.noises]);
    let energy = |degree| ConformalLaw {
        name: "H0".into(),
        degree,
        casimir: false,
        value: Arc::new(move |y| formulas.energy(y, 1.0, &no_noise)),
    };
    let casimirs = facts.casimirs.iter().enumerate().map(casimir);
    let laws = casimirs.chain(facts.energy_law().map(energy)).collect();
    Problem { laws, ..problem }
}
