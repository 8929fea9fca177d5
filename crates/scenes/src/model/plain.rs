//! A system from the fields of its equation, without B and Hamiltonians.

use std::sync::Arc;

use casimir::{
    formula::{Definition, Equation, FormulaSystem},
    mc::Friction,
};

use super::{
    AtRunTime, Built,
    damping::{constant, damping},
    formulas::{misdefined, single},
    problem,
};
use crate::{Calculus, Formulas, Read, Reading, State, refuse, strings, words};

/// Builds the model of an equation. Damping of all components is friction, which every scheme takes
/// exactly.
pub fn build(reading: &Reading, drift: &Formulas) -> Read<Built> {
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
    let definition = Definition {
        name: file.title.clone().unwrap_or("equation".into()),
        state: strings(&state.components),
        vectors: state.vectors.clone(),
        parameters: constants.numbers.clone(),
        equation: Some(Equation {
            drift: words(drift),
            noises: table.noise.iter().flatten().map(words).collect(),
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
    let problem = problem(reading, system.clone(), constant(0.0), y0.to_vec())?;
    let names = system.names().clone();
    Ok(Built::new(AtRunTime::new(problem, friction, Some(system)), names, None))
}
