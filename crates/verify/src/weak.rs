//! Weak convergence of `sexp` for twelve test functions of the rigid body with three noises.
//!
//! The weak error at a step size is a sum of differences between neighbouring levels, each measured with an
//! antithetic twin (see [`mc::WeakDifferences`]), plus what is left below the finest level. The reference is the
//! Richardson extrapolation 2E[φ] at half the finest step − the expectation at the finest step, measured on streams of its own.

use mc::{CrossMoments, Ladder, Observable, Outcome, Run, WeakDifferences};
use schemes::Sexp;
use systems::{Damping, PoissonSystem, Problem};

use crate::experiment::{Context, truncation};
use crate::order::fit_weak;
use crate::results::{Kind, Panel, Point, Series};
use crate::strong::describe_failures;

/// One panel: a name and the test functions on it.
pub(crate) struct WeakPanel<const D: usize> {
    pub id: &'static str,
    pub title: &'static str,
    pub observables: Vec<Observable<D>>,
}

/// What the weak experiment is made of; step sizes are powers of two.
pub(crate) struct WeakSetup {
    pub paper: &'static str,
    pub setup: String,
    /// Step sizes 2^−first … 2^−last; the reference uses 2^−(last + 1), too.
    pub first: u32,
    pub last: u32,
    pub samples: u64,
    /// Paths of the difference between the two finest steps. Its variance is that of the next coarser difference
    /// over 4, its weight in the errors 2, so an eighth of the samples suffices.
    pub reference_samples: u64,
}

/// All panels from one pass.
pub(crate) fn weak_panels<S, G, const D: usize, const M: usize>(
    context: &Context<'_>,
    setup: &WeakSetup,
    problem: &Problem<S, G, D>,
    panels: &[WeakPanel<D>],
) -> Vec<Panel>
where
    S: PoissonSystem<D, M>,
    G: Damping,
{
    let observables: Vec<Observable<D>> = panels.iter().flat_map(|panel| panel.observables.iter().copied()).collect();
    let id = panels.iter().map(|panel| panel.id).collect::<Vec<_>>().join(", ");
    let sexp = Sexp::default();
    let main = differences(context, &id, setup.first, setup.last, setup.samples, 0, problem, &sexp, &observables);
    let tail_id = format!("{id} (reference)");
    let tail = differences(
        context,
        &tail_id,
        setup.last,
        setup.last + 1,
        setup.reference_samples,
        1,
        problem,
        &sexp,
        &observables,
    );

    let taus: Vec<f64> = (setup.first..=setup.last).map(|exponent| 0.5f64.powi(exponent as i32)).collect();
    let mut next = 0;
    let mut failures = describe_failures(main.failed, &main.failures);
    failures.extend(describe_failures(tail.failed, &tail.failures));
    panels
        .iter()
        .map(|panel| {
            let series = panel
                .observables
                .iter()
                .map(|observable| {
                    let f = next;
                    next += 1;
                    weak_series(observable.name, &taus, main.statistic.of(f), tail.statistic.of(f))
                })
                .collect();
            Panel {
                id: panel.id.to_owned(),
                kind: Kind::Weak,
                title: panel.title.to_owned(),
                setup: setup.setup.clone(),
                paper: setup.paper.to_owned(),
                samples: setup.samples,
                reference: format!(
                    "Richardson extrapolation of sexp at τ = 2^-{} and 2^-{}, from {} paths of their own; errors are \
                     sums of antithetic differences between neighbouring steps",
                    setup.last,
                    setup.last + 1,
                    setup.reference_samples
                ),
                failures: failures.clone(),
                clipped: Vec::new(),
                series,
            }
        })
        .collect()
}

/// Antithetic differences between neighbouring step sizes 2^−first … 2^−last.
#[allow(clippy::too_many_arguments)]
fn differences<S, G, const D: usize, const M: usize>(
    context: &Context<'_>,
    id: &str,
    first: u32,
    last: u32,
    samples: u64,
    part: u64,
    problem: &Problem<S, G, D>,
    sexp: &Sexp,
    observables: &[Observable<D>],
) -> Outcome<WeakDifferences<D>>
where
    S: PoissonSystem<D, M>,
    G: Damping,
{
    let levels = (last - first) as usize;
    let mut runs: Vec<Run<'_, S, D, M>> = (0..=levels).map(|level| Run::new(sexp, level)).collect();
    runs.extend((0..levels).map(|level| Run::swapped(sexp, level)));
    // Coarsest difference first.
    let triples: Vec<(usize, usize, usize)> =
        (0..levels).rev().map(|fine| (fine + 1, fine, levels + 1 + fine)).collect();
    let finest_steps = (problem.t_end * 2f64.powi(last as i32)).round() as u64;
    let ladder = Ladder::new(problem, finest_steps, levels, truncation(), context.key(part), runs)
        .unwrap_or_else(|error| unreachable!("the set-up of the paper is valid: {error}"));
    context.progress.begin(id, ladder.steps_per_path() * samples);
    let outcome = ladder.run(samples, || WeakDifferences::new(observables, &triples, ladder.coarse_steps()), &|work| {
        context.progress.advance(work);
    });
    context.progress.end();
    outcome
}

/// Errors e_l = Σ_{j≥l} d_j + 2d̃, where d_j are the differences of the ladder and d̃ that of the reference: with an
/// error Cτ + O(τ²), the expectation at the finest step is 2d̃ away from the limit up to O(τ²).
pub(crate) fn weak_series(name: &str, taus: &[f64], main: &CrossMoments, tail: &CrossMoments) -> Series {
    let levels = taus.len();
    let tail_variance = 4.0 * tail.covariance_of_means(0, 0);
    let sum_from = |l: usize| (l..levels - 1).map(|j| main.mean(j)).sum::<f64>();
    let errors: Vec<f64> = (0..levels).map(|l| sum_from(l) + 2.0 * tail.mean(0)).collect();
    let covariance: Vec<Vec<f64>> = (0..levels)
        .map(|l| {
            (0..levels)
                .map(|m| {
                    let pairs = (l..levels - 1).flat_map(|i| (m..levels - 1).map(move |j| (i, j)));
                    pairs.map(|(i, j)| main.covariance_of_means(i, j)).sum::<f64>() + tail_variance
                })
                .collect()
        })
        .collect();
    let points =
        (0..levels).map(|l| Point::Error { tau: taus[l], value: errors[l], se: covariance[l][l].sqrt() }).collect();
    Series {
        scheme: "sexp".to_owned(),
        quantity: name.to_owned(),
        points,
        rate: fit_weak(taus, &errors, &covariance),
        max_relative_defect: None,
    }
}
