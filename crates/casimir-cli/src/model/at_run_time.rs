//! Systems that are known at run time: formulas and lattices.

use std::sync::{Arc, OnceLock};

use casimir::{
    analysis::{
        Candidates,
        facts::{Facts, Form, fastest},
    },
    formula::FormulaSystem,
    mc::{self, Expect, Setup},
    schemes::{BuiltIn, Method, SchemeError},
    systems::run_time::{Problem, System},
};

use super::{Known, Model, laws::with_laws};

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

    fn candidates(&self) -> Result<Candidates<'_>, SchemeError> {
        let candidates = Candidates::at_run_time(&self.problem)?;
        Ok(match self.facts() {
            Some(facts) => candidates.with_casimirs(facts.casimirs.clone()),
            None => candidates,
        })
    }

    fn with_laws<'a>(&'a self, setup: Setup<'a>) -> Setup<'a> {
        match self.facts() {
            Some(facts) => {
                Setup { problem: with_laws(setup.problem, self.system(), facts), ..setup }
            }
            None => setup,
        }
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
