//! What paths collect: the time, integrals, averages and events.

use std::{slice::from_ref, sync::Arc};

use casimir::{
    formula::{Formula, Names, Tape},
    mc::{Along, Passage, variance_rate},
    real::{Row, WIDTH},
    systems::run_time::System,
};

use super::{
    observe::{Observable, Quantity, Vocabulary},
    source::{Read, Source},
    values::{At, Event, Text},
};

/// What a path collects.
#[derive(Clone)]
pub enum Collected {
    /// The time.
    Time,
    /// An integral or average over time.
    Mean(Kind, Quantity),
    /// An event.
    Passage(EventOf),
}

/// Which mean over time.
#[derive(Clone, Copy)]
pub enum Kind {
    /// ∫₀ᵗ v ds.
    Integral,
    /// (1/t)∫₀ᵗ v ds.
    Average,
}

impl Kind {
    /// The mean at time zero, where the function has this value.
    pub fn at_start(self, value: f64) -> f64 {
        match self {
            Self::Integral => 0.0,
            Self::Average => value,
        }
    }
}

/// The event that a function is positive.
#[derive(Clone)]
pub struct EventOf {
    /// The function.
    pub phi: Quantity,
    /// Its gradient; none if it is seen at the ends of steps only.
    pub gradient: Option<Arc<Tape>>,
    stops: bool,
}

/// The mean over time that a formula is, and the formula of what it is of: `integral(v)` or
/// `average(v)`.
pub fn of(text: &At<Text>) -> Option<(Kind, At<Text>)> {
    let trimmed = text.0.trim();
    let kinds = [("integral", Kind::Integral), ("average", Kind::Average)];
    kinds.iter().find_map(|&(word, kind)| {
        let inner =
            trimmed.strip_prefix(word)?.trim_start().strip_prefix('(')?.strip_suffix(')')?;
        let mut depth = 0;
        let closes = |c: char| {
            depth += i32::from(c == '(') - i32::from(c == ')');
            depth < 0
        };
        (!inner.chars().any(closes)).then(|| (kind, At::new(text.span(), Text(inner.into()))))
    })
}

/// An event. A condition in components and parameters is followed within steps, too.
pub fn passage(
    source: &Source,
    event: &At<Event>,
    names: &Names,
    vocabulary: &mut Vocabulary,
) -> Read<EventOf> {
    let (text, stops) = match &**event {
        Event::When(text) => (At::new(event.span(), text.clone()), false),
        Event::Table(table) => (table.when.clone(), table.stop),
    };
    vocabulary.demand_condition(source, &text)?;
    let formula = Formula::parse(&text.0, names).ok();
    match formula.and_then(|formula| formula.excess()) {
        Some(excess) => {
            let inputs = excess.variables.len();
            let gradient = excess.gradient(&(0..inputs).collect::<Vec<_>>());
            let gradient = Some(Arc::new(gradient));
            Ok(EventOf { phi: excess.into(), gradient, stops })
        }
        None => {
            let condition = vocabulary.quantity(source, &text)?;
            Ok(EventOf { phi: condition, gradient: None, stops })
        }
    }
}

impl Collected {
    /// The same for a driver.
    pub fn along<'a>(&self, system: &'a dyn System) -> Along<'a> {
        let function = |quantity: &Quantity| Arc::new(Observable::new("", quantity.clone()));
        match self {
            Self::Time => Along::Time,
            Self::Mean(Kind::Integral, quantity) => Along::Integral(function(quantity)),
            Self::Mean(Kind::Average, quantity) => Along::Average(function(quantity)),
            Self::Passage(EventOf { phi, gradient, stops }) => {
                let layout = &system.description().layout;
                let is_small = layout.rows == system.description().dimension
                    && layout.tile_rows >= layout.rows;
                let gradient = gradient.clone().filter(|_| is_small);
                let variance = gradient.map(|gradient| {
                    variance_rate(system, move |y: &[Row], slope: &mut [Row]| {
                        let mut scratch = vec![[0.0; WIDTH]; gradient.scratch_rows()];
                        gradient.evaluate(from_ref(&y), slope, &mut scratch);
                    })
                });
                Along::Passage(Passage { phi: function(phi), variance, stops: *stops })
            }
        }
    }
}
