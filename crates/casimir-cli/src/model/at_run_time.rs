//! Systems that are known at run time: formulas and lattices.

use std::sync::{Arc, OnceLock};

use casimir::{
    analysis::facts::{DampingIntegral, Facts, Form, fastest},
    formula::FormulaSystem,
    mc::{self, Expect, Friction, Setup},
    schemes::{BuiltIn, Method, SchemeError},
    systems::run_time::{Problem, System},
};

use super::{Known, Model, formulas::damped};

/// A problem whose system is known at run time.
pub struct AtRunTime {
    problem: Problem,
    friction: Vec<Friction>,
    formulas: Option<Arc<FormulaSystem>>,
    facts: OnceLock<Facts>,
}

impl AtRunTime {
    /// The problem of a lattice, or that of formulas.
    pub fn new(
        problem: Problem,
        friction: Vec<Friction>,
        formulas: Option<Arc<FormulaSystem>>,
    ) -> Self {
        Self { problem, friction, formulas, facts: OnceLock::new() }
    }

    /// What formulas keep, found once. Lattices are too large.
    fn facts(&self) -> Option<&Facts> {
        self.formulas.as_ref()?;
        Some(self.facts.get_or_init(|| Facts::of(&self.problem)))
    }
}

impl Model for AtRunTime {
    fn problem(&self) -> mc::Problem<'_> {
        let mut problem = mc::Problem::at_run_time(&self.problem);
        if let Some(facts) = self.facts() {
            problem.laws = facts.laws(self.system());
        }
        problem.with_friction(&self.friction)
    }

    fn scheme(&self, scheme: BuiltIn) -> Result<Arc<dyn Method + '_>, SchemeError> {
        let scheme = scheme.at_run_time(self.problem.system())?;
        Ok(Friction::around(Setup::owning(&self.problem, scheme)?.scheme, &self.friction))
    }

    /// Formulas and lattices have areas for those who name their schemes.
    fn recommended(&self) -> (&'static str, String) {
        let system = self.problem.system().description();
        let (scheme, why) = self.kept(false).scheme(self.system());
        match &system.parts {
            Err(reason) if self.formulas.is_none() && !system.is_transverse => {
                (scheme, format!("{why}; split would not do: {reason}"))
            }
            _ => (scheme, why),
        }
    }

    fn known(&self) -> Known {
        let Some((facts, system)) = self.facts().zip(self.formulas.as_ref()) else {
            return Known::default();
        };
        let laws = self.problem().laws;
        let holds = |name: &str| laws.iter().any(|law| law.name == name);
        let form = |(k, form): (usize, &Form)| {
            let name = format!("C{}", k + 1);
            let broken = if holds(&name) { "" } else { ", which friction breaks" };
            format!("Casimir {name} = {}{broken}", form.formula())
        };
        let energy = facts.energy_law().filter(|_| holds("H0")).map(|degree| {
            match (facts.damped, self.friction.is_empty()) {
                (false, true) => "H0 is constant".into(),
                (_, true) => format!("H0 decays as exp(-{degree} ∫γ)"),
                _ => "H0 decays as each of its monomials".into(),
            }
        });
        let of_friction = || {
            let t_end = self.problem.t_end();
            let mut all = self.friction.iter();
            all.find_map(|one| DampingIntegral::of(&*one.damping, t_end).mistake())
        };
        Known {
            equations: system.equations(&damped(&self.problem, &self.friction)),
            laws: facts.casimirs.iter().enumerate().map(form).chain(energy).collect(),
            mistake: facts.mistake.clone().or_else(of_friction),
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
        self.formulas.as_ref()?;
        Some(Expect::at_run_time(&self.problem).ok()?.with_friction(&self.friction))
    }

    fn friction(&self) -> &[Friction] {
        &self.friction
    }

    fn system(&self) -> &dyn System {
        self.problem.system()
    }
}
