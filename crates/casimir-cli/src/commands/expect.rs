//! `casimir expect`: expectations with intervals.

use std::{
    sync::{
        Mutex, PoisonError,
        atomic::{AtomicU64, Ordering},
    },
    time::Instant,
};

use casimir::{
    mc::{
        self, Observe,
        expect::{Expectation, SoFar},
        parts::{Job, Share, remove},
    },
    plot::Progress,
};

use super::{
    Settled, coarsest_steps, folder, open, print, print_json, scheme, threads, under_bar,
    until_stopped, warn,
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
    let ready = Ready::new(&scene, None)?;
    let folder = arguments.output.out.as_deref();
    folder.map_or(Ok(()), folder::prepare)?;
    let (results, stopped) = until_stopped(folder, |job, _| ready.compute(job))?;
    if let Some(results) = &results {
        report(&scene, results, arguments.output.json)?;
    }
    match (stopped, folder) {
        (true, Some(folder)) => Err(Failure::stopped(format!(
            "{} has a checkpoint; the same command goes on from there",
            folder.display()
        ))),
        (true, None) => Err(Failure::stopped("nothing is kept; with --out DIR the samples are")),
        (false, Some(folder)) => {
            if let Some(results) = results {
                output::write_expectation(&scene, &results, folder)?;
            }
            Ok(remove(folder, Share::WHOLE)?)
        }
        (false, None) => Ok(()),
    }
}

/// The scheme, which stays `auto` where points, levels and order are chosen too.
pub fn settle(scene: &Scene) -> Settled {
    warn(scene);
    let is_chosen = scene.settings.scheme == AUTO && scene.model.expect().is_some();
    if is_chosen { (AUTO.into(), None) } else { scheme(scene) }
}

/// Expectations that were checked.
pub struct Ready<'a> {
    scene: &'a Scene,
    expect: mc::Expect<'a>,
    because: Option<String>,
    accuracy: f64,
}

impl<'a> Ready<'a> {
    /// Chooses the way, and checks that there is something to expect.
    pub fn new(scene: &'a Scene, settled: Option<&Settled>) -> Done<Self> {
        let (false, Some(accuracy)) = (scene.expected.is_empty(), scene.accuracy) else {
            let name = scene.observables.first().map_or("y1", |observable| &*observable.name);
            let message = format!(
                "nothing is expected: add a table\n  [expect]\n  of = [\"{name}\"]\n  accuracy = 1e-3"
            );
            return Err(scene.source.error(None, message).into());
        };
        let (settings, model) = (&scene.settings, &scene.model);
        let (scheme, because) = settled.cloned().unwrap_or_else(|| settle(scene));
        let chosen = if scheme == AUTO { model.expect() } else { None };
        let (expect, because, steps) = match chosen {
            Some(chosen) => (chosen, None, settings.coarsest_steps),
            None => {
                let given = mc::Expect::with_scheme(scene.setup(&scheme)?);
                let given = given.with_truncation(settings.truncation);
                let steps = settings.coarsest_steps.unwrap_or(coarsest_steps(settings.until));
                (given, because, Some(steps))
            }
        };
        let mut expect = expect.with_key(settings.key).with_watch(hear);
        if let Some(steps) = steps {
            expect = expect.with_coarsest_steps(steps);
        }
        Ok(Self { scene, expect, because, accuracy })
    }

    /// Computes the expectations as a piece of work of a job.
    pub fn compute(self, job: &Job) -> Done<Option<Results>> {
        let Self { scene, expect, because, accuracy } = self;
        let start = Instant::now();
        let phi: Vec<&dyn Observe> = scene.expected.iter().map(|phi| phi as _).collect();
        let (done, next) = (AtomicU64::new(0), Mutex::new(FIRST));
        let expectation = under_bar("sampling until the accuracy is reached", 0, |bars| {
            expect.run_in(job, "expectation", &phi, accuracy, &|work| {
                bars.advance(work);
                let done = done.fetch_add(work, Ordering::Relaxed) + work;
                let seconds = start.elapsed().as_secs_f64();
                if let Ok(mut next) = next.try_lock()
                    && seconds > *next
                {
                    *next = seconds + seconds.min(MOST_SILENCE);
                    bars.note(&how_far(done as f64, seconds));
                }
            })
        })?;
        let seconds = start.elapsed().as_secs_f64();
        Ok(expectation.map(|expectation| Results { because, expectation, seconds }))
    }
}

/// What the last round of samples gave.
static SO_FAR: Mutex<Option<SoFar>> = Mutex::new(None);
/// Seconds until something is said, and between two lines.
const FIRST: f64 = 5.0;
const MOST_SILENCE: f64 = 60.0;

fn hear(so_far: &SoFar) {
    *SO_FAR.lock().unwrap_or_else(PoisonError::into_inner) = Some(*so_far);
}

/// The half-width so far, and what the accuracy takes.
fn how_far(done: f64, seconds: f64) -> String {
    let mut text = format!("{seconds:.0} s, {done:.1e} path-steps: ");
    let Some(SoFar { half_width, accuracy, expected, max_cost, .. }) =
        *SO_FAR.lock().unwrap_or_else(PoisonError::into_inner)
    else {
        return text + "no interval yet";
    };
    if half_width.is_infinite() {
        text += "no interval yet, ";
    } else {
        text += &format!("± {half_width:.1e} so far, ± {accuracy:.1e} is wanted: ");
    }
    let most = max_cost as f64;
    let left = |cost: f64| (cost - done).max(0.0) * seconds / done;
    let rest = match expected {
        None => "smaller steps are needed".into(),
        Some(cost) if cost > most => format!(
            "that takes about {cost:.0e} path-steps, and {most:.0e} are allowed, {:.0} s more",
            left(most)
        ),
        Some(cost) => format!("about {:.0} s more", left(cost)),
    };
    text + &rest
}

/// Says what was found.
pub fn report(scene: &Scene, results: &Results, json: bool) -> Done {
    match json {
        true => print_json(&output::expectation_json(scene, results)),
        false => print(&output::expectation_text(scene, results)),
    }
}
