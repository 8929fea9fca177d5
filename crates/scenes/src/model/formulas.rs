//! A system from formulas: B and Hamiltonians, or the fields of an equation without them.

use std::sync::Arc;

use casimir::{
    formula::{Definition, DefinitionError, Equation, FormulaSystem, Which},
    inspect::facts::energy,
    mc::{self, Friction, demand},
    stats::Warning,
    systems::{
        probe::around,
        run_time::{Problem, System},
    },
};
use keys::*;

use super::{
    AtRunTime, Built,
    bath::{baths, heats},
    damping::{constant, damping},
    problem,
};

/// Bytes of an entry of B, and those of what is made of a component.
const ENTRY: f64 = 2e3;
const COMPONENT: f64 = 3e4;

/// Builds the model of a system from formulas.
pub fn build(reading: &Reading) -> Read<Built> {
    let Reading { file, constants, settings } = reading;
    let table = &file.system;
    let missing = |what: &str| {
        let words = "or `drift` and `noise` alone; or the `name` of a system of the project, see \
                     `casimir new --list`";
        Wrong::new(None, format_args!("[system] needs {what}; {words}"))
    };
    let state = table.state.as_ref();
    let state = state.ok_or_else(|| missing("`state`, the names of the components"))?;
    let structure = table.structure.as_ref();
    let structure = structure.ok_or_else(|| missing("`B`, the structure matrix"))?;
    let energy = table.energy.as_ref().ok_or_else(|| missing("`H0`, the Hamiltonian"))?;
    single(table)?;
    let state = State::new(state)?;
    let d = state.components.len();
    let entries = match &**structure {
        Listed::List(rows) => rows.iter().map(|row| row.len()).sum(),
        Listed::Text(_) => 0,
    };
    let memory = ENTRY * entries as f64 + COMPONENT * d as f64;
    demand(format!("the formulas of {d} components"), memory)
        .map_err(|error| Wrong::new(structure, error))?;
    let mut definition = Definition {
        structure: keys::structure((&state, &constants.names), structure)?,
        energy: energy.0.clone(),
        noises: table.noises.as_ref().map_or(Vec::new(), words),
        ..definition(reading, &state, "formulas")
    };
    let shares = baths(reading, &mut definition)?;
    let mut system = defined(reading, &state, &definition)?;
    let (damping, mut friction) = damping(reading, &definition.state, &state.vectors)?;
    // Baths that are friction and noise of one component, and are exact as such.
    let (of_baths, first) = (system.friction(), definition.noises.len());
    for &(m, component, rate) in of_baths.iter().rev() {
        definition.noises.insert(first, definition.baths.remove(m).through);
        friction.push(Friction { damping: constant(rate), components: vec![component] });
    }
    if !of_baths.is_empty() {
        system = defined(reading, &state, &definition)?;
    }
    let quantities = heats(&shares, &system, (&of_baths, first));
    let (names, system) = (system.names().clone(), Arc::new(system));
    let problem = problem(reading, system.clone(), damping, settings.initial.to_vec())?;
    compare(reading, &system, (&problem, &friction))?;
    let model = AtRunTime::new(problem, friction, Some(system));
    Ok(Built { quantities, ..Built::new(model, names, Some(Further::Energy(energy.clone()))) })
}

/// Builds the model of an equation that has neither B nor H. Damping of all components is friction,
/// which every scheme takes exactly.
pub fn build_plain(reading: &Reading, drift: &Formulas) -> Read<Built> {
    let Reading { file, settings, .. } = reading;
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
        equation: Some(Equation {
            drift: words(drift),
            noises: table.noise.iter().flatten().map(words).collect(),
            ito: table.calculus.as_deref() == Some(&Calculus::Ito),
        }),
        ..definition(reading, &state, "equation")
    };
    let (system, y0) = (defined(reading, &state, &definition)?, &settings.initial);
    let (of_all, mut friction) = damping(reading, &definition.state, &state.vectors)?;
    if friction.is_empty() && file.damping.is_some() {
        friction.push(Friction { damping: of_all, components: (0..y0.len()).collect() });
    }
    let (names, system) = (system.names().clone(), Arc::new(system));
    let problem = problem(reading, system.clone(), constant(0.0), y0.to_vec())?;
    let remark = if table.calculus.is_none() { sense(&problem, &system) } else { None };
    let model = AtRunTime { remark, ..AtRunTime::new(problem, friction, Some(system)) };
    Ok(Built::new(model, names, None))
}

