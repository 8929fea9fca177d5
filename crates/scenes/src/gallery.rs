//! The scenes of the gallery.

use crate::among;

/// The scenes of the gallery, by name.
macro_rules! gallery {
    ($($name:literal)+) => {
        /// Name and text of every scene of the gallery.
        pub const GALLERY: &[(&str, &str)] =
            &[$(($name, include_str!(concat!("../gallery/", $name, ".toml")))),+];
    };
}

gallery! {
    "empty"
    "kubo"
    "duffing"
    "double-well"
    "langevin"
    "josephson"
    "neuron"
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
    "stirred-sphere"
    "spin-one"
    "dephasing"
}

/// The text of a scene.
///
/// # Errors
/// A message with the known names, unless `name` is one of them.
pub fn scene(name: &str) -> Result<&'static str, String> {
    let names: Vec<&str> = GALLERY.iter().map(|(name, _)| *name).collect();
    let found = GALLERY.iter().find(|(known, _)| *known == name).map(|(_, text)| *text);
    found.ok_or_else(|| format!("no scene `{name}`{}", among(name, &names)))
}
