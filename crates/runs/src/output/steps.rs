//! Step errors in words.

use casimir::analysis::{
    STIFF, StepCheck,
    StepError::{self, About, Below, CannotTell, Fine},
    StepErrors, TURN,
};

use super::*;

/// Known step errors of the mean and of the deviation of an observable, which a study shows with
/// the half-width of its interval.
pub fn step_errors(results: &Results, name: &str) -> Option<[StepError; 2]> {
    let (study, check) = (results.study.as_ref()?, results.check.as_ref()?);
    let errors = check.observables.iter().find(|errors| errors.observable == name)?;
    let interval = study.series(name)?.last().mean_interval;
    // Without an interval a step error is compared with the spread alone.
    let sampling = interval.map_or(0.0, |(lo, hi)| 0.5 * (hi - lo));
    let spread = errors.deviation.value;
    Some([errors.mean, errors.deviation].map(|of| check.step_error(of, sampling, spread)))
}

/// Cell of a table: the step error of the mean, and in brackets that of the deviation.
pub fn step_cell(errors: Option<[StepError; 2]>) -> String {
    let Some(errors) = errors else { return "–".into() };
    let [mean, deviation] = errors.map(|error| match error {
        Fine(_) => None,
        About(size) => Some(rough(size)),
        Below(size) => Some(format!("< {}", rough(size))),
        CannotTell => Some("?".into()),
    });
    let deviation = deviation.map_or(String::new(), |deviation| format!(" ({deviation})"));
    mean.unwrap_or("small".into()) + &deviation
}

/// Step error, as a part of a value, that leaves no digit of it.
const NO_DIGIT: f64 = 0.5;

/// The part of its energy that the fastest motion lacks is worth a word from this on, 0.46 radians
/// in a step, and the part that is left with the steps that are advised.
const LOST: f64 = 0.05;
const LEFT: f64 = 0.01;

