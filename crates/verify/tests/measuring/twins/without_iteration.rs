//! Twins of the schemes without iteration and of the one-step remainders.

use kernels::Tuned;
use mc::Setup;
use noise::StepNoise;
use schemes::{BuiltIn, Composed, Composition, Explicit, Increment, Paths, Sexp, Step, Times};
use systems::{
    Damping, Flows, Problem,
    paper::{maxwell_bloch, pendulum, poisson3_strong, rigid_body_energy, rigid_body_three_noises},
};
use verify::{
    Compiled, Conditions, altered,
    results::Claim,
    statements::{
        local::{self, BodyScheme, PIECES, Vector, difference, remainder_claims, scheme_remainder},
        without_iteration::{keeps_casimir, order_two},
    },
};

use super::{
    conformal::{casimir, obeys_law},
    orders::strong,
};

/// The increment over the whole step.
fn whole(pieces: &[Vector; PIECES]) -> Vector {
    std::array::from_fn(|m| pieces.iter().map(|dw| dw[m]).sum())
}

/// The expansion of the exact flow with ½ΔWΔWᵀ for the iterated integrals, as on one straight line,
/// without areas: the remainder is then of order τ.
pub fn local_without_areas(conditions: &Conditions) -> Claim {
    let remainder = |tau: f64, pieces: &[Vector; PIECES]| {
        let straight = whole(pieces).map(|w| w / PIECES as f64);
        difference(local::exact_end(tau, pieces), local::expansion(tau, &[straight; PIECES]))
    };
    let [claim, _] = remainder_claims(conditions, "local-exact", "the exact flow", remainder);
    claim
}

/// The expansion of the scheme without ½Σ fₘ′f_l ΔŴ_lΔŴₘ.
pub fn local_without_second_order(conditions: &Conditions) -> Claim {
    let remainder = |tau: f64, pieces: &[Vector; PIECES]| {
        difference(local::scheme_end(&Sexp, tau, pieces)[0], local::first_order(tau, whole(pieces)))
    };
    let [claim, _] = remainder_claims(conditions, "local-sexp", "sexp", remainder);
    claim
}

/// `split` without the way back: each flow once, for the whole step.
pub struct InARow;

impl<S: Flows<D, M>, const D: usize, const M: usize> Composition<S, D, M> for InARow {
    const ID: &'static str = "split, in a row";

    #[inline(always)]
    fn compose<const N: usize>(&self, step: &Step, paths: &mut Paths<'_, S, D, M, N>) {
        paths.scale(step.first_decay);
        (0..S::PARTS).for_each(|part| paths.flow(part, Times::step(step)));
        paths.scale(step.second_decay);
    }
}

/// The right scheme for a problem.
fn right<S: Tuned<D, M>, G: Damping, const D: usize, const M: usize>(
    problem: &Problem<S, G, D>,
    scheme: BuiltIn,
) -> Setup<'_> {
    Compiled::of(problem).curves(&[scheme]).swap_remove(0).setup
}

/// `sexp-li` with v = ∇h(ẑ + shift·B(ẑ)∇h(ẑ)), where ½ is right.
struct Shifted {
    shift: f64,
}

impl Explicit for Shifted {
    const ID: &'static str = "sexp-li, shifted";

    #[inline(always)]
    fn advance<H: Increment>(&self, h: H, y: H::Vector) -> H::Vector {
        let start = y * h.step().first_decay;
        let v = h.gradient(start + h.field(start) * self.shift);
        h.cayley(start, v) * h.step().second_decay
    }
}

/// `sexp-li` with ẑ + a − b for Cayley's ẑ + a + b, where a is odd in v and b even.
struct Sign;

impl Explicit for Sign {
    const ID: &'static str = "sexp-li, sign";