/// The remark on an equation without `calculus` where Itô's sense would have another drift.
fn sense(problem: &Problem, system: &FormulaSystem) -> Option<Warning> {
    let of = mc::Problem::at_run_time(problem);
    let points = around(problem.y0(), |y| system.check_domain(y).is_ok());
    let at = |t: f64, y: &[f64]| (of.coefficients)(t, y).correction.iter().any(|&one| one != 0.0);
    let differs = |y: &Vec<f64>| TIMES.iter().any(|&t| at(t, y));
    points.iter().any(differs).then(|| {
        Warning::new("the equation is read as Stratonovich's")
            .with_reason("`calculus` is not given, and Itô's has another drift")
            .with_remedy("write `calculus = \"ito\"` or `\"stratonovich\"`")
    })
}

/// A definition of a state and parameters, with the name of the title or else this one.
fn definition(Reading { file, constants, .. }: &Reading, state: &State, name: &str) -> Definition {
    Definition {
        name: file.title.as_deref().unwrap_or(name).into(),
        state: strings(&state.components),
        vectors: state.vectors.clone(),
        parameters: constants.numbers.clone(),
        ..Definition::default()
    }
}

/// The system of a definition.
fn defined(reading: &Reading, state: &State, definition: &Definition) -> Read<FormulaSystem> {
    FormulaSystem::new(definition, &reading.settings.initial)
        .map_err(|error| misdefined(reading, state, &error))
}

/// Refuses parameters that are lists.
fn single(table: &SystemTable) -> Read<()> {
    let is_list = |value: &At<Parameter>| !matches!(**value, Parameter::One(_));
    if let Some((key, value)) = table.parameters.iter().find(|(_, value)| is_list(value)) {
        refuse!(value, "the parameter `{}` of formulas is one number", **key);
    }
    Ok(())
}

/// Times at which an equation is looked at, and the relative difference that counts as rounding.
const TIMES: [f64; 3] = [0.0, 0.618, 2.236];
const ROUNDING: f64 = 1e-9;

/// Compares the equation with `drift` and `noise`, if these are given as well, at points around the
/// initial value. Itô's drift has ½Σ bₘ′bₘ besides. Components that stay zero, such as momenta that
/// make any equation one of this form, are zero at the points, and need no formula.
fn compare(
    reading: &Reading,
    system: &FormulaSystem,
    (problem, friction): (&Problem, &[Friction]),
) -> Read<()> {
    let SystemTable { calculus, drift, noise, .. } = &reading.file.system;
    let noise = noise.as_deref().unwrap_or_default();
    let Some(drift) = drift else {
        let Some(place) = keys::place(calculus).or(noise.first().map(At::span)) else {
            return Ok(());
        };
        refuse!(place, "`calculus` and `noise` are for an equation: give its `drift` as well");
    };
    let of = mc::Problem::at_run_time(problem).with_friction(friction);
    let (y0, is_ito) = (problem.y0(), calculus.as_deref() == Some(&Calculus::Ito));
    if noise.len() != of.noises {
        refuse!(
            noise.last().unwrap_or(drift),
            "H has {} noises, and `noise` has {}",
            of.noises,
            noise.len()
        );
    }
    let mut names = system.names().clone();
    names.variable("t").map_err(|error| Wrong::new(drift, error))?;
    let mut points = around(y0, |y| system.check_domain(y).is_ok());
    let moving = moving(&of, system, &mut points);
    for (m, texts) in (1..).zip(noise).chain([(0, drift)]) {
        let (given, d) = (texts.len(), y0.len());
        let all = match given {
            _ if given == moving.len() => moving.clone(),
            _ if given == d => (0..d).collect(),
            _ => refuse!(texts, "one formula for each of {d} components, got {given}"),
        };
        for (i, text) in all.into_iter().zip(texts.iter()) {
            let formula = text.formula(&names)?;
            for (y, t) in points.iter().flat_map(|y| TIMES.map(|t| (y, t))) {
                let given = formula.value(&[y, &[t][..]].concat());
                let at = (of.coefficients)(t, y);
                let correction = if is_ito { at.correction[i] } else { 0.0 };
                let own = match m {
                    0 => at.drift[i] - problem.damping().rate(t) * y[i] + correction,
                    _ => at.noises[m - 1][i],
                };
                let is = |own: f64| {
                    (given - own).abs() <= ROUNDING * (given.abs() + own.abs() + at.drift[i].abs())
                };
                if is(own) {
                    continue;
                }
                let other = own + at.correction[i] - 2.0 * correction;
                let hint =
                    if m == 0 && is(other) { "; Itô's ½Σ b′b is the difference" } else { "" };
                let what = if m == 0 { "drift".into() } else { format!("noise {m}") };
                let sense = if is_ito { "Itô" } else { "Stratonovich" };
                let equation = &system.equations(&damped(problem, friction))[i];
                refuse!(
                    text,
                    "this {what} is {given:.6} at y = {y:?}, t = {t}, and that of B and H is \
                     {own:.6} in the sense of {sense}{hint}: only equations of this form are \
                     simulated. Theirs, of Stratonovich, is {equation}"
                );
            }
        }
    }
    Ok(())
}

