//! A system from the fields of its equation, without B and Hamiltonians.

use std::sync::{Arc, OnceLock};

use casimir::{
    formula::{Definition, Equation, FormulaSystem},
    mc::Friction,
    systems::run_time::Problem,
};

use super::{
    AtRunTime, Built,
    damping::{constant, damping},
    formulas::{misdefined, single},
};
use crate::{At, Calculus, Read, Reading, State, Text, refuse};

/// Builds the model of an equation. Damping of all components is friction, which every scheme takes
/// exactly.
pub fn build(reading: &Reading<'_>, drift: &At<Vec<At<Text>>>) -> Read<Built> {
    let Reading { file, constants, settings } = reading;
    let table = &file.system;
    single(table)?;
    let Some(state) = &table.state else {
        refuse!(drift, "[system] needs `state`, the names of the components");
    };
    if let Some(bath) = file.bath.first() {
        refuse!(
            &bath.temperature,
            "a heat bath belongs to an energy: give B and H0 as well, or its noise and damping"
        );
    }
    let state = State::new(state)?;
    let field = |texts: &At<Vec<At<Text>>>| texts.iter().map(|text| text.0.clone()).collect();
    let definition = Definition {
        name: file.title.clone().unwrap_or("equation".into()),
        state: state.components.iter().map(|name| name.to_string()).collect(),
        vectors: state.vectors.clone(),
        parameters: constants.numbers.clone(),
        equation: Some(Equation {
            drift: field(drift),
            noises: table.noise.iter().flatten().map(field).collect(),
            ito: table.calculus.as_deref() == Some(&Calculus::Ito),
        }),
        ..Definition::default()
    };
    let y0 = &settings.initial;
    let system = FormulaSystem::new(&definition, y0);
    let system = Arc::new(system.map_err(|error| misdefined(reading, &state, &error))?);
    let (of_all, mut friction) = damping(reading, &definition.state, &state.vectors)?;
    if friction.is_empty() && file.damping.is_some() {
        friction.push(Friction { damping: of_all, components: (0..y0.len()).collect() });
    }
    let problem = Problem::new(system.clone(), constant(0.0), y0.clone(), settings.until)
        .map_err(|error| reading.initial_error(error))?;
    Ok(Built {
        sizes: Vec::new(),
        names: system.names().clone(),
        model: Box::new(AtRunTime {
            initial: None,
            problem,
            friction,
            formulas: Some(system),
            facts: OnceLock::new(),
            flows: OnceLock::new(),
        }),
        components: definition.state,
        energy: None,
        quantities: Vec::new(),
    })
}
