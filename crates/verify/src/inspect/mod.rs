//! A report on a system for its author: [`inspect()`] and [`inspect_problem`].
//!
//! [`inspect()`] evaluates a system and its derivatives at random points. It reports
//!
//! - whether B is skew-symmetric, and whether closed forms agree with the energy;
//! - whether the claimed invariants are invariants, and of which degree;
//! - all linear and quadratic Casimirs of B, what is almost one, and those Σ cᵢ ln|yᵢ|;
//! - whether the noises commute;
//! - which statements of the paper apply, which orders to expect, and a scheme to take;
//! - the step size below which the implicit step is a contraction.
//!
//! [`inspect_problem`] adds what follows from damping and initial value, and looks along pilot
//! paths. A report prints as text and serializes as data.
//!
//! Each [`Finding`] has a [`Status`]. All formulas are evaluated in numbers that bound their own
//! rounding error ([`real::Bounded`]), component by component. A defect beyond its bound is a
//! counterexample: the identity is *refuted*, and the defect is printed with its place. An identity
//! that held at all points is *shown* if its formulas are polynomials of a degree below the number
//! of points, else *found by search*; the accuracy is printed. Where the bound is above 1e-11 of
//! the terms it *cannot be told*. A supremum is the largest value over the points, a lower bound
//! only.
//!
//! ```
//! use systems::{MaxwellBloch, RigidBody};
//! use verify::inspect;
//!
//! let report = inspect(&MaxwellBloch)?;
//! assert!(report.structure.skew.holds() && report.mistakes.is_empty());
//! assert_eq!(report.casimirs.found[0].formula, "0.5 y2² + 0.5 y3²");
//! assert!(report.bound.is_none(), "nothing bounds y1: {report}");
//!
//! let body = inspect(&RigidBody::three_noises([2.0, 1.0, 0.5], [1.0, 2.0, 3.0])?)?;
//! assert!(!body.noise.commute.holds());
//! assert_eq!(body.order("sexp"), Some((0.5, 1.0)));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod advice;
mod algebra;
mod casimirs;
mod damping;
mod erased;
mod error;
mod facts;
mod finding;
mod formulas;
mod function;
mod hamiltonian;
mod invariants;
mod large;
mod logarithms;
mod noises;
mod pilot;
mod points;
mod problem;
mod recommendation;
mod report;
mod solvability;
mod structure;
#[cfg(test)]
mod tests;
mod theory;

use formula::FormulaSystem;
use systems::{Damping, PoissonSystem, Problem};

use algebra::norm;
use erased::{Erased, System};
use formulas::OfFormulas;
use pilot::{pilot_paths, pilot_paths_of};
use points::Points;
use report::Quadrature;
use theory::{with_unbounded_rate, without_damping};

pub use advice::{Override, WithoutIteration};
pub use casimirs::{Casimirs, FoundCasimir};
pub use damping::DampingIntegral;
pub use error::InspectError;
pub use facts::{Facts, Form, fastest};
pub use finding::{Finding, Status};
pub use function::{Kind, Minimum, Shape};
pub use hamiltonian::Hamiltonians;
pub use invariants::ClaimedInvariant;
pub use large::{Identity, LargeInspection, inspect_large};
pub use logarithms::LogarithmicCasimir;
pub use noises::Noises;
pub use pilot::Pilot;
pub use points::Region;
pub use problem::{Bound, ProblemFindings};
pub use recommendation::{Kept, Purpose, Recommendation, long_times};
pub use report::Inspection;
pub use solvability::Solvability;
pub use structure::Structure;
pub use theory::{Applies, ExpectedOrder, Theorem};

/// Half the side of the box in which a system alone is inspected.
const HALF_SIDE: f64 = 2.0;

/// Inspects a system at random points of its domain with |yᵢ| ≤ 2.
///
/// # Errors
/// [`InspectError::NoPoints`] if too little of the box is in the domain ([`inspect_problem`]
/// searches around y₀), [`InspectError::NotFinite`] if B or the energy is NaN or infinite at a
/// point of the domain.
pub fn inspect<S: PoissonSystem<D, M>, const D: usize, const M: usize>(
    system: &S,
) -> Result<Inspection, InspectError> {
    let system = Erased::<S, D, M>(system);
    let points = Points::new(&system, Region::Box(HALF_SIDE), None)?;
    check_finite(&system, &points)?;
    Ok(Inspection::of(&system, &points).with_mistakes(Quadrature::OfTheSystem))
}

