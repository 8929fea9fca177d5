//! A system from formulas.

use std::sync::Arc;

use casimir::{
    formula::{Definition, DefinitionError, FormulaSystem, Which},
    systems::{Damping, run_time::Problem},
};

use super::{Built, at_run_time::AtRunTime};
use crate::scene::{
    At, Parameter, Read, Reading, SceneError, State, Structure, Text, structure as entries,
};

/// The model of formulas.
pub fn build(reading: &Reading<'_>, damping: Arc<dyn Damping>) -> Read<Built> {
    let Reading { source, file, constants, settings } = reading;
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
        return Err(source.error(None, message));
    };
    if let Some((key, value)) =
        table.parameters.iter().find(|(_, value)| !matches!(***value, Parameter::One(_)))
    {
        let message = format!("the parameter `{}` of formulas is one number", **key);
        return Err(source.error(value.span(), message));
    }
    let words = |text: &At<Text>| text.0.clone();
    let state = State::new(source, state)?;
    let definition = Definition {
        name: file.title.clone().unwrap_or("formulas".into()),
        state: state.components.iter().map(|name| name.to_string()).collect(),
        vectors: state.vectors.clone(),
        parameters: constants.numbers.clone(),
        structure: entries(source, &state, structure)?,
        energy: words(energy),
        noises: table.noises.iter().flat_map(|noises| noises.iter()).map(words).collect(),
    };
    let y0 = &settings.initial;
    let system = FormulaSystem::new(&definition, y0);
    let system = Arc::new(system.map_err(|error| misdefined(reading, &state, &error))?);
    let names = system.names().clone();
    let problem = Problem::new(system.clone(), damping, y0.clone(), settings.until)
        .map_err(|error| reading.initial_error(error))?;
    Ok(Built {
        of_vector: 1,
        model: Box::new(AtRunTime::new(problem, Some(system))),
        components: definition.state,
        names,
        energy: None,
        quantities: Vec::new(),
    })
}

/// What is wrong with a definition, at its place.
fn misdefined(reading: &Reading<'_>, state: &State, error: &DefinitionError) -> SceneError {
    let (source, table) = (reading.source, &reading.file.system);
    let structure = table.structure.as_ref();
    let (mut formula, mut place) = (None, structure.map(At::span));
    match error.which {
        Which::Matrix => {}
        Which::Structure(row, column) => {
            if let Some(Structure::Rows(rows)) = structure.map(|structure| &**structure) {
                // All of B is given, or what stands above the diagonal.
                let first = if rows.len() == state.components.len() { 0 } else { row };
                formula = rows.get(row - 1).and_then(|row| row.get(column - 1 - first));
            }
        }
        Which::Energy => formula = table.energy.as_ref(),
        Which::Noise(m) => {
            formula = table.noises.as_ref().and_then(|noises| noises.get(m - 1));
        }
        Which::InitialValue => place = Some(reading.settings.initial_place.clone()),
        Which::State => {
            // A name in the message is in quotes.
            let is_named = |name: &&At<String>| error.message.contains(&format!("`{}`", ***name));
            let name = state.components.iter().rfind(is_named);
            place = name.map(At::span).or(table.state.as_ref().map(At::span));
        }
    }
    match (formula, &error.formula) {
        (Some(formula), Some(inner)) => source.formula_error(formula, inner),
        (Some(formula), None) => source.error(formula.span(), error),
        (None, _) => source.error(place, error),
    }
}
