//! Functions that were found to obey the conformal law.

use std::sync::Arc;

use casimir::{
    analysis::facts::{Facts, Form, energy},
    mc::{ConformalLaw, Problem},
    systems::run_time::System,
};

/// A problem with the laws that follow from what was found: Casimirs, and the energy.
pub fn with_laws<'a>(
    problem: Problem<'a>,
    system: &'a dyn System,
    facts: &'a Facts,
) -> Problem<'a> {
    let casimir = |(k, form): (usize, &'a Form)| ConformalLaw {
        name: format!("C{}", k + 1),
        degree: f64::from(form.degree),
        casimir: true,
        value: Arc::new(|y| form.value(y)),
    };
    let of_energy = |degree| ConformalLaw {
        name: "H0".into(),
        degree,
        casimir: false,
        value: Arc::new(move |y| energy(system, y)),
    };
    let casimirs = facts.casimirs.iter().enumerate().map(casimir);
    let laws = casimirs.chain(facts.energy_law().map(of_energy)).collect();
    Problem { laws, ..problem }
}
