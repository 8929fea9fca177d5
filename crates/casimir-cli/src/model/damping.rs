//! The damping of a scene: of all components, or friction on some.

use std::sync::Arc;

use casimir::{
    formula::{Definition, Formula, FormulaDamping, FormulaSystem, nearest},
    mc::{self, Friction},
    systems::{Constant, Damping, run_time::Problem},
};

use crate::scene::{At, Read, Reading, Text};

/// The components with a rate, where each is damped alone.
pub type Rates<'a> = Vec<(usize, &'a At<Text>)>;

/// The rates of components; none where one rate is that of all. `vectors` are those of the state.
pub fn rates<'a>(
    reading: &Reading<'a>,
    components: &[String],
    vectors: &[(String, Vec<String>)],
) -> Read<Rates<'a>> {
    let (source, Some(table)) = (reading.source, &reading.file.damping) else {
        return Ok(Vec::new());
    };
    let given: Vec<(&At<String>, &At<Text>)> = match (&table.rate, &table.components) {
        (Some(_), None) if table.rates.is_empty() => return Ok(Vec::new()),
        (Some(rate), Some(named)) if table.rates.is_empty() => {
            named.iter().map(|name| (name, rate)).collect()
        }
        (None, None) if !table.rates.is_empty() => table.rates.iter().collect(),
        _ => {
            let message = "[damping] has a `rate`, of all or of some `components`, or `rates` such \
                           as { p1 = \"g1\" }";
            let others = || table.rates.keys().next().map(At::span);
            let place = table.rate.as_ref().map(At::span).or_else(others);
            return Err(source.error(place, message));
        }
    };
    let mut rates = Rates::new();
    for (name, rate) in given {
        of_rate(reading, rate)?;
        let vector = vectors.iter().find(|(vector, _)| vector == name.as_str());
        let named = vector.map_or(std::slice::from_ref(&**name), |(_, of)| of);
        for one in named {
            let Some(i) = components.iter().position(|known| known == one) else {
                let message = format!("`{one}` is no component{}", nearest(one, components));
                return Err(source.error(name.span(), message));
            };
            if rates.iter().any(|(known, _)| *known == i) {
                return Err(source.error(name.span(), format!("`{one}` is damped twice")));
            }
            rates.push((i, rate));
        }
    }
    Ok(rates)
}

/// The damping of all components, and friction on those with these rates.
pub fn damping(
    reading: &Reading<'_>,
    rates: &Rates<'_>,
    dimension: usize,
) -> Read<(Arc<dyn Damping>, Vec<Friction>)> {
    let none = Constant::new(0.0).unwrap_or_else(|error| unreachable!("{error}"));
    let Some(table) = &reading.file.damping else { return Ok((Arc::new(none), Vec::new())) };
    if let (Some(place), Some(_)) = (&table.temperature, &reading.file.system.name) {
        let message = "a `temperature` is for formulas; a lattice has it as a parameter";
        return Err(reading.source.error(place.span(), message));
    }
    if let (Some(rate), []) = (&table.rate, &rates[..]) {
        return Ok((of_rate(reading, rate)?, Vec::new()));
    }
    // Rates that are the same are one friction.
    let mut groups: Vec<(&At<Text>, Vec<usize>)> = Vec::new();
    for (i, rate) in rates {
        match groups.iter_mut().find(|(known, _)| known.0 == rate.0) {
            Some((_, all)) => all.push(*i),
            None => groups.push((rate, vec![*i])),
        }
    }
    match groups[..] {
        [(rate, ref all)] if all.len() == dimension => Ok((of_rate(reading, rate)?, Vec::new())),
        _ => {
            let friction = groups.into_iter().map(|(rate, components)| {
                Ok(Friction { damping: of_rate(reading, rate)?, components })
            });
            Ok((Arc::new(none), friction.collect::<Read<_>>()?))
        }
    }
}