/// The step errors that a reader must know of, the worst first; why they cannot be known, if half
/// the step does not show them.
pub fn step_lines(results: &Results, scene: &Scene) -> Vec<Warning> {
    let Results { check: Some(check), study, tables, .. } = results else { return Vec::new() };
    let mut lines = Vec::new();
    let steps = scene.settings.steps;
    let more = |times: f64| digits((steps as f64 * times).ceil());
    let half = match check.blocks {
        Some(time) => format!("{} blocks of t = {} with half the step", check.paths, rough(time)),
        None if check.paths == 1 => "one path with half the step".into(),
        None => format!("{} paths with half the step", check.paths),
    };
    let all = check.failed + check.paths;
    if all == 0 {
        return lines; // interrupted before
    }
    let failed = (check.failed > 0).then(|| {
        Warning::new(format!("{} of {all} paths of the check of the steps failed", check.failed))
    });
    let turns = format!("the fastest motion turns by {} radians in a step", rough(check.turn));
    if check.damping > STIFF {
        let what = format!("the damping of a step is exp(-{})", digits(check.damping));
        lines.push(
            Warning::new(what)
                .with_reason("what happens within a step is not resolved")
                .with_remedy(format!("take more than {} steps", more(check.damping))),
        );
    }
    if check.turn > TURN {
        let steps = more(check.turn);
        lines.push(
            Warning::new(turns.clone() + ", which is not resolved")
                .with_remedy(format!("take more than {steps} steps")),
        );
    }
    if let Some((t, enough)) = check.unresolved {
        let take = enough.map_or("many more".into(), |steps| steps.to_string());
        let near = digits(t);
        let what = format!(
            "a function of t changes within a step near t = {near} by more than from step to step"
        );
        lines.push(
            Warning::new(what)
                .with_reason("a step that is half as long may miss the same")
                .with_remedy(format!("take {take} steps")),
        );
    }
    if !check.resolves() {
        lines.extend(failed);
        return lines;
    }
    let [mut worst, mut seen, mut below, mut hidden] = [const { Vec::new() }; 4];
    // With the size of what it is an error of.
    let mut sort = |name: String, error: StepError, size: f64| match error {
        About(error) if error <= NO_DIGIT * size => {
            let percent = rough(100.0 * error / size);
            seen.push(format!("{name} about {} ({percent} %)", rough(error)));
        }
        About(_) => worst.push(name),
        CannotTell => hidden.push(name),
        Fine(_) | Below(_) => {}
    };
    let largest =
        |all: &mut dyn Iterator<Item = f64>| all.fold(0.0f64, |most, x| most.max(x.abs()));
    for StepErrors { observable, mean, deviation, along_paths } in &check.observables {
        if let Some([first, second]) = step_errors(results, observable) {
            // What passes zero at the end has digits along the later half of the way.
            let series = study.iter().find_map(|study| study.series(observable));
            let points = series.map_or(&[][..], |series| &series.points);
            let later = || points[points.len() / 2..].iter();
            let spread = largest(&mut later().filter_map(|point| point.deviation));
            sort(
                observable.clone(),
                first,
                largest(&mut later().filter_map(|point| point.mean)).max(spread),
            );
            sort(format!("the deviation of {observable}"), second, spread);
            if let Below(_) = first {
                below.push(observable.clone());
            }
        } else if study.is_none() {
            // Of single paths the difference itself is shown.
            let size = largest(
                &mut tables
                    .iter()
                    .filter_map(|table| table.column(observable))
                    .flat_map(|column| &column[column.len() / 2..])
                    .copied(),
            )
            .max(casimir::real::elementary::hypot(mean.value, deviation.value));
            let along = 2.0 * along_paths;
            if along > 0.01 * size {
                sort(observable.clone(), About(along), size);
            }
        }
    }
    let along = if study.is_some() { "" } else { " along a path" };
    if !worst.is_empty() {
        let worst = worst.join(", ");
        lines.push(
            Warning::new(format!("no digit{along} of {worst} is right"))
                .with_reason(format!("{steps} steps are too few, by {half}"))
                .with_remedy("take more steps"),
        );
    }
    if !seen.is_empty() {
        lines.push(
            Warning::new(format!("step error{along} of {}", seen.join(", of ")))
                .with_reason(format!("by {half}")),
        );
    }
    if !(below.is_empty() && hidden.is_empty())
        && scene.problem().noises > 0
        && check.energy_lost() >= LOST
    {
        // Where x²/(1 + x²) is LEFT.
        let enough = more(0.5 * check.turn * (1.0 / LEFT - 1.0).sqrt());
        let lost = rough(100.0 * check.energy_lost());
        let why = "where noise drives it, schemes like the midpoint rule give it about";
        lines.push(
            Warning::new(turns)
                .with_reason(format!("{why} {lost} % too little energy"))
                .with_remedy(format!("take {enough} steps for 1 %")),
        );
    }
    if !below.is_empty() {
        lines.push(
            Warning::new(format!(
                "the step error of {} may exceed the sampling error, up to the number after <",
                below.join(", ")
            ))
            .with_reason(format!("{half} see none")),
        );
    }
    if !hidden.is_empty() {
        lines.push(
            Warning::new(format!("cannot tell the step error of {}", hidden.join(", ")))
                .with_reason(format!(
                    "{half} see none, and would miss one as large as the deviation"
                )),
        );
    }
    lines.extend(
        along_lags(results, scene, check).map(|line| line.with_reason(format!("by {half}"))),
    );
    lines.extend(failed);
    lines
}

/// Autocorrelations, with their spectra, whose step errors may exceed their sampling errors: by the
/// inequality of Cauchy and Schwarz a correlation with the past has at most the error that paths
/// have, in deviations.
fn along_lags(results: &Results, scene: &Scene, check: &StepCheck) -> Option<Warning> {
    let study = results.study.as_ref()?;
    let of = |(&k, series): (&usize, &[Series])| {
        let sampling = series[0]
            .points
            .iter()
            .filter_map(|point| point.mean_interval.map(|(lo, hi)| 0.5 * (hi - lo)))
            .fold(0.0, f64::max);
        let errors = check.observables.get(k)?;
        let bound = errors.mean.of_error * errors.along_paths / errors.deviation.value;
        (bound > sampling && bound < f64::INFINITY)
            .then(|| format!("{} (up to {})", errors.observable, rough(bound)))
    };
    let wide: Vec<_> =
        scene.wanted.lagged.iter().zip(study.lagged.chunks(2)).filter_map(of).collect();
    (!wide.is_empty()).then(|| {
        Warning::new(format!(
            "the step errors of autocorrelation and spectrum may exceed the sampling errors: of {}",
            wide.join(", of ")
        ))
        .with_remedy("take more steps")
    })
}

/// Formats a size with two digits.
fn rough(x: f64) -> String {
    format!("{x:.1e}").parse().map_or("–".into(), digits)
}
