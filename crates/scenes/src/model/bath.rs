//! The heat baths of a scene.

use std::{ops::Range, slice::from_mut};

use casimir::{
    formula::{Bath, Coordinate, Definition, FormulaSystem},
    inspect::facts::is_divergence_free,
    real::{Row, Rows},
    systems::{Linearity, run_time::System},
};
use keys::*;

use super::damping::{Rates, of_rate, rates};

/// Fractions of T at which the conditions of a bath are checked, at points around the initial
/// value.
const TIMES: [f64; 3] = [0.0, 0.37, 1.0];

/// The noises and the friction of one bath.
pub struct Share {
    /// Noises of the definition, by friction, and functions among those of all baths.
    noises: Range<usize>,
    functions: Range<usize>,
    /// The constant rates of its friction.
    friction: Vec<(usize, f64)>,
}

/// Adds heat baths to a definition: noises of friction on momenta, whose damping is exact, and
/// functions through which baths act otherwise.
pub fn baths(reading: &Reading, definition: &mut Definition) -> Read<Vec<Share>> {
    let Reading { file, settings, .. } = reading;
    let times = TIMES.map(|part| part * settings.until);
    let mut shares = Vec::new();
    for BathTable { temperature, through, friction, transverse } in file.bath.iter() {
        let kt = of_rate(reading, temperature, &definition.state)?;
        let is_least = |t: &f64| kt.rate(*t) < 0.0 || kt.rate(*t) == 0.0 && friction.is_empty();
        if let Some(t) = times.iter().find(|t| is_least(t)) {
            refuse!(temperature, "kT must be positive, got {} at t = {t}", kt.rate(*t));
        }
        if through.len() + friction.len() + transverse.len() == 0 {
            refuse!(
                temperature,
                "a bath acts by `friction` on momenta, `through` functions of the state, or \
                 `transverse` damping of spins"
            );
        }
        for (name, text) in friction {
            let rate = of_rate(reading, text, &definition.state)?;
            if let Some((t, rate)) = times.map(|t| (t, rate.rate(t))).iter().find(|at| at.1 < 0.0) {
                let name = name.as_str();
                refuse!(text, "friction of `{name}` must not be negative, got {rate} at t = {t}");
            }
        }
        let rates = rates(reading, friction, &definition.state, &definition.vectors)?;
        let noises = of_friction(reading, definition, &rates, temperature)?;
        let first = (definition.noises.len(), definition.baths.len());
        definition.noises.extend(noises);
        let texts = through.iter().map(|text| text.0.clone());
        let through = texts.chain(of_spins(reading, definition, transverse, temperature)?);
        let bath = |through| Bath { through, temperature: temperature.0.clone() };
        definition.baths.extend(through.map(bath));
        shares.push(Share {
            noises: first.0..definition.noises.len(),
            functions: first.1..definition.baths.len(),
            friction: rates.iter().map(|(i, _, damping)| (*i, damping.rate(0.0))).collect(),
        });
    }
    Ok(shares)
}

/// The heat that each of several baths gives to the system, if nothing changes with time: `heat1`,
/// …. `exact` are the functions of baths that became friction, the first of which has the noise
/// `first`.
pub fn heats(
    shares: &[Share],
    system: &FormulaSystem,
    (exact, first): (&[(usize, usize, f64)], usize),
) -> Vec<Observable> {
    if shares.len() < 2 || system.description().depends_on_time {
        return Vec::new();
    }
    let functions = shares.last().map_or(0, |share| share.functions.end);
    let mut others = system.description().noises - (functions - exact.len())..;
    let converted = |k| exact.iter().position(|(n, ..)| *n == k).map(|place| first + place);
    let place = |k| converted(k).or_else(|| others.next());
    let places: Vec<usize> = (0..functions).filter_map(place).collect();
    let heat = |(n, Share { noises, functions, friction }): (usize, &Share)| {
        let noises: Vec<usize> =
            noises.clone().chain(places[functions.clone()].iter().copied()).collect();
        let own = exact.iter().filter(|(k, ..)| functions.contains(k));
        let friction = friction.iter().copied().chain(own.map(|&(_, i, rate)| (i, rate)));
        let tape = system.heat(&noises, &friction.collect::<Vec<_>>());
        let d = system.description().dimension;
        let power = move |y: &[Row], values: &mut Row| {
            let mut scratch = Rows::zero(tape.scratch_rows());
            tape.evaluate(&[&y[..d]], from_mut(values), &mut scratch);
        };
        Observable::new(format!("heat{n}"), Quantity::smooth(power))
    };
    (1..).zip(shares).map(heat).collect()
}