/// The Hamiltonians of the noises of a heat bath with a temperature, for friction on momenta: with
/// dpᵢ = … − γᵢpᵢdt, H₀ = pᵢ²/2mᵢ + … and its coordinate q, √(2γᵢmᵢkT)q.
pub fn bath(
    reading: &Reading<'_>,
    definition: &Definition,
    rates: &Rates<'_>,
    temperature: &At<Text>,
) -> Read<Vec<String>> {
    let Reading { source, file, settings, .. } = reading;
    let wrong = |message: String| source.error(temperature.span(), message);
    if let Some(noises) = &file.system.noises {
        let message = "the noise follows from the `temperature`: leave out `H`";
        return Err(source.error(noises.span(), message));
    }
    if rates.is_empty() {
        let message = "a temperature needs friction on momenta: `components` or `rates`";
        return Err(wrong(message.into()));
    }
    // With the components as Hamiltonians of noises, these have the columns of B.
    let columns = Definition { noises: definition.state.clone(), ..definition.clone() };
    let y0 = &settings.initial;
    // What is wrong with the definition is told without noises.
    let Ok(system) = FormulaSystem::new(&columns, y0) else { return Ok(Vec::new()) };
    let none = Constant::new(0.0).unwrap_or_else(|error| unreachable!("{error}"));
    let problem = Problem::new(Arc::new(system), Arc::new(none), y0.clone(), settings.until);
    let Ok(problem) = problem else { return Ok(Vec::new()) };
    let of = mc::Problem::at_run_time(&problem);
    let noise = |(i, rate): &(usize, &At<Text>)| {
        let name = &definition.state[*i];
        let b: Vec<f64> =
            (of.coefficients)(0.0, y0).noises.iter().map(|column| column[*i]).collect();
        let mut others = (0..b.len()).filter(|&j| b[j] != 0.0);
        let (Some(q), None) = (others.next(), others.next()) else {
            let message = format!("`{name}` is no momentum: write its noise as `H`");
            return Err(wrong(message));
        };
        // dq = −b ∂H₀/∂p dt with ∂H₀/∂p = p/m.
        let slope = |by: f64| {
            let mut y = y0.clone();
            y[*i] += by;
            -(of.coefficients)(0.0, &y).drift[q] / b[q]
        };
        let inverse = [0.5, 1.0, 2.0].map(|by| (slope(by) - slope(-by)) / (2.0 * by));
        let m = 1.0 / inverse[0];
        if !(m > 0.0 && inverse.iter().all(|one| (one * m - 1.0).abs() <= 1e-9)) {
            let message = format!("H0 has no term {name}^2/(2*m): write the noise as `H`");
            return Err(wrong(message));
        }
        let (rate, kt, factor) = (&rate.0, &temperature.0, m / (b[q] * b[q]));
        Ok(format!("sqrt(2*({rate})*({kt})*{factor:?})*{}", definition.state[q]))
    };
    rates.iter().map(noise).collect()
}

/// The damping of a rate.
fn of_rate(reading: &Reading<'_>, rate: &At<Text>) -> Read<Arc<dyn Damping>> {
    let Reading { source, constants, settings, .. } = reading;
    let mut names = constants.names.clone();
    names.variable("t").map_err(|error| source.error(rate.span(), error))?;
    let formula = Formula::parse(&rate.0, &names);
    let formula = formula.map_err(|error| source.formula_error(rate, &error))?;
    for t in [0.0, settings.until] {
        if let Some(error) = formula.explain(&[t]) {
            let message = format!("{} at t = {t}", error.message);
            return Err(source.error_in(rate, &error, message));
        }
    }
    Ok(match formula.depends_on(0) {
        true => Arc::new(FormulaDamping::new(formula)),
        false => {
            Arc::new(Constant::new(formula.value(&[0.0])).unwrap_or_else(|e| unreachable!("{e}")))
        }
    })
}
