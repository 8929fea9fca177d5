//! Which scheme to take for paths, and what it keeps: one rule for `inspect`, `run` and `compare`.
//! What each scheme does is in [`schemes::BuiltIn`].
//!
//! Paths are for `sexp`: `sexp-h` where noises commute and have flows, and with Lévy areas where
//! they do not commute and areas are drawn. They are for `split` where a step of `sexp` is dear and
//! flows are known, and `sexp-li` on a lattice in a bath. `heun` and `em` are for those who name
//! them. An equation without B and H has `heun`, and `midpoint` where it keeps quadratic functions.

use mc::Problem;
use systems::run_time::{Description, Parts, System};

use super::{MAX_COMPONENTS, is_proportional};

/// Properties of a problem that decide the scheme for paths.
#[derive(Clone, Copy, Debug, Default)]
pub struct Conserved {
    /// Whether there are linear or quadratic Casimirs with a law; of an equation without B and H
    /// whether quadratic functions have one, since all schemes keep linear ones.
    pub casimirs: bool,
    /// Whether the energy has a law: every noise is a multiple of H₀, which is homogeneous or not
    /// damped.
    pub energy: bool,
    /// Whether noises do not commute and Lévy areas are drawn.
    pub areas: bool,
    /// Whether there is noise.
    pub noise: bool,
    /// Whether some component is damped.
    pub damped: bool,
}

/// Fractions of T up to which the integral of a damping is evaluated.
const TIMES: [f64; 3] = [0.2, 0.6, 1.0];

/// Whether some component is damped.
pub fn is_damped(problem: &Problem<'_>) -> bool {
    let damps =
        |part: &f64| problem.dampings().any(|one| one.integral(0.0, part * problem.t_end) != 0.0);
    TIMES.iter().any(damps)
}

impl Conserved {
    /// Reads the properties of `problem` and its laws, without the laws that friction breaks.
    pub fn of(problem: &Problem<'_>, system: &dyn System, areas: bool) -> Self {
        let plain = system.description().plain;
        let has = |casimir: bool| {
            let mut laws = problem.laws.iter().filter(|law| !plain || law.degree == 2.0);
            laws.any(|law| law.casimir == casimir)
        };
        let damped = is_damped(problem);
        // Without damping H₀ is constant, homogeneous or not. Lattices are too large to look at.
        let constant = !damped && problem.y0.len() <= MAX_COMPONENTS;
        Self {
            casimirs: has(true),
            energy: has(false) || constant && is_proportional(system, &problem.y0),
            areas,
            noise: problem.noises > 0,
            damped,
        }
    }

    /// Selects the scheme for paths of this system, and says why.
    pub fn scheme(self, system: &dyn System) -> (&'static str, String) {
        let system = system.description();
        if system.plain {
            let (scheme, why) = match self.casimirs {
                true => ("midpoint", "it keeps the quadratic functions that all fields keep"),
                false => ("heun", "it is explicit, and the fields keep no quadratic function"),
            };
            let levy = "; noises do not commute: heun-levy has strong order 1";
            let levy = if system.noises_commute { "" } else { levy };
            return (scheme, format!("{why}{levy}"));
        }
        let scheme = match self.areas {
            _ if system.parts.as_ref().is_ok_and(|parts| parts.preferred) => "split",
            // A lattice.
            _ if system.has_bath && system.joined.is_empty() => "sexp-li",
            true => "sexp-levy",
            false if has_flows_of_noises(system) => "sexp-h",
            false => "sexp",
        };
        let casimirs = match (self.casimirs, self.damped) {
            (true, true) => "it keeps the laws of Casimirs, and",
            (true, false) => "it keeps the Casimirs, and",
            (false, true) => "it damps exactly, and keeps",
            (false, false) => "it keeps",
        };
        let energy = match scheme {
            "split" | "sexp-li" => "nearly the energy",
            _ if self.energy && self.damped => "the law of the energy",
            _ => "the energy",
        };
        let causes = [
            (self.noise, "the noise"),
            (self.damped, "the damping"),
            (system.has_bath, "the bath"),
            (system.depends_on_time, "what depends on time"),
        ];
        let causes = causes.into_iter().filter(|(acts, _)| *acts && !self.energy);
        let causes = causes.map(|(_, cause)| cause).collect::<Vec<_>>().join(" and ");
        let but = if causes.is_empty() { "" } else { " but for " };
        let order = match scheme {
            "sexp-levy" => "; Lévy areas give strong order 1",
            "sexp-h" if system.is_langevin => "; space-time areas give strong order 2",
            "sexp-h" => "; space-time areas give strong order 1.5",
            _ => "",
        };
        (scheme, format!("{casimirs} {energy}{but}{causes}{order}"))
    }
}

/// Whether noises commute and the flow of each is known, so that `sexp-h` keeps what `sexp` keeps,
/// with a higher order at about its cost.
fn has_flows_of_noises(system: &Description) -> bool {
    let known = |parts: &Parts| parts.of_noise.iter().flatten().count() == system.noises;
    let steady = system.noises_commute && !system.depends_on_time;
    steady && system.noises > 0 && system.parts.as_ref().is_ok_and(known)
}
