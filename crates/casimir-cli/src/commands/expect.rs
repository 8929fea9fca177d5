//! `casimir expect`: expectations with intervals.

use casimir::mc::expect::Keeping;
use casimir_cli::{
    failure::{Done, Failure},
    scene::{Changes, Scene},
    verbs,
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
    let (watch, keeping) = (stoppable(), keeping(arguments, &scene)?);
    if keeping.holds() {
        eprintln!("going on from {}; to begin anew, delete it", keeping.file.display());
    }
    let kept = keeping.file.clone();
    let (found, reached) = verbs::expect(&scene, Some(keeping), &watch)?;
    tell(&found, folder, "expectation", arguments.output.json)?;
    match (watch.stop.is_asked(), reached) {
        (true, _) => Err(Failure::Stopped(format!(
            "the samples are in {}: the same command goes on from them",
            kept.display()
        ))),
        (_, true) => Ok(()),
        _ => Err(Failure::Run(format!("±{} not reached", scene.accuracy.unwrap_or_default()))),
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
