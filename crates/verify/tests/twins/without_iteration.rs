//! Twins of the schemes without iteration.

use schemes::{Explicit, Increment, SexpLi, Split};
use systems::{
    Damping, Flows, PoissonSystem, Problem,
    paper::{
        maxwell_bloch, pendulum, poisson3_strong, rigid_body_energy, rigid_body_three_noises, valid,
    },
};
use verify::results::Claim;
use verify::{
    Conditions,
    statements::{
        local::{BodyScheme, remainder_claims, scheme_remainder},
        without_iteration::{keeps_casimir, order_two},
    },
};

use super::{
    altered::{Pathwise, altered, damped_after, damped_before, damped_by_first_half, in_a_row},
    conformal::casimir,
    orders::strong,
};

/// `sexp-li` for a problem.
fn right<S: PoissonSystem<D, M>, G, const D: usize, const M: usize>(
    problem: &Problem<S, G, D>,
) -> SexpLi {
    valid(SexpLi::new(problem.system(), problem.y0()))
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
    local(conditions, "local-split", &in_a_row())
}

pub fn strong_shifted(conditions: &Conditions) -> Claim {
    // About a fixed axis, as of a single noise of the other bodies, v does not change.
    strong(conditions, "strong-one", &rigid_body_energy(1.0), &Shifted { shift: 0.0 }, 1.0)
}

pub fn pendulum_in_a_row(conditions: &Conditions) -> Claim {
    strong(conditions, "strong-one", &pendulum(), &in_a_row(), 1.0)
}

pub fn poisson_in_a_row(conditions: &Conditions) -> Claim {
    strong(conditions, "strong-one", &poisson3_strong(), &in_a_row(), 1.0)
}

pub fn sign_in_cayley(conditions: &Conditions) -> Claim {
    casimir(conditions, &Sign)
}

pub fn first_half_twice(conditions: &Conditions) -> Claim {
    let scheme = right(&rigid_body_three_noises(1.0));
    casimir(conditions, &altered(scheme, damped_by_first_half))
}

pub fn first_half_twice_split(conditions: &Conditions) -> Claim {
    casimir(conditions, &altered(Split, damped_by_first_half))
}

pub fn clipped_body(conditions: &Conditions) -> Claim {
    let right = altered(right(&rigid_body_three_noises(1.0)), |step| step);
    let scheme = Pathwise { clips: true, ..right };
    keeps_casimir::<_, _, 3, 3>(conditions, 0, rigid_body_three_noises, &scheme)
}

pub fn clipped_light(conditions: &Conditions) -> Claim {
    let scheme = Pathwise { clips: true, ..altered(Split, |step| step) };
    keeps_casimir::<_, _, 3, 1>(conditions, 0, maxwell_bloch, &scheme)
}

pub fn sign_in_cayley_with_large_noise(conditions: &Conditions) -> Claim {
    keeps_casimir::<_, _, 3, 3>(conditions, 0, rigid_body_three_noises, &Sign)
}

pub fn order_in_a_row<S: Flows<D, M>, G: Damping, const D: usize, const M: usize>(
    conditions: &Conditions,
    problem: &Problem<S, G, D>,
) -> Claim {
    order_two(conditions, problem, &in_a_row())
}

/// `sexp-li` with all of the damping before the rest.
pub fn order_damped_before(conditions: &Conditions) -> Claim {
    let problem = rigid_body_three_noises(1.0);
    let wrong = altered(right(&problem), damped_before);
    order_two::<_, _, 3, 3>(conditions, &problem, &wrong)
}

/// `split` with all of the damping after the rest.
pub fn order_damped_after(conditions: &Conditions) -> Claim {
    let wrong = altered(Split, damped_after);
    order_two::<_, _, 2, 1>(conditions, &pendulum(), &wrong)
}
