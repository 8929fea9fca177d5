//! Step errors in words.

use casimir::{
    mc::study::StudyResult,
    verify::{STIFF, StepCheck, StepError, StepErrors, TURN},
};

use super::digits;
use crate::scene::Scene;

/// What is known of the step errors of the mean and of the deviation of an observable that a study
/// shows with the half-width of its interval.
pub fn step_errors(check: &StepCheck, study: &StudyResult, name: &str) -> Option<[StepError; 2]> {
    let errors = check.observables.iter().find(|errors| errors.observable == name)?;
    let interval = study.series(name)?.last().mean_interval;
    // Without an interval a step error is compared with the spread alone.
    let sampling = interval.map_or(0.0, |(lo, hi)| 0.5 * (hi - lo));
    let spread = errors.deviation.value;
    Some([errors.mean, errors.deviation].map(|of| check.step_error(of, sampling, spread)))
}

/// The cell of a table: that of the mean, and in brackets that of the deviation.
pub fn step_cell(errors: Option<[StepError; 2]>) -> String {
    let word = |error| match error {
        StepError::Fine(_) => None,
        StepError::About(size) => Some(rough(size)),
        StepError::Below(size) => Some(format!("< {}", rough(size))),
        StepError::CannotTell => Some("?".into()),
    };
    match errors.map(|errors| errors.map(word)) {
        None => "–".into(),
        Some([None, None]) => "small".into(),
        Some([mean, deviation]) => {
            let mean = mean.unwrap_or("small".into());
            mean + &deviation.map_or(String::new(), |deviation| format!(" ({deviation})"))
        }
    }
}

/// A step error of this part of a value leaves no digit of it.
const NO_DIGIT: f64 = 0.5;

/// The step errors that a reader must know of, the worst first.
pub fn step_lines(check: &StepCheck, study: Option<&StudyResult>, scene: &Scene) -> Vec<String> {
    let (mut worst, mut seen, mut hidden) = (Vec::new(), Vec::new(), Vec::new());
    for errors in &check.observables {
        let StepErrors { observable, mean, deviation, along_paths } = errors;
        let Some(study) = study else {
            // Of single paths the difference itself is shown.
            let size = mean.value.hypot(deviation.value);
            let along = 2.0 * along_paths;
            match along <= 0.01 * size {
                true => {}
                false if along <= NO_DIGIT * size => seen.push(share(observable, along, size)),
                false => worst.push(observable.clone()),
            }
            continue;
        };
        let Some(found) = step_errors(check, study, observable) else { continue };
        let spread = deviation.value.abs();
        let sizes = [mean.value.abs().max(spread), spread];
        for ((error, size), what) in found.into_iter().zip(sizes).zip(["", "the deviation of "]) {
            let name = format!("{what}{observable}");
            match error {
                StepError::About(error) if error > NO_DIGIT * size => worst.push(name),
                StepError::About(error) => seen.push(share(&name, error, size)),
                StepError::CannotTell => hidden.push(name),
                StepError::Fine(_) | StepError::Below(_) => {}
            }
        }
    }
    let steps = scene.settings.steps;
    let mut lines = Vec::new();
    let at_half = format!("{} paths with half the step", check.paths);
    if check.damping > STIFF {
        lines.push(format!(
            "the damping of a step is exp(-{}): what happens within a step is not resolved, take \
             more than {} steps",
            digits(Some(check.damping)),
            digits(Some((steps as f64 * check.damping).ceil()))
        ));
    }
    if check.turn > TURN {
        lines.push(format!(
            "the fastest motion turns by {} radians in a step, which is not resolved: take more than \
             {} steps",
            rough(check.turn),
            digits(Some((steps as f64 * check.turn).ceil()))
        ));
    }
    if !worst.is_empty() {
        let what = if study.is_some() { "no digit" } else { "no digit along a path" };
        lines.push(format!(
            "{what} of {} is right: {steps} steps are too few, by {at_half}",
            worst.join(", ")
        ));
    }
    if !seen.is_empty() {
        let along = if study.is_some() { "" } else { " along a path" };
        lines.push(format!("step error{along} of {}; by {at_half}", seen.join(", of ")));
    }
    if !hidden.is_empty() && check.damping <= STIFF && check.turn <= TURN {
        lines.push(format!(
            "cannot tell the step error of {}: {at_half} see none, and would miss one as large as the \
             deviation",
            hidden.join(", ")
        ));
    }
    if check.failed > 0 {
        lines.push(format!(
            "{} of {} paths of the check of the steps failed",
            check.failed,
            check.failed + check.paths
        ));
    }
    lines
}

/// `q about 0.02 (3 %)`.
fn share(name: &str, error: f64, size: f64) -> String {
    format!("{name} about {} ({} %)", rough(error), rough(100.0 * error / size))
}

/// To two digits.
fn rough(x: f64) -> String {
    digits(format!("{x:.1e}").parse().ok())
}
