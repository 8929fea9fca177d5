//! `casimir equilibrium` and `casimir lyapunov`: averages along chains.

use casimir_cli::{
    failure::Done,
    scene::Changes,
    verbs::{self, Asked},
};

use super::{
    expect::{finish, keeping},
    folder, open, stoppable, threads,
};
use crate::arguments::{Equilibrium, Lyapunov};

/// The layout of chains in their file.
const LAYOUT: u32 = 2;
/// The accuracy of exponents.
const ACCURACY: f64 = 0.01;

/// Averages over the stationary law.
pub fn equilibrium(arguments: &Equilibrium) -> Done {
    chains(arguments, "equilibrium", Asked::Averages)
}

/// Lyapunov exponents.
pub fn lyapunov(Lyapunov { count, chains: arguments }: &Lyapunov) -> Done {
    let accuracy = arguments.accuracy.unwrap_or(ACCURACY);
    chains(arguments, "lyapunov", Asked::Exponents(*count as usize, accuracy))
}

fn chains(arguments: &Equilibrium, command: &str, asked: Asked) -> Done {
    let Equilibrium { scene: file, accuracy, steps, chains, path_steps, scheme, output } =
        arguments;
    let mut scene = open(file, &Changes { steps: *steps, ..Changes::from(scheme) })?;
    threads(output.threads)?;
    scene.accuracy = accuracy.or(scene.accuracy);
    let folder = folder::named(output.out.clone(), file, command);
    let (exponents, wanted) = match asked {
        Asked::Averages => (None, scene.accuracy),
        Asked::Exponents(count, accuracy) => (Some(count), Some(accuracy)),
    };
    let changes = serde_json::to_string(&(scheme, steps, chains, exponents, LAYOUT))?;
    let (watch, keeping) = (stoppable(), keeping(&scene, folder.join("chains.bin"), &changes));
    let kept = keeping.clone();
    let found = verbs::equilibrium(&scene, asked, (*chains, *path_steps), Some(keeping), &watch)?;
    folder::prepare(&folder)?;
    finish(&found, Some(&folder), (command, output.json), &watch, (&kept, wanted))
}
