//! Twins of the conformal laws and of the bounds that follow from them.

use mc::Setup;
use real::Real;
use schemes::{Implicit, Increment, Scheme};
use systems::{
    Damping, Invariant, PoissonSystem, Problem, RigidBody,
    paper::{rigid_body_three_noises, valid},
};
use verify::{
    Conditions,
    conformal_law::{ROUND_OFF, approach, largest_defect},
    results::{Claim, Evidence},
};

/// A system whose discrete gradient is the gradient at the midpoint, and whose last component of
/// B(y)v is multiplied by `last`.
///
/// The discrete gradient is a mistake unless the Hamiltonians are quadratic, and so is any factor
/// but 1: with −1, B is no longer skew.
pub struct WrongSystem<S> {
    /// The right system.
    right: S,
    /// Factor of the last component.
    last: f64,
}

impl<S: PoissonSystem<D, M>, const D: usize, const M: usize> PoissonSystem<D, M>
    for WrongSystem<S>
{
    fn name(&self) -> &'static str {
        self.right.name()
    }
    #[inline(always)]
    fn structure<R: Real>(&self, y: [R; D], v: [R; D]) -> [R; D] {
        let mut product = self.right.structure(y, v);
        product[D - 1] = product[D - 1] * self.last;
        product
    }
    #[inline(always)]
    fn energy<R: Real>(&self, y: [R; D], dt: f64, dw: [f64; M]) -> R {
        self.right.energy(y, dt, dw)
    }
    #[inline(always)]
    fn averaged_gradient<R: Real>(&self, a: [R; D], b: [R; D], dt: f64, dw: [f64; M]) -> [R; D] {
        self.right.gradient(dgrad::midpoint(a, b), dt, dw)
    }
    fn invariants(&self) -> Vec<Invariant> {
        self.right.invariants()
    }
    fn invariant<R: Real>(&self, index: usize, y: [R; D]) -> R {
        self.right.invariant(index, y)
    }
}

/// The problem with a wrong system.
pub fn wrong<S: PoissonSystem<3, M>, G: Damping, const M: usize>(
    problem: Problem<S, G, 3>,
    last: f64,
) -> Problem<WrongSystem<S>, G, 3> {
    let (right, damping, y0, t_end) = problem.into_parts();
    valid(Problem::new(WrongSystem { right, last }, damping, y0, t_end))
}

/// Steps of τ = 0.1 on [0, 10], as in the invariant panels.
const STEPS: u64 = 100;

/// The claim of the invariant panels about one scheme, first invariant of the system.
pub fn obeys_law(conditions: &Conditions, setup: &Setup<'_>) -> Claim {
    let path = conditions.path(0, setup, STEPS, 0);
    let measured = Evidence::Defect {
        invariant: setup.problem.laws[0].name.clone(),
        paths: 1,
        steps: STEPS,
        largest: largest_defect(&setup.problem, 0, &path),
        tolerance: ROUND_OFF,
        obeys: true,
    };
    Claim::new(conditions.id, "the conformal law holds at every step", measured)
}

/// [`obeys_law`] of the Casimir of the rigid body.
pub fn casimir(conditions: &Conditions, scheme: &dyn Scheme<RigidBody<3>, 3, 3>) -> Claim {
    obeys_law(conditions, &Setup::of(&rigid_body_three_noises(10.0), scheme))
}

/// `sexp` with e^{−∫γ} over the first half for both halves: with δ that factor, the equation of
/// z = y_{n+1} is z = δ(ẑ + B((ẑ + w)/2)∇̄h(ẑ, w)), ẑ = δy_n, w = z/δ.
pub struct FirstHalfTwice;

impl Implicit for FirstHalfTwice {
    const ID: &'static str = "sexp, first half twice";

    #[inline(always)]
    fn psi<H: Increment>(&self, h: H, start: H::Vector, z: H::Vector) -> H::Vector {
        let decay = h.step().first_decay;
        let start = start * decay;
        (start + h.averaged_field(start, z * (1.0 / decay))) * decay
    }
}

/// `sexp` with B at the beginning of the step, z = ẑ + B(ẑ)∇̄h(ẑ, z): the noise is multiplied by
/// an old state, as in the Itô form.
pub struct OldStructure;

impl Implicit for OldStructure {
    const ID: &'static str = "sexp, old structure";
    const EXACT_DAMPING: bool = true;

    #[inline(always)]
    fn psi<H: Increment>(&self, h: H, start: H::Vector, z: H::Vector) -> H::Vector {
        start + h.structure(start, h.averaged_gradient(start, z))
    }
}

pub fn old_structure_at_small_steps(conditions: &Conditions) -> Claim {
    // Up to T = 1: the Casimir of the wrong method drifts away.
    let problem = rigid_body_three_noises(1.0);
    let (steps, wrong) = (STEPS / 10, Setup::of::<_, _, 3, 3>(&problem, &OldStructure));
    let path = conditions.path(0, &wrong, steps, 0);
    let largest = largest_defect(&wrong.problem, 0, &path);
    let measured = approach(conditions, &wrong, 0, steps, largest);
    let statement = "the Casimir returns to the conformal law as τ → 0";
    Claim::new(conditions.id, statement, measured)
}
