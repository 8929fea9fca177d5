//! Referee for the orders of solvers of others.

use casimir::{
    analysis::{Decision, Judged, LevelNoise, Referee, SolverStates, StepSizes, Verdict},
    mc::{Observe, demand},
};
use serde_json::{Value, json};

use super::{
    Found, coarsest_steps,
    order::{described, figures},
};
use crate::failure::Done;
use scenes::Scene;

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

/// Claims about a solver, to be confirmed or refuted, and observations of it.
#[derive(Clone, Debug, Default)]
pub struct Claims {
    /// Claimed strong order.
    pub strong: Option<f64>,
    /// Claimed weak order.
    pub weak: Option<f64>,
    /// Whether the solver is claimed to conserve the laws of the scene.
    pub keeps: bool,
    /// Whether the solver is the same map in each step, so that single steps show its order.
    pub same_step: bool,
    /// Whether two answers to the same noise differed.
    pub own_noise: bool,
    /// Seconds at each step size, none where they were not taken.
    pub seconds: Vec<f64>,
}

/// Halvings from the finest steps of a solver to those of the reference.
const REFINEMENT: u32 = 3;

/// The referee of a scene.
fn referee(scene: &Scene, measure: Measure) -> Done<Referee<'_>> {
    let settings = &scene.settings;
    let areas = !scene.model.system().description().noises_commute;
    let scheme = if areas && scene.setup("sexp-levy").is_ok() { "sexp-levy" } else { "sexp" };
    let steps = measure.steps.unwrap_or_else(|| coarsest_steps(settings.until));
    let sizes = StepSizes::new(steps, settings.truncation, settings.key);
    let (levels, samples) = (measure.levels, measure.paths);
    // Those of the solver and of the reference, and what is made of them.
    let states = 16.0 * scene.components.len() as f64 * (levels + 4) as f64;
    demand(format!("the states of {samples} paths"), states * samples as f64)?;
    let sizes = StepSizes { levels, samples, refinement: REFINEMENT, ..sizes };
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
    let what = format!("the noise of {paths} paths at {} step sizes", measure.levels);
    demand(what, 8.0 * steps * (2.0 + m) * m * paths as f64)?;
    let wrong = |error| scene.steps_error(error);
    let noise = referee.noise(first, paths).map_err(wrong)?;
    Ok((noise, referee.reference(first, paths).map_err(wrong)?))
}

/// The sizes of single steps, each with the noise of one and of two half steps.
///
/// # Errors
/// Errors of the reference.
pub fn single_steps(scene: &Scene, measure: Measure) -> Done<Vec<(f64, [LevelNoise; 2])>> {
    let referee = referee(scene, measure)?;
    let taus = referee.single_taus().into_iter();
    Ok(taus.map(|tau| (tau, referee.single_noise(tau))).collect())
}

/// Judges the states of a solver.
///
/// # Errors
/// Errors of the reference.
pub fn judge(
    scene: &Scene,
    measure: Measure,
    states: &SolverStates,
    claims: &Claims,
) -> Done<Found> {
    let referee = referee(scene, measure)?;
    let observables: Vec<&dyn Observe> = scene.tested().map(|phi| phi as _).collect();
    let found = referee.judge(&observables, states);
    let Judged { strong, weak, taus, errors, reference_error, laws, solves } = &found;
    let own_noise = claims.own_noise;
    let (mut text, mut verdicts) = (String::new(), Vec::new());
    let mut say = |what: String, claim: Option<(String, Verdict)>, words: String| {
        let (claimed, verdict) = claim.unzip();
        let verdict = verdict.map(|verdict| match verdict {
            Verdict::Confirmed => "confirmed",
            Verdict::Refuted => "refuted",
            Verdict::CannotTell => "cannot tell",
        });
        text += &what;
        if let (Some(claimed), Some(verdict)) = (&claimed, verdict) {
            text += &format!(" {claimed}: {verdict}");
        }
        text += &format!(": {words}\n");
        verdicts
            .push(json!({ "what": what, "claimed": claimed, "verdict": verdict, "words": words }));
    };
    let claim = claims.strong.map(|claimed| match own_noise {
        true => (claimed, Verdict::Refuted),
        false => (claimed, strong.is_strongly(claimed, claims.same_step)),
    });
    let confirmed = claim.is_some_and(|(_, verdict)| verdict == Verdict::Confirmed);
    let words = match (&strong.decision, solves) {
        _ if own_noise => "the same increments give other states: it draws noise of its own".into(),
        (Decision::Kept, _) => "exact: all step sizes give the same states up to rounding".into(),
        (_, Some(solves)) => format!("it solves {solves}; {strong}"),
        (Decision::WrongLimit, None) => {
            format!("it solves another equation than that of `scene.inspect()`; {strong}")
        }
        (Decision::Undecided { .. }, _) if confirmed => format!("no less; by itself {strong}"),
        _ => strong.to_string(),
    };
    let told = |claim: Option<(f64, Verdict)>| claim.map(|(order, v)| (order.to_string(), v));
    say("strong order".into(), told(claim), words);
    for (name, order) in weak {
        let mut claim = claims.weak.map(|claimed| (claimed, order.is_weakly(claimed)));
        let mut words = order.to_string();
        if let Some((claimed, verdict @ Verdict::CannotTell)) = &mut claim
            && !own_noise
            && strong.implies_weakly(order, *claimed)
        {
            *verdict = Verdict::Confirmed;
            words = format!(
                "implied by the strong order, for steps that are smooth in τ and ΔW; by itself \
                 {order}"
            );
        }
        say(format!("weak order of E[{name}]"), told(claim), words);
    }
    for (name, defect, rounding) in laws {
        let (verdict, words) = if defect <= rounding {
            (Verdict::Confirmed, format!("kept to {defect:.0e}, which is rounding"))
        } else {
            let words = format!("defect {defect:.1e}, rounding would be {rounding:.0e}");
            (Verdict::Refuted, words)
        };
        let claim = claims.keeps.then(|| ("kept".to_owned(), verdict));
        say(format!("law {name}"), claim, words);
    }
    text += &format!(
        "root mean square errors of y(T), to {reference_error:.0e}, the error of the reference:\n"
    );
    text += "  step      error     ns per path-step\n";
    for (l, (tau, error)) in taus.iter().zip(errors).enumerate() {
        let steps = (referee.sizes.coarsest_steps << l) as f64 * measure.paths as f64;
        let cost = claims.seconds.get(l);
        let cost = cost.map_or("–".into(), |seconds| format!("{:.0}", seconds / steps * 1e9));
        text += &format!("  {tau:<8.2e}  {error:<8.2e}  {cost}\n");
    }
    let figures = figures("solver", strong, weak);
    let laws = laws.iter().map(
        |(name, defect, rounding)| json!({ "law": name, "defect": defect, "rounding": rounding }),
    );
    let [strong, weak] = described(strong, weak);
    let json = json!({
        "verdicts": verdicts, "strong": strong, "weak": weak,
        "laws": laws.collect::<Value>(), "steps": taus, "errors": errors,
        "reference_error": reference_error, "solves": solves, "own_noise": own_noise,
        "seconds": claims.seconds,
    });
    Ok(Found::of(scene, [], &text, json, figures))
}
