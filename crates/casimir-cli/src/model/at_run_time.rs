//! Systems that are known at run time: formulas and lattices.

use std::sync::{Arc, OnceLock};

use casimir::{
    analysis::facts::{Facts, Form, energy, fastest},
    formula::FormulaSystem,
    mc::{self, ConformalLaw, Expect, Setup},
    schemes::{BuiltIn, Method, SchemeError},
    systems::run_time::{Problem, System},
};

use super::{Known, Model};

/// A problem whose system is known at run time.
pub struct AtRunTime {
    problem: Problem,
    formulas: Option<Arc<FormulaSystem>>,
    facts: OnceLock<Facts>,
}

impl AtRunTime {
    /// The problem of a lattice, or that of formulas.
    pub fn new(problem: Problem, formulas: Option<Arc<FormulaSystem>>) -> Self {
        Self { problem, formulas, facts: OnceLock::new() }
    }

    /// What formulas keep, found once. Lattices are too large.
    fn facts(&self) -> Option<&Facts> {
        self.formulas.as_ref()?;
        Some(self.facts.get_or_init(|| Facts::of(&self.problem)))
    }
}

impl Model for AtRunTime {
    fn problem(&self) -> mc::Problem<'_> {
        mc::Problem::at_run_time(&self.problem)
    }

    fn scheme(&self, scheme: BuiltIn) -> Result<Arc<dyn Method + '_>, SchemeError> {
        let scheme = scheme.at_run_time(self.problem.system())?;
        Ok(Setup::owning(&self.problem, scheme)?.scheme)
    }

    fn casimirs(&self) -> Vec<Form> {
        self.facts().map_or_else(Vec::new, |facts| facts.casimirs.clone())
    }

    fn with_laws<'a>(&'a self, setup: Setup<'a>) -> Setup<'a> {
        let (Some(facts), system) = (self.facts(), self.system()) else { return setup };
        let law =
            |name: String, degree, casimir, value| ConformalLaw { name, degree, casimir, value };
        let casimirs = facts.casimirs.iter().enumerate().map(|(k, form)| {
            let value = Arc::new(|y: &[f64]| form.value(y));
            law(format!("C{}", k + 1), f64::from(form.degree), true, value)
        });
        let of_energy =
            |degree| law("H0".into(), degree, false, Arc::new(move |y: &[f64]| energy(system, y)));
        let laws = casimirs.chain(facts.energy_law().map(of_energy)).collect();
        Setup { problem: mc::Problem { laws, ..setup.problem }, ..setup }
    }

    fn recommended(&self) -> (&'static str, String) {
        let system = self.problem.system().description();
        if let Some(facts) = self.facts() {
            let (scheme, why) = facts.kept().scheme();
            return match system.depends_on_time {
                true => (scheme, why.replace("the noise", "what noise and time do")),
                false => (scheme, why),
            };
        }
        let (scheme, why) = match &system.parts {
            Ok(_) => ("split", "the energy stays near".into()),
            Err(_) if system.is_transverse => {
                ("sexp-li", "transverse damping governs the energy".into())
            }
            Err(reason) => ("sexp", format!("split would not do: {reason}")),
        };
        (scheme, format!("it keeps the length of each spin; {why}"))
    }

    fn known(&self) -> Known {
        let Some((facts, system)) = self.facts().zip(self.formulas.as_ref()) else {
            return Known::default();
        };
        let form = |(k, form): (usize, &Form)| format!("Casimir C{} = {}", k + 1, form.formula());
        let energy = facts.energy_law().map(|degree| match facts.damped {
            true => format!("H0 decays as exp(-{degree} ∫γ)"),
            false => "H0 is constant".into(),
        });
        Known {
            equations: system.equations(facts.damped),
            laws: facts.casimirs.iter().enumerate().map(form).chain(energy).collect(),
            mistake: facts.mistake.clone(),
        }
    }

    fn fastest(&self) -> f64 {
        match self.formulas {
            Some(_) => fastest(self.problem.system(), self.problem.y0()),
            None => 0.0,
        }
    }

    /// None for a lattice: a point has as many dimensions as spins, steps and noises together.
    fn expect(&self) -> Option<Expect<'_>> {
        self.formulas.as_ref().and_then(|_| Expect::at_run_time(&self.problem).ok())
    }

    fn system(&self) -> &dyn System {
        self.problem.system()
    }
}
