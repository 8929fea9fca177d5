//! The hard cases.

mod branch;
mod damping;
mod hamiltonians;
mod increments;
mod large_noise;
mod states;

use anyhow::Result;
use lab::streams;
use noise::StreamKey;
use serde::Serialize;
use systems::paper::{INERTIA, NOISE_INERTIA, rigid_body_start};
use systems::{Damping, RigidBody};

use crate::Arguments;
use crate::paths::Experiment;
use crate::results::{CaseResult, Row};

/// A family of hard inputs.
#[derive(Serialize)]
pub struct Case {
    /// Identifier.
    pub id: &'static str,
    /// The title.
    pub title: &'static str,
    /// System, damping, steps and noise.
    pub setup: &'static str,
    /// What exact mathematics says.
    pub mathematics: &'static str,
    /// What the measured figure is.
    pub quantity: &'static str,
    /// What is guaranteed, and why.
    pub guarantee: &'static str,
    /// What the settings vary.
    pub varied: &'static str,
    /// How the page plots the rows, if it does.
    #[serde(skip)]
    pub plot: Option<Plot>,
    /// Runs all schemes in all settings.
    #[serde(skip)]
    rows: fn(&Context) -> Rows,
}

/// The quantity of most cases.
const SQUARED_LENGTH: &str = "largest relative distance of |y|² from its law, before a path ends";

/// The figures of all schemes over the settings as numbers.
pub struct Plot {
    pub x_title: &'static str,
    /// What is outside of this range is drawn at its border.
    pub range: (f64, f64),
}

/// All families, in the order of the page and of their streams.
pub static CASES: [Case; 13] = [
    damping::STIFF,
    damping::ANTI,
    damping::ROUGH,
    large_noise::CASE,
    increments::EXTREME,
    increments::BIG_STEPS,
    states::SCALES,
    states::EQUILIBRIA,
    hamiltonians::NEAR_EQUAL,
    hamiltonians::SHARP,
    hamiltonians::STIFF,
    states::LOTKA_VOLTERRA,
    increments::NO_NOISE,
];

/// The guarantee of cases whose equations may have no solution.
const KEEPS_THE_LAW: &str = "`sexp` in all forms is on the law to rounding, or ends with a typed \
                             error. Nothing is guaranteed of the others.";

/// All schemes in all settings of a case.
type Rows = Result<Vec<Row>>;

/// What a case needs to run.
pub struct Context<'a> {
    pub key: StreamKey,
    arguments: &'a Arguments,
}

/// Runs the cases that are asked for.
pub fn run(arguments: &Arguments) -> Result<Vec<CaseResult>> {
    let numbered = CASES.iter().zip(streams::HARD_CASES..);
    let wanted = numbered.filter(|(case, _)| arguments.wants(case.id));
    let results = wanted.map(|(case, experiment)| {
        let key = StreamKey { seed: arguments.seed, experiment };
        Ok(CaseResult { case, rows: (case.rows)(&Context { key, arguments })? })
    });
    results.collect()
}

/// The paper's rigid body with three noises, with any damping and steps.
fn body<G: Damping>(
    context: &Context,
    damping: G,
    steps: (u64, f64),
) -> Result<Experiment<RigidBody<3>, G, 3, 3>> {
    let body = RigidBody::three_noises(INERTIA, NOISE_INERTIA)?;
    Experiment::new(context, (body, damping), rigid_body_start(), steps)
}

/// The rows of every setting.
fn each<T>(settings: impl IntoIterator<Item = T>, rows: impl FnMut(T) -> Rows) -> Rows {
    let rows: Vec<Vec<Row>> = settings.into_iter().map(rows).collect::<Result<_>>()?;
    Ok(rows.into_iter().flatten().collect())
}
