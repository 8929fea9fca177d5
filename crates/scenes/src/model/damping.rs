//! The damping of a scene: of all components, or friction on some.

use std::sync::Arc;

use casimir::{
    formula::{FormulaDamping, nearest},
    mc::Friction,
    systems::{Constant, Damping, probe::rate_integrals},
};

use crate::digits;
use crate::{At, Read, Reading, Text, Wrong, place, refuse};

/// The components with a rate, where each is damped alone.
pub type Rates<'a> = Vec<(usize, &'a At<Text>)>;

/// The rates of components, by `rates` or the friction of baths; none where one rate is that of
/// all. `vectors` are those of the state.
pub fn rates<'a>(
    reading: &Reading<'a>,
    components: &[String],
    vectors: &Vectors,
) -> Read<Rates<'a>> {
    let mut given: Vec<(&At<String>, &At<Text>)> = match &reading.file.damping {
        None => Vec::new(),
        Some(table) => match (&table.rate, &table.components, table.rates.is_empty()) {
            (Some(_), None, true) => Vec::new(),
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
        },
    };
    given.extend(reading.file.bath.iter().flat_map(|bath| &bath.friction));
    named_rates(reading, &given, components, vectors)
}

/// Vectors of the state: their names and those of their components.
pub type Vectors = [(String, Vec<String>)];

/// The rates of components from those of components and vectors by name.
pub fn named_rates<'a>(
    reading: &Reading<'a>,
    given: &[(&At<String>, &'a At<Text>)],
    components: &[String],
    vectors: &Vectors,
) -> Read<Rates<'a>> {
    let mut rates = Rates::new();
    for (name, rate) in given {
        of_rate(reading, rate)?;
        let vector = vectors.iter().find(|(vector, _)| vector == name.as_str());
        let named = vector.map_or(std::slice::from_ref(&***name), |(_, of)| of);
        for one in named {
            let Some(i) = components.iter().position(|known| known == one) else {
                let hint = nearest(one, components);
                refuse!(*name, "`{one}` is no component{hint}");
            };
            if rates.iter().any(|(known, _)| *known == i) {
                refuse!(*name, "`{one}` is damped twice");
            }
            rates.push((i, *rate));
        }
    }
    Ok(rates)
}

/// The damping of all components, or friction on some.
pub fn damping(
    reading: &Reading<'_>,
    components: &[String],
    vectors: &Vectors,
) -> Read<(Arc<dyn Damping>, Vec<Friction>)> {
    let rates = rates(reading, components, vectors)?;
    let of_all = reading.file.damping.as_ref().and_then(|table| match &table.components {
        None => table.rate.as_ref(),
        Some(_) => None,
    });
    let of_all = of_all.map_or_else(|| Ok(constant(0.0)), |rate| of_rate(reading, rate))?;
    // Rates that are the same are one friction.
    let mut groups: Vec<(&At<Text>, Vec<usize>)> = Vec::new();
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
        [one] if one.components.len() == components.len() && reading.file.damping.is_some() => {
            Ok((friction.swap_remove(0).damping, Vec::new()))
        }
        _ => Ok((of_all, friction)),
    }
}

/// Parts of [0, T] on which a rate is integrated before a run.
const PARTS: u32 = 64;

/// The damping of a rate.
pub fn of_rate(reading: &Reading<'_>, rate: &At<Text>) -> Read<Arc<dyn Damping>> {
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
pub fn constant(rate: f64) -> Arc<dyn Damping> {
    Arc::new(Constant::new(rate).expect("the rate is finite"))
}
