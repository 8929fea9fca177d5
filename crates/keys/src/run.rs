//! Settings of a simulation, from a scene and a command line.

use std::{ops::Range, str::FromStr};

use casimir::{
    mc::Initial,
    noise::{StreamKey, Truncation},
};
use serde::{Deserialize, Serialize};

use crate::{
    At, Constants, Count, Listed, Read, SceneFile, Source, Values, initial::initial, place, refuse,
};

/// Changes that a command line makes in a scene.
#[cfg_attr(feature = "clap", derive(clap::Args))]
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Changes {
    /// Number of paths, instead of that of the scene; 1e6 is a number
    #[cfg_attr(feature = "clap", arg(long, value_name = "N", value_parser = super::count))]
    pub paths: Option<u64>,
    /// Number of steps, instead of that of the scene
    #[cfg_attr(feature = "clap", arg(long, value_name = "N", value_parser = super::count))]
    pub steps: Option<u64>,
    /// Half-width of 95 % intervals, instead of that of the scene.
    #[cfg_attr(feature = "clap", arg(skip))]
    #[serde(skip)]
    pub accuracy: Option<f64>,
    /// Test functions, instead of those of the scene.
    #[cfg_attr(feature = "clap", arg(skip))]
    #[serde(skip_deserializing, skip_serializing_if = "Vec::is_empty")]
    pub of: Vec<String>,
    /// Parameters of derivatives, instead of those of the scene.
    #[cfg_attr(feature = "clap", arg(skip))]
    #[serde(skip_deserializing, skip_serializing_if = "Vec::is_empty")]
    pub gradient: Vec<String>,
    /// Draw other random numbers for each combination of a sweep, not the same for all
    #[cfg_attr(feature = "clap", arg(long))]
    #[serde(default)]
    pub independent: bool,
    /// Scheme and seed.
    #[cfg_attr(feature = "clap", command(flatten))]
    #[serde(flatten)]
    pub scheme: SchemeAndSeed,
}

/// Changes that every sampling command accepts.
#[cfg_attr(feature = "clap", derive(clap::Args))]
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct SchemeAndSeed {
    /// The scheme, instead of that of the scene: auto, sexp, sexp-li, heun, …
    #[cfg_attr(feature = "clap", arg(long, value_name = "NAME"))]
    pub scheme: Option<String>,
    /// Seed of the random numbers, instead of that of the scene
    #[cfg_attr(feature = "clap", arg(
        long,
        value_name = "N",
        allow_negative_numbers = true,
        value_parser = super::seed
    ))]
    pub seed: Option<u64>,
    /// A parameter of the scene, with one value or several: a=0.1,0.2 or a=0:1:11
    #[cfg_attr(feature = "clap", arg(long = "set", value_name = "NAME=VALUE"))]
    #[serde(default)]
    pub sets: Vec<Set>,
}

/// `--set NAME=VALUES`: the values of a parameter, instead of those of the scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Set {
    /// The parameter.
    pub name: String,
    /// Values as they are written.
    pub values: Vec<String>,
}

impl Set {
    /// One value of a parameter.
    pub fn of(name: &str, value: f64) -> Self {
        Self { name: name.into(), values: vec![format!("{value:?}")] }
    }
}

impl FromStr for Set {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (name, values) = text.split_once('=').ok_or_else(|| {
            format!("`{text}` has no value: write NAME=VALUE, or NAME=0.1,0.2,0.5")
        })?;
        let Values(values) = Values::new(values)?;
        Ok(Self { name: name.trim().into(), values })
    }
}

/// Checked settings of a run.
#[derive(Clone)]
pub struct Settings {
    /// Initial value as it is written; a possible one if initial values are random.
    pub initial: At<Vec<f64>>,
    /// Random initial values.
    pub random: Option<Initial<'static>>,
    /// Name of the file of states, if there is one.
    pub states: Option<String>,
    /// The final time.
    pub until: f64,
    /// Number of steps.
    pub steps: u64,
    /// The scheme, or `auto`.
    pub scheme: String,
    /// Number of paths.
    pub paths: u64,
    /// Number of paths whose tables are kept.
    pub tables: u64,
    /// Number of saved times.
    pub times: u64,
    /// Number of snapshots of a large lattice after the start.
    pub snapshots: u64,
    /// Whether a few paths of a large lattice are computed one by one, as `run` does.
    pub one_by_one: bool,
    /// Key of the random streams.
    pub key: StreamKey,
    /// Truncation of the increments.
    pub truncation: Truncation,
    /// Place of the steps, in bytes of the text.
    pub steps_place: Range<usize>,
    /// Place of the scheme, unless the command line chooses it.
    pub scheme_place: Option<Range<usize>>,
}

