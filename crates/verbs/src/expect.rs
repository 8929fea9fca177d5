//! Expectations with intervals.

use std::time::Instant;

use casimir::expectation::{Estimate, Expect, ExpectSettings, WarningKind};
use casimir::mc::{Checkpoint, Observe};
use serde_json::json;

use super::{Found, Watch, coarsest_steps, scheme, with_interval};
use crate::failure::{Done, Failure};
use scenes::{AUTO, Scene, model::with_names};

/// Computes the expectations of a scene, with samples that are kept if this is wanted.
pub fn expect(scene: &Scene, keeping: Option<&Checkpoint>, watch: &Watch) -> Done<Found> {
    let accuracy = wanted(scene)?;
    let (expect, settings, because) = chosen(scene)?;
    let start = Instant::now();
    let mut expect = expect.with(ExpectSettings { stop: watch.stop.clone(), ..settings });
    expect.checkpoint = keeping;
    let phi: Vec<&dyn Observe> = scene.expected.iter().map(|phi| phi as _).collect();
    let found = watch.until("the first estimates", accuracy, |told| {
        let mut expect = expect;
        expect.told = Box::new(told);
        expect.run(&phi, accuracy)
    });
    if let (true, Err(_)) = (watch.stop.is_asked(), &found) {
        return Err(Failure::Stopped("before the first estimates".into()));
    }
    let (found, seconds) = (found?, start.elapsed().as_secs_f64());
    // Components have names here.
    let mut found = found;
    for warning in &mut found.warnings {
        if let WarningKind::Component(_) = warning.kind {
            warning.text = with_names(&warning.text, &scene.components);
        }
    }
    let mut text = found.to_string();
    if let Some(because) = &because {
        text += &format!("{}: {because}\n", found.scheme);
    }
    text += &format!("{seconds:.2} s\n");
    let estimate = |one: &Estimate| with_interval(one, one.interval(), one.half_width());
    let json = json!({
        "scheme": found.scheme, "because": because,
        "accuracy": found.accuracy, "reached": found.reached(),
        "estimates": found.estimates.iter().map(estimate).collect::<Vec<_>>(),
        "levels": found.levels, "single_steps": found.single_steps,
        "path_steps": found.cost, "seconds": seconds,
    });
    let warnings = found.warnings.iter().map(ToString::to_string);
    let reached = found.reached();
    Ok(Found::of(scene, warnings, &text, json, Vec::new()).to(reached, Some(accuracy)))
}

/// The accuracy that is wanted of a scene.
fn wanted(scene: &Scene) -> Done<f64> {
    scene.accuracy.filter(|_| !scene.expected.is_empty()).ok_or_else(|| {
        let name = scene.observables.first().map_or("y1", |observable| &*observable.name);
        let message = format!(
            "nothing is expected: add a table\n  [expect]\n  of = [\"{name}\"]\n  accuracy = 1e-3"
        );
        scene.source.error(None, message).into()
    })
}

/// The scheme that is named; or all that go with it is chosen: points, levels and order.
fn chosen(scene: &Scene) -> Done<(Expect<'_>, ExpectSettings, Option<String>)> {
    let settings = &scene.settings;
    let mut with = ExpectSettings { key: settings.key, ..ExpectSettings::default() };
    let is_auto = settings.scheme == AUTO;
    let whole = scene.model.expect().filter(|_| is_auto && !scene.collects());
    let (expect, because) = match whole {
        Some(chosen) => (chosen.starting(settings.random.clone()), None),
        None => {
            let (scheme, because) = scheme(scene);
            with.truncation = settings.truncation;
            with.coarsest_steps = coarsest_steps(settings.until);
            (Expect::with_scheme(scene.collecting(scene.setup(&scheme)?)), because)
        }
    };
    with.coarsest_steps = scene.changes.steps.unwrap_or(with.coarsest_steps);
    Ok((expect, with, because))
}
