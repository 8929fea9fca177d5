//! Which scheme to take, for what: one rule for `inspect`, `run` and `recommend`. What each scheme
//! does is in [`schemes::BuiltIn`].
//!
//! Paths are for `sexp`, with Lévy areas where noises do not commute and areas are drawn; for
//! `split` where a step of `sexp` is dear and flows are known, as on a lattice. `heun` and `em` are
//! for those who name them.

/// What a scheme for paths has to care for.
#[derive(Clone, Copy, Debug, Default)]
pub struct Kept {
    /// There are linear or quadratic Casimirs.
    pub casimirs: bool,
    /// The equation has an energy law: every noise is a multiple of H₀, which is homogeneous or
    /// not damped.
    pub energy: bool,
    /// Noises do not commute, and Lévy areas are drawn.
    pub areas: bool,
}

impl Kept {
    /// The scheme for paths, and why.
    pub fn scheme(self) -> (&'static str, String) {
        let kept = match (self.casimirs, self.energy) {
            (true, true) => "it keeps the energy and the Casimirs",
            (false, true) => "it keeps the energy",
            (true, false) => "it keeps the Casimirs, and the energy but for the noise",
            (false, false) => "it damps exactly, and keeps the energy but for the noise",
        };
        match self.areas {
            true => ("sexp-levy", format!("{kept}; Lévy areas give strong order 1")),
            false => ("sexp", kept.into()),
        }
    }
}
