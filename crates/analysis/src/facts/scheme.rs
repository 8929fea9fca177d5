//! Which scheme to take, for what: one rule for `inspect`, `run` and `recommend`.
//!
//! | scheme | damping | Casimirs of degree 1, 2 | energy over long times |
//! |---|---|---|---|
//! | `sexp`, `sexp-levy` | exact | kept | kept but for the noise |
//! | `split`, `nv` | exact | kept, of any degree where flows are exact | stays near |
//! | `sexp-li`, `sexp-li-levy` | exact | kept; explicit where B is constant | drifts |
//! | `midpoint` | of order 2 | kept without damping | stays near without damping |
//! | `heun`, `em` | of order 2, 1 | lost | drifts, or explodes |
//!
//! So paths are for `sexp`, with Lévy areas where noises do not commute and areas are drawn; for
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

/// What a scheme does over long times. `constant`: B does not depend on y.
pub fn long_times(scheme: &str, constant: bool) -> &'static str {
    match scheme {
        "sexp" | "sexp-levy" => "exact damping; Casimirs and, but for the noise, the energy kept",
        "sexp-li" | "sexp-li-levy" if constant => {
            "exact damping; explicit, since B is constant: the energy drifts"
        }
        "sexp-li" | "sexp-li-levy" => "exact damping; Casimirs kept; the energy drifts",
        "split" | "nv" => {
            "exact damping; Casimirs kept; the energy stays near where flows are exact"
        }
        "midpoint" => "without damping Casimirs are kept, and the energy stays near",
        _ => "nothing is kept: the energy drifts, or explodes",
    }
}
