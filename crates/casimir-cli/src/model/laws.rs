//! Functions that were found to obey the conformal law.

use std::sync::Arc;

use casimir::{
    analysis::facts::{Facts, Form},
    mc::{ConformalLaw, Formulas, Problem},
};

/// A problem with the laws that follow from what was found: Casimirs, and the energy.
pub fn with_laws<'a>(problem: Problem<'a>, facts: &'a Facts) -> Problem<'a> {
    let casimir = |(k, form): (usize, &Form)| {
        let (name, degree) = (format!("C{}", k + 1), f64::from(form.degree));
        ConformalLaw { name, degree, casimir: true }
    };
    let energy = |degree| ConformalLaw { name: "H0".into(), degree, casimir: false };
    let casimirs = facts.casimirs.iter().enumerate().map(casimir);
    let laws = casimirs.chain(facts.energy_law().map(energy)).collect();
    let no_noise = vec![0.0; problem.noises];
    let formulas = WithLaws { formulas: problem.formulas, casimirs: &facts.casimirs, no_noise };
    Problem { laws, formulas: Arc::new(formulas), ..problem }
}

struct WithLaws<'a> {
    formulas: Arc<dyn Formulas + 'a>,
    casimirs: &'a [Form],
    no_noise: Vec<f64>,
}

impl Formulas for WithLaws<'_> {
    fn energy(&self, y: &[f64], dt: f64, dw: &[f64]) -> f64 {
        self.formulas.energy(y, dt, dw)
    }

    fn field(&self, y: &[f64], dt: f64, dw: &[f64]) -> Vec<f64> {
        self.formulas.field(y, dt, dw)
    }

    fn ito_correction(&self, y: &[f64]) -> Vec<f64> {
        self.formulas.ito_correction(y)
    }

    fn law(&self, index: usize, y: &[f64]) -> f64 {
        match self.casimirs.get(index) {
            Some(form) => form.value(y),
            None => self.formulas.energy(y, 1.0, &self.no_noise),
        }
    }
}
