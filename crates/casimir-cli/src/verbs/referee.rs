//! Orders of solvers that are not ours.

use casimir::{
    analysis::{
        Decision, Judged, LevelNoise, Limit, Order, Referee, SolverStates, StepSizes, VISITS,
    },
    mc::Observe,
};
use serde_json::json;

use super::{
    Found, coarsest_steps,
    order::{described, figures, series},
};
use crate::{failure::Done, scene::Scene};

/// How a solver is measured.
#[derive(Clone, Copy, Debug)]
pub struct Measure {
    /// Steps of the coarsest size; those of `casimir order` without.
    pub steps: Option<u64>,
    /// Step sizes, each half of the one before.
    pub levels: usize,
    /// Paths, a multiple of 32.
    pub paths: u64,
}

/// What is said of a solver, to be confirmed or refuted, and what was seen of it besides.
#[derive(Clone, Debug, Default)]
pub struct Claims {
    /// Its strong order.
    pub strong: Option<f64>,
    /// Its weak order.
    pub weak: Option<f64>,
    /// Whether it keeps the laws of the scene.
    pub keeps: bool,
    /// Whether it is the same map in each step, so that single steps show its order.
    pub same_step: bool,
    /// How far apart two answers to the same noise were, as a part of the states.
    pub own_noise: f64,
    /// Seconds at each step size, none where they were not taken.
    pub seconds: Vec<f64>,
}

/// Confidence at which points contradict a claim, and how far below it they have to be.
const CONTRADICTION: f64 = 0.999;
const BELOW: f64 = 0.3;
/// Halvings from the finest steps of a solver to those of the reference.
const REFINEMENT: u32 = 3;

/// The referee of a scene.
fn referee(scene: &Scene, measure: Measure) -> Done<Referee<'_>> {
    let settings = &scene.settings;
    let scheme = match scene.model.system().description().noises_commute {
        true => "sexp",
        false if scene.setup("sexp-levy").is_ok() => "sexp-levy",
        false => "sexp",
    };
    let steps = measure.steps.unwrap_or_else(|| coarsest_steps(settings.until));
    let sizes = StepSizes::new(steps, settings.truncation, settings.key);
    let (levels, samples) = (measure.levels, measure.paths);
    let sizes = StepSizes { levels, samples, refinement: REFINEMENT, ..sizes };
    Ok(Referee { setup: scene.setup(scheme)?, sizes })
}

/// What a solver gets for so many paths from path number `first` on: the noise of every step size,
/// coarsest first; and states at time 0 and at the end by the reference, of which the last has
/// steps of twice the size.
///
/// # Errors
/// As of a reference.
pub fn solver_noise(
    scene: &Scene,
    measure: Measure,
    (first, paths): (u64, usize),
) -> Done<(Vec<LevelNoise>, [Vec<f64>; 3])> {
    let referee = referee(scene, measure)?;
    let wrong = |error| scene.steps_error(error);
    let noise = referee.noise(first, paths).map_err(wrong)?;
    Ok((noise, referee.reference(first, paths).map_err(wrong)?))
}

/// The sizes of single steps, each with the noise of one and of two half steps.
///
/// # Errors
/// As of a reference.
pub fn single_steps(scene: &Scene, measure: Measure) -> Done<Vec<(f64, [LevelNoise; 2])>> {
    let referee = referee(scene, measure)?;
    let taus = referee.single_taus().into_iter();
    Ok(taus.map(|tau| (tau, referee.single_noise(tau))).collect())
}

/// The number of states from which single steps begin.
pub const SINGLE_STATES: usize = VISITS;

/// What a claim has come to. A lower order that paths do not contradict counts if all steps are the
/// same map, as single steps are. Where no order is named, single steps confirm the claim of which
/// every possible order is high enough, and points of paths that are clearly lower refute it. Those
/// of means may follow another power, where their error changes its sign.
fn verdict(order: &Order, claimed: f64, same_step: bool, of_paths: bool) -> &'static str {
    let rate = order.rate.as_ref().filter(|rate| !rate.misfits());
    let reaches = rate.map_or(f64::NAN, |rate| rate.interval(CONTRADICTION).1);
    let possible = || order.one_step.iter().flat_map(|step| step.strong_orders());
    let agrees = matches!(order.limit, Limit::Agrees { .. });
    match order.decision {
        Decision::Order { order, .. } if order >= claimed => "confirmed",
        Decision::Kept => "confirmed",
        Decision::WrongLimit => "refuted",
        Decision::Order { .. } if same_step || reaches < claimed => "refuted",
        _ if of_paths && reaches < claimed - BELOW => "refuted",
        _ if agrees
            && reaches >= claimed
            && possible().reduce(f64::min).is_some_and(|least| least >= claimed) =>
        {
            "confirmed"
        }
        _ => "cannot tell",
    }
}

