//! What a system is, found by looking at it: a report for its author.
//!
//! [`inspect()`] evaluates a system and its derivatives at random points and says whether B is
//! skew, whether claimed invariants are invariants and of which degree, which Casimirs B has,
//! whether noises commute, which statements of the paper apply, which orders to expect and up to
//! which step size the implicit step is a contraction. [`inspect_problem`] adds what follows from
//! damping and initial value. A report prints in words and serializes as data.
//!
//! An identity between analytic functions that holds at one random point holds everywhere with
//! probability one, so findings are as certain as the threshold of round-off is fair. Suprema are
//! largest values over the points looked at, and no more than that.
//!
//! ```
//! use systems::{MaxwellBloch, RigidBody};
//! use verify::inspect;
//!
//! let report = inspect(&MaxwellBloch)?;
//! assert!(report.structure.skew.holds && report.mistakes.is_empty());
//! assert_eq!(report.casimirs.found[0].formula, "0.5 y2² + 0.5 y3²");
//! assert!(report.bound.is_none(), "nothing bounds y1: {report}");
//!
//! let body = inspect(&RigidBody::three_noises([2.0, 1.0, 0.5], [1.0, 2.0, 3.0])?)?;
//! assert!(!body.noise.commute.holds);
//! assert_eq!(body.order("sexp"), Some((0.5, 1.0)));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod algebra;
mod bound;
mod casimirs;
mod error;
mod expected;
mod finding;
mod hamiltonian;
mod invariants;
mod noises;
mod points;
mod probe;
mod shape;
mod solvability;
mod structure;
mod words;

use serde::Serialize;
use systems::{Damping, PoissonSystem, Problem};

use algebra::norm;
use points::Points;
use probe::{Of, Probe};

pub use bound::{Bound, ProblemFindings};
pub use casimirs::{Casimirs, FoundCasimir};
pub use error::InspectError;
pub use expected::{Applies, ExpectedOrder, Theorem};
pub use finding::Finding;
pub use hamiltonian::Hamiltonians;
pub use invariants::ClaimedInvariant;
pub use noises::Noises;
pub use points::Region;
pub use shape::{Kind, Minimum, Shape};
pub use solvability::Solvability;
pub use structure::Structure;

/// What a system is.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Inspection {
    /// Its name.
    pub system: String,
    /// D.
    pub dimension: usize,
    /// M.
    pub noises: usize,
    /// Where the points for identities were taken from.
    pub region: Region,
    /// How many there were.
    pub points: usize,
    /// Whether the system was defined at every point that was tried.
    pub defined_everywhere: bool,
    /// B(y).
    pub structure: Structure,
    /// H₀, …, H_M.
    pub hamiltonians: Hamiltonians,
    /// The noise fields.
    pub noise: Noises,
    /// The invariants that the system claims.
    pub invariants: Vec<ClaimedInvariant>,
    /// The linear and quadratic Casimirs that B has.
    pub casimirs: Casimirs,
    /// What bounds all paths, if something does.
    pub bound: Option<Bound>,
    /// The norms of the solvability bound.
    pub solvability: Solvability,
    /// Where they were taken.
    pub solvability_region: Region,
    /// What follows from damping and initial value; `None` for a system alone.
    pub problem: Option<ProblemFindings>,
    /// Which statements of the paper apply.
    pub theorems: Vec<Theorem>,
    /// What to expect of the schemes.
    pub orders: Vec<ExpectedOrder>,
    /// Everything that is not as it must be or as it was claimed, in words; empty for a sound
    /// system.
    pub mistakes: Vec<String>,
}

/// Half the side of the box in which a system alone is looked at.
const HALF_SIDE: f64 = 2.0;

/// Looks at a system at points with |yᵢ| ≤ 2 where it is defined.
///
/// # Errors
/// [`InspectError::NoPoints`] when it is defined hardly anywhere there ([`inspect_problem`] looks
/// around y₀), [`InspectError::NotFinite`] when B or the energy is NaN or infinite at a point where
/// it says that it is defined.
pub fn inspect<S: PoissonSystem<D, M>, const D: usize, const M: usize>(
    system: &S,
) -> Result<Inspection, InspectError> {
    let system = Of::<S, D, M>(system);
    let points = Points::new(&system, Region::Box(HALF_SIDE), None)?;
    check_finite(&system, &points)?;
    Ok(Inspection::of(&system, &points).concluded())
}

/// Looks at a problem in the ball that all its paths stay in, if something bounds them, or of twice
/// the length of y₀; and at its damping.
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
    let system = Of::<S, D, M>(&problem.system);
    let length = norm(&problem.y0);
    let ball = Region::Ball(if length > 0.0 { 2.0 * length } else { HALF_SIDE });
    let points = Points::new(&system, ball, Some(&problem.y0))?;
    check_finite(&system, &points)?;
    let mut inspection = Inspection::of(&system, &points);
    let Inspection { hamiltonians, casimirs, bound, .. } = &inspection;
    let findings = ProblemFindings::of(problem, hamiltonians, casimirs, bound.as_ref());
    if let Some(radius) = findings.radius.filter(|radius| radius.is_finite() && *radius > 0.0) {
        let reached = Points::new(&system, Region::Ball(radius), Some(&problem.y0))?;
        inspection.solvability = Solvability::of(&system, &reached);
        inspection.solvability_region = reached.region;
    }
    inspection.problem = Some(findings);
    Ok(inspection.concluded())
}

/// Refuses points where B or h is not a number: there is nothing to be said of such a system.
fn check_finite(system: &dyn Probe, points: &Points) -> Result<(), InspectError> {
    let ones = vec![1.0; system.noises() + 1];
    for y in &points.many {
        let values = system.field(y, &ones).into_iter().chain([system.energy(y, &ones)]);
        for value in values {
            if !value.is_finite() {
                return Err(InspectError::NotFinite { at: y.clone(), value });
            }
        }
    }
    Ok(())
}

impl Inspection {
    fn of(system: &dyn Probe, points: &Points) -> Self {
        let hamiltonians = Hamiltonians::of(system, points);
        let casimirs = Casimirs::of(system, points);
        Self {
            system: system.name().to_owned(),
            dimension: system.dimension(),
            noises: system.noises(),
            region: points.region.clone(),
            points: points.few.len(),
            defined_everywhere: points.everywhere,
            structure: Structure::of(system, points),
            noise: Noises::of(system, points),
            invariants: ClaimedInvariant::all(system, points),
            bound: Bound::of(&hamiltonians, &casimirs),
            solvability: Solvability::of(system, points),
            solvability_region: points.region.clone(),
            hamiltonians,
            casimirs,
            problem: None,
            theorems: Vec::new(),
            orders: Vec::new(),
            mistakes: Vec::new(),
        }
    }

    /// Draws the conclusions.
    fn concluded(mut self) -> Self {
        self.theorems = expected::theorems(&self);
        self.orders = expected::orders(&self);
        self.mistakes = words::mistakes(&self);
        self
    }

    /// (strong, weak) order to expect of a scheme, by its identifier.
    #[must_use]
    pub fn order(&self, scheme: &str) -> Option<(f64, f64)> {
        self.orders
            .iter()
            .find(|order| order.scheme == scheme)
            .map(|order| (order.strong, order.weak))
    }

    /// Whether a statement of the paper applies, by its identifier.
    #[must_use]
    pub fn applies(&self, statement: &str) -> Option<Applies> {
        self.theorems
            .iter()
            .find(|theorem| theorem.statement == statement)
            .map(|theorem| theorem.applies)
    }
}