/// √(2αkT/|s|)s for the components of spins s.
fn of_spins(
    reading: &Reading,
    Definition { state, vectors, .. }: &Definition,
    transverse: &Named<Text>,
    temperature: &At<Text>,
) -> Read<Vec<String>> {
    let mut through = Vec::new();
    for (name, alpha) in transverse {
        of_rate(reading, alpha, state)?;
        let spin = vectors.iter().find(|(vector, all)| vector == &**name && all.len() == 3);
        let Some((_, components)) = spin else {
            refuse!(name, "`{}` is no spin: a vector of three components, as s[xyz]", **name);
        };
        let values =
            components.iter().filter_map(|one| state.iter().position(|known| known == one));
        let y0 = &reading.settings.initial;
        let length = values.map(|i| y0[i] * y0[i]).sum::<f64>().sqrt();
        if length == 0.0 {
            refuse!(name, "the spin `{}` begins with length 0", **name);
        }
        let (alpha, kt) = (&alpha.0, &temperature.0);
        let phi = |one: &String| format!("sqrt(2*({alpha})*({kt})/{length:?})*{one}");
        through.extend(components.iter().map(phi));
    }
    Ok(through)
}

/// The Hamiltonians of the noises of a heat bath by friction on momenta: with
/// dpᵢ = … − γᵢpᵢdt, H₀ = pᵢ²/2mᵢ + … and its coordinate q, √(2γᵢmᵢkT)q.
///
/// e^{−H₀/kT} is stationary if fields B∇H have no divergence, B∇q is constant and acts on pᵢ alone,
/// and ∂H₀/∂pᵢ = pᵢ/mᵢ with a constant mᵢ. All this is looked at in the formulas, and what fails is
/// named.
fn of_friction(
    Reading { file, settings, .. }: &Reading,
    definition: &Definition,
    rates: &Rates,
    temperature: &At<Text>,
) -> Read<Vec<String>> {
    if rates.is_empty() {
        return Ok(Vec::new());
    }
    if let Some(noises) = &file.system.noises {
        refuse!(noises, "the noise of friction follows from the `temperature`: leave out `H`");
    }
    let y0 = &settings.initial;
    let free = Definition { noises: Vec::new(), baths: Vec::new(), ..definition.clone() };
    // What is wrong with the definition is told later.
    let Ok(system) = FormulaSystem::new(&free, y0) else { return Ok(Vec::new()) };
    let is_constant = system.description().linearity == Linearity::Constant;
    if !is_constant && !is_divergence_free(&system, y0) {
        refuse!(
            temperature,
            "fields B∇H have a divergence here: exp(-H0/kT) is not stationary, with any noise"
        );
    }
    let momenta: Vec<usize> = rates.iter().map(|(i, ..)| *i).collect();
    let noise = |(&(i, rate, _), found): (&(usize, &str, _), _)| {
        let (state, name) = (&definition.state, &definition.state[i]);
        let Some(Coordinate { component, mass }) = found else {
            refuse!(
                temperature,
                "`{name}` is not the momentum of one coordinate, with a constant entry of B: a bath \
                 acts on it `through` functions of the state, which keeps Casimirs"
            );
        };
        let q = &state[component];
        let what = match mass {
            Ok(mass) if mass > 0.0 => {
                let kt = &temperature.0;
                return Ok(format!("sqrt(2*({rate})*({kt})*{mass:?})*{q}"));
            }
            Err(Some(k)) => format!("∂H0/∂{name} depends on `{}`", state[k]),
            _ => format!("H0 has no term {name}^2/(2*m)"),
        };
        refuse!(
            temperature,
            "{what}: friction of a bath takes a constant mass m. Let it act `through` a function \
             such as sqrt(2*m*kT)*{q}, with any m"
        );
    };
    rates.iter().zip(system.coordinates(&momenta)).map(noise).collect()
}
