//! `casimir new`: scenes to begin with.

use casimir::formula::nearest;

use super::print;
use crate::{
    arguments::New,
    failure::{Done, Failure},
    model::PROJECT,
};

/// The scenes of the gallery, by name.
macro_rules! gallery {
    ($($name:literal)+) => {
        /// Name and text of every scene of the gallery.
        pub const GALLERY: &[(&str, &str)] =
            &[$(($name, include_str!(concat!("../../../../scenes/", $name, ".toml")))),+];
    };
}

gallery! {
    "empty"
    "kubo"
    "duffing"
    "double-well"
    "josephson"
    "pendulum"
    "rigid-body"
    "heavy-top"
    "kirchhoff"
    "spin-in-field"
    "rabi"
    "spin-echo"
    "three-spins"
    "spin-lattice"
    "quench"
    "lotka-volterra"
    "predator-prey"
    "food-chain"
    "epidemic"
    "maxwell-bloch"
    "poisson3"
    "charged-particle"
    "magnetic-noise"
    "henon-heiles"
    "oscillator-chain"
    "toda"
    "point-vortices"
    "vortex-ring"
}

/// Prints a scene, or lists them.
pub fn new(arguments: &New) -> Done {
    if arguments.list {
        let mut list = String::from("Scenes, for casimir new NAME:\n");
        for (name, text) in GALLERY {
            list += &format!("  {name:<18}{}\n", headline(text));
        }
        list += "\nSystems of the project, for `name` in [system], and their parameters:\n";
        for (name, parameters, what) in PROJECT {
            list += &format!("  {name:<18}{what}\n");
            if !parameters.is_empty() {
                list += &format!("{:20}{parameters}\n", "");
            }
        }
        return print(&list);
    }
    let name = arguments.name.as_deref().unwrap_or("empty");
    match GALLERY.iter().find(|(known, _)| *known == name) {
        Some((_, text)) => print(text),
        None => {
            let names: Vec<&str> = GALLERY.iter().map(|(name, _)| *name).collect();
            let (hint, names) = (nearest(name, &names), names.join(", "));
            Err(Failure::usage(format!("no scene `{name}`; there are {names}{hint}")))
        }
    }
}

/// The first line of a scene, without its #.
fn headline(text: &str) -> &str {
    text.lines().next().unwrap_or("").trim_start_matches(['#', ' '])
}
