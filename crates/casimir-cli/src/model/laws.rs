//! Functions that were found to obey the conformal law.

use casimir::{
    analysis::inspect::{Facts, Form},
    mc::{ConformalLaw, Formulas, Problem},
};

/// A function F with F(y(t)) = e^{−p∫γ}F(y(0)).
#[derive(Clone)]
pub enum Law {
    /// A linear or quadratic Casimir.
    Casimir(Form),
    /// H₀, with noises proportional to it.
    Energy(f64),
}

/// The laws that follow from what was found.
pub fn laws(facts: &Facts) -> Vec<Law> {
    let casimirs = facts.casimirs.iter().cloned().map(Law::Casimir);
    casimirs.chain(facts.energy_law().map(Law::Energy)).collect()
}

/// A problem with these laws.
pub fn with_laws(problem: Problem<'_>, laws: Vec<Law>) -> Problem<'_> {
    let mut casimirs = 0;
    let law = |law: &Law| match law {
        Law::Casimir(found) => {
            casimirs += 1;
            let degree = f64::from(found.degree);
            ConformalLaw { name: format!("C{casimirs}"), degree, casimir: true }
        }
        Law::Energy(degree) => ConformalLaw { name: "H0".into(), degree: *degree, casimir: false },
    };
    let columns = laws.iter().map(law).collect();
    let formulas = Box::new(WithLaws {
        formulas: problem.formulas,
        laws,
        no_noise: vec![0.0; problem.noises],
    });
    Problem { laws: columns, formulas, ..problem }
}

struct WithLaws<'a> {
    formulas: Box<dyn Formulas + 'a>,
    laws: Vec<Law>,
    no_noise: Vec<f64>,
}

impl Formulas for WithLaws<'_> {
    fn structure(&self, y: &[f64], v: &[f64]) -> Vec<f64> {
        self.formulas.structure(y, v)
    }

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
        match &self.laws[index] {
            Law::Casimir(found) => found.value(y),
            Law::Energy(_) => self.formulas.energy(y, 1.0, &self.no_noise),
        }
    }
}
