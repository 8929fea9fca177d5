//! Referee for the orders of solvers of others.

use crate::{
    order::{described, figures},
    prelude::*,
};
use casimir::{
    analysis::{Claims, LevelNoise, Referee, SolverStates, StepSizes},
    mc::demand,
};

/// Settings for the measurement of a solver.
#[derive(Clone, Copy, Debug)]
pub struct Measure {
    /// Steps of the coarsest size; those of `casimir order` without.
    pub steps: Option<u64>,
    /// Step sizes, each half of the one before.
    pub levels: usize,
    /// Paths, a multiple of 32.
    pub paths: u64,
}

/// Halvings from the finest steps of a solver to those of the reference.
const REFINEMENT: u32 = 3;

/// The referee of a scene.
fn referee(scene: &Scene, measure: Measure) -> Done<Referee<'_>> {
    let settings = &scene.settings;
    let scheme =
        if !scene.model.system().description().noises_commute && scene.setup("sexp-levy").is_ok() {
            "sexp-levy"
        } else {
            "sexp"
        };
    let Measure { steps, levels, paths: samples } = measure;
    let steps = steps.unwrap_or_else(|| coarsest_steps(settings.until));
    // Those of the solver and of the reference, and what is made of them.
    let states = 16.0 * scene.components.len() as f64 * (levels + 4) as f64;
    demand(format!("the states of {samples} paths"), states * samples as f64)?;
    let sizes = StepSizes {
        levels,
        samples,
        refinement: REFINEMENT,
        ..StepSizes::new(steps, settings.truncation, settings.key)
    };
    Ok(Referee { setup: scene.setup(scheme)?, sizes })
}

/// Input of a solver for `paths` paths from path number `first` on: the noise of every step size,
/// coarsest first; and states at time 0 and at the end by the reference, of which the last has
/// steps of twice the size.
///
/// # Errors
/// Errors of the reference.
pub fn solver_noise(
    scene: &Scene,
    measure: Measure,
    (first, paths): (u64, usize),
) -> Done<(Vec<LevelNoise>, [Vec<f64>; 3])> {
    let referee = referee(scene, measure)?;
    let (m, coarsest) = (scene.problem().noises as f64, referee.sizes.coarsest_steps as f64);
    let steps = coarsest * 2f64.powi(measure.levels as i32);
    demand(
        format!("the noise of {paths} paths at {} step sizes", measure.levels),
        8.0 * steps * (2.0 + m) * m * paths as f64,
    )?;
    let wrong = |error| scene.steps_error(error);
    Ok((
        referee.noise(first, paths).map_err(wrong)?,
        referee.reference(first, paths).map_err(wrong)?,
    ))
}

/// The sizes of single steps, each with the noise of one and of two half steps.
///
/// # Errors
/// Errors of the reference.
pub fn single_steps(scene: &Scene, measure: Measure) -> Done<Vec<(f64, [LevelNoise; 2])>> {
    let referee = referee(scene, measure)?;
    Ok(referee.single_taus().into_iter().map(|tau| (tau, referee.single_noise(tau))).collect())
}

/// Judges what is claimed of a solver by its states.
///
/// # Errors
/// Errors of the reference.
pub fn judge(
    scene: &Scene,
    measure: Measure,
    states: &SolverStates,
    claims: &Claims,
) -> Done<Found> {
    let found = referee(scene, measure)?.judge(&observed(scene.tested()), states);
    let verdicts = claims.judge(&found);
    let figures = figures("solver", &found.strong, &found.weak);
    let mut json = json!(found);
    json["verdicts"] = json!(verdicts);
    [json["strong"], json["weak"]] = described(&found.strong, &found.weak);
    Ok(Found::of(scene, [], &format!("{verdicts}{found}"), json, figures))
}
