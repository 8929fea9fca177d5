//! Functions of the state that are of interest, and what paths collect for them: the time,
//! integrals, averages and events.

use std::{array::from_fn, slice::from_mut, sync::Arc};

use casimir::{
    formula::{Formula, Names, Tape},
    mc::{Along, Gradient, InTimeAt, Observe, Passage},
    real::{Bounded, PathMask, Row, Rows, WIDTH},
    systems::run_time::InTime,
};

use crate::{At, Event, Read, Text, refuse};

/// A function of the states of 32 paths; row i is component i.
pub type OfRows = dyn Fn(&[Row], &mut Row) + Send + Sync;

/// How a quantity depends on the state; of several that are joined the last one counts.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// Smoothly, as a formula or a function of the system such as its energy.
    Smooth,
    /// With `abs`, `min` or `max`.
    Kinked,
    /// With conditions, so that it may jump.
    Jumping,
    /// By what a path has collected.
    AlongPath,
    /// By what is observed at the ends of steps only: the error is of order √τ.
    Monitored,
}

/// A function of the state.
#[derive(Clone)]
pub enum Quantity {
    /// A component.
    Component(usize),
    /// A function of the state, and of what a path has collected in the rows after it.
    Function(Kind, Arc<OfRows>),
}

impl Quantity {
    /// A smooth function of the state.
    pub fn smooth(of: impl Fn(&[Row], &mut Row) + Send + Sync + 'static) -> Self {
        Self::Function(Kind::Smooth, Arc::new(of))
    }

    /// Writes the values on 32 paths.
    pub fn evaluate(&self, y: &[Row], values: &mut Row) {
        match self {
            Self::Component(row) => *values = y[*row],
            Self::Function(_, of) => of(y, values),
        }
    }

    /// How the quantity depends on the state.
    pub fn kind(&self) -> Kind {
        match self {
            Self::Component(_) => Kind::Smooth,
            Self::Function(kind, _) => *kind,
        }
    }

    /// Whether the quantity is a function of the state alone without jumps.
    pub fn is_continuous(&self) -> bool {
        self.kind() < Kind::Jumping
    }

    /// Whether the quantity is a function of the state alone.
    pub fn is_of_state(&self) -> bool {
        self.kind() < Kind::AlongPath
    }
}

/// A function of the state with its name.
#[derive(Clone)]
pub struct Observable {
    /// Name of the observable.
    pub name: String,
    /// Quantity that is observed.
    pub quantity: Quantity,
}

impl Observable {
    /// A quantity with a name.
    pub fn new(name: impl Into<String>, quantity: Quantity) -> Self {
        Self { name: name.into(), quantity }
    }
}

impl Observe for Observable {
    fn name(&self) -> &str {
        &self.name
    }

    fn evaluate(&self, y: &[Row], _: PathMask, values: &mut Row) {
        self.quantity.evaluate(y, values);
    }

    fn is_smooth(&self) -> Option<bool> {
        match self.quantity.kind() {
            Kind::Smooth => Some(true),
            Kind::Kinked | Kind::Jumping => None,
            Kind::AlongPath | Kind::Monitored => Some(false),
        }
    }

    fn weak_order(&self) -> f64 {
        if self.quantity.kind() == Kind::Monitored { 0.5 } else { 1.0 }
    }
}

/// Inputs that formulas of observables may use.
pub struct Vocabulary {
    /// The components of y and the parameters.
    names: Names,
    /// Further inputs after the components.
    further: Vec<Further>,
    /// Quantities that paths collect.
    pub collected: Vec<Along>,
    /// Formulas of the time that they integrate or follow.
    pub in_time: Vec<Arc<dyn InTimeAt>>,
    /// Row of the time, if paths collect it.
    time: Option<usize>,
    /// The initial value, and what paths have collected there.
    start: Vec<f64>,
    dimension: usize,
}

/// An input of formulas beside components and parameters.
#[derive(Clone)]
pub enum Further {
    /// A quantity that is known.
    Quantity(Quantity),
    /// The time, which paths collect if it is used.
    Time,
    /// The formula of H₀, which may depend on time.
    Energy(At<Text>),
}

impl Vocabulary {
    /// Vocabulary with components, parameters, `t`, and `H0` if there is one.
    pub fn new(names: Names, energy: Option<Further>, y0: &[f64]) -> Self {
        let mut vocabulary = Self {
            names,
            further: Vec::new(),
            collected: Vec::new(),
            in_time: Vec::new(),
            time: None,
            start: y0.to_vec(),
            dimension: y0.len(),
        };
        vocabulary.add("t", Further::Time);
        energy.into_iter().for_each(|energy| vocabulary.add("H0", energy));
        vocabulary
    }

