//! `casimir inspect`, `expect`, `equilibrium`, `lyapunov`, `order` and `compare`: what is found of
//! a scene.

use std::path::PathBuf;

use casimir::mc::expect::Keeping;
use casimir_cli::{
    failure::{Done, Failure},
    scene::{Scene, SchemeAndSeed},
    verbs::{self, Found, Watch},
};
use serde::Serialize;

use super::{folder, open, stoppable, tell, watch};
use crate::arguments::{Compare, Equilibrium, Expect, Inspect, Lyapunov, Order};

/// The layout of chains in their file.
const LAYOUT: u32 = 2;
/// The accuracy of exponents.
const ACCURACY: f64 = 0.01;

/// Says what a system is. The scheme of the scene is not asked for.
pub fn inspect(Inspect { sets, on }: &Inspect) -> Done {
    let sets = SchemeAndSeed { sets: sets.clone(), ..SchemeAndSeed::default() };
    let scene = open(on, &sets, None)?;
    tell(&verbs::inspect(&scene, &watch())?, on.out.clone(), "inspect", on.json)
}

/// Measures the orders of a scheme on a scene.
pub fn order(Order { path_steps, scheme, on }: &Order) -> Done {
    let scene = open(on, scheme, None)?;
    let folder = folder(on, "order")?;
    let found = verbs::order(&scene, *path_steps, &watch())?;
    tell(&found, Some(folder), "order", on.json)
}

/// Compares all schemes on a scene.
pub fn compare(Compare { error, budget, sets, seed, on }: &Compare) -> Done {
    let seed = SchemeAndSeed { scheme: None, seed: *seed, sets: sets.clone() };
    let scene = open(on, &seed, None)?;
    let folder = folder(on, "compare")?;
    let found = verbs::compare(&scene, *error, *budget, &watch())?;
    tell(&found, Some(folder), "compare", on.json)
}

/// Computes the expectations of a scene.
pub fn expect(Expect { accuracy, steps, scheme, on }: &Expect) -> Done {
    let mut scene = open(on, scheme, *steps)?;
    scene.accuracy = accuracy.or(scene.accuracy);
    let kept = keeping(&scene, folder(on, "expect")?.join("samples.bin"), &(scheme, steps))?;
    let watch = stoppable();
    let found = verbs::expect(&scene, Some(kept.clone()), &watch);
    finish(found, on.out.clone(), ("expectation", on.json), &watch, &kept)
}

/// Averages over the stationary law.
pub fn equilibrium(arguments: &Equilibrium) -> Done {
    chains(arguments, "equilibrium", None)
}

/// Lyapunov exponents.
pub fn lyapunov(Lyapunov { count, chains: arguments }: &Lyapunov) -> Done {
    chains(arguments, "lyapunov", Some(*count as usize))
}

fn chains(arguments: &Equilibrium, command: &str, exponents: Option<usize>) -> Done {
    let Equilibrium { accuracy, steps, chains, path_steps, scheme, on } = arguments;
    let mut scene = open(on, scheme, *steps)?;
    scene.accuracy = accuracy.or(exponents.map_or(scene.accuracy, |_| Some(ACCURACY)));
    let folder = folder(on, command)?;
    let changes = (scheme, steps, chains, exponents, LAYOUT);
    let kept = keeping(&scene, folder.join("chains.bin"), &changes)?;
    let watch = stoppable();
    let limits = (*chains, *path_steps);
    let found = verbs::equilibrium(&scene, exponents, limits, Some(kept.clone()), &watch);
    finish(found, Some(folder), (command, on.json), &watch, &kept)
}

/// Says what was found and what is kept; whether it was stopped or its accuracy not reached is the
/// exit code.
fn finish(
    found: Done<Found>,
    folder: Option<PathBuf>,
    (file, json): (&str, bool),
    watch: &Watch,
    kept: &Keeping,
) -> Done {
    let told = found.and_then(|found| tell(&found, folder, file, json).map(|()| found.unreached));
    let file = kept.file.display();
    if let Some(error) = kept.failure.get() {
        eprintln!("warning: the samples are not kept in {file}: {error}");
    }
    let next = || match kept.holds() {
        true => format!("samples are in {file}: the same command goes on from them"),
        false => "no samples are kept: the same command begins anew".into(),
    };
    match told {
        Err(Failure::Stopped(words)) => Err(Failure::Stopped(format!("{words}; {}", next()))),
        Ok(_) if watch.stop.is_asked() => Err(Failure::Stopped(next())),
        Ok(Some(words)) => Err(Failure::Run(words)),
        told => told.map(drop),
    }
}

/// Where samples are kept, and what they depend on.
fn keeping(scene: &Scene, file: PathBuf, changes: &impl Serialize) -> Done<Keeping> {
    let law = scene.settings.random.as_ref().map_or("", |random| &random.law);
    let changes = serde_json::to_string(changes)?;
    let study = [env!("CARGO_PKG_VERSION"), &changes, law, &scene.source.text].join("\n");
    let keeping = Keeping { file, study, ..Keeping::default() };
    if keeping.holds() {
        eprintln!("going on from {}; to begin anew, delete it", keeping.file.display());
    }
    Ok(keeping)
}
