//! `casimir expect`: expectations with intervals.

use std::time::Instant;

use casimir::{
    mc::{
        self, ExpectSettings, Observe,
        expect::{Expectation, Keeping},
    },
    plot::{files, under_words},
};

use super::{coarsest_steps, folder, open, print, print_json, scheme, stop, threads, warn};
use crate::{
    arguments::Expect,
    failure::{Done, Failure},
    output,
    scene::{AUTO, Changes, Scene},
};

/// What was found.
pub struct Results {
    /// Why it is this scheme, if that was left to the program.
    pub because: Option<String>,
    /// Expectations with levels and warnings.
    pub expectation: Expectation,
    /// Seconds of the computation.
    pub seconds: f64,
}

/// Computes the expectations of a scene.
pub fn expect(arguments: &Expect) -> Done {
    let mut scene = open(
        &arguments.scene,
        &Changes { steps: arguments.steps, ..Changes::from(&arguments.scheme) },
    )?;
    threads(arguments.output.threads)?;
    scene.accuracy = arguments.accuracy.or(scene.accuracy);
    let (false, Some(accuracy)) = (scene.expected.is_empty(), scene.accuracy) else {
        let name = scene.observables.first().map_or("y1", |observable| &*observable.name);
        let message = format!(
            "nothing is expected: add a table\n  [expect]\n  of = [\"{name}\"]\n  accuracy = 1e-3"
        );
        return Err(scene.source.error(None, message).into());
    };
    warn(&scene);
    let (expect, settings, because) = chosen(&scene)?;
    let folder = arguments.output.out.as_deref();
    folder.map_or(Ok(()), folder::prepare)?;
    let (start, stop) = (Instant::now(), stop());
    let keeping = keeping(arguments, &scene)?;
    if keeping.holds() {
        eprintln!("going on from {}; to begin anew, delete it", keeping.file.display());
    }
    let kept = keeping.file.clone();
    let expect = expect.with(ExpectSettings { stop: stop.clone(), ..settings }).keeping(keeping);
    let phi: Vec<&dyn Observe> = scene.expected.iter().map(|phi| phi as _).collect();
    let expectation = under_words("the first estimates", |say| {
        let told = |half_width, done| {
            let left = start.elapsed().as_secs_f64() * (1.0 / done - 1.0);
            say(format!(
                "±{half_width:.1e} so far, ±{accuracy:.1e} wanted, about {left:.0} s left"
            ));
        };
        expect.telling(told).run(&phi, accuracy, &|_| ())
    });
    if let (true, Err(_)) = (stop.is_asked(), &expectation) {
        return Err(Failure::stopped("before the first estimates"));
    }
    let seconds = start.elapsed().as_secs_f64();
    let results = Results { because, expectation: expectation?, seconds };
    let json = output::expectation_json(&scene, &results);
    match arguments.output.json {
        true => print_json(&json),
        false => print(&output::expectation_text(&scene, &results)),
    }?;
    if let Some(folder) = folder {
        files::write_json(&folder.join("expectation.json"), &json)?;
    }
    match (stop.is_asked(), results.expectation.reached()) {
        (true, _) => Err(Failure::stopped(format!(
            "the samples are in {}: the same command goes on from them",
            kept.display()
        ))),
        (_, true) => Ok(()),
        _ => Err(Failure::run(format!("±{accuracy} not reached"))),
    }
}

/// Where samples are kept, and what they depend on.
fn keeping(arguments: &Expect, scene: &Scene) -> Done<Keeping> {
    let folder = folder::named(arguments.output.out.clone(), &arguments.scene, "expect");
    let changes = serde_json::to_string(&(&arguments.scheme, arguments.steps))?;
    let law = scene.settings.random.as_ref().map_or("", |random| &random.law);
    let version = env!("CARGO_PKG_VERSION");
    let study = [version, &changes, law, &scene.source.text].join("\n");
    Ok(Keeping { file: folder.join("samples.bin"), study })
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
