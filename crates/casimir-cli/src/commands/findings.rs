//! `casimir inspect`, `order` and `compare`: findings about a system and its schemes.

use casimir_cli::{
    failure::Done,
    scene::{Changes, SchemeAndSeed},
    verbs,
};

use super::{folder, open, tell, threads, watch};
use crate::arguments::{Compare, Inspect, Order};

/// Says what a system is. The scheme of the scene is not asked for.
pub fn inspect(arguments: &Inspect) -> Done {
    let sets = SchemeAndSeed { sets: arguments.sets.clone(), ..SchemeAndSeed::default() };
    let scene = open(&arguments.scene, &Changes::from(&sets))?;
    tell(&verbs::inspect(&scene, &watch())?, None, "inspect", arguments.json)
}

/// Measures the orders of a scheme on a scene.
pub fn order(arguments: &Order) -> Done {
    let scene = open(&arguments.scene, &Changes::from(&arguments.scheme))?;
    threads(arguments.output.threads)?;
    let found = verbs::order(&scene, arguments.path_steps, &watch())?;
    let folder = folder::of(arguments.output.out.clone(), &arguments.scene, "order")?;
    tell(&found, Some(&folder), "order", arguments.output.json)
}

/// Compares all schemes on a scene.
pub fn compare(arguments: &Compare) -> Done {
    let seed = SchemeAndSeed { scheme: None, seed: arguments.seed, sets: arguments.sets.clone() };
    let scene = open(&arguments.scene, &Changes::from(&seed))?;
    threads(arguments.output.threads)?;
    let found = verbs::compare(&scene, arguments.error, arguments.budget, &watch())?;
    let folder = folder::of(arguments.output.out.clone(), &arguments.scene, "compare")?;
    tell(&found, Some(&folder), "compare", arguments.output.json)
}