/// Inspects the system of a problem at random points with ‖y‖ ≤ 2‖y₀‖, around y₀ and at states of
/// pilot paths, and its damping.
///
/// If something bounds all paths, the contraction constant is that of the ball in which they stay.
///
/// # Errors
/// As [`inspect()`].
pub fn inspect_problem<S, G, const D: usize, const M: usize>(
    problem: &Problem<S, G, D>,
) -> Result<Inspection, InspectError>
where
    S: PoissonSystem<D, M>,
    G: Damping,
{
    let system = Erased::<S, D, M>(problem.system());
    let pilot = pilot_paths(problem);
    let (damping, y0) = (problem.damping() as &dyn Damping, problem.y0());
    let report = inspect_around(&system, damping, &y0, problem.t_end(), pilot)?;
    Ok(report.with_mistakes(Quadrature::OfTheSystem))
}

/// Inspects a system from texts, without damping, at random points with ‖y‖ ≤ 2‖y₀‖ and around y₀.
///
/// # Errors
/// As [`inspect()`].
pub fn inspect_formulas(system: &FormulaSystem, y0: &[f64]) -> Result<Inspection, InspectError> {
    let system = OfFormulas(system);
    let points = Points::new(&system, ball(y0), Some(y0))?;
    check_finite(&system, &points)?;
    Ok(Inspection::of(&system, &points).with_mistakes(Quadrature::Ours))
}

/// Inspects a problem whose system is from texts, as [`inspect_problem`].
///
/// # Errors
/// As [`inspect()`].
pub fn inspect_formula_problem(
    system: &FormulaSystem,
    damping: &dyn Damping,
    y0: &[f64],
    t_end: f64,
) -> Result<Inspection, InspectError> {
    let pilot = pilot_paths_of(system, damping, y0, t_end);
    let report = inspect_around(&OfFormulas(system), damping, y0, t_end, pilot)?;
    Ok(report.with_mistakes(Quadrature::Ours))
}

/// The ball around zero in which a problem is inspected.
fn ball(y0: &[f64]) -> Region {
    let length = norm(y0);
    Region::Ball(if length > 0.0 { 2.0 * length } else { HALF_SIDE })
}

fn inspect_around(
    system: &dyn System,
    damping: &dyn Damping,
    y0: &[f64],
    t_end: f64,
    pilot: (Pilot, Vec<Vec<f64>>),
) -> Result<Inspection, InspectError> {
    let points = Points::new(system, ball(y0), Some(y0))?;
    let points = points.with_paths(system, y0, pilot);
    check_finite(system, &points)?;
    let mut report = Inspection::of(system, &points);
    let findings = ProblemFindings::of(damping, y0, t_end, system, report.bound.as_ref());
    if let Some(radius) = findings.radius.filter(|radius| radius.is_finite() && *radius > 0.0) {
        let reached = Points::new(system, Region::Ball(radius), Some(y0))?;
        report.solvability = Solvability::of(system, &reached);
    }
    if findings.integral.none {
        without_damping(&mut report);
    }
    if !findings.integral.finite {
        with_unbounded_rate(&mut report);
    }
    report = report.with_recommendations(!findings.integral.none);
    report.problem = Some(findings);
    Ok(report)
}

fn check_finite(system: &dyn System, points: &Points) -> Result<(), InspectError> {
    let ones = vec![1.0; system.noises() + 1];
    let energy = system.energy(&ones);
    for y in points.for_suprema.iter().chain(&points.for_identities) {
        let values = system.field(y, &ones).0.into_iter().chain([energy.value(y)]);
        if let Some(value) = values.map(|x| x.value).find(|value| !value.is_finite()) {
            return Err(InspectError::NotFinite { at: y.clone(), value });
        }
    }
    Ok(())
}