    #[inline(always)]
    fn advance<H: Increment>(&self, h: H, y: H::Vector) -> H::Vector {
        let start = y * h.step().first_decay;
        let v = h.gradient(start + h.field(start) * 0.5);
        (start * 2.0 - h.cayley(start, v * -1.0)) * h.step().second_decay
    }
}

/// The first claim about the remainder of a scheme.
fn local(conditions: &Conditions, id: &str, scheme: &BodyScheme) -> Claim {
    let remainder = |tau: f64, pieces: &_| scheme_remainder(scheme, tau, pieces);
    let [claim, _] = remainder_claims(conditions, id, scheme.id(), remainder);
    claim
}

pub fn local_shifted(conditions: &Conditions, shift: f64) -> Claim {
    local(conditions, "local-sexp-li", &Shifted { shift })
}

pub fn local_in_a_row(conditions: &Conditions) -> Claim {
    local(conditions, "local-split", &Composed(InARow))
}

pub fn strong_shifted(conditions: &Conditions) -> Claim {
    // About a fixed axis, as of a single noise of the other bodies, v does not change.
    strong(conditions, "strong-one", &rigid_body_energy(1.0), &Shifted { shift: 0.0 }, 1.0)
}

pub fn pendulum_in_a_row(conditions: &Conditions) -> Claim {
    strong(conditions, "strong-one", &pendulum(), &Composed(InARow), 1.0)
}

pub fn poisson_in_a_row(conditions: &Conditions) -> Claim {
    strong(conditions, "strong-one", &poisson3_strong(), &Composed(InARow), 1.0)
}

pub fn sign_in_cayley(conditions: &Conditions) -> Claim {
    casimir(conditions, &Sign)
}

/// The damping of the first half for both halves.
pub fn first_half_twice(conditions: &Conditions, scheme: BuiltIn) -> Claim {
    let problem = rigid_body_three_noises(10.0);
    let change = |step: &mut Step, _: &mut StepNoise| step.second_decay = step.first_decay;
    let wrong = altered(right(&problem, scheme), None, change);
    obeys_law(conditions, "conformal-casimir", &wrong)
}

pub fn clipped_body(conditions: &Conditions) -> Claim {
    let problem = rigid_body_three_noises(1.0);
    let clipped = altered(right(&problem, BuiltIn::SexpLi), Some(true), |_, _| ());
    keeps_casimir(conditions, 0, clipped)
}

pub fn clipped_light(conditions: &Conditions) -> Claim {
    let problem = maxwell_bloch(1.0);
    let clipped = altered(right(&problem, BuiltIn::Split), Some(true), |_, _| ());
    keeps_casimir(conditions, 0, clipped)
}

pub fn sign_in_cayley_with_large_noise(conditions: &Conditions) -> Claim {
    let problem = rigid_body_three_noises(1.0);
    keeps_casimir(conditions, 0, Setup::of::<_, _, 3, 3>(&problem, &Sign))
}

pub fn order_in_a_row<S: Flows<D, M>, G: Damping, const D: usize, const M: usize>(
    conditions: &Conditions,
    problem: &Problem<S, G, D>,
) -> Claim {
    order_two(conditions, 0, Setup::of(problem, &Composed(InARow)))
}

/// `sexp-li` with all of the damping before the rest.
pub fn order_damped_before(conditions: &Conditions) -> Claim {
    let problem = rigid_body_three_noises(1.0);
    let before = |step: &mut Step, _: &mut StepNoise| {
        (step.first_decay, step.second_decay) = (step.first_decay * step.second_decay, 1.0);
    };
    order_two(conditions, 0, altered(right(&problem, BuiltIn::SexpLi), None, before))
}

/// `split` with all of the damping after the rest.
pub fn order_damped_after(conditions: &Conditions) -> Claim {
    let after = |step: &mut Step, _: &mut StepNoise| {
        (step.first_decay, step.second_decay) = (1.0, step.first_decay * step.second_decay);
    };
    order_two(conditions, 0, altered(right(&pendulum(), BuiltIn::Split), None, after))
}
