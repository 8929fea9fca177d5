//! A system from formulas.

use std::sync::{Arc, OnceLock};

use casimir::{
    analysis::{
        Candidates,
        facts::{Facts, Form, fastest},
        inspect,
        inspect::{InspectError, InspectSettings, Inspection},
    },
    formula::{Definition, DefinitionError, Formula, FormulaSystem, Which},
    mc::{self, Expect, Setup},
    schemes::{BuiltIn, Method, SchemeError},
    systems::{
        Damping, Linearity,
        run_time::{Problem, System},
    },
};
use toml::Spanned;

use super::{
    Built, Known, Model,
    laws::{laws, with_laws},
};
use crate::scene::{
    Constants, Parameter, Quantity, Read, SceneError, SceneFile, Settings, Source, SystemTable,
    Text,
};

struct Formulas {
    system: Arc<FormulaSystem>,
    problem: Problem,
    facts: OnceLock<Facts>,
}

impl Formulas {
    /// What the system keeps, found once.
    fn facts(&self) -> &Facts {
        self.facts.get_or_init(|| Facts::of(&self.problem))
    }
}

impl Model for Formulas {
    fn problem(&self) -> mc::Problem<'_> {
        mc::Problem::at_run_time(&self.problem)
    }

    fn scheme(&self, scheme: BuiltIn) -> Result<Arc<dyn Method + '_>, SchemeError> {
        let scheme = scheme.at_run_time(self.problem.system())?;
        Ok(Setup::owning(&self.problem, scheme)?.scheme)
    }

    fn candidates(&self) -> Result<Candidates<'_>, SchemeError> {
        let candidates = Candidates::at_run_time(&self.problem)?;
        Ok(candidates.with_casimirs(self.facts().casimirs.clone()))
    }

    fn with_laws<'a>(&'a self, setup: Setup<'a>) -> Setup<'a> {
        Setup { problem: with_laws(setup.problem, laws(self.facts())), ..setup }
    }

    fn recommended(&self) -> (&'static str, String) {
        self.facts().kept().scheme()
    }

    fn known(&self) -> Known {
        let facts = self.facts();
        let form = |(k, form): (usize, &Form)| format!("Casimir C{} = {}", k + 1, form.formula());
        let energy = facts.energy_law().map(|degree| match facts.damped {
            true => format!("H0 decays as exp(-{degree} ∫γ)"),
            false => "H0 is constant".into(),
        });
        Known {
            equations: self.system.equations(facts.damped),
            laws: facts.casimirs.iter().enumerate().map(form).chain(energy).collect(),
            mistake: facts.mistake.clone(),
        }
    }

    fn fastest(&self) -> f64 {
        fastest(self.problem.system(), self.problem.y0())
    }

    fn constant_structure(&self) -> bool {
        self.system.description().linearity == Linearity::Constant
    }

    fn expect(&self) -> Option<Expect<'_>> {
        Expect::at_run_time(&self.problem).ok()
    }

    fn findings(&self) -> Result<Inspection, InspectError> {
        inspect(self.problem.system(), &InspectSettings::at_run_time(&self.problem))
    }
}

/// The model of formulas.
pub fn build(
    source: &Source,
    file: &SceneFile,
    constants: &Constants,
    damping: Arc<dyn Damping>,
    settings: &Settings,
) -> Read<Built> {
    let table = &file.system;
    let (Some(state), Some(structure), Some(energy)) =
        (&table.state, &table.structure, &table.energy)
    else {
        let missing = match (&table.state, &table.structure) {
            (None, _) => "`state`, the names of the components",
            (_, None) => "`B`, the structure matrix",
            _ => "`H0`, the Hamiltonian",
        };
        let message = format!(
            "[system] needs {missing}; or the `name` of a system of the project, see `casimir new \
             --list`"
        );
        return Err(source.error_of_all(message));
    };
    if let Some((key, value)) =
        table.parameters.iter().find(|(_, value)| !matches!(value.get_ref(), Parameter::One(_)))
    {
        let message = format!("the parameter `{}` of formulas is one number", key.get_ref());
        return Err(source.error(value.span(), message));
    }
    let words = |text: &Spanned<Text>| text.get_ref().0.clone();
    let rows = structure.get_ref();
    let noises = table.noises.as_ref().map(Spanned::get_ref);
    let definition = Definition {
        name: file.title.clone().unwrap_or("formulas".into()),
        state: state.get_ref().iter().map(|name| name.get_ref().clone()).collect(),
        parameters: constants.numbers.clone(),
        structure: rows.iter().map(|row| row.get_ref().iter().map(words).collect()).collect(),
        energy: words(energy),
        noises: noises.map_or(Vec::new(), |noises| noises.iter().map(words).collect()),
    };
    let y0 = &settings.initial;
    let system = FormulaSystem::new(&definition, y0)
        .map_err(|error| misdefined(source, table, settings, &definition, error))?;
    let h0 = Formula::parse(&definition.energy, system.names());
    let h0 = h0.map_err(|error| source.formula_error(energy, &error))?;
    let names = system.names().clone();
    let system = Arc::new(system);
    let problem = Problem::new(system.clone(), damping, y0.clone(), settings.until)
        .map_err(|error| settings.initial_error(source, error))?;
    Ok(Built {
        model: Box::new(Formulas { system, problem, facts: OnceLock::new() }),
        components: definition.state,
        names,
        energy: Quantity::Formula(Arc::new(h0)),
        quantities: Vec::new(),
    })
}

/// The place of what is wrong with a definition.
fn misdefined(
    source: &Source,
    table: &SystemTable,
    settings: &Settings,
    definition: &Definition,
    error: DefinitionError,
) -> SceneError {
    let formula = |which: &Which| formula_of(table, definition.state.len(), which);
    let structure = table.structure.as_ref().map_or(0..0, Spanned::span);
    match &error {
        DefinitionError::Formula { which, error: inner } => match formula(which) {
            Some(formula) => source.formula_error(formula, inner),
            None => source.error_of_all(error),
        },
        DefinitionError::DerivativeNotFinite { which, .. } => match formula(which) {
            Some(formula) => source.error(formula.span(), error),
            None => source.error_of_all(error),
        },
        DefinitionError::NotSkew { row, column, .. } => {
            let entry = formula(&Which::Structure(*row, *column));
            source.error(entry.map_or(structure, Spanned::span), error)
        }
        DefinitionError::StructureSize { .. } => source.error(structure, error),
        DefinitionError::Name(_) | DefinitionError::NoState => {
            // A name in the message is in quotes.
            let message = error.to_string();
            let names = table.state.iter().flat_map(|state| state.get_ref());
            let mut wrong = names.filter(|name| message.contains(&format!("`{}`", name.get_ref())));
            let place = wrong.next_back().map(Spanned::span);
            let state = table.state.as_ref().map_or(0..0, Spanned::span);
            source.error(place.unwrap_or(state), message)
        }
        _ => settings.initial_error(source, error),
    }
}

/// A formula of a definition in the file.
fn formula_of<'a>(
    table: &'a SystemTable,
    dimension: usize,
    which: &Which,
) -> Option<&'a Spanned<Text>> {
    match *which {
        Which::Structure(row, column) => {
            let rows = table.structure.as_ref()?.get_ref();
            let entries = rows.get(row - 1)?.get_ref();
            let above = if rows.len() == dimension { 0 } else { row };
            entries.get(column - 1 - above)
        }
        Which::Energy => table.energy.as_ref(),
        Which::Noise(m) => table.noises.as_ref()?.get_ref().get(m - 1),
    }
}