    /// Adds an observable as an input, unless its name has a meaning already.
    pub fn know(&mut self, Observable { name, quantity }: &Observable) {
        self.add(name, Further::Quantity(quantity.clone()));
    }

    fn add(&mut self, name: &str, further: Further) {
        if self.names.variable(name).is_ok() {
            self.further.push(further);
        }
    }

    /// Makes paths collect `what`, whose rows have the values `at_start` at time zero.
    fn collect<const N: usize>(
        &mut self,
        kind: Kind,
        what: Along,
        at_start: [f64; N],
    ) -> [Quantity; N] {
        let first = self.start.len();
        self.start.extend(at_start);
        self.collected.push(what);
        from_fn(|k| {
            let number = move |y: &[Row], values: &mut Row| *values = y[first + k];
            Quantity::Function(kind, Arc::new(number))
        })
    }

    /// The quantity of a further input; the first is the time.
    fn known(&mut self, k: usize) -> Read<Quantity> {
        let quantity = self.of(self.further[k].clone())?;
        self.further[k] = Further::Quantity(quantity.clone());
        Ok(quantity)
    }

    /// Converts a further input to its quantity.
    pub fn of(&mut self, further: Further) -> Read<Quantity> {
        match further {
            Further::Quantity(quantity) => Ok(quantity),
            Further::Time => {
                self.time = Some(self.start.len());
                let [time] = self.collect(Kind::AlongPath, Along::Time, [0.0]);
                Ok(time)
            }
            Further::Energy(text) => self.quantity(&text),
        }
    }

    /// The value of a quantity at time zero.
    fn at_start(&self, quantity: &Quantity) -> f64 {
        let mut values = [0.0; WIDTH];
        quantity.evaluate(&Rows::splat(&self.start), &mut values);
        values[0]
    }

    /// Checks that a formula is a condition.
    pub fn demand_condition(&self, text: &At<Text>) -> Read<()> {
        if Formula::parse(&text.0, &self.names).is_ok_and(|formula| !formula.is_condition()) {
            refuse!(text, "a probability is that of a condition, such as \"x > 0\"");
        }
        Ok(())
    }

    /// The quantity of a formula, which must have a value at the initial value.
    pub fn quantity(&mut self, text: &At<Text>) -> Read<Quantity> {
        let formula = text.formula(&self.names)?;
        let (dimension, all) = (self.dimension, self.dimension + self.further.len());
        let used = self.used(&formula)?;
        let mut point = self.start[..dimension].to_vec();
        point.resize(all, 0.0);
        for (k, quantity) in &used {
            point[dimension + k] = self.at_start(quantity);
        }
        text.demand_value(&formula, &point, "the initial value")?;
        let tape = Tape::new(&formula.graph, &[formula.root], &[0..dimension, dimension..all]);
        let further = all - dimension;
        let own = if formula.has_conditions() {
            Kind::Jumping
        } else if formula.has_kinks() {
            Kind::Kinked
        } else {
            Kind::Smooth
        };
        let kind = used.iter().map(|(_, quantity)| quantity.kind()).fold(own, Kind::max);
        let function = Arc::new(move |y: &[Row], values: &mut Row| {
            let mut others = vec![[0.0; WIDTH]; further + tape.scratch_rows()];
            let (others, scratch) = others.split_at_mut(further);
            used.iter().for_each(|(k, quantity)| quantity.evaluate(y, &mut others[*k]));
            tape.evaluate(&[&y[..dimension], others], from_mut(values), scratch);
        });
        Ok(Quantity::Function(kind.min(Kind::AlongPath), function))
    }

    /// The further inputs that a formula reads.
    fn used(&mut self, formula: &Formula) -> Read<Vec<(usize, Quantity)>> {
        let dimension = self.dimension;
        let further = formula.reads().into_iter().filter_map(|k| k.checked_sub(dimension));
        further.map(|k| Ok((k, self.known(k)?))).collect()
    }

    /// Notes a formula that paths integrate or follow, if it changes with time.
    fn follow(&mut self, formula: Formula) -> Read<()> {
        let used = self.used(&formula)?;
        let (Some(time), false) = (self.time, used.iter().all(|(_, of)| of.is_of_state())) else {
            return Ok(());
        };
        let (start, dimension) = (self.start.clone(), self.dimension);
        self.in_time.push(Arc::new(Followed { formula, used, time, start, dimension }));
        Ok(())
    }

