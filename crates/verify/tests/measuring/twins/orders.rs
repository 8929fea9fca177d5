//! Twins of the convergence orders.

use analysis::{StepSizes, strong_order, weak_order};
use mc::{Observable, Setup};
use noise::{Noise, StepNoise, StreamKey, WienerPath};
use real::WIDTH;
use schemes::{Explicit, Increment, Scheme, Sexp, SexpLevy, Step};
use systems::{
    Damping, PoissonSystem, Problem, RigidBody,
    paper::{rigid_body_one_noise, rigid_body_three_noises, valid},
};
use verify::{
    Conditions, altered,
    results::{Claim, Evidence},
    truncation,
};

/// Step sizes 2⁻⁵ … 2⁻¹², reference 2⁻¹⁴: enough levels and paths to tell order ½ from order 1 on
/// every seed.
fn step_sizes(conditions: &Conditions) -> StepSizes {
    let sizes = StepSizes::new(32, truncation(), conditions.key(0));
    StepSizes { levels: 8, refinement: 2, samples: 512, ..sizes }
}

/// The strong order one of a scheme.
pub fn strong<S: PoissonSystem<D, M>, G: Damping, const D: usize, const M: usize>(
    conditions: &Conditions,
    problem: &Problem<S, G, D>,
    scheme: &dyn Scheme<S, D, M>,
) -> Claim {
    altered_strong(conditions, problem, scheme, 1.0, |_, _| ())
}

/// The strong order of a scheme on another noise than it should have.
fn altered_strong<S: PoissonSystem<D, M>, G: Damping, const D: usize, const M: usize>(
    conditions: &Conditions,
    problem: &Problem<S, G, D>,
    scheme: &dyn Scheme<S, D, M>,
    order: f64,
    change: impl Fn(&mut Step, &mut StepNoise) + Send + Sync,
) -> Claim {
    // Areas cost more normals the finer the steps: 2⁻⁴ … 2⁻¹¹ and a reference at 2⁻¹³ will do.
    let coarsest_steps = if scheme.about().reads_areas { 16 } else { 32 };
    let sizes = StepSizes { coarsest_steps, ..step_sizes(conditions) };
    let setup = altered(Setup::of(problem, scheme), false, change);
    let measured = Evidence::of_order(valid(strong_order(&setup, &sizes)), order);
    Claim::new(conditions.id, format!("strong order {order}"), measured)
}

/// Euler–Maruyama with the Itô correction taken `factor` times.
pub struct Miscorrected {
    pub factor: f64,
}

impl Explicit for Miscorrected {
    const ID: &'static str = "em, wrong correction";

    #[inline(always)]
    fn advance<H: Increment>(&self, h: H, y: H::Vector) -> H::Vector {
        let step = h.step();
        let drift = h.ito_correction(y) * self.factor - y * step.rate_at_start;
        y + (h.field(y) + drift * step.tau)
    }
}

/// The weak order one of it.
pub fn weak(conditions: &Conditions, factor: f64) -> Claim {
    let observable = Observable { name: "y3", function: |y: [f64; 3]| y[2] };
    let sizes = StepSizes { levels: 6, samples: 2048, ..step_sizes(conditions) };
    let (problem, wrong) = (rigid_body_three_noises(1.0), Miscorrected { factor });
    let measured = valid(weak_order(&Setup::of(&problem, &wrong), &observable, &sizes, None));
    let measured = Evidence::of_order(measured, 1.0);
    Claim::new(conditions.id, "weak order 1 for φ = y3", measured)
}

/// The strong order ½ of a scheme on another noise than it should have, three of them.
pub fn half(
    conditions: &Conditions,
    scheme: &dyn Scheme<RigidBody<3>, 3, 3>,
    change: impl Fn(&mut Step, &mut StepNoise) + Send + Sync,
) -> Claim {
    altered_strong(conditions, &rigid_body_three_noises(1.0), scheme, 0.5, change)
}

pub fn truncated_too_early(conditions: &Conditions) -> Claim {
    let problem = rigid_body_one_noise();
    let clamp = |step: &mut Step, noise: &mut StepNoise| {
        let bound = 0.5 * step.tau.sqrt();
        noise.increments[0].iter_mut().for_each(|dw| *dw = dw.clamp(-bound, bound));
    };
    altered_strong::<_, _, 3, 1>(conditions, &problem, &Sexp, 1.0, clamp)
}

/// The strong order of `sexp-levy` on the right increments and the wrong areas.
fn with_areas(
    conditions: &Conditions,
    change: impl Fn(&mut Step, &mut StepNoise) + Send + Sync,
) -> Claim {
    let problem = rigid_body_three_noises(1.0);
    let levy = SexpLevy::new(problem.system(), problem.y0());
    altered_strong::<_, _, 3, 3>(conditions, &problem, &levy, 1.0, change)
}

/// Areas times a factor: of the wrong sign, or none.
pub fn scaled_areas(conditions: &Conditions, factor: f64) -> Claim {
    with_areas(conditions, move |_, noise| {
        noise.areas.as_flattened_mut().iter_mut().for_each(|area| *area *= factor);
    })
}

/// Normal areas with the right variance given the increments, (τ² + τ(ΔWₘ² + ΔW_l²))/12, drawn for
/// each step of each step size by itself: the stream is keyed by the bits of the increments, so
/// that the twin is reproducible.
pub fn fresh_areas(conditions: &Conditions) -> Claim {
    with_areas(conditions, |step, noise| {
        for p in 0..WIDTH {
            let Noise { increments, mut areas, .. } = noise.path::<3>(p);
            let [a, b, c] = increments.map(f64::to_bits);
            let key = StreamKey { seed: a ^ b.rotate_left(21), experiment: c ^ step.tau.to_bits() };
            let mut normals = WienerPath::<3>::new(key, 0);
            for (m, l) in [(0, 1), (0, 2), (1, 2)] {
                let squares = increments[m].powi(2) + increments[l].powi(2);
                let deviation = (step.tau * (step.tau + squares) / 12.0).sqrt();
                areas[m][l] = deviation * normals.normal();
            }
            noise.set_path(p, &Noise { areas, ..Noise::increments(increments) });
        }
    })
}
