//! Weak convergence of `sexp` for twelve test functions of the rigid body with three noises.
//!
//! d_l = E[φ(y_τ)] − E[φ(y_{τ/2})] with τ = 2^−l is measured for every l from the coarsest step
//! size to the finest, on paths of its own, with an antithetic twin (see [`mc::WeakDifferences`]).
//! The order is fitted to the d_l, which needs no assumption about what is left below the finest
//! step. The errors that a figure shows are their sums e_l = Σ_{j ≥ l} d_j, ended by a Richardson
//! tail: below the finest step L, an error Cτ + O(τ²) leaves d_L once more, up to O(τ²).
//!
//! # Which estimator
//!
//! Work for a given standard error is variance times cost. For the rigid body, with the cost
//! counted in path-steps and the median taken over the twelve test functions (`cargo test -p verify
//! estimators -- --nocapture`):
//!
//! | τ | independent paths | plain coupled difference | antithetic difference | variance of the latter / τ² |
//! |---|---|---|---|---|
//! | 2⁻⁶ | 3.8 | 1.6e-3 | 6.0e-6 | 7.7e-5 |
//! | 2⁻⁸ | 15 | 1.7e-3 | 1.5e-6 | 7.9e-5 |
//! | 2⁻¹⁰ | 59 | 1.7e-3 | 4.0e-7 | 8.2e-5 |
//!
//! The variance of an antithetic difference falls like τ², that of a plain one like τ, and the
//! antithetic one is the cheapest at every step size although it takes five steps where the others
//! take three.
//!
//! # How many paths
//!
//! The variance of d_l falls like τ_l², d_l itself like τ_l: the *relative* error of d_l is κ/√N_l
//! with the same κ at every step size, and a path costs c_l = 5·2^l steps. An order is a matter of
//! relative errors. Minimising Σ κ²/N_l for a given Σ c_l N_l gives N_l ∝ 1/√c_l ∝ √τ_l. (The sum
//! e_l alone, to an absolute accuracy, would ask for N_l ∝ √(V_l/c_l) ∝ τ_l^{3/2}, as in multilevel
//! Monte Carlo, and the finest errors would drown.) The paper's 500 000 paths are kept at the
//! coarsest difference; with seven differences the finest gets an eighth of them.

#[cfg(test)]
mod estimators;

use mc::{Ladder, Observable, Outcome, Run, WeakDifferences};
use schemes::Sexp;
use stats::{CrossMoments, Point, fit_weak_differences};
use systems::{Damping, Problem};
use verify::results::{DifferenceSamples, Kind, Panel, Series};

use crate::experiment::{Context, truncation};
use crate::kernels::Compiled;
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
    /// Step sizes 2^−first … 2^−last; the difference at the finest uses 2^−(last + 1), too.
    pub first: u32,
    pub last: u32,
    /// Paths of the coarsest difference.
    pub samples: u64,
}

impl WeakSetup {
    /// Paths of the difference between 2^−exponent and half of it: `samples`·√(τ_l/τ_first),
    /// rounded upwards.
    fn samples(&self, exponent: u32) -> u64 {
        (self.samples as f64 * 0.5f64.powi((exponent - self.first) as i32).sqrt()).ceil() as u64
    }
}

