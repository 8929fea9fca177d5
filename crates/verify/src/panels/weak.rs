//! Weak convergence of `sexp` for twelve test functions of the rigid body with three noises.
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
//! counted in path-steps and the median taken over the twelve test functions:
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

use mc::Problem;
use stats::weak_errors;

use super::strong::describe_failures;
use crate::*;

/// Identifiers of the weak panels, which one set of runs makes.
pub const WEAK_IDS: &[&str] =
    &["rigid-body-weak-y", "rigid-body-weak-y2", "rigid-body-weak-cos", "rigid-body-weak-sin"];
const FUNCTIONS: [&str; 4] = ["y_j", "y_j²", "cos y_j", "sin y_j"];

/// Coarsest step size 2⁻⁶.
const FIRST: u32 = 6;

/// Measures all weak panels. For the step sizes τ = 2⁻⁶ … 2^−last, the difference between τ and τ/2
/// has most·√(τ/2⁻⁶) paths, rounded upwards.
pub fn measure(conditions: &Conditions) -> Findings {
    let problem = rigid_body_three_noises(1.0);
    let sexp = Compiled::of(&problem).sexp();
    let (last, most): (_, u32) = conditions.choose((12, 500_000), (9, 65_536));
    let difference = |l| DifferenceSamples {
        tau: power_of_half(l),
        samples: (f64::from(most) * power_of_half(l - FIRST).sqrt()).ceil() as u64,
    };
    let grid: Vec<_> = (FIRST..=last).map(difference).collect();
    let observables = weak_observables();
    let antithetic = |part, sizes: &DifferenceSamples| {
        let scheme = || sexp.scheme.clone();
        let runs = vec![Run::new(scheme(), 1), Run::new(scheme(), 0), Run::swapped(scheme(), 0)];
        let ladder = difference_ladder(&sexp.problem, sizes.tau, conditions.key(part), runs);
        moments_of(&ladder, sizes.samples, observables.len(), |view, p, f| {
            let phi = |run| (observables[f].function)(view.path(run, p));
            phi(0) - 0.5 * (phi(1) + phi(2))
        })
    };
    let (series, failures) = series("sexp", &grid, &observables, Expansion::EveryPower, antithetic);
    let steps = format!("τ = 2^-{FIRST} … 2^-{last}, {TRUNCATED}");
    let samples: Vec<String> = grid.iter().map(|level| level.samples.to_string()).collect();
    let (samples, finer) = (samples.join(", "), last + 1);
    let reference = format!(
        "sums of antithetic differences between neighbouring steps, each on paths of its own \
         ({samples}); below 2^-{finer} a Richardson tail, the difference between 2^-{last} and \
         2^-{finer} once more. The order is fitted to the differences, without the tail."
    );
    let mut findings = Findings::default();
    for ((id, phi), series) in WEAK_IDS.iter().zip(FUNCTIONS).zip(series.chunks(3)) {
        let words = ["", BODY_3, "sexp has weak order 1 for every test function."];
        findings.claims.extend(series.iter().map(|Series { quantity, rate, .. }| {
            let statement = format!("|E φ(y_N) − E φ(y(T))| ≤ C τ for φ = {quantity} (k ≥ 2)");
            let measured = Evidence::order_bound(1.0, rate.clone());
            Claim::new("weak-one", statement, measured).about(id, "sexp")
        }));
        findings.panels.push(Panel {
            title: format!("Rigid body, three noises: weak error of E[{phi}]"),
            samples: grid[0].samples,
            reference: reference.clone(),
            differences: grid.clone(),
            series: series.to_vec(),
            failures: failures.clone(),
            ..panel(words, id, Kind::Weak, &sexp.problem, &steps)
        });
    }
    findings
}

/// The weak errors of a scheme for every φ and the paths that failed, from the moments of
/// `differences` between each step size, with its part of the noise, and half of it.
pub fn series(
    scheme: &str,
    grid: &[DifferenceSamples],
    observables: &[Observable<3>],
    expansion: Expansion,
    differences: impl Fn(u64, &DifferenceSamples) -> (CrossMoments, Vec<String>),
) -> (Vec<Series>, Vec<String>) {
    let (moments, failures): (Vec<_>, Vec<_>) =
        (0..).zip(grid).map(|(part, sizes)| differences(part, sizes)).unzip();
    let taus: Vec<f64> = grid.iter().map(|difference| difference.tau).collect();
    let series = observables.iter().enumerate().map(|(f, observable)| {
        let (points, rate) = weak_errors(&taus, &moments, f, expansion);
        let (scheme, quantity) = (scheme.into(), observable.name.into());
        Series { scheme, quantity, points, rate, ..Series::default() }
    });
    (series.collect(), failures.concat())
}

/// Runs at the steps `tau` (level 1) and half of it (level 0).
pub fn difference_ladder<'a>(
    problem: &Problem<'a>,
    tau: f64,
    key: StreamKey,
    runs: Vec<Run<'a>>,
) -> Ladder<'a> {
    let finest_steps = (2.0 * problem.t_end / tau).round() as u64;
    valid(Ladder::new(problem, finest_steps, 1, truncation(), key, runs))
}

/// Moments at the final time of `number` functions of a path, given by the number of the path in
/// its block and that of the function, and the paths that failed.
pub fn moments_of(
    ladder: &Ladder<'_>,
    samples: u64,
    number: usize,
    function: impl Fn(&View<'_>, usize, usize) -> f64 + Sync,
) -> (CrossMoments, Vec<String>) {
    let values = |view: &View<'_>, rows: &mut [Row]| {
        for (f, row) in rows.iter_mut().enumerate() {
            view.live.paths().for_each(|p| row[p] = function(view, p, f));
        }
    };
    let new = || FinalMoments::new(ladder.coarse_steps(), number, &values);
    let measured = ladder.run(samples, new);
    let failures = describe_failures(&measured);
    (measured.statistic.moments, failures)
}
