//! Comparison of schemes: the cheapest one for an error.

use casimir::{
    analysis::{self, Candidates, CompareSettings},
    figures,
};

use crate::prelude::*;
use scenes::Set;

/// Error against cost of all schemes, and the cheapest one for an error of y(T).
#[cfg_attr(feature = "clap", derive(clap::Args))]
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Compare {
    /// The wanted root-mean-square error of y(T)
    #[cfg_attr(
        feature = "clap",
        arg(long, allow_negative_numbers = true, default_value_t = Compare::default().error)
    )]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub error: f64,
    /// Seconds that it may take
    #[cfg_attr(feature = "clap", arg(
        long,
        value_name = "SECONDS",
        allow_negative_numbers = true,
        default_value_t = Compare::default().budget
    ))]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub budget: f64,
    /// A parameter of the scene: NAME=VALUE
    #[cfg_attr(feature = "clap", arg(long = "set", value_name = "NAME=VALUE"))]
    #[serde(skip)]
    pub sets: Vec<Set>,
    /// Seed of the random numbers, instead of that of the scene
    #[cfg_attr(feature = "clap", arg(long))]
    #[serde(skip)]
    pub seed: Option<u64>,
}

impl Default for Compare {
    fn default() -> Self {
        Self { error: 1e-3, budget: 60.0, sets: Vec::new(), seed: None }
    }
}

impl Verb for Compare {
    const NAME: &'static str = "compare";
    const STORES: Stores = Stores::Measurements;

    fn changes(&self) -> Changes {
        Changes {
            scheme: SchemeAndSeed { scheme: None, seed: self.seed, sets: self.sets.clone() },
            ..Changes::default()
        }
    }

    fn meaning(&self) -> String {
        format!("error = {}\n", self.error)
    }

    fn compute(&self, scene: &Scene, store: &Store<'_>, watch: &Watch) -> Done<Found> {
        let (&Self { error, budget, .. }, settings) = (self, &scene.settings);
        let start = Instant::now();
        let (auto, because) = scene.model.recommended();
        let wanted = CompareSettings {
            budget_s: (budget - start.elapsed().as_secs_f64()).max(0.5 * budget),
            stop: watch.stop.clone(),
            job: store.job().cloned(),
            ..CompareSettings::new(error, settings.truncation, settings.key)
        };
        let candidates = Candidates::built_in(|id| scene.model.scheme(id))
            .map_err(|error| refused(scene, error))?;
        let comparison =
            watch.under(&format!("errors and times of all schemes, {budget} s at most"), 0, |_| {
                analysis::compare(&scene.problem(), &candidates, &wanted, &|least, left_s| {
                    watch.progress.message(&format!(
                        "error {least:.1e} so far, {error:.1e} wanted, {left_s:.0} s left at most"
                    ));
                })
            });
        watch.check()?;
        let comparison = comparison.map_err(|error| refused(scene, error))?;
        let rule = match comparison.recommended() {
            Some(scheme) if scheme == auto => format!("`auto` takes {auto}, too"),
            _ => format!(
                "`auto` takes {auto} for long times: {because}.\nThe table ranks by processor time for \
                 this error at T = {}, on this machine",
                settings.until
            ),
        };
        let caption = "Errors of all schemes against their cost.";
        let figure = Figure::new("compare", figures::comparison(&comparison), caption);
        let text = format!("{comparison}\n{rule}.\n");
        Ok(Found::of(scene, [], &text, json!(comparison), vec![figure]))
    }
}
