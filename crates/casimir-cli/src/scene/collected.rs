//! What paths collect: the time, integrals, averages and events.

use std::{slice::from_ref, sync::Arc};

use casimir::{
    formula::{Formula, Names},
    mc::{Along, Gradient, Passage},
    real::{Row, WIDTH},
};

use super::{
    observe::{Observable, Quantity, Vocabulary},
    source::{Read, Source},
    values::{At, Event, Text},
};

/// The observable of a formula: `integral(v)`, `average(v)`, or a function of the state.
pub fn observable(source: &Source, text: &At<Text>, vocabulary: &mut Vocabulary) -> Read<Quantity> {
    let of = |word: &str| -> Option<At<Text>> {
        let inner =
            text.0.trim().strip_prefix(word)?.trim_start().strip_prefix('(')?.strip_suffix(')')?;
        let mut depth = 0;
        let closes = |c: char| {
            depth += i32::from(c == '(') - i32::from(c == ')');
            depth < 0
        };
        (!inner.chars().any(closes)).then(|| At::new(text.span(), Text(inner.into())))
    };
    let (integral, average) = (of("integral"), of("average"));
    let is_average = average.is_some();
    let Some(inner) = integral.or(average) else { return vocabulary.quantity(source, text) };
    let v = vocabulary.quantity(source, &inner)?;
    let function = Arc::new(Observable::new("", v.clone()));
    let [row] = vocabulary.collect(Along::Integral(function), [0.0]);
    let integral = Quantity::Collected(row);
    if !is_average {
        return Ok(integral);
    }
    let time = vocabulary.known(source, 0)?;
    Ok(Quantity::AlongPath(Arc::new(move |y: &[Row], values: &mut Row| {
        let mut t = [0.0; WIDTH];
        time.evaluate(y, &mut t);
        if t[0] == 0.0 {
            return v.evaluate(y, values);
        }
        integral.evaluate(y, values);
        values.iter_mut().zip(t).for_each(|(value, t)| *value /= t);
    })))
}

/// Whether an event has happened, and when. A condition in `names`, components and parameters, is
/// followed within steps, too.
pub fn event(
    source: &Source,
    event: &At<Event>,
    names: Option<&Names>,
    vocabulary: &mut Vocabulary,
) -> Read<[Quantity; 2]> {
    let text = At::new(event.span(), event.0.when.clone());
    vocabulary.demand_condition(source, &text)?;
    let formula = names.and_then(|names| Formula::parse(&text.0, names).ok());
    let excess = formula.and_then(|formula| formula.excess());
    let (phi, gradient) = match excess {
        Some(excess) => {
            let tape = excess.gradient(&(0..excess.variables.len()).collect::<Vec<_>>());
            let gradient = move |y: &[Row], slope: &mut [Row]| {
                let mut scratch = vec![[0.0; WIDTH]; tape.scratch_rows()];
                tape.evaluate(from_ref(&y), slope, &mut scratch);
            };
            (excess.into(), Some(Arc::new(gradient) as Arc<Gradient>))
        }
        None => (vocabulary.quantity(source, &text)?, None),
    };
    let begun = f64::from(u8::from(vocabulary.at_start(&phi) > 0.0));
    let seen = if gradient.is_some() { Quantity::Collected } else { Quantity::Monitored };
    let phi = Arc::new(Observable::new("", phi));
    let passage = Passage { phi, gradient, stops: event.0.stop };
    Ok(vocabulary.collect(Along::Passage(passage), [begun, 0.0]).map(seen))
}