/// Judges the states of a solver.
///
/// # Errors
/// As of a reference.
pub fn judge(
    scene: &Scene,
    measure: Measure,
    states: &SolverStates,
    claims: &Claims,
) -> Done<Found> {
    let referee = referee(scene, measure)?;
    let few = usize::from(scene.expected.is_empty());
    let observables = scene.observables.iter().take(few).chain(&scene.expected);
    let observables: Vec<&dyn Observe> = observables.map(|phi| phi as _).collect();
    let found = referee.judge(&observables, states);
    let Judged { strong, weak, errors, reference_error, laws, solves } = &found;
    let taus: Vec<f64> = (0..measure.levels)
        .map(|l| scene.settings.until / (referee.sizes.coarsest_steps << l) as f64)
        .collect();
    // Rounding in another order of sums is no noise.
    let own_noise = claims.own_noise > 1e-6;
    let (mut text, mut verdicts) = (String::new(), Vec::new());
    let mut say = |what: String, claimed: Option<String>, verdict: &str, words: String| {
        let claim = claimed.as_ref().map_or(String::new(), |c| format!(" {c}: {verdict}"));
        text += &format!("{what}{claim}: {words}\n");
        let claim = claimed.is_some().then_some(verdict);
        verdicts
            .push(json!({ "what": what, "claimed": claimed, "verdict": claim, "words": words }));
    };
    let with_reference = |order: &Order| {
        let words = order.to_string().replace("the exact solution", "the reference");
        words.replace("no order: the scheme converges to something else; ", "another limit; ")
    };
    let strong_words = match (own_noise, solves) {
        _ if strong.decision == Decision::Kept => {
            "exact: its states at all step sizes are the same up to rounding".to_owned()
        }
        (true, _) => "the same increments give other states: it draws noise of its own".to_owned(),
        (_, Some(solves)) => format!("it solves {solves}; {}", with_reference(strong)),
        _ if strong.decision == Decision::WrongLimit => format!(
            "it solves another equation than that of `scene.inspect()`; {}",
            with_reference(strong)
        ),
        _ => with_reference(strong),
    };
    let claimed = match claims.strong {
        Some(_) if own_noise => "refuted",
        claim => claim.map_or("", |claim| verdict(strong, claim, claims.same_step, true)),
    };
    let undecided = matches!(strong.decision, Decision::Undecided { .. });
    let strong_words = match claimed {
        "confirmed" if undecided => format!("no less; by itself {strong_words}"),
        _ => strong_words,
    };
    say("strong order".into(), claims.strong.map(|c| c.to_string()), claimed, strong_words);
    for (name, order) in weak {
        // Errors of means are at most those of paths; and those of a smooth step of Gaussian
        // increments have integer powers of τ, so that an order above zero is one or more.
        let shown = match strong.decision {
            Decision::Kept => f64::INFINITY,
            _ => strong.order().map_or(0.0, |order| order.max(1.0)),
        };
        let follows = |claim| !own_noise && shown >= claim;
        let (claimed, words) =
            match claims.weak.map(|claim| (claim, verdict(order, claim, true, false))) {
                Some((claim, "cannot tell")) if follows(claim) => (
                    "confirmed",
                    "implied by the strong order, for steps that are smooth in ΔW; by itself ",
                ),
                claimed => (claimed.map_or("", |(_, verdict)| verdict), ""),
            };
        let what = format!("weak order of E[{name}]");
        let words = words.to_owned() + &with_reference(order);
        say(what, claims.weak.map(|c| c.to_string()), claimed, words);
    }
    for (name, defect, rounding) in laws {
        let kept = defect <= rounding;
        let words = match kept {
            true => format!("kept to {defect:.0e}, which is rounding"),
            false => format!("defect {defect:.1e}, rounding would be {rounding:.0e}"),
        };
        let claimed = claims.keeps.then(|| "kept".to_owned());
        say(format!("law {name}"), claimed, if kept { "confirmed" } else { "refuted" }, words);
    }
    text += &format!(
        "root mean square errors of y(T), to {reference_error:.0e}, the error of the reference:\n"
    );
    text += "  step      error     ns per path-step\n";
    for (l, (tau, error)) in taus.iter().zip(errors).enumerate() {
        let steps = (referee.sizes.coarsest_steps << l) as f64 * measure.paths as f64;
        let cost = claims.seconds.get(l).map(|s| format!("{:.0}", s / steps * 1e9));
        let cost = cost.unwrap_or_else(|| "–".into());
        text += &format!("  {tau:<8.2e}  {error:<8.2e}  {cost}\n");
    }
    let of_weak = weak.iter().map(|(name, order)| series("solver", name, order));
    let figures = figures(series("solver", "y(T)", strong), &of_weak.collect::<Vec<_>>());
    let json = json!({
        "title": scene.title, "verdicts": verdicts, "strong": described("y(T)", strong),
        "weak": weak.iter().map(|(name, order)| described(name, order)).collect::<Vec<_>>(),
        "laws": laws.iter().map(|(name, defect, rounding)| {
            json!({ "law": name, "defect": defect, "rounding": rounding })
        }).collect::<Vec<_>>(),
        "steps": taus, "errors": errors, "reference_error": reference_error,
        "solves": solves, "own_noise": claims.own_noise, "seconds": claims.seconds,
    });
    Ok(Found { text, json, figures })
}
