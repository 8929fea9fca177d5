//! Comparison of schemes: the cheapest one for an error.

use std::{sync::Arc, time::Instant};

use casimir::{
    analysis::{self, Candidates, CompareSettings},
    figures,
    mc::parts::Job,
};

use super::{Found, Watch};
use crate::{failure::Done, output::Figure};
use scenes::Scene;

/// Compares all schemes on a scene at a root-mean-square error of y(T), within seconds. Errors are
/// kept by a job if there is one.
pub fn compare(
    scene: &Scene,
    error: f64,
    budget: f64,
    job: Option<&Arc<Job>>,
    watch: &Watch,
) -> Done<Found> {
    let (settings, start) = (&scene.settings, Instant::now());
    // What a run takes, for other reasons.
    let (auto, because) = scene.model.recommended();
    let spent = start.elapsed().as_secs_f64();
    let wanted = CompareSettings {
        budget_s: (budget - spent).max(0.5 * budget),
        stop: watch.stop.clone(),
        job: job.cloned(),
        ..CompareSettings::new(error, settings.truncation, settings.key)
    };
    let candidates = Candidates::built_in(|id| scene.model.scheme(id))
        .map_err(|error| scene.source.error(None, error))?;
    let what = format!("errors and times of all schemes, {budget} s at most");
    let problem = scene.problem();
    let comparison = watch.under(&what, 0, |_| {
        let told = |least, left_s| {
            watch.progress.message(&format!(
                "error {least:.1e} so far, {error:.1e} wanted, {left_s:.0} s left at most"
            ));
        };
        analysis::compare(&problem, &candidates, &wanted, &told)
    });
    watch.check()?;
    let comparison = comparison.map_err(|error| scene.source.error(None, error))?;
    let rule = match comparison.recommended() {
        Some(scheme) if scheme == auto => format!("a run takes {auto}, too"),
        _ => format!(
            "a run takes {auto} by another rule, that of long times: {because}.\nHere the \
             processor time for this error at T = {}, on this machine, decides",
            settings.until
        ),
    };
    let caption = "Errors of all schemes against their cost.";
    let figure = Figure::new("compare", figures::comparison(&comparison), caption);
    let text = format!("{comparison}\n{rule}.\n");
    Ok(Found::of(scene, [], &text, serde_json::to_value(&comparison)?, vec![figure]))
}
