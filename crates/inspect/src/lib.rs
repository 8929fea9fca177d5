//! What a system is: [`inspect()`] evaluates it at random points and reports to its author.
//!
//! ```
//! use inspect::{InspectSettings, inspect};
//! use systems::{MaxwellBloch, RigidBody, run_time::Compiled};
//!
//! let settings = InspectSettings::default();
//! let maxwell = Compiled::new(MaxwellBloch, [1.0, 2.0, 3.0]);
//! let report = inspect(&maxwell, &settings)?;
//! assert!(report.structure.skew.holds() && report.mistakes.is_empty());
//! assert_eq!(report.casimirs.as_ref().unwrap().found[0].formula, "0.5 y2² + 0.5 y3²");
//! assert!(report.bound.is_none(), "nothing bounds y1: {report}");
//!
//! let body = RigidBody::three_noises([2.0, 1.0, 0.5], [1.0, 2.0, 3.0])?;
//! let body = inspect(&Compiled::new(body, [0.6, 0.0, 0.8]), &settings)?;
//! assert!(!body.noise.commute.holds());
//! assert_eq!(body.order("sexp"), Some((0.5, 1.0)));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! It works on the run-time interface [`System`]; [`Compiled`](systems::run_time::Compiled) takes a
//! system in Rust there. The report says
//!
//! - whether B is skew-symmetric, and whether all methods agree with B and the energy;
//! - whether the claimed invariants are invariants, and of which degree;
//! - all linear and quadratic Casimirs of B and those Σ cᵢ ln|yᵢ|;
//! - whether the noises commute;
//! - which statements of the paper apply, which orders to expect, and a scheme to take.
//!
//! Of an equation without B and H it asks for neither, and says which functions drift and noises
//! keep, and whether they keep volume.
//!
//! With an initial value it looks there and at the damping, too. A report prints as text and
//! serializes as data.
//!
//! Each [`Finding`] has one of three answers, see [`Status`]. A defect is relative to the terms of
//! its identity. It is none if it is below 10⁻¹⁴ of them. A larger one is a counterexample if it is
//! about the same at four states 10⁻⁹ apart: there round-off differs. Anything else cannot be told.
//! A property that holds was looked at at points only, and a supremum is the largest value over
//! these, a lower bound.

mod casimirs;
pub mod facts;
mod fields;
mod hamiltonian;
mod inspection;
mod invariants;
mod noises;
mod points;
mod problem;
mod report;
mod shape;
mod structure;
mod theory;

use systems::{
    Damping, Problem,
    run_time::{Lanes, System},
};

use mc::Friction;

use crate::facts::{MAX_SEARCHED, Probe, norm};
use points::{Points, Sight};

pub use crate::facts::{DampingIntegral, Finding, Form, Status};
pub use points::{InspectError, Region};
pub use {
    casimirs::*, fields::*, hamiltonian::*, inspection::*, invariants::*, noises::*, problem::*,
    shape::*, structure::*,
};

/// Half side of the box in which a system without an initial value is inspected.
const HALF_SIDE: f64 = 2.0;
/// Largest number of components of a system that is inspected in a whole region, not only near its
/// initial value.
const SMALL: usize = 64;

/// Settings of an inspection: initial value, damping, friction, Lévy areas and scheme.
#[derive(Clone)]
pub struct InspectSettings<'a> {
    /// Initial value: random points have ‖y‖ ≤ 2‖y₀‖, and others are around it. Without an
    /// initial value, points have |yᵢ| ≤ 2.
    pub y0: Option<Vec<f64>>,
    /// The damping and the final time.
    pub damping: Option<(&'a dyn Damping, f64)>,
    /// Friction on single components, in addition to the damping.
    pub friction: &'a [Friction],
    /// Whether Lévy areas are drawn for the system.
    pub areas: bool,
    /// Scheme that a run of the system takes for paths, and why; if not given,
    /// [`Conserved`](crate::facts::Conserved) selects it from the findings.
    pub run: Option<(&'static str, String)>,
}

/// Settings for a system alone, without an initial value; Lévy areas are drawn.
impl Default for InspectSettings<'_> {
    fn default() -> Self {
        Self { y0: None, damping: None, friction: &[], areas: true, run: None }
    }
}

impl<'a> InspectSettings<'a> {
    /// The settings for a problem; areas are drawn for its system.
    pub fn of<S, G: Damping, const D: usize>(problem: &'a Problem<S, G, D>) -> Self {
        let damping = Some((problem.damping() as &dyn Damping, problem.t_end()));
        Self { y0: Some(problem.y0().to_vec()), damping, ..Self::default() }
    }
}