/// The scheme that `inspect` recommends.
pub const AUTO: &str = "auto";

/// Least number of paths for statistics; those of fewer say little.
pub const FEW_PATHS: u64 = 100;
/// Default number of tables that are stored beside statistics.
const TABLES: u64 = 3;
/// Largest number of saved times for which a divisor is searched.
const MAX_TRIED: u64 = 1_000_000;
/// Default limit of the number of saved times.
const TIMES: u64 = 200;

impl Settings {
    /// The settings of a scene, with the changes of a command line.
    pub fn new(
        source: &Source,
        SceneFile { run, system, .. }: &SceneFile,
        constants: &Constants,
        changes: &Changes,
        one_by_one: bool,
    ) -> Read<Self> {
        let SchemeAndSeed { scheme: changed, seed, .. } = changes.scheme.clone();
        let own = run.seed.as_ref().map_or(1, |seed| seed.0);
        let key = StreamKey { seed: seed.unwrap_or(own), experiment: 0 };
        // Initial values of sites of a lattice may depend on their places.
        let has_places = system.name.as_ref().is_some_and(|name| **name == "spin-lattice");
        let (initial, random) = initial(source, &run.initial, constants, key, has_places)?;
        let until = constants.value(&run.until)?;
        if until <= 0.0 {
            refuse!(&run.until, "the final time must be positive, got {until}");
        }
        let number =
            |count: &Option<At<Count>>, otherwise| count.as_ref().map_or(otherwise, |n| n.0);
        let steps = changes.steps.unwrap_or(run.steps.0);
        let paths = changes.paths.unwrap_or(number(&run.paths, 1));
        let divisor = |most: u64| {
            let mut down = (1..=most.min(steps)).rev();
            down.find(|times| steps.is_multiple_of(*times)).unwrap_or(1)
        };
        let times = match &run.times {
            Some(times) if steps.is_multiple_of(times.0) => times.0,
            Some(times) if changes.steps.is_none() => {
                let (given, near) = (times.0, divisor(times.0.min(MAX_TRIED)));
                refuse!(times, "{given} times do not divide {steps} steps: take {near}");
            }
            // Or the steps were changed on the command line.
            _ => divisor(TIMES),
        };
        let snapshots = number(&run.snapshots, 1);
        if !times.is_multiple_of(snapshots) {
            refuse!(place(&run.snapshots), "{snapshots} snapshots do not divide {times} times");
        }
        let tables = if paths < FEW_PATHS { paths } else { number(&run.tables, TABLES).min(paths) };
        let order = number(&run.truncation, 4);
        let Some(truncation) = u32::try_from(order).ok().and_then(|k| Truncation::new(k).ok())
        else {
            refuse!(place(&run.truncation), "the order must be below 2^32, got {order}");
        };
        // Nobody asked for clipped increments that show in the results.
        let truncation = if run.truncation.is_none() { truncation.wide() } else { truncation };
        Ok(Self {
            initial: At::new(run.initial.span(), initial),
            random,
            states: match &*run.initial {
                Listed::Text(file) => Some(file.clone()),
                Listed::List(_) => None,
            },
            until,
            steps,
            paths,
            tables,
            times,
            one_by_one,
            snapshots,
            key,
            truncation,
            steps_place: run.steps.span(),
            scheme_place: run.scheme.as_ref().filter(|_| changed.is_none()).map(At::span),
            scheme: changed.or(run.scheme.as_deref().cloned()).unwrap_or(AUTO.into()),
        })
    }

    /// Whether statistics are computed.
    pub fn is_study(&self) -> bool {
        self.paths >= FEW_PATHS
    }
}
