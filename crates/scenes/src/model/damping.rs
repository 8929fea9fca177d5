//! The damping of a scene: of all components, or friction on some.

use std::sync::Arc;

use casimir::{
    formula::{Definition, FormulaDamping, FormulaSystem, nearest},
    inspect::facts::is_divergence_free,
    mc::{self, Friction},
    systems::{
        Constant, Damping, Linearity,
        probe::{around, rate_integrals},
        run_time::{Problem, System},
    },
};

use crate::digits;
use crate::{At, Read, Reading, Text, Wrong, place, refuse};

/// The components with a rate, where each is damped alone.
pub type Rates<'a> = Vec<(usize, &'a At<Text>)>;

/// The rates of components; none where one rate is that of all. `vectors` are those of the state.
pub fn rates<'a>(
    reading: &Reading<'a>,
    components: &[String],
    vectors: &[(String, Vec<String>)],
) -> Read<Rates<'a>> {
    let Some(table) = &reading.file.damping else { return Ok(Vec::new()) };
    let given: Vec<(&At<String>, &At<Text>)> =
        match (&table.rate, &table.components, table.rates.is_empty()) {
            (Some(_), None, true) => return Ok(Vec::new()),
            (Some(rate), Some(named), true) => named.iter().map(|name| (name, rate)).collect(),
            (None, None, false) => table.rates.iter().collect(),
            (rate, ..) => {
                let others = || table.rates.keys().next().map(At::span);
                let place = place(rate).or_else(others);
                refuse!(
                    place,
                    "[damping] has a `rate`, of all or of some `components`, or `rates` such as \
                     {{ p1 = \"g1\" }}"
                );
            }
        };
    let mut rates = Rates::new();
    for (name, rate) in given {
        of_rate(reading, rate)?;
        let vector = vectors.iter().find(|(vector, _)| vector == name.as_str());
        let named = vector.map_or(std::slice::from_ref(&**name), |(_, of)| of);
        for one in named {
            let Some(i) = components.iter().position(|known| known == one) else {
                let hint = nearest(one, components);
                refuse!(name, "`{one}` is no component{hint}");
            };
            if rates.iter().any(|(known, _)| *known == i) {
                refuse!(name, "`{one}` is damped twice");
            }
            rates.push((i, rate));
        }
    }
    Ok(rates)
}

/// The damping of all components, or friction on some. `vectors` are those of the state.
pub fn damping(
    reading: &Reading<'_>,
    components: &[String],
    vectors: &[(String, Vec<String>)],
) -> Read<(Arc<dyn Damping>, Vec<Friction>)> {
    let rates = rates(reading, components, vectors)?;
    let Some(table) = &reading.file.damping else { return Ok((constant(0.0), Vec::new())) };
    if let (Some(place), Some(_)) = (&table.temperature, &reading.file.system.name) {
        refuse!(place, "a `temperature` is for formulas; a lattice has it as a parameter");
    }
    // Rates that are the same are one friction.
    let all = table.rate.iter().filter(|_| rates.is_empty());
    let mut groups: Vec<(&At<Text>, Vec<usize>)> =
        all.map(|rate| (rate, (0..components.len()).collect())).collect();
    for (i, rate) in rates {
        match groups.iter_mut().find(|(known, _)| known.0 == rate.0) {
            Some((_, all)) => all.push(i),
            None => groups.push((rate, vec![i])),
        }
    }
    let friction = groups
        .into_iter()
        .map(|(rate, components)| Ok(Friction { damping: of_rate(reading, rate)?, components }));
    let mut friction = friction.collect::<Read<Vec<_>>>()?;
    match &friction[..] {
        [one] if one.components.len() == components.len() => {
            Ok((friction.swap_remove(0).damping, Vec::new()))
        }
        _ => Ok((constant(0.0), friction)),
    }
}

/// Fractions of T at which the conditions of a bath are checked, at points around the initial
/// value.
const TIMES: [f64; 3] = [0.0, 0.37, 1.0];
/// Differences below this part of their terms count as rounding.
const ROUNDING: f64 = 1e-9;

