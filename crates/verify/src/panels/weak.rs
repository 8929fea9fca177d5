//! Weak convergence of `sexp`, and of schemes without iteration where they are wanted, for twelve
//! test functions of the rigid body with three noises.
//!
//! d_l = E[φ(y_τ)] − E[φ(y_{τ/2})] with τ = 2^−l is measured for every l from the coarsest step
//! size to the finest, on paths of its own, as the mean of φ(coarse) − ½(φ(fine) + φ(swapped)). The
//! swapped run exchanges the two increments of every coarse step: this antithetic path cancels the
//! Lévy areas that schemes of strong order ½ omit (Giles and Szpruch 2014, *Ann. Appl. Probab.*
//! 24).
//! The order is fitted to the d_l, which needs no assumption about what is left below the finest
//! step. The errors that a figure shows are their sums e_l = Σ_{j ≥ l} d_j, ended by a Richardson
//! tail: below the finest step L, an error Cτ + O(τ²) leaves d_L once more, up to O(τ²).
//!
//! # Which estimator
//!
//! Work for a given standard error is variance times cost. For the rigid body, with the cost
//! counted in path-steps and the median taken over the twelve test functions (`cargo test -p
//! casimir-verify antithetic -- --nocapture`):
//!
//! | τ | independent paths | plain difference | antithetic difference | its variance / τ² |
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
mod tests;

use analysis::FinalMoments;
use mc::{Ladder, Observable, Run, View, bind};
use noise::StreamKey;
use real::Row;
use schemes::Sexp;
use stats::{CrossMoments, Expansion, weak_errors};
use systems::{
    Cosine, Problem, RigidBody,
    paper::{rigid_body_three_noises, valid},
};

use super::{
    curves::{Curve, without_iteration},
    strong::{describe_failures, power_of_half},
};
use crate::{
    Conditions, Findings, Method, TRUNCATED, Words, compiled, in_words,
    results::{Claim, DifferenceSamples, Evidence, Kind, Panel, Series},
    truncation,
};