/// The components except those that begin at zero and stay there, as nothing moves them: these are
/// zero at the `points` then. All components if H₀ is not constant there, as of motion in a plane.
fn moving(of: &mc::Problem<'_>, system: &FormulaSystem, points: &mut Vec<Vec<f64>>) -> Vec<usize> {
    let all = 0..of.y0.len();
    let mut zero: Vec<usize> = all.clone().filter(|&i| of.y0[i] == 0.0).collect();
    let (mut left, mut states) = (usize::MAX, Vec::new());
    while zero.len() < left {
        (left, states) = (zero.len(), points.clone());
        for y in &mut states {
            zero.iter().for_each(|&i| y[i] = 0.0);
            for at in TIMES.map(|t| (of.coefficients)(t, y)) {
                zero.retain(|&i| at.drift[i] == 0.0 && at.noises.iter().all(|f| f[i] == 0.0));
            }
        }
    }
    if left == all.len() || states.iter().any(|y| energy(system, y) != energy(system, &states[0])) {
        return all.collect();
    }
    *points = states;
    all.filter(|i| !zero.contains(i)).collect()
}

/// Whether each component is damped.
pub fn damped(problem: &Problem, friction: &[Friction]) -> Vec<bool> {
    let all = problem.damping().integral(0.0, problem.t_end()) != 0.0;
    let has = |i: usize| friction.iter().any(|friction| friction.components.contains(&i));
    (0..problem.y0().len()).map(|i| all || has(i)).collect()
}

/// The error in a definition, at its place in the scene.
fn misdefined(reading: &Reading, state: &State, error: &DefinitionError) -> Wrong {
    let table = &reading.file.system;
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
            formula = table.noises.iter().flat_map(|noises| noises.iter()).nth(m - 1);
            // Or a bath made it.
            let bath = reading.file.bath.first().map(|bath| bath.temperature.span());
            place = bath.or(place);
        }
        Which::Temperature(m) => {
            let of = |bath: &BathTable| bath.through.len() + 3 * bath.transverse.len();
            let mut all = reading.file.bath.iter().flat_map(|bath| vec![bath; of(bath)]);
            place = all.nth(m - 1).map(|bath| bath.temperature.span());
        }
        Which::Field(m, i) => {
            let field = match m {
                0 => table.drift.as_ref(),
                _ => table.noise.iter().flatten().nth(m - 1),
            };
            match i {
                0 => place = field.map(At::span),
                _ => formula = field.and_then(|field| field.get(i - 1)),
            }
        }
        Which::InitialValue => place = Some(reading.settings.initial.span()),
        Which::State => {
            // A name in the message is in quotes.
            let is_named = |name: &&Name| error.message.contains(&format!("`{}`", ***name));
            let name = state.components.iter().rfind(is_named);
            place = name.map(At::span).or(keys::place(&table.state));
        }
    }
    match (formula, &error.formula) {
        (Some(formula), Some(inner)) => Wrong::formula(formula, inner),
        (Some(formula), None) => Wrong::new(formula, error),
        (None, _) => Wrong::new(place, error),
    }
}
