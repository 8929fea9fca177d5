//! How a scene is simulated.

use casimir::{
    mc::Setup,
    noise::{StreamKey, Truncation},
};
use clap::Args;
use toml::Spanned;

use super::{
    file::RunTable,
    or,
    read::Constants,
    source::{Read, SceneError, Source},
    values::Count,
};

/// What a command line changes in a scene.
#[derive(Args, Clone, Debug, Default)]
pub struct Changes {
    /// Number of paths, instead of that of the scene; 1e6 is a number
    #[arg(long, value_name = "N", value_parser = count)]
    pub paths: Option<u64>,
    /// Number of steps, instead of that of the scene
    #[arg(long, value_name = "N", value_parser = count)]
    pub steps: Option<u64>,
    /// Scheme and seed.
    #[command(flatten)]
    pub scheme: SchemeAndSeed,
}

/// What every command that samples may change.
#[derive(Args, Clone, Debug, Default)]
pub struct SchemeAndSeed {
    /// The scheme, instead of that of the scene: auto, sexp, sexp-li, heun, …
    #[arg(long, value_name = "NAME")]
    pub scheme: Option<String>,
    /// Seed of the random numbers, instead of that of the scene
    #[arg(long, value_name = "N")]
    pub seed: Option<u64>,
}

impl From<&SchemeAndSeed> for Changes {
    fn from(scheme: &SchemeAndSeed) -> Self {
        Self { scheme: scheme.clone(), ..Self::default() }
    }
}

/// A whole number from a command line.
pub fn count(text: &str) -> Result<u64, String> {
    let wrong = || format!("`{text}` is not a whole number of at least 1, such as 1000 or 1e6");
    if let Ok(number) = text.parse::<u64>() {
        return if number > 0 { Ok(number) } else { Err(wrong()) };
    }
    let number: f64 = text.parse().map_err(|_| wrong())?;
    let whole = number.fract() == 0.0 && (1.0..=9e15).contains(&number);
    if whole { Ok(number as u64) } else { Err(wrong()) }
}

/// Checked settings of a run.
#[derive(Clone, Debug)]
pub struct Settings {
    /// The initial value as it is written.
    pub initial: Vec<f64>,
    /// The final time.
    pub until: f64,
    /// Number of steps.
    pub steps: u64,
    /// Steps of the coarsest level of expectations, if the command line says it.
    pub coarsest_steps: Option<u64>,
    /// The scheme, or `auto`.
    pub scheme: String,
    /// Number of paths.
    pub paths: u64,
    /// Number of paths whose tables are kept.
    pub tables: u64,
    /// Number of saved times.
    pub times: u64,
    /// The streams.
    pub key: StreamKey,
    /// The truncation.
    pub truncation: Truncation,
    places: Places,
}

/// Where the settings stand, in bytes of the text.
#[derive(Clone, Debug)]
struct Places {
    initial: std::ops::Range<usize>,
    steps: std::ops::Range<usize>,
    scheme: Option<std::ops::Range<usize>>,
}

/// The scheme that `inspect` recommends.
pub const AUTO: &str = "auto";

/// Statistics of fewer paths say little.
pub const FEW_PATHS: u64 = 100;
/// Tables that are kept beside statistics.
const TABLES: u64 = 3;
/// Most saved times unless the scene says otherwise.
const TIMES: u64 = 200;

impl Settings {
    /// The settings of a scene, with the changes of a command line.
    pub fn new(
        source: &Source,
        run: &RunTable,
        constants: &Constants,
        changes: &Changes,
    ) -> Read<Self> {
        let initial = run.initial.get_ref().iter().map(|text| constants.value(source, text));
        let initial = initial.collect::<Read<Vec<f64>>>()?;
        let until = constants.value(source, &run.until)?;
        if until <= 0.0 {
            let message = format!("the final time must be positive, got {until}");
            return Err(source.error(run.until.span(), message));
        }
        let number = |count: Option<&Spanned<Count>>, otherwise| or(count, Count(otherwise)).0;
        let steps = changes.steps.unwrap_or(run.steps.get_ref().0);
        let paths = changes.paths.unwrap_or(number(run.paths.as_ref(), 1));
        let divides = |times: &u64| steps.is_multiple_of(*times);
        let default = (1..=TIMES.min(steps)).rev().find(divides).unwrap_or(1);
        let times = match &run.times {
            // The steps were changed on the command line.
            Some(times) if changes.steps.is_some() && !divides(&times.get_ref().0) => default,
            Some(times) if !divides(&times.get_ref().0) => {
                let given = times.get_ref().0;
                let near = (1..=given.min(steps)).rev().find(divides).unwrap_or(1);
                let message = format!("{given} times do not divide {steps} steps: take {near}");
                return Err(source.error(times.span(), message));
            }
            times => number(times.as_ref(), default),
        };
        let tables = match paths < FEW_PATHS {
            true => paths,
            false => number(run.tables.as_ref(), TABLES).min(paths),
        };
        let order = number(run.truncation.as_ref(), 4);
        let truncation = u32::try_from(order).ok().and_then(|order| Truncation::new(order).ok());
        // Nobody asked for clipped increments that show in the results.
        let truncation = match run.truncation {
            None => truncation.map(Truncation::wide),
            Some(_) => truncation,
        };
        let Some(truncation) = truncation else {
            let place = run.truncation.as_ref().map_or(0..0, Spanned::span);
            return Err(source.error(place, format!("the order must be below 2^32, got {order}")));
        };
        let scheme = run.scheme.as_ref().map(Spanned::get_ref).cloned();
        let SchemeAndSeed { scheme: changed, seed } = changes.scheme.clone();
        let keeps = changed.is_none();
        let scheme = changed.or(scheme).unwrap_or(AUTO.into());
        let places = Places {
            initial: run.initial.span(),
            steps: run.steps.span(),
            scheme: run.scheme.as_ref().filter(|_| keeps).map(Spanned::span),
        };
        let key = StreamKey { seed: seed.or(run.seed).unwrap_or(1), experiment: 0 };
        Ok(Self {
            initial,
            until,
            steps,
            coarsest_steps: changes.steps,
            scheme,
            paths,
            tables,
            times,
            key,
            truncation,
            places,
        })
    }

    /// An error about the initial value.
    pub fn initial_error(&self, source: &Source, message: impl std::fmt::Display) -> SceneError {
        source.error(self.places.initial.clone(), message)
    }

    /// An error about the steps.
    pub fn steps_error(&self, source: &Source, message: impl std::fmt::Display) -> SceneError {
        source.error(self.places.steps.clone(), message)
    }

    /// An error about the scheme.
    pub fn scheme_error(&self, source: &Source, message: impl std::fmt::Display) -> SceneError {
        match &self.places.scheme {
            Some(place) => source.error(place.clone(), message),
            None => source.error_of_all(message),
        }
    }

    /// Checks that a scheme can take these steps.
    pub fn check_steps(&self, source: &Source, setup: &Setup<'_>) -> Read<()> {
        let tau = self.until / self.steps as f64;
        if setup.scheme.clips_increments()
            && let Err(error) = self.truncation.bound(tau)
        {
            let least = self.until.floor() as u64 + 1;
            let scheme = setup.scheme.id();
            let message = format!(
                "{scheme} truncates increments: {error}. Take at least {least} steps, or leave out \
                 `truncation`"
            );
            return Err(self.steps_error(source, message));
        }
        Ok(())
    }

    /// Whether statistics are computed.
    pub fn is_study(&self) -> bool {
        self.paths >= FEW_PATHS
    }
}
