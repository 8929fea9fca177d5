//! `casimir expect`: expectations with intervals.

use std::path::{Path, PathBuf};

use casimir::mc::expect::Keeping;
use casimir_cli::{
    failure::{Done, Failure},
    scene::{Changes, Scene},
    verbs::{self, Found, Watch},
};

use super::{folder, open, stoppable, tell, threads};
use crate::arguments::Expect;

/// Computes the expectations of a scene.
pub fn expect(arguments: &Expect) -> Done {
    let mut scene = open(
        &arguments.scene,
        &Changes { steps: arguments.steps, ..Changes::from(&arguments.scheme) },
    )?;
    threads(arguments.output.threads)?;
    scene.accuracy = arguments.accuracy.or(scene.accuracy);
    let folder = arguments.output.out.as_deref();
    folder.map_or(Ok(()), folder::prepare)?;
    let changes = serde_json::to_string(&(&arguments.scheme, arguments.steps))?;
    let file = folder::named(arguments.output.out.clone(), &arguments.scene, "expect");
    let (watch, keeping) = (stoppable(), keeping(&scene, file.join("samples.bin"), &changes));
    let kept = keeping.clone();
    let found = verbs::expect(&scene, Some(keeping), &watch)?;
    finish(&found, folder, ("expectation", arguments.output.json), &watch, (&kept, scene.accuracy))
}

/// Says what was found; whether it was stopped or its accuracy not reached is the exit code.
pub fn finish(
    (found, reached): &(Found, bool),
    folder: Option<&Path>,
    (file, json): (&str, bool),
    watch: &Watch,
    (kept, accuracy): (&Keeping, Option<f64>),
) -> Done {
    tell(found, folder, file, json)?;
    if let Some(error) = kept.failure.get() {
        eprintln!("warning: the samples are not kept in {}: {error}", kept.file.display());
    }
    match (watch.stop.is_asked(), reached) {
        (true, _) => Err(Failure::Stopped(format!(
            "the samples are in {}: the same command goes on from them",
            kept.file.display()
        ))),
        (_, true) => Ok(()),
        _ => Err(Failure::Run(match accuracy {
            Some(accuracy) => format!("±{accuracy:e} not reached, or not to be believed"),
            None => "not to be believed".into(),
        })),
    }
}

/// Where samples are kept, and what they depend on.
pub fn keeping(scene: &Scene, file: PathBuf, changes: &str) -> Keeping {
    let law = scene.settings.random.as_ref().map_or("", |random| &random.law);
    let study = [env!("CARGO_PKG_VERSION"), changes, law, &scene.source.text].join("\n");
    let keeping = Keeping { file, study, ..Keeping::default() };
    if keeping.holds() {
        eprintln!("going on from {}; to begin anew, delete it", keeping.file.display());
    }
    keeping
}