/// All panels from one pass.
pub(crate) fn weak_panels<S, G, const D: usize, const M: usize>(
    context: &Context<'_>,
    setup: &WeakSetup,
    problem: &Problem<S, G, D>,
    panels: &[WeakPanel<D>],
) -> Vec<Panel>
where
    S: Compiled<D, M>,
    G: Damping,
{
    let observables: Vec<Observable<D>> =
        panels.iter().flat_map(|panel| panel.observables.iter().copied()).collect();
    let id = panels.iter().map(|panel| panel.id).collect::<Vec<_>>().join(", ");
    let outcomes = differences(context, &id, setup, problem, &observables);

    let tau = |exponent: u32| 0.5f64.powi(exponent as i32);
    let taus: Vec<f64> = (setup.first..=setup.last).map(tau).collect();
    let failures: Vec<String> = outcomes
        .iter()
        .flat_map(|outcome| describe_failures(outcome.failed, &outcome.failures))
        .collect();
    let samples: Vec<DifferenceSamples> = (setup.first..=setup.last)
        .map(|exponent| DifferenceSamples { tau: tau(exponent), samples: setup.samples(exponent) })
        .collect();
    let reference = format!(
        "sums of antithetic differences between neighbouring steps, each on paths of its own ({}); below 2^-{} a Richardson \
         tail, the difference between 2^-{} and 2^-{} once more. The order is fitted to the differences, without the tail.",
        samples
            .iter()
            .map(|difference| difference.samples.to_string())
            .collect::<Vec<_>>()
            .join(", "),
        setup.last + 1,
        setup.last,
        setup.last + 1,
    );
    let mut number = 0..;
    panels
        .iter()
        .map(|panel| {
            let series = panel.observables.iter().zip(&mut number).map(|(observable, f)| {
                let differences: Vec<&CrossMoments> =
                    outcomes.iter().map(|outcome| outcome.statistic.moments(f)).collect();
                weak_series(observable.name, &taus, &differences)
            });
            Panel {
                id: panel.id.to_owned(),
                kind: Kind::Weak,
                title: panel.title.to_owned(),
                setup: setup.setup.clone(),
                paper: setup.paper.to_owned(),
                samples: setup.samples,
                reference: reference.clone(),
                failures: failures.clone(),
                clipped: Vec::new(),
                differences: samples.clone(),
                series: series.collect(),
            }
        })
        .collect()
}

/// Antithetic differences between neighbouring step sizes, coarsest first; each is a part of the
/// experiment.
fn differences<S, G, const D: usize, const M: usize>(
    context: &Context<'_>,
    id: &str,
    setup: &WeakSetup,
    problem: &Problem<S, G, D>,
    observables: &[Observable<D>],
) -> Vec<Outcome<WeakDifferences<D>>>
where
    S: Compiled<D, M>,
    G: Damping,
{
    let sexp = S::sexp(Sexp::default());
    let ladders: Vec<(u64, Ladder<'_, S, G, D, M>)> = (setup.first..=setup.last)
        .zip(0..)
        .map(|(exponent, part)| {
            let runs = vec![
                Run::new(sexp.as_ref(), 1),
                Run::new(sexp.as_ref(), 0),
                Run::swapped(sexp.as_ref(), 0),
            ];
            let finest_steps = (problem.t_end * 2f64.powi(exponent as i32 + 1)).round() as u64;
            let ladder =
                Ladder::new(problem, finest_steps, 1, truncation(), context.key(part), runs)
                    .unwrap_or_else(|error| {
                        unreachable!("the set-up of the paper is valid: {error}")
                    });
            (setup.samples(exponent), ladder)
        })
        .collect();
    context
        .progress
        .begin(id, ladders.iter().map(|(samples, ladder)| samples * ladder.steps_per_path()).sum());
    let outcomes = ladders
        .iter()
        .map(|(samples, ladder)| {
            let statistic =
                || WeakDifferences::new(observables, &[(0, 1, 2)], ladder.coarse_steps());
            ladder.run(*samples, statistic, &|work| context.progress.advance(work))
        })
        .collect();
    context.progress.end();
    outcomes
}

/// A curve from independent differences at the step sizes `taus`, each half of the one before.
pub(crate) fn weak_series(name: &str, taus: &[f64], differences: &[&CrossMoments]) -> Series {
    let means: Vec<f64> = differences.iter().map(|difference| difference.mean(0)).collect();
    let variances: Vec<f64> =
        differences.iter().map(|difference| difference.covariance_of_means(0, 0)).collect();
    let covariance: Vec<Vec<f64>> = (0..taus.len())
        .map(|l| (0..taus.len()).map(|m| if l == m { variances[l] } else { 0.0 }).collect())
        .collect();
    let finest = taus.len() - 1;
    let points = (0..taus.len()).map(|l| {
        let error = means[l..finest].iter().sum::<f64>() + 2.0 * means[finest];
        let variance = variances[l..finest].iter().sum::<f64>() + 4.0 * variances[finest];
        Point::normal(taus[l], error, variance.sqrt())
    });
    Series {
        scheme: "sexp".to_owned(),
        quantity: name.to_owned(),
        points: points.collect(),
        rate: fit_weak_differences(taus, &means, &covariance),
        max_relative_defect: None,
    }
}
