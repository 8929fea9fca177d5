//! `any-increment` and `no-noise`: properties of the schemes without iteration beside their strong
//! and weak orders, see `docs/theory.md`.
//!
//! `any-increment`: on systems where every step has a solution no increment is clipped, every step
//! is solved, and the Casimir is on its conformal law, however large the increments are.
//!
//! `no-noise`: for ordinary differential equations the order is two, since the damping stands
//! symmetrically about the step.

use crate::{conformal_law::ROUND_OFF, *};

pub(super) fn any_increment(conditions: &Conditions) -> Findings {
    let (body, light) = (rigid_body_three_noises(1.0), paper::maxwell_bloch(1.0));
    of_each(conditions, [Compiled::of(&body), Compiled::of(&light)], keeps_casimir)
}

pub(super) fn no_noise(conditions: &Conditions) -> Findings {
    let (pendulum, body) = (paper::pendulum(), rigid_body_three_noises(1.0));
    let (light, poisson) = (paper::maxwell_bloch(1.0), paper::poisson3_strong());
    let (pendulum, body) = (Compiled::of(&pendulum), Compiled::of(&body));
    of_each(conditions, [pendulum, body, Compiled::of(&light), Compiled::of(&poisson)], order_two)
}

/// Makes a claim about each of the schemes on each problem; the schemes are counted.
fn of_each<'a>(
    conditions: &Conditions,
    problems: impl IntoIterator<Item = Compiled<'a>>,
    claim: fn(&Conditions, u64, Setup<'_>) -> Claim,
) -> Findings {
    let schemes = [BuiltIn::SexpLi, BuiltIn::Split];
    let curves = problems.into_iter().flat_map(|problem| (0..).zip(problem.curves(&schemes)));
    Findings::of(curves.map(|(part, Curve { name, setup, .. })| {
        claim(conditions, part, setup).about("", name).proven(false)
    }))
}

/// Alters a set-up: increments are multiplied by `factor`.
fn scaled(setup: Setup<'_>, factor: f64) -> Setup<'_> {
    altered(setup, false, move |_: &mut Step, noise: &mut StepNoise| {
        noise.increments.as_flattened_mut().iter_mut().for_each(|dw| *dw *= factor);
    })
}

const STEPS: u64 = 400;
const TAU: f64 = 0.0625;
const PATHS: u64 = 16;
/// Step size at which truncation would clip every third increment, and the number of such steps.
const LONG_STEP: f64 = 0.9;
const LONG_STEPS: u64 = 16;

/// Checks steps with increments of 1, 10 and 100 standard deviations: all steps are solved, and the
/// first invariant obeys its law to [`ROUND_OFF`]. A path with long steps must be the same with and
/// without truncation.
pub fn keeps_casimir(conditions: &Conditions, part: u64, mut setup: Setup<'_>) -> Claim {
    let mut quantities = Vec::new();
    setup.problem.t_end = STEPS as f64 * TAU;
    for size in [1.0, 10.0, 100.0] {
        let setup = scaled(setup.clone(), size);
        let (mut solved, mut largest) = (STEPS, 0.0);
        for path in 0..PATHS {
            let path = conditions.path(part, &setup, STEPS, path);
            solved = solved.min(path.len() as u64 - 1);
            largest = worse(largest, largest_defect(&setup.problem, 0, &path));
        }
        let of_size = format!("increments of {size} standard deviations");
        let words = format!("solved of {STEPS} steps, {of_size}");
        quantities.push(Bounded::at_least(words, solved as f64, STEPS as f64));
        let words = format!("largest relative defect, {of_size}");
        quantities.push(Bounded::at_most(words, largest, ROUND_OFF));
    }
    setup.problem.t_end = LONG_STEPS as f64 * LONG_STEP;
    let [clipped, free] = [truncation(), Truncation::none()]
        .map(|truncation| followed(&setup, LONG_STEPS, truncation, conditions.key(part), 0));
    let words = format!("what clipping increments would change at τ = {LONG_STEP}");
    quantities.push(Bounded::at_most(words, apart(&clipped, &free), 0.0));
    let statement = format!(
        "{}: every step is solved and the Casimir obeys the conformal law for any increments, of \
         which none is clipped",
        setup.problem.name
    );
    Claim::new("any-increment", statement, Evidence::bounds(quantities))
}

/// Distance of the ends of two paths.
fn apart(one: &Path, other: &Path) -> f64 {
    distance(&one[one.len() - 1].1, &other[other.len() - 1].1)
}

/// Number of steps of the coarsest of three runs.
const COARSE: u64 = 128;

/// Measures the order from the ends of three runs without noise: half-way between the order two and
/// that of a composition that is not symmetric is ½.
pub fn order_two(conditions: &Conditions, _part: u64, setup: Setup<'_>) -> Claim {
    let setup = scaled(setup, 0.0);
    let [coarse, middle, fine] =
        [1, 2, 4].map(|finer| conditions.path(0, &setup, finer * COARSE, 0));
    let order = elementary::log2(apart(&coarse, &middle) / apart(&middle, &fine));
    let words = format!("order from {COARSE}, {} and {} steps", 2 * COARSE, 4 * COARSE);
    let quantities =
        [Bounded::at_least(words.clone(), order, 1.75), Bounded::at_most(words, order, 2.25)];
    let statement = format!("{}: order two without noise", setup.problem.name);
    Claim::new("no-noise", statement, Evidence::bounds(quantities))
}
