//! `any-increment` and `no-noise`: what the schemes without iteration promise beside their strong
//! and weak orders, see `docs/theory.md`.
//!
//! `any-increment`: on systems where every step has a solution no increment is clipped, every step
//! is solved, and the Casimir is on its conformal law, however large the increments are.
//!
//! `no-noise`: for ordinary differential equations the order is two, since the damping stands
//! symmetrically about the step.

use analysis::worse;
use mc::Setup;
use noise::Truncation;
use schemes::BuiltIn;
use systems::paper::{maxwell_bloch, pendulum, poisson3_strong, rigid_body_three_noises};

use crate::{
    Altered, Compiled, Conditions, Findings,
    conformal_law::{ROUND_OFF, largest_defect},
    experiment::{Path, followed, squared_distance},
    results::{Bounded, Claim, Evidence},
    truncation,
};

pub(super) fn any_increment(conditions: &Conditions) -> Findings {
    let (body, light) = (rigid_body_three_noises(1.0), maxwell_bloch(1.0));
    of_each(&[Compiled::of(&body), Compiled::of(&light)], |part, setup| {
        keeps_casimir(conditions, part, setup)
    })
}

pub(super) fn no_noise(conditions: &Conditions) -> Findings {
    let (pendulum, body) = (pendulum(), rigid_body_three_noises(1.0));
    let (light, poisson) = (maxwell_bloch(1.0), poisson3_strong());
    let problems = [
        Compiled::of(&pendulum),
        Compiled::of(&body),
        Compiled::of(&light),
        Compiled::of(&poisson),
    ];
    of_each(&problems, |_, setup| order_two(conditions, setup))
}

/// A claim about each of the schemes on each problem; the schemes are counted.
fn of_each(problems: &[Compiled<'_>], claim: impl Fn(u64, Setup<'_>) -> Claim) -> Findings {
    let mut claims = Vec::new();
    for problem in problems {
        let curves = problem.curves(&[BuiltIn::SexpLi, BuiltIn::Split]);
        claims.extend(
            (0..)
                .zip(curves)
                .map(|(part, curve)| claim(part, curve.setup).about("", curve.name).proven(false)),
        );
    }
    claims.into()
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
pub fn keeps_casimir(conditions: &Conditions, part: u64, mut setup: Setup<'_>) -> Claim {
    let mut quantities = Vec::new();
    setup.problem.t_end = STEPS as f64 * TAU;
    for size in SIZES {
        let method = setup.scheme.clone();
        setup = Altered::setup(setup, |method| method.factor = size);
        let (mut solved, mut largest) = (STEPS, 0.0);
        for path in 0..PATHS {
            let path = conditions.path(part, &setup, STEPS, path);
            solved = solved.min(path.len() as u64 - 1);
            largest = worse(largest, largest_defect(&setup.problem, 0, &path));
        }
        setup.scheme = method;
        let words = format!("solved of {STEPS} steps, increments of {size} standard deviations");
        quantities.push(Bounded::at_least(words, solved as f64, STEPS as f64));
        let words = format!("largest relative defect, increments of {size} standard deviations");
        quantities.push(Bounded::at_most(words, largest, ROUND_OFF));
    }
    setup.problem.t_end = LONG_STEPS as f64 * LONG_STEP;
    let [clipped, free] = [truncation(), Truncation::none()]
        .map(|truncation| followed(&setup, LONG_STEPS, truncation, conditions.key(part), 0));
    let words = format!("what clipping increments would change at τ = {LONG_STEP}");
    quantities.push(Bounded::at_most(words, distance(&clipped, &free), 0.0));
    let statement = format!(
        "{}: every step is solved and the Casimir obeys the conformal law for any increments, of \
         which none is clipped",
        setup.problem.name
    );
    Claim::new("any-increment", statement, Evidence::bounds(quantities))
}

/// How far apart two paths end.
fn distance(one: &Path, other: &Path) -> f64 {
    let [one, other] = [one, other].map(|path| &path[path.len() - 1].1);
    squared_distance(one, other).sqrt()
}

/// Steps of the coarsest of three runs.
const COARSE: u64 = 128;
/// Half-way between the order two and that of a composition that is not symmetric is ½.
const SLACK: f64 = 0.25;

/// The order from the ends of three runs without noise.
pub fn order_two(conditions: &Conditions, setup: Setup<'_>) -> Claim {
    let setup = Altered::setup(setup, |method| method.factor = 0.0);
    let [coarse, middle, fine] =
        [1, 2, 4].map(|finer| conditions.path(0, &setup, finer * COARSE, 0));
    let order = (distance(&coarse, &middle) / distance(&middle, &fine)).log2();
    let words = format!("order from {COARSE}, {} and {} steps", 2 * COARSE, 4 * COARSE);
    let quantities = vec![
        Bounded::at_least(words.clone(), order, 2.0 - SLACK),
        Bounded::at_most(words, order, 2.0 + SLACK),
    ];
    let statement = format!("{}: order two without noise", setup.problem.name);
    Claim::new("no-noise", statement, Evidence::bounds(quantities))
}