/// A test function with its name.
type TestFunction = (&'static str, fn([f64; 3]) -> f64);

/// One panel: a name and the test functions on it.
pub struct WeakPanel {
    pub id: &'static str,
    pub title: &'static str,
    pub functions: [TestFunction; 3],
}

/// The test functions of panels.
pub fn observables(panels: &[&WeakPanel]) -> Vec<Observable<3>> {
    panels
        .iter()
        .flat_map(|panel| panel.functions)
        .map(|(name, function)| Observable { name, function })
        .collect()
}

/// Coarsest step size 2⁻⁶.
const FIRST: u32 = 6;

/// Step sizes 2⁻⁶ … 2^−last, each with the paths of the difference between it and half of it:
/// `most`·√(τ/2⁻⁶), rounded upwards, as often as the settings want it.
fn grid(conditions: &Conditions, last: u32, most: u64) -> Vec<DifferenceSamples> {
    let samples = |l: u32| (most as f64 * power_of_half(l - FIRST).sqrt()).ceil() as u64;
    let samples = |l| conditions.paths(samples(l));
    let difference = |l| DifferenceSamples { tau: power_of_half(l), samples: samples(l) };
    (FIRST..=last).map(difference).collect()
}

/// The panels that are wanted, which one set of runs makes.
pub fn measure(panels: &[WeakPanel], conditions: &Conditions) -> Findings {
    let problem = rigid_body_three_noises(1.0);
    let (last, most) = conditions.choose((12, 500_000), (9, 65_536));
    let grid = grid(conditions, last, most);
    let wanted = |panel: &&WeakPanel| conditions.wanted.contains(&panel.id);
    let panels: Vec<&WeakPanel> = panels.iter().filter(wanted).collect();
    let observables = observables(&panels);
    let mut curves = vec![Curve::new(Method::Sexp, compiled(Sexp))];
    curves.extend(without_iteration(conditions.further, &problem));
    let more = conditions.times_in_words();
    let steps = format!("τ = 2^-{FIRST} … 2^-{last}, {TRUNCATED}{more}");
    let drawn = panels.iter().map(|panel| {
        let words = Words {
            title: panel.title,
            system: in_words::BODY_3,
            paper: "sexp has weak order 1 for every test function.",
        };
        Panel {
            samples: grid[0].samples,
            reference: reference(&grid, last),
            differences: grid.clone(),
            ..words.panel(panel.id, Kind::Weak, &problem, &steps)
        }
    });
    let mut findings = Findings { panels: drawn.collect(), claims: Vec::new() };
    let taus: Vec<f64> = grid.iter().map(|difference| difference.tau).collect();
    for curve in &curves {
        let (moments, failures) = differences(conditions, &grid, &problem, &observables, curve);
        let mut series = observables.iter().enumerate().map(|(f, observable)| {
            let (points, rate) = weak_errors(&taus, &moments, f, Expansion::EveryPower);
            let (scheme, quantity) = (curve.name.into(), observable.name.into());
            Series { scheme, quantity, points, rate, ..Series::default() }
        });
        for (panel, drawn) in panels.iter().zip(&mut findings.panels) {
            let series: Vec<Series> = series.by_ref().take(panel.functions.len()).collect();
            let claims = series.iter().map(|series| claim(panel.id, curve.method, series, &more));
            findings.claims.extend(claims);
            drawn.series.extend(series);
            drawn.failures.extend_from_slice(&failures);
        }
    }
    findings
}

/// The paper's bound for `sexp`; the order of any other scheme.
fn claim(panel: &str, method: Method, series: &Series, more: &str) -> Claim {
    let (scheme, quantity) = (&series.scheme, &series.quantity);
    let paper = method == Method::Sexp;
    let statement = match paper {
        true => format!("|E φ(y_N) − E φ(y(T))| ≤ C τ for φ = {quantity} (k ≥ 2{more})"),
        false => format!("{scheme} has weak order 1 for φ = {quantity}{more}"),
    };
    let measured = Evidence::order_bound(1.0, series.rate.clone());
    Claim::new("weak-one", statement, measured).about(panel, scheme).proven(paper)
}

/// What the errors are sums of, in words.
fn reference(grid: &[DifferenceSamples], last: u32) -> String {
    let samples: Vec<String> = grid.iter().map(|level| level.samples.to_string()).collect();
    let finer = last + 1;
    format!(
        "sums of antithetic differences between neighbouring steps, each on paths of its own ({}); \
         below 2^-{finer} a Richardson tail, the difference between 2^-{last} and 2^-{finer} once \
         more. The order is fitted to the differences, without the tail.",
        samples.join(", ")
    )
}

/// Moments of antithetic differences between neighbouring step sizes, coarsest first, and the paths
/// that failed; each difference is a part of the experiment.
fn differences(
    conditions: &Conditions,
    grid: &[DifferenceSamples],
    problem: &Problem<RigidBody<3>, Cosine, 3>,
    observables: &[Observable<3>],
    curve: &Curve<RigidBody<3>, 3, 3>,
) -> (Vec<CrossMoments>, Vec<String>) {
    let bound = || bind(problem, curve.scheme.as_ref());
    let (mut moments, mut failures) = (Vec::new(), Vec::new());
    for (part, DifferenceSamples { tau, samples }) in (0..).zip(grid) {
        let runs = vec![Run::new(bound(), 1), Run::new(bound(), 0), Run::swapped(bound(), 0)];
        let ladder = difference_ladder(problem, *tau, conditions.key(part), runs);
        let id = conditions.wanted.join(", ");
        conditions.progress.begin(&id, samples * ladder.steps_per_path());
        let difference = |phi: &dyn Fn(usize) -> f64| phi(0) - 0.5 * (phi(1) + phi(2));
        let advance = |work| conditions.progress.advance(work);
        let (found, failed) = moments_of(&ladder, *samples, observables, difference, &advance);
        moments.push(found);
        failures.extend(failed);
    }
    conditions.progress.end();
    (moments, failures)
}

/// Runs at the steps `tau` (level 1) and half of it (level 0).
pub fn difference_ladder<'a>(
    problem: &'a Problem<RigidBody<3>, Cosine, 3>,
    tau: f64,
    key: StreamKey,
    runs: Vec<Run<'a>>,
) -> Ladder<'a> {
    let finest_steps = (2.0 * problem.t_end() / tau).round() as u64;
    valid(Ladder::new(&mc::Problem::of(problem), finest_steps, 1, truncation(), key, runs))
}

/// Moments of a combination of φ of the runs at the final time, for every φ, and the paths that
/// failed.
pub fn moments_of(
    ladder: &Ladder<'_>,
    samples: u64,
    observables: &[Observable<3>],
    combination: impl Fn(&dyn Fn(usize) -> f64) -> f64 + Sync,
    advance: &(dyn Fn(u64) + Sync),
) -> (CrossMoments, Vec<String>) {
    let values = |view: &View<'_>, rows: &mut [Row]| {
        for (row, observable) in rows.iter_mut().zip(observables) {
            for p in view.live.paths() {
                row[p] = combination(&|run| (observable.function)(view.path(run, p)));
            }
        }
    };
    let new = || FinalMoments::new(ladder.coarse_steps(), observables.len(), &values);
    let measured = ladder.run(samples, new, advance);
    let failures = describe_failures(&measured);
    (measured.statistic.moments, failures)
}
