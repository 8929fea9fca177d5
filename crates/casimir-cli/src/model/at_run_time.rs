//! Systems that are known at run time: formulas and lattices.

use std::sync::{Arc, OnceLock};

use casimir::{
    analysis::facts::{DampingIntegral, Facts, Form, Kept, fastest},
    formula::FormulaSystem,
    mc::{self, Expect, Friction, Setup},
    schemes::{BuiltIn, Method, SchemeError},
    systems::run_time::{Problem, System},
};

use super::{Known, Model, formulas::damped};

/// A problem whose system is known at run time.
pub struct AtRunTime {
    pub problem: Problem,
    pub friction: Vec<Friction>,
    /// None of a lattice.
    pub formulas: Option<Arc<FormulaSystem>>,
    /// Those of formulas, when they are found.
    pub facts: OnceLock<Facts>,
}

impl AtRunTime {
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
        let system = self.system().description();
        let kept = Kept::of(&self.problem(), self.system(), false);
        let (scheme, mut why) = kept.scheme(self.system());
        if let (Err(reason), None, false) = (&system.parts, &self.formulas, system.is_transverse) {
            why += &format!("; split would not do: {reason}");
        }
        (scheme, why)
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
        self.formulas.as_ref().map_or(0.0, |_| fastest(self.system(), self.problem.y0()))
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
