//! Invariants along one path, beside their conformal law.

use mc::trajectory;
use schemes::Midpoint;
use stats::Point;
use systems::{Damping, PoissonSystem, Problem};
use verify::results::{Claim, Kind, Panel, Series, Verdict};
use verify::{claim, decide};

use crate::approach::{largest_defect, returns_to_law};
use crate::experiment::{Context, Yield, truncation};
use crate::kernels::Compiled;
use crate::strong::schemes_of_the_paper;

/// What an invariant panel is made of.
pub(crate) struct InvariantSetup {
    pub id: &'static str,
    pub title: &'static str,
    pub paper: &'static str,
    pub setup: String,
    pub steps: u64,
    /// Names of the invariants to show, the one of the paper first.
    pub invariants: &'static [&'static str],
}

/// One path of each scheme on the same noise.
fn invariant_panel<S, G, const D: usize, const M: usize>(
    context: &Context<'_>,
    setup: &InvariantSetup,
    problem: &Problem<S, G, D>,
) -> Panel
where
    S: Compiled<D, M>,
    G: Damping,
{
    let schemes = schemes_of_the_paper::<S, D, M>();
    context.progress.begin(setup.id, setup.steps * schemes.len() as u64);
    let mut failures = Vec::new();
    let paths: Vec<_> = schemes
        .iter()
        .map(|scheme| {
            let path =
                trajectory(problem, scheme.as_ref(), setup.steps, truncation(), context.key(0), 0)
                    .unwrap_or_else(|error| {
                        unreachable!("the set-ups of the paper are valid: {error}")
                    });
            failures.extend(path.failure.map(|failure| failure.to_string()));
            context.progress.advance(setup.steps);
            path
        })
        .collect();
    context.progress.end();

    let known = problem.system.invariants();
    let mut series = Vec::new();
    for &name in setup.invariants {
        let index = position(problem, name);
        for (scheme, path) in schemes.iter().zip(&paths) {
            let initial = problem.system.invariant(index, problem.y0);
            let points: Vec<(f64, f64, f64)> = path
                .times
                .iter()
                .zip(&path.states)
                .map(|(&t, &y)| {
                    let decay = (-known[index].degree * problem.damping.integral(0.0, t)).exp();
                    (t, problem.system.invariant(index, y), decay * initial)
                })
                .collect();
            let defect = largest_defect(problem, index, &path.times, &path.states);
            series.push(Series {
                scheme: scheme.id().to_owned(),
                quantity: name.to_owned(),
                points: points
                    .into_iter()
                    .map(|(t, value, exact)| Point::Value { t, value, exact })
                    .collect(),
                rate: None,
                max_relative_defect: Some(defect),
            });
        }
    }
    Panel {
        id: setup.id.to_owned(),
        kind: Kind::Invariant,
        title: setup.title.to_owned(),
        setup: setup.setup.clone(),
        paper: setup.paper.to_owned(),
        samples: 1,
        reference: "the conformal law exp(−p ∫γ) F(y₀)".to_owned(),
        failures,
        clipped: Vec::new(),
        differences: Vec::new(),
        series,
    }
}

/// Largest relative defect of `sexp` that counts as round-off on the paper's paths of at most 500
/// steps. A step leaves a residual of at most two ulp and a handful of roundings, say 16 ε in all;
/// if none cancelled, 500 steps would give 1.8e-12, as a random walk √500·16 ε = 8e-14. 2e-13 lies
/// between, below the worst case.
pub(crate) const ROUND_OFF_DEFECT: f64 = 2e-13;
/// A relative defect above this is visible in a figure: Euler–Maruyama is expected there.
const VISIBLE_DEFECT: f64 = 1e-3;

/// The panel, with a claim for each curve.
pub(crate) fn invariant_yield<S, G, const D: usize, const M: usize>(
    context: &Context<'_>,
    setup: &InvariantSetup,
    problem: &Problem<S, G, D>,
) -> Yield
where
    S: Compiled<D, M>,
    G: Damping,
{
    let panel = invariant_panel(context, setup, problem);
    let claims = panel
        .series
        .iter()
        .map(|series| {
            let energy = series.quantity == "H";
            let function = if energy { "H" } else { "the Casimir" };
            let defect = series.max_relative_defect.unwrap_or(f64::NAN);
            let mut evidence = format!(
                "largest relative defect of {} along the path: {defect:.1e}",
                series.quantity
            );
            let (statement, verdict, proven) = match series.scheme.as_str() {
                "sexp" => (
                    format!("{function} obeys the conformal law at every step"),
                    decide(defect <= ROUND_OFF_DEFECT),
                    true,
                ),
                "em" => (
                    format!("{function} visibly leaves the conformal law"),
                    decide(defect > VISIBLE_DEFECT),
                    false,
                ),
                _ => {
                    let index = position(problem, &series.quantity);
                    let (returns, how) = returns_to_law(
                        context,
                        problem,
                        S::midpoint(Midpoint::default()).as_ref(),
                        index,
                        setup.steps,
                    );
                    evidence = format!("{evidence}; {how}");
                    let verdict =
                        if defect > ROUND_OFF_DEFECT { returns } else { Verdict::Refuted };
                    (
                        format!("{function} leaves the conformal law, and returns to it as τ → 0"),
                        verdict,
                        false,
                    )
                }
            };
            // A path that ended early proves nothing about the rest.
            let complete = series.points.len() as u64 == setup.steps + 1;
            Claim {
                panel: panel.id.clone(),
                scheme: series.scheme.clone(),
                proven,
                ..claim(
                    if energy { "energy-balance" } else { "conformal-casimir" },
                    &statement,
                    if complete { verdict } else { Verdict::Undecided },
                    evidence,
                )
            }
        })
        .collect();
    Yield { panels: vec![panel], claims }
}

/// Where the system lists its invariant of this name.
fn position<S, G, const D: usize, const M: usize>(problem: &Problem<S, G, D>, name: &str) -> usize
where
    S: PoissonSystem<D, M>,
{
    let known = problem.system.invariants();
    known
        .iter()
        .position(|invariant| invariant.name == name)
        .unwrap_or_else(|| unreachable!("{} has no invariant {name}", problem.system.name()))
}
