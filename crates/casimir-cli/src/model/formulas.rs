//! A system from formulas.

use std::sync::Arc;

use casimir::{
    formula::{Definition, DefinitionError, Difference, Equation, Formula, FormulaSystem, Which},
    systems::{Damping, run_time::Problem},
};

use super::{Built, at_run_time::AtRunTime};
use crate::scene::{
    At, Calculus, Listed, Parameter, Read, Reading, SceneError, State, SystemTable, Text,
    structure as entries,
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
    compare(reading, &system, &*damping)?;
    let problem = Problem::new(system.clone(), damping, y0.clone(), settings.until)
        .map_err(|error| reading.initial_error(error))?;
    Ok(Built {
        sizes: Vec::new(),
        model: Box::new(AtRunTime::new(problem, Some(system))),
        components: definition.state,
        names,
        energy: None,
        quantities: Vec::new(),
    })
}

/// Compares an equation that is given as well.
fn compare(reading: &Reading<'_>, system: &FormulaSystem, damping: &dyn Damping) -> Read<()> {
    let Reading { source, file, settings, .. } = reading;
    let SystemTable { calculus, drift, noise, noises, .. } = &file.system;
    let (Some(drift), noise) = (drift, noise.as_deref().unwrap_or_default()) else {
        let noise = noise.as_ref().and_then(|all| all.first());
        let place = calculus.as_ref().map(At::span).or(noise.map(At::span));
        return place.map_or(Ok(()), |place| {
            let message = "`calculus` and `noise` are for an equation: give its `drift` as well";
            Err(source.error(place, message))
        });
    };
    let (dimension, number) = (settings.initial.len(), noises.as_ref().map_or(0, |all| all.len()));
    if noise.len() != number {
        let message = format!("H has {number} noises, and `noise` has {}", noise.len());
        return Err(source.error(noise.last().unwrap_or(drift).span(), message));
    }
    let mut names = system.names().clone();
    names.variable("t").map_err(|error| source.error(drift.span(), error))?;
    let parse = |texts: &At<Vec<At<Text>>>| {
        if texts.len() != dimension {
            let message = format!("one formula for each of {dimension} components, got {}", texts.len());
            return Err(source.error(texts.span(), message));
        }
        let formula = |text: &At<Text>| {
            Formula::parse(&text.0, &names).map_err(|error| source.formula_error(text, &error))
        };
        texts.iter().map(formula).collect::<Read<Vec<_>>>()
    };
    let given = Equation {
        drift: parse(drift)?,
        noises: noise.iter().map(parse).collect::<Read<_>>()?,
        ito: calculus.as_ref().is_some_and(|calculus| **calculus == Calculus::Ito),
    };
    match system.difference(&given, &|t| damping.rate(t), &settings.initial) {
        Some(Difference { noise: m, component, message }) => {
            let texts = if m == 0 { drift } else { &noise[m - 1] };
            Err(source.error(texts[component].span(), message))
        }
        None => Ok(()),
    }
}

/// What is wrong with a definition, at its place.
fn misdefined(reading: &Reading<'_>, state: &State, error: &DefinitionError) -> SceneError {
    let (source, table) = (reading.source, &reading.file.system);
    let structure = table.structure.as_ref();
    let (mut formula, mut place) = (None, structure.map(At::span));
    match error.which {
        Which::Matrix => {}
        Which::Structure(row, column) => {
            if let Some(Listed::List(rows)) = structure.map(|structure| &**structure) {
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
