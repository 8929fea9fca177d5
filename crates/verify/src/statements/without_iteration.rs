//! `any-increment` and `no-noise`: what the schemes without iteration promise beside their strong
//! and weak orders, see `docs/theory.md`.
//!
//! `any-increment`: on systems where every step has a solution no increment is clipped, every step
//! is solved, and the Casimir is on its conformal law, however large the increments are.
//!
//! `no-noise`: for ordinary differential equations the order is two, since the damping stands
//! symmetrically about the step.

use analysis::worse;
use mc::{Setup, squared_distance, trajectory};
use noise::{BlockNoise, Noise, Truncation};
use schemes::{Scheme, Step};
use systems::{
    Damping, PoissonSystem, Problem,
    paper::{maxwell_bloch, pendulum, poisson3_strong, rigid_body_three_noises, valid},
};

use crate::{
    Conditions, Findings, Method, OtherNoise, PaperSystem,
    conformal_law::{ROUND_OFF, along, largest_defect},
    panels::curves::{Curve, without_iteration},
    results::{Bounded, Claim, Evidence},
    truncation,
};

const METHODS: [Method; 2] = [Method::SexpLi, Method::Split];

pub(super) fn any_increment(conditions: &Conditions) -> Findings {
    let body = every(&rigid_body_three_noises(1.0), |part, scheme| {
        keeps_casimir(conditions, part, rigid_body_three_noises, scheme)
    });
    let light = every(&maxwell_bloch(1.0), |part, scheme| {
        keeps_casimir(conditions, part, maxwell_bloch, scheme)
    });
    [body, light].concat().into()
}

pub(super) fn no_noise(conditions: &Conditions) -> Findings {
    fn orders<S: PaperSystem<D, M>, G: Damping, const D: usize, const M: usize>(
        conditions: &Conditions,
        problem: &Problem<S, G, D>,
    ) -> Vec<Claim> {
        every(problem, |_, scheme| order_two(conditions, problem, scheme))
    }
    [
        orders(conditions, &pendulum()),
        orders(conditions, &rigid_body_three_noises(1.0)),
        orders(conditions, &maxwell_bloch(1.0)),
        orders(conditions, &poisson3_strong()),
    ]
    .concat()
    .into()
}

/// A claim about each of the schemes, which are counted.
fn every<S: PaperSystem<D, M>, G, const D: usize, const M: usize>(
    problem: &Problem<S, G, D>,
    claim: impl Fn(u64, &dyn Scheme<S, D, M>) -> Claim,
) -> Vec<Claim> {
    let schemes = without_iteration(&METHODS, problem);
    let claim = |(part, curve): (u64, &Curve<S, D, M>)| {
        claim(part, curve.scheme.as_ref()).about("", curve.name).proven(false)
    };
    (0..).zip(&schemes).map(claim).collect()
}

/// Sizes of the increments in standard deviations.
const SIZES: [f64; 3] = [1.0, 10.0, 100.0];
const STEPS: u64 = 400;
const TAU: f64 = 0.0625;
const PATHS: u64 = 16;
/// A step at which truncation would clip every third increment, and how many of them.
const LONG_STEP: f64 = 0.9;
const LONG_STEPS: u64 = 16;

/// All steps with increments of all sizes are solved, the first invariant is kept to what counts as
/// round-off on as many steps, and a path with long steps is the same with and without truncation.
pub fn keeps_casimir<S: PoissonSystem<D, M>, G: Damping, const D: usize, const M: usize>(
    conditions: &Conditions,
    part: u64,
    problem: impl Fn(f64) -> Problem<S, G, D>,
    scheme: &dyn Scheme<S, D, M>,
) -> Claim {
    let short = problem(STEPS as f64 * TAU);
    let mut quantities = Vec::new();
    for size in SIZES {
        let noise = |_: &Step, noise: &BlockNoise<M>, p: usize| {
            Noise::increments(noise.increments_of(p).map(|dw| size * dw))
        };
        let scaled = OtherNoise { scheme, noise };
        let (mut solved, mut largest) = (STEPS, 0.0);
        for path in 0..PATHS {
            let path = conditions.path(part, &short, &scaled, STEPS, path);
            solved = solved.min(path.states.len() as u64 - 1);
            largest = worse(largest, largest_defect(&along(&short, 0, &path)));
        }
        let words = format!("solved of {STEPS} steps, increments of {size} standard deviations");
        quantities.push(Bounded::at_least(words, solved as f64, STEPS as f64));
        let words = format!("largest relative defect, increments of {size} standard deviations");
        quantities.push(Bounded::at_most(words, largest, ROUND_OFF));
    }
    let long = problem(LONG_STEPS as f64 * LONG_STEP);
    let end = |truncation| {
        let key = conditions.key(part);
        let path = valid(trajectory(&Setup::of(&long, scheme), LONG_STEPS, truncation, key, 0));
        path.state::<D>(path.states.len() - 1)
    };
    let distance = squared_distance(end(truncation()), end(Truncation::none())).sqrt();
    let words = format!("what clipping increments would change at τ = {LONG_STEP}");
    quantities.push(Bounded::at_most(words, distance, 0.0));
    let statement = format!(
        "{}: every step is solved and the Casimir obeys the conformal law for any increments, of \
         which none is clipped",
        short.system().name()
    );
    Claim::new("any-increment", statement, Evidence::bounds(quantities))
}

/// Steps of the coarsest of three runs.
const COARSE: u64 = 128;
/// Half-way between the order two and that of a composition that is not symmetric is ½.
const SLACK: f64 = 0.25;

/// The order from the ends of three runs without noise.
pub fn order_two<S: PoissonSystem<D, M>, G: Damping, const D: usize, const M: usize>(
    conditions: &Conditions,
    problem: &Problem<S, G, D>,
    scheme: &dyn Scheme<S, D, M>,
) -> Claim {
    let silent = |_: &Step, _: &BlockNoise<M>, _: usize| Noise::increments([0.0; M]);
    let silent = OtherNoise { scheme, noise: silent };
    let [coarse, middle, fine] = [1, 2, 4].map(|finer| {
        let path = conditions.path(0, problem, &silent, finer * COARSE, 0);
        path.state::<D>(path.states.len() - 1)
    });
    let distance = |a, b| squared_distance(a, b).sqrt();
    let order = (distance(coarse, middle) / distance(middle, fine)).log2();
    let words = format!("order from {COARSE}, {} and {} steps", 2 * COARSE, 4 * COARSE);
    let quantities = vec![
        Bounded::at_least(words.clone(), order, 2.0 - SLACK),
        Bounded::at_most(words, order, 2.0 + SLACK),
    ];
    let statement = format!("{}: order two without noise", problem.system().name());
    Claim::new("no-noise", statement, Evidence::bounds(quantities))
}
