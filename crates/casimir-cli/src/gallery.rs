//! The scenes of the gallery.

use casimir::formula::nearest;

/// The scenes of the gallery, by name.
macro_rules! gallery {
    ($($name:literal)+) => {
        /// Name and text of every scene of the gallery.
        pub const GALLERY: &[(&str, &str)] =
            &[$(($name, include_str!(concat!("../scenes/", $name, ".toml")))),+];
    };
}

gallery! {
    "empty"
    "kubo"
    "duffing"
    "double-well"
    "langevin"
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

/// The text of a scene.
///
/// # Errors
/// The names that there are.
pub fn scene(name: &str) -> Result<&'static str, String> {
    match GALLERY.iter().find(|(known, _)| *known == name) {
        Some((_, text)) => Ok(text),
        None => {
            let names: Vec<&str> = GALLERY.iter().map(|(name, _)| *name).collect();
            let (hint, names) = (nearest(name, &names), names.join(", "));
            Err(format!("no scene `{name}`; there are {names}{hint}"))
        }
    }
}
