//! Twins of the schemes without iteration and of the one-step remainders.

use kernels::Tuned;
use mc::Setup;
use noise::StepNoise;
use schemes::{BuiltIn, Composition, Explicit, Increment, Paths, Sexp, Step, Times};
use systems::{
    Damping, Flows, Problem,
    paper::{pendulum, rigid_body_three_noises},
};
use verify::{
    Compiled, Conditions, altered,
    results::Claim,
    statements::{
        local::{self, BodyScheme, PIECES, Vector, difference, remainder_claims, scheme_remainder},
        without_iteration::{keeps_casimir, order_two},
    },
};

use super::conformal::obeys_law;

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
    let [claim, _] = remainder_claims(conditions, "the exact flow", remainder);
    claim
}

/// The expansion of the scheme without ½Σ fₘ′f_l ΔŴ_lΔŴₘ.
pub fn local_without_second_order(conditions: &Conditions) -> Claim {
    let remainder = |tau: f64, pieces: &[Vector; PIECES]| {
        difference(local::scheme_end(&Sexp, tau, pieces)[0], local::first_order(tau, whole(pieces)))
    };
    let [claim, _] = remainder_claims(conditions, "sexp", remainder);
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
pub struct Shifted {
    pub shift: f64,
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
pub struct Sign;

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
pub fn local(conditions: &Conditions, scheme: &BodyScheme) -> Claim {
    let remainder = |tau: f64, pieces: &_| scheme_remainder(scheme, tau, pieces);
    let [claim, _] = remainder_claims(conditions, scheme.about().id, remainder);
    claim
}

/// The damping of the first half for both halves.
pub fn first_half_twice(conditions: &Conditions, scheme: BuiltIn) -> Claim {
    let problem = rigid_body_three_noises(10.0);
    let change = |step: &mut Step, _: &mut StepNoise| step.second_decay = step.first_decay;
    let wrong = altered(right(&problem, scheme), false, change);
    obeys_law(conditions, &wrong)
}

/// The right scheme on clipped increments.
pub fn clipped<S: Tuned<D, M>, G: Damping, const D: usize, const M: usize>(
    conditions: &Conditions,
    problem: &Problem<S, G, D>,
    scheme: BuiltIn,
) -> Claim {
    keeps_casimir(conditions, 0, altered(right(problem, scheme), true, |_, _| ()))
}

/// `sexp-li` with all of the damping before the rest.
pub fn order_damped_before(conditions: &Conditions) -> Claim {
    let problem = rigid_body_three_noises(1.0);
    let before = |step: &mut Step, _: &mut StepNoise| {
        (step.first_decay, step.second_decay) = (step.first_decay * step.second_decay, 1.0);
    };
    order_two(conditions, 0, altered(right(&problem, BuiltIn::SexpLi), false, before))
}

/// `split` with all of the damping after the rest.
pub fn order_damped_after(conditions: &Conditions) -> Claim {
    let after = |step: &mut Step, _: &mut StepNoise| {
        (step.first_decay, step.second_decay) = (1.0, step.first_decay * step.second_decay);
    };
    order_two(conditions, 0, altered(right(&pendulum(), BuiltIn::Split), false, after))
}
