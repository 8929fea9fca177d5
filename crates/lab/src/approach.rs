//! A scheme that leaves the conformal law, and returns to it as the step shrinks.

use mc::trajectory;
use schemes::Scheme;
use stats::Moments;
use systems::{Damping, PoissonSystem, Problem};
use verify::results::Verdict;
use verify::{DEVIATIONS, worse};

use crate::experiment::{Context, truncation};

/// Paths at each of the two steps. A single path proves nothing: the largest defect along one of
/// them has a heavy tail.
const PATHS: u64 = 32;
/// How much finer the second step is.
const REFINEMENT: u64 = 64;
/// Between the order 0 of a scheme that solves another equation and the order ½ that every scheme
/// here has at least.
const ORDER: f64 = 0.25;

/// The part of the context's noise that belongs to these paths.
const PART: u64 = 8;

/// The order in τ of the largest relative defect d along a path: (mean ln d(τ) − mean ln
/// d(τ/64))/ln 64, with 4.42 standard errors of it. Holds above ¼, is refuted below, and undecided
/// when the interval contains ¼ or a path failed.
pub(crate) fn returns_to_law<S, G, const D: usize, const M: usize>(
    context: &Context<'_>,
    problem: &Problem<S, G, D>,
    scheme: &dyn Scheme<S, D, M>,
    index: usize,
    steps: u64,
) -> (Verdict, String)
where
    S: PoissonSystem<D, M>,
    G: Damping,
{
    let coarse = mean_logarithm(context, PART, problem, scheme, index, steps);
    let fine = mean_logarithm(context, PART + 1, problem, scheme, index, REFINEMENT * steps);
    let (Some(coarse), Some(fine)) = (coarse, fine) else {
        return (Verdict::Undecided, "a path has no defect to compare".to_owned());
    };
    let scale = (REFINEMENT as f64).ln();
    let order = (coarse.mean() - fine.mean()) / scale;
    let error = DEVIATIONS * coarse.standard_error().hypot(fine.standard_error()) / scale;
    let verdict = if order - error > ORDER {
        Verdict::Holds
    } else if order + error < ORDER {
        Verdict::Refuted
    } else {
        Verdict::Undecided
    };
    let evidence = format!(
        "over {PATHS} paths each at τ and τ/{REFINEMENT} the largest defect is {:.1e} and {:.1e} in the geometric mean, order {order:.2} ± {error:.2}",
        coarse.mean().exp(),
        fine.mean().exp()
    );
    (verdict, evidence)
}

/// ln of the largest relative defect along a path, over the paths; nothing if a path fails or keeps
/// the law exactly.
fn mean_logarithm<S, G, const D: usize, const M: usize>(
    context: &Context<'_>,
    part: u64,
    problem: &Problem<S, G, D>,
    scheme: &dyn Scheme<S, D, M>,
    index: usize,
    steps: u64,
) -> Option<Moments>
where
    S: PoissonSystem<D, M>,
    G: Damping,
{
    let mut logarithms = Moments::default();
    for path in 0..PATHS {
        let path = trajectory(problem, scheme, steps, truncation(), context.key(part), path)
            .unwrap_or_else(|error| unreachable!("the set-ups of the paper are valid: {error}"));
        let logarithm = largest_defect(problem, index, &path.times, &path.states).ln();
        if path.failure.is_some() || !logarithm.is_finite() {
            return None;
        }
        logarithms.add(logarithm);
    }
    Some(logarithms)
}

/// max |F(yₙ)/(e^{−p∫γ}F(y₀)) − 1| along a path; NaN if any of them is.
pub(crate) fn largest_defect<S, G, const D: usize, const M: usize>(
    problem: &Problem<S, G, D>,
    index: usize,
    times: &[f64],
    states: &[[f64; D]],
) -> f64
where
    S: PoissonSystem<D, M>,
    G: Damping,
{
    let degree = problem.system.invariants()[index].degree;
    let initial: f64 = problem.system.invariant(index, problem.y0);
    let defects = times.iter().zip(states).map(|(&t, &y)| {
        let exact = (-degree * problem.damping.integral(0.0, t)).exp() * initial;
        (problem.system.invariant(index, y) / exact - 1.0).abs()
    });
    defects.fold(0.0, worse)
}