/// Inspects a system at random points of its domain.
///
/// Casimirs are searched in systems of up to 512 components.
///
/// A system of up to 24 components is looked at component by component, one of more along random
/// directions: there a small defect in one of many components may be below the rounding of a sum.
/// One of more than 64 components is looked at near its initial value only.
///
/// # Errors
/// [`InspectError::NoPoints`] if too little of the region is in the domain, or if a large system
/// has no initial value; [`InspectError::NotFinite`] if B or the energy is NaN or infinite at a
/// point of the domain.
pub fn inspect(
    system: &dyn System,
    settings: &InspectSettings<'_>,
) -> Result<Inspection, InspectError> {
    let y0 = settings.y0.as_deref();
    let (probe, description) = (Probe::new(system), system.description());
    let rows_of_paths = description.layout.lanes == Lanes::Paths;
    let small = rows_of_paths && description.dimension <= SMALL;
    let region = match y0 {
        _ if !small => Region::Near,
        Some(y0) if norm(y0) > 0.0 => Region::Ball(2.0 * norm(y0)),
        Some(_) => Region::Ball(HALF_SIDE),
        None => Region::Box(HALF_SIDE),
    };
    let mut points = Points::new(&probe, region, y0)?;
    if let (true, Some(y0)) = (small, y0) {
        points.add_start(&probe, y0);
    }
    let sight = &mut Sight::new(probe, &points);
    check_finite(sight)?;
    let (plain, silent) = (description.plain, description.noises == 0);
    let searched = rows_of_paths && description.dimension <= MAX_SEARCHED;
    let mut report = Inspection {
        system: match sight.matrices.is_empty() {
            true => format!("{} ({})", description.name, description.parameters),
            false => description.name.clone(),
        },
        dimension: description.dimension,
        noises: description.noises,
        is_langevin: description.is_langevin,
        has_flows: description.parts.is_ok(),
        depends_on_time: description.depends_on_time,
        region: points.region.clone(),
        points: points.for_identities.len(),
        defined_everywhere: points.everywhere,
        structure: if plain { Structure::default() } else { Structure::of(sight) },
        hamiltonians: match plain {
            true => Hamiltonians { silent, ..Hamiltonians::default() },
            false => Hamiltonians::of(sight),
        },
        fields: plain.then(|| Fields::of(sight)),
        noise: Noises::of(sight),
        invariants: ClaimedInvariant::all(sight),
        casimirs: searched.then(|| Casimirs::of(sight)),
        bound: None,
        problem: None,
        theorems: Vec::new(),
        orders: Vec::new(),
        recommended: Vec::new(),
        mistakes: Vec::new(),
        undecided: Vec::new(),
    };
    // Friction may break what bounds paths.
    let uniform = settings.friction.is_empty();
    if uniform && report.structure.sound().holds() {
        let of = |casimirs| Bound::of(&report.hamiltonians, casimirs);
        report.bound = report.casimirs.as_ref().and_then(of);
    }
    report.problem = y0.zip(settings.damping).map(|(y0, damping)| {
        ProblemFindings::of((damping, settings.friction), y0, system, report.bound.as_ref())
    });
    let integral = report.problem.as_ref().map(|problem| &problem.integral);
    let damped = integral.is_none_or(|integral| !integral.none);
    let finite_rates = integral.is_none_or(|integral| integral.finite);
    report.orders = theory::orders(&report, settings.areas, finite_rates);
    // The paper's equation has neither friction nor a bath.
    if !plain {
        report.theorems = theory::theorems(&report, damped, uniform && !description.has_bath);
    }
    report.recommended = theory::recommendations(&report, system, settings, damped);
    Ok(report.with_mistakes())
}

fn check_finite(Sight { probe, points, .. }: &mut Sight<'_>) -> Result<(), InspectError> {
    let weights = vec![1.0; probe.noises() + 1];
    for states in [&points.for_suprema, &points.for_identities] {
        let gradient = probe.gradient(states, &weights);
        let fields = probe.structure(states, &gradient);
        let energies = probe.energy(states, &weights);
        for ((y, field), energy) in states.iter().zip(fields).zip(energies) {
            let mut values = field.into_iter().chain([energy]);
            if let Some(value) = values.find(|value| !value.is_finite()) {
                return Err(InspectError::NotFinite { at: y.clone(), value });
            }
        }
    }
    Ok(())
}
