//! Twins of the conformal laws and of the bounds that follow from them.

use lab::conformal_law::{ROUND_OFF, along, approach, largest_defect};
use lab::statements::{exact_conformal, moment_bound};
use lab::{Conditions, truncation};
use mc::trajectory;
use noise::{BlockNoise, Noise};
use nonlin::{BlockStatus, Solution};
use real::{Block, WIDTH};
use schemes::{EulerMaruyama, Implicit, Increment, Scheme, Sexp, Step};
use systems::paper::{lotka_volterra_2_2, rigid_body_three_noises, valid};
use systems::{Damping, PoissonSystem, Problem, RigidBody, vector_field};
use verify::results::{Claim, Evidence};

use super::wrong_systems::{MidpointGradient, SignError};

/// The problem with another system.
fn with_system<S, T, G, const M: usize>(
    problem: Problem<S, G, 3>,
    wrong: impl FnOnce(S) -> T,
) -> Problem<T, G, 3>
where
    T: PoissonSystem<3, M>,
    G: Damping,
{
    let Problem { system, damping, y0, t_end } = problem;
    valid(Problem::new(wrong(system), damping, y0, t_end))
}

/// Steps of τ = 0.1 on [0, 10], as in the invariant panels.
const STEPS: u64 = 100;

/// The claim of the invariant panels about one scheme, first invariant of the system.
fn obeys_law<S, G, const M: usize>(
    conditions: &Conditions<'_>,
    id: &str,
    problem: &Problem<S, G, 3>,
    scheme: &dyn Scheme<S, 3, M>,
) -> Claim
where
    S: PoissonSystem<3, M>,
    G: Damping,
{
    let path = valid(trajectory(problem, scheme, STEPS, truncation(), conditions.key(0), 0));
    let measured = Evidence::Defect {
        invariant: problem.system.invariants()[0].name.to_owned(),
        paths: 1,
        steps: STEPS,
        largest: largest_defect(&along(problem, 0, &path)),
        tolerance: ROUND_OFF,
        obeys: true,
    };
    Claim::new(id, "the conformal law holds at every step", measured)
}

pub fn sign_in_exact_flow(conditions: &Conditions<'_>) -> Claim {
    let problem = with_system::<_, _, _, 3>(rigid_body_three_noises(1.0), SignError);
    exact_conformal::law(conditions, 0, &problem).swap_remove(0)
}

pub fn sign_in_structure(conditions: &Conditions<'_>) -> Claim {
    let problem = with_system::<_, _, _, 3>(rigid_body_three_noises(10.0), SignError);
    obeys_law::<_, _, 3>(conditions, "conformal-casimir", &problem, &Sexp::default())
}

/// `sexp` with e^{−∫γ} over the first half for both halves: with δ that factor, the equation of
/// z = y_{n+1} is z = δ(ẑ + B((ẑ + w)/2)∇̄h(ẑ, w)), ẑ = δy_n, w = z/δ.
struct FirstHalfTwice;

impl Implicit for FirstHalfTwice {
    const ID: &'static str = "sexp, first half twice";

    #[inline(always)]
    fn psi<H: Increment>(&self, h: H, start: H::Vector, z: H::Vector) -> H::Vector {
        let decay = h.step().first_decay;
        let start = start * decay;
        (start + h.averaged_field(start, z * (1.0 / decay))) * decay
    }
}

pub fn damping_of_the_wrong_half(conditions: &Conditions<'_>) -> Claim {
    let problem = rigid_body_three_noises(10.0);
    obeys_law::<_, _, 3>(conditions, "conformal-casimir", &problem, &FirstHalfTwice)
}

/// The drift by `sexp`, the noise added at the old state.
struct DriftThenNoise;

impl Scheme<RigidBody<3>, 3, 3> for DriftThenNoise {
    fn id(&self) -> &'static str {
        "sexp, explicit noise"
    }

    fn reads_areas(&self) -> bool {
        false
    }

    fn clips_increments(&self) -> bool {
        true
    }

    fn step_block(
        &self,
        system: &RigidBody<3>,
        step: &Step,
        noise: &BlockNoise<3>,
        y: &mut Block<3>,
        status: &mut BlockStatus,
    ) {
        *status = BlockStatus::explicit();
        for p in 0..WIDTH {
            y.set_path(p, self.step(system, step, &noise.path(p), y.path(p)).z);
        }
        status.fail_where_not_finite(y);
    }

    fn step(
        &self,
        system: &RigidBody<3>,
        step: &Step,
        noise: &Noise<3>,
        y: [f64; 3],
    ) -> Solution<3> {
        let change = vector_field(system, y, 0.0, noise.increments);
        let drift = Sexp::default().step(system, step, &Noise::increments([0.0; 3]), y);
        Solution { z: std::array::from_fn(|i| drift.z[i] + change[i]), ..drift }
    }
}

pub fn explicit_noise(conditions: &Conditions<'_>) -> Claim {
    let problem = rigid_body_three_noises(10.0);
    obeys_law(conditions, "conformal-casimir", &problem, &DriftThenNoise)
}

pub fn explicit_noise_at_small_steps(conditions: &Conditions<'_>) -> Claim {
    // Up to T = 1: the Casimir of the wrong method grows, and much later its paths have no
    // solution.
    let problem = rigid_body_three_noises(1.0);
    let (steps, key) = (STEPS / 10, conditions.key(0));
    let path = valid(trajectory(&problem, &DriftThenNoise, steps, truncation(), key, 0));
    let largest = largest_defect(&along(&problem, 0, &path));
    let measured = approach(conditions, &problem, &DriftThenNoise, 0, steps, largest);
    let statement = "the Casimir returns to the conformal law as τ → 0";
    Claim::new("conformal-casimir", statement, measured)
}

pub fn midpoint_quadrature(conditions: &Conditions<'_>) -> Claim {
    let problem = with_system::<_, _, _, 1>(lotka_volterra_2_2(10.0), MidpointGradient);
    obeys_law::<_, _, 1>(conditions, "energy-balance", &problem, &Sexp::default())
}

pub fn unbounded_scheme(conditions: &Conditions<'_>) -> Claim {
    let problem = moment_bound::undamped();
    moment_bound::bound::<_, _, 3>(conditions, 0, &problem, &EulerMaruyama, "C", 0.5)
}
