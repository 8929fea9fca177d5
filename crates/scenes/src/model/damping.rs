//! The damping of a scene: of all components, or friction on some.

use std::sync::Arc;

use casimir::{
    formula::{FormulaDamping, nearest},
    mc::Friction,
    systems::{Constant, Damping, probe::rate_integrals},
};
use indexmap::IndexMap;
use keys::*;

/// The components with a rate, where each is damped alone: the text of the rate, and the damping.
pub type Rates<'a> = Vec<(usize, &'a str, Arc<dyn Damping>)>;

/// Vectors of the state: their names and those of their components.
pub type Vectors = [(String, Vec<String>)];

/// The rates of components from those of components and vectors by name.
pub fn rates<'a>(
    reading: &Reading,
    given: impl IntoIterator<Item = (&'a Name, &'a At<Text>)>,
    components: &[String],
    vectors: &Vectors,
) -> Read<Rates<'a>> {
    let mut rates = Rates::new();
    for (name, rate) in given {
        let damping = of_rate(reading, rate, components)?;
        let vector = vectors.iter().find(|(vector, _)| vector == name.as_str());
        let named = vector.map_or(std::slice::from_ref(&**name), |(_, of)| of);
        for one in named {
            let Some(i) = components.iter().position(|known| known == one) else {
                refuse!(name, "`{one}` is no component{}", nearest(one, components));
            };
            if rates.iter().any(|(known, ..)| *known == i) {
                refuse!(name, "`{one}` is damped twice");
            }
            rates.push((i, &rate.0, Arc::clone(&damping)));
        }
    }
    Ok(rates)
}

/// The damping of all components, or friction on some. `vectors` are those of the state.
pub fn damping(
    reading: &Reading,
    components: &[String],
    vectors: &Vectors,
) -> Read<(Arc<dyn Damping>, Vec<Friction>)> {
    let table = reading.file.damping.as_ref();
    let (mut of_all, mut given) = (None, Vec::new());
    if let Some(DampingTable { rate, components, rates }) = table {
        match (rate, components, rates.is_empty()) {
            (Some(rate), None, true) => of_all = Some(rate),
            (Some(rate), Some(named), true) => given.extend(named.iter().map(|name| (name, rate))),
            (None, None, false) => given.extend(rates),
            _ => refuse!(
                place(rate).or_else(|| Some(rates.keys().next()?.span())),
                "[damping] has a `rate`, of all or of some `components`, or `rates` such as \
                 {{ p1 = \"g1\" }}"
            ),
        }
    }
    given.extend(reading.file.bath.iter().flat_map(|bath| &bath.friction));
    // Rates that are the same are one friction.
    let mut groups = IndexMap::<&str, Friction>::new();
    for (i, rate, damping) in rates(reading, given, components, vectors)? {
        let new = Friction { damping, components: Vec::new() };
        groups.entry(rate).or_insert(new).components.push(i);
    }
    let friction: Vec<Friction> = groups.into_values().collect();
    match &friction[..] {
        [Friction { damping, components: all }]
            if all.len() == components.len() && table.is_some() =>
        {
            Ok((damping.clone(), Vec::new()))
        }
        _ => Ok((
            of_all.map_or(Ok(constant(0.0)), |rate| of_rate(reading, rate, components))?,
            friction,
        )),
    }
}

/// Parts of [0, T] on which a rate is integrated before a run.
const PARTS: u32 = 64;

/// The damping of a rate of some of the components.
pub fn of_rate(
    reading: &Reading,
    rate: &At<Text>,
    components: &[String],
) -> Read<Arc<dyn Damping>> {
    let Reading { constants, settings, .. } = reading;
    let mut names = constants.names.clone();
    // No parameter has this name.
    _ = names.variable("t");
    let components: Vec<_> = components.iter().map(String::as_str).collect();
    let formula = rate.formula(&names).map_err(|wrong| {
        wrong.instead(
            &components,
            "a rate or temperature depends on t and parameters alone; friction by the state is \
             a part of `drift`",
        )
    })?;
    for t in [0.0, settings.until] {
        rate.demand_value(&formula, &[t], format_args!("t = {t}"))?;
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