/// The Hamiltonians of the noises of a heat bath with a temperature, for friction on momenta: with
/// dpᵢ = … − γᵢpᵢdt, H₀ = pᵢ²/2mᵢ + … and its coordinate q, √(2γᵢmᵢkT)q.
///
/// e^{−H₀/kT} is stationary if fields B∇H have no divergence, B∇q is constant and acts on pᵢ alone,
/// and ∂H₀/∂pᵢ = pᵢ/mᵢ with a constant mᵢ. All this is looked at, and what fails is named.
pub fn bath(
    reading: &Reading<'_>,
    definition: &Definition,
    rates: &Rates<'_>,
    temperature: &At<Text>,
) -> Read<Vec<String>> {
    let Reading { file, settings, .. } = reading;
    if let Some(noises) = &file.system.noises {
        refuse!(noises, "the noise follows from the `temperature`: leave out `H`");
    }
    if rates.is_empty() {
        refuse!(temperature, "a temperature needs friction on momenta: `components` or `rates`");
    }
    let (kt, times) = (of_rate(reading, temperature)?, TIMES.map(|part| part * settings.until));
    if let Some(t) = times.into_iter().find(|t| kt.rate(*t) < 0.0) {
        refuse!(temperature, "kT is at least 0, got {} at t = {t}", kt.rate(t));
    }
    // With the components as Hamiltonians of noises, these have the columns of B.
    let columns = Definition { noises: definition.state.clone(), ..definition.clone() };
    let (y0, state) = (&settings.initial, &definition.state);
    // What is wrong with the definition is told without noises.
    let Ok(system) = FormulaSystem::new(&columns, y0) else { return Ok(Vec::new()) };
    let points = around(y0, |y| system.check_domain(y).is_ok());
    let problem = Problem::new(Arc::new(system), constant(0.0), y0.clone(), settings.until);
    let Ok(problem) = problem else { return Ok(Vec::new()) };
    let description = problem.system().description();
    if description.linearity != Linearity::Constant && !is_divergence_free(problem.system(), y0) {
        refuse!(
            temperature,
            "fields B∇H have a divergence here: exp(-H0/kT) is not stationary, with any noise"
        );
    }
    let of = mc::Problem::at_run_time(&problem);
    let times = if description.depends_on_time { &times[..] } else { &times[..1] };
    let states: Vec<_> = points
        .iter()
        .flat_map(|y| times.iter().map(move |t| (*t, y)))
        .map(|(t, y)| (y, (of.coefficients)(t, y)))
        .collect();
    let noise = |(i, rate): &(usize, &At<Text>)| {
        let (i, name) = (*i, &state[*i]);
        // Of a coordinate B∇q is constant, and acts on its momentum alone.
        let is_coordinate = |q: &usize| {
            let b = states[0].1.noises[*q][i];
            let near = |x: f64, y: f64| (x - y).abs() <= ROUNDING * b.abs();
            let column = |at: &mc::Coefficients| at.noises[*q].clone().into_iter().enumerate();
            let mut columns = states.iter().map(|(_, at)| column(at));
            b != 0.0
                && columns.all(|mut all| all.all(|(k, x)| near(x, if k == i { b } else { 0.0 })))
        };
        let Some(q) = (0..state.len()).find(is_coordinate) else {
            refuse!(
                temperature,
                "`{name}` is not the momentum of one coordinate, with a constant entry of B. Noise \
                 B∇H keeps Casimirs, as |L| of a body: a bath that changes them takes momenta that \
                 stay zero, see \"Any other equation\" in docs/scenes.md; for spins take \
                 `spin-lattice`"
            );
        };
        // dq = −b ∂H₀/∂p dt with ∂H₀/∂p = p/m.
        let b = states[0].1.noises[q][i];
        let slope_of = |at: &mc::Coefficients| -at.drift[q] / b;
        let slope = |y: &[f64], k: usize, y_k: f64| {
            let mut y = y.to_vec();
            y[k] = y_k;
            slope_of(&(of.coefficients)(0.0, &y))
        };
        let m = 1.0 / (slope(y0, i, y0[i] + 0.5) - slope(y0, i, y0[i] - 0.5));
        let size = points.iter().fold(0.0, |size: f64, y| size.max(y[i].abs()));
        let is_kinetic =
            |(y, at): &(&Vec<f64>, _)| (m * slope_of(at) - y[i]).abs() <= ROUNDING * size;
        if !(m > 0.0 && states.iter().all(is_kinetic)) {
            let y = &points[points.len() - 1];
            let first = slope(y, i, y[i]);
            let differs =
                |k: &usize| (slope(y, *k, points[1][*k]) - first).abs() > ROUNDING * first.abs();
            let what = match (0..state.len()).filter(|k| *k != i).find(differs) {
                Some(k) => format!("∂H0/∂{name} depends on `{}`", state[k]),
                None => format!("H0 has no term {name}^2/(2*m)"),
            };
            refuse!(
                temperature,
                "{what}: a bath takes a constant mass m. Write the noise as `H`: for a mass m of \
                 the coordinate or the time, with ∂H/∂{} = sqrt(2*γ*m*kT)",
                state[q]
            );
        }
        let (rate, kt, factor) = (&rate.0, &temperature.0, m / (b * b));
        Ok(format!("sqrt(2*({rate})*({kt})*{factor:?})*{}", state[q]))
    };
    rates.iter().map(noise).collect()
}

/// Parts of [0, T] on which a rate is integrated before a run.
const PARTS: u32 = 64;

/// The damping of a rate.
fn of_rate(reading: &Reading<'_>, rate: &At<Text>) -> Read<Arc<dyn Damping>> {
    let Reading { constants, settings, .. } = reading;
    let mut names = constants.names.clone();
    names.variable("t").map_err(|error| Wrong::new(rate, error))?;
    let formula = rate.formula(&names)?;
    for t in [0.0, settings.until] {
        if let Some(error) = formula.explain(&[t]) {
            let message = format!("{} at t = {t}", error.message);
            return Err(Wrong::in_formula(rate, &error, message));
        }
    }
    if formula.reads().is_empty() {
        return Ok(constant(formula.value(&[0.0])));
    }
    let damping = FormulaDamping::new(formula);
    if let (_, Some(t)) = rate_integrals(&damping, settings.until, PARTS) {
        refuse!(rate, "this has no integral about t = {}", digits(t));
    }
    Ok(Arc::new(damping))
}

/// Damping with a finite constant rate.
fn constant(rate: f64) -> Arc<dyn Damping> {
    Arc::new(Constant::new(rate).expect("the rate is finite"))
}