    /// The observable of a formula: `integral(v)`, `average(v)`, or a function of the state.
    pub fn observable(&mut self, text: &At<Text>) -> Read<Quantity> {
        let of = |word: &str| -> Option<At<Text>> {
            let inner = text
                .0
                .trim()
                .strip_prefix(word)?
                .trim_start()
                .strip_prefix('(')?
                .strip_suffix(')')?;
            let mut depth = 0;
            let closes = |c: char| {
                depth += i32::from(c == '(') - i32::from(c == ')');
                depth < 0
            };
            (!inner.chars().any(closes)).then(|| At::new(text.span(), Text(inner.into())))
        };
        let (integral, average) = (of("integral"), of("average"));
        let is_average = average.is_some();
        let Some(inner) = integral.or(average) else { return self.quantity(text) };
        let v = self.quantity(&inner)?;
        self.follow(inner.formula(&self.names)?)?;
        let along = Along::Integral(Arc::new(Observable::new("", v.clone())));
        let [integral] = self.collect(Kind::AlongPath, along, [0.0]);
        if !is_average {
            return Ok(integral);
        }
        let time = self.known(0)?;
        let average = move |y: &[Row], values: &mut Row| {
            let mut t = [0.0; WIDTH];
            time.evaluate(y, &mut t);
            if t[0] == 0.0 {
                return v.evaluate(y, values);
            }
            integral.evaluate(y, values);
            values.iter_mut().zip(t).for_each(|(value, t)| *value /= t);
        };
        Ok(Quantity::Function(Kind::AlongPath, Arc::new(average)))
    }

    /// Whether an event has happened, and when. A condition in `names`, components and parameters,
    /// is followed within steps, too.
    pub fn event(&mut self, event: &At<Event>, names: Option<&Names>) -> Read<[Quantity; 2]> {
        let text = At::new(event.span(), event.0.when.clone());
        self.demand_condition(&text)?;
        let formula = names.and_then(|names| Formula::parse(&text.0, names).ok());
        let excess = formula.and_then(|formula| formula.excess());
        let (kind, phi, gradient) = match excess {
            Some(excess) => {
                let inputs = excess.variables.len();
                let tape = excess.gradient(&(0..inputs).collect::<Vec<_>>());
                let gradient =
                    move |y: &[Row], slope: &mut [Row]| slope.copy_from_slice(&tape.rows(&[y]));
                let phi = Quantity::smooth(move |y, phi| *phi = excess.values(&y[..inputs]));
                (Kind::AlongPath, phi, Some(Arc::new(gradient) as Arc<Gradient>))
            }
            None => {
                let phi = self.quantity(&text)?;
                text.formula(&self.names)?.excess().map_or(Ok(()), |excess| self.follow(excess))?;
                (Kind::Monitored, phi, None)
            }
        };
        let begun = f64::from(u8::from(self.at_start(&phi) > 0.0));
        let phi = Arc::new(Observable::new("", phi));
        let passage = Passage { phi, gradient, stops: event.0.stop };
        Ok(self.collect(kind, Along::Passage(passage), [begun, 0.0]))
    }
}

/// A formula of the state, the time, and what is known of paths.
struct Followed {
    formula: Formula,
    used: Vec<(usize, Quantity)>,
    /// The initial value and what paths have collected there, with the row of the time.
    start: Vec<f64>,
    time: usize,
    dimension: usize,
}

impl InTimeAt for Followed {
    fn at(&self, y: &[f64]) -> Box<dyn InTime + '_> {
        let mut rows = Rows::splat(&self.start);
        y.iter().zip(&mut *rows).for_each(|(y, row)| *row = [*y; WIDTH]);
        Box::new(FollowedAt { of: self, rows })
    }
}

/// A formula at a state.
struct FollowedAt<'a> {
    of: &'a Followed,
    rows: Rows,
}

impl FollowedAt<'_> {
    /// The inputs of the formula at 32 times.
    fn inputs(&self, times: &Row) -> Vec<Row> {
        let Followed { formula, used, time, dimension, .. } = self.of;
        let mut rows = self.rows.clone();
        rows[*time] = *times;
        let mut inputs = rows[..*dimension].to_vec();
        inputs.resize(formula.variables.len(), [0.0; WIDTH]);
        for (k, quantity) in used {
            quantity.evaluate(&rows, &mut inputs[dimension + k]);
        }
        inputs
    }
}

impl InTime for FollowedAt<'_> {
    fn values(&self, times: &Row) -> Vec<Row> {
        vec![self.of.formula.values(&self.inputs(times))]
    }

    /// None if the formula reads what changes with time but the time.
    fn bounds(&self, time: Bounded) -> Vec<Bounded> {
        let Followed { formula, used, dimension, .. } = self.of;
        if used.iter().any(|(k, quantity)| *k > 0 && !quantity.is_of_state()) {
            return Vec::new();
        }
        let inputs = self.inputs(&[time.value; WIDTH]);
        let input = |k: usize| if k == *dimension { time } else { Bounded::exact(inputs[k][0]) };
        formula.graph.values(&[formula.root], input)
    }
}
