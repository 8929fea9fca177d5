//! `casimir expect`: expectations with intervals.

use std::time::Instant;

use casimir::mc::{self, ExpectSettings, Observe, expect::Expectation, parts::Stop};

use super::{
    coarsest_steps, folder, open, print, print_json, scheme, stop, threads, under_bar, warn,
};
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
    let ready = Ready::new(&scene)?;
    let folder = arguments.output.out.as_deref();
    folder.map_or(Ok(()), folder::prepare)?;
    let stop = stop();
    let results = ready.compute(&stop);
    if let (true, Err(_)) = (stop.is_asked(), &results) {
        return Err(Failure::stopped("before the first estimates"));
    }
    let results = results?;
    report(&scene, &results, arguments.output.json)?;
    folder.map_or(Ok(()), |folder| output::write_expectation(&scene, &results, folder))?;
    if stop.is_asked() { Err(Failure::stopped("the samples are not kept")) } else { Ok(()) }
}

/// Expectations that were checked.
struct Ready<'a> {
    scene: &'a Scene,
    expect: mc::Expect<'a>,
    settings: ExpectSettings,
    because: Option<String>,
    accuracy: f64,
}

impl<'a> Ready<'a> {
    /// Chooses the way, and checks that there is something to expect.
    fn new(scene: &'a Scene) -> Done<Self> {
        let (false, Some(accuracy)) = (scene.expected.is_empty(), scene.accuracy) else {
            let name = scene.observables.first().map_or("y1", |observable| &*observable.name);
            let message = format!(
                "nothing is expected: add a table\n  [expect]\n  of = [\"{name}\"]\n  accuracy = 1e-3"
            );
            return Err(scene.source.error(None, message).into());
        };
        warn(scene);
        let (settings, model) = (&scene.settings, &scene.model);
        let is_auto = settings.scheme == AUTO;
        // Points, levels and order are chosen with the scheme.
        let mut with = ExpectSettings { key: settings.key, ..ExpectSettings::default() };
        let (expect, because) = match model.expect().filter(|_| is_auto) {
            Some(chosen) => (chosen, None),
            None => {
                let (scheme, because) = scheme(scene);
                (with.truncation, with.coarsest_steps) =
                    (settings.truncation, coarsest_steps(settings.until));
                (mc::Expect::with_scheme(scene.setup(&scheme)?), because)
            }
        };
        with.coarsest_steps = settings.coarsest_steps.unwrap_or(with.coarsest_steps);
        Ok(Self { scene, expect, settings: with, because, accuracy })
    }

    fn compute(self, stop: &Stop) -> Done<Results> {
        let Self { scene, expect, settings, because, accuracy } = self;
        let start = Instant::now();
        let expect = expect.with(ExpectSettings { stop: stop.clone(), ..settings });
        let phi: Vec<&dyn Observe> = scene.expected.iter().map(|phi| phi as _).collect();
        let expectation = under_bar("sampling until the accuracy is reached", 0, |bars| {
            expect.run(&phi, accuracy, &|work| bars.advance(work))
        })?;
        Ok(Results { because, expectation, seconds: start.elapsed().as_secs_f64() })
    }
}

/// Says what was found.
fn report(scene: &Scene, results: &Results, json: bool) -> Done {
    match json {
        true => print_json(&output::expectation_json(scene, results)),
        false => print(&output::expectation_text(scene, results)),
    }
}
