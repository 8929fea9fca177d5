//! Expectations with intervals.

use std::time::Instant;

use casimir::mc::{
    self, ExpectSettings, Observe,
    expect::{Estimate, Expectation, Keeping, WarningKind},
};
use serde_json::{Value, json};

use super::{Found, Watch, coarsest_steps, scheme, warnings};
use crate::{
    failure::{Done, Failure},
    model::with_names,
    scene::{AUTO, Scene},
};

/// Computes the expectations of a scene, with samples that are kept if this is wanted; and whether
/// their accuracy is reached.
pub fn expect(scene: &Scene, keeping: Option<Keeping>, watch: &Watch) -> Done<(Found, bool)> {
    let accuracy = wanted(scene)?;
    let (expect, settings, because) = chosen(scene)?;
    let start = Instant::now();
    let mut expect = expect.with(ExpectSettings { stop: watch.stop.clone(), ..settings });
    if let Some(keeping) = keeping {
        expect = expect.keeping(keeping);
    }
    let phi: Vec<&dyn Observe> = scene.expected.iter().map(|phi| phi as _).collect();
    let expectation = watch
        .until("the first estimates", accuracy, |told| expect.telling(told).run(&phi, accuracy));
    if let (true, Err(_)) = (watch.stop.is_asked(), &expectation) {
        return Err(Failure::Stopped("before the first estimates".into()));
    }
    let seconds = start.elapsed().as_secs_f64();
    let (expectation, reason) = (expectation?, because.as_deref());
    let words = text(scene, &expectation, reason, seconds);
    let json = json(scene, &expectation, reason, seconds);
    Ok((Found::new(words, json, Vec::new()), expectation.reached()))
}

/// The accuracy that is wanted of a scene.
pub fn wanted(scene: &Scene) -> Done<f64> {
    scene.accuracy.filter(|_| !scene.expected.is_empty()).ok_or_else(|| {
        let name = scene.observables.first().map_or("y1", |observable| &*observable.name);
        let message = format!(
            "nothing is expected: add a table\n  [expect]\n  of = [\"{name}\"]\n  accuracy = 1e-3"
        );
        scene.source.error(None, message).into()
    })
}

/// The expectations in words.
fn text(scene: &Scene, expectation: &Expectation, because: Option<&str>, seconds: f64) -> String {
    let mut text = warnings(&scene.model.known().mistake) + &expectation.to_string();
    for warning in &expectation.warnings {
        if let WarningKind::Component(_) = warning.kind {
            text = text.replace(&warning.text, &with_names(&warning.text, &scene.components));
        }
    }
    if let Some(because) = because {
        text += &format!("{}: {because}\n", expectation.scheme);
    }
    text + &format!("{seconds:.2} s\n")
}

/// The expectations for programs.
fn json(scene: &Scene, expectation: &Expectation, because: Option<&str>, seconds: f64) -> Value {
    let estimate = |estimate: &Estimate| {
        let (mut json, (lo, hi)) = (json!(estimate), estimate.interval());
        json["lo"] = lo.into();
        json["hi"] = hi.into();
        json["half_width"] = estimate.half_width().into();
        json
    };
    json!({
        "title": scene.title, "scheme": expectation.scheme, "because": because,
        "accuracy": expectation.accuracy, "reached": expectation.reached(),
        "estimates": expectation.estimates.iter().map(estimate).collect::<Vec<_>>(),
        "levels": expectation.levels, "single_steps": expectation.single_steps,
        "path_steps": expectation.cost, "seconds": seconds,
    })
}

/// The scheme that is named; or all that go with it is chosen: points, levels and order.
fn chosen(scene: &Scene) -> Done<(mc::Expect<'_>, ExpectSettings, Option<String>)> {
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
            (mc::Expect::with_scheme(scene.collecting(scene.setup(&scheme)?)), because)
        }
    };
    with.coarsest_steps = settings.coarsest_steps.unwrap_or(with.coarsest_steps);
    Ok((expect, with, because))
}
