//! Twins of the schemes without iteration.

use kernels::Tuned;
use mc::Setup;
use schemes::{BuiltIn, Composed, Explicit, Increment};
use systems::{
    Damping, Flows, Problem,
    paper::{maxwell_bloch, pendulum, poisson3_strong, rigid_body_energy, rigid_body_three_noises},
};
use verify::{
    Altered, Compiled, Conditions,
    results::Claim,
    statements::{
        local::{BodyScheme, remainder_claims, scheme_remainder},
        without_iteration::{keeps_casimir, order_two},
    },
};

use super::{
    altered::{InARow, damped_after, damped_before, damped_by_first_half},
    conformal::{casimir, obeys_law},
    orders::strong,
};

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
    remainder_claims(conditions, id, scheme.id(), remainder).swap_remove(0)
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

pub fn first_half_twice(conditions: &Conditions, scheme: BuiltIn) -> Claim {
    let problem = rigid_body_three_noises(10.0);
    let wrong = Altered::setup(right(&problem, scheme), |m| m.step = damped_by_first_half);
    obeys_law(conditions, "conformal-casimir", &wrong)
}

pub fn clipped_body(conditions: &Conditions) -> Claim {
    let problem = rigid_body_three_noises(1.0);
    keeps_casimir(
        conditions,
        0,
        Altered::setup(right(&problem, BuiltIn::SexpLi), |m| m.clips = true),
    )
}

pub fn clipped_light(conditions: &Conditions) -> Claim {
    let problem = maxwell_bloch(1.0);
    keeps_casimir(
        conditions,
        0,
        Altered::setup(right(&problem, BuiltIn::Split), |m| m.clips = true),
    )
}

pub fn sign_in_cayley_with_large_noise(conditions: &Conditions) -> Claim {
    let problem = rigid_body_three_noises(1.0);
    keeps_casimir(conditions, 0, Setup::of::<_, _, 3, 3>(&problem, &Sign))
}

pub fn order_in_a_row<S: Flows<D, M>, G: Damping, const D: usize, const M: usize>(
    conditions: &Conditions,
    problem: &Problem<S, G, D>,
) -> Claim {
    order_two(conditions, Setup::of(problem, &Composed(InARow)))
}

/// `sexp-li` with all of the damping before the rest.
pub fn order_damped_before(conditions: &Conditions) -> Claim {
    let problem = rigid_body_three_noises(1.0);
    order_two(
        conditions,
        Altered::setup(right(&problem, BuiltIn::SexpLi), |m| m.step = damped_before),
    )
}

/// `split` with all of the damping after the rest.
pub fn order_damped_after(conditions: &Conditions) -> Claim {
    order_two(
        conditions,
        Altered::setup(right(&pendulum(), BuiltIn::Split), |m| m.step = damped_after),
    )
}
