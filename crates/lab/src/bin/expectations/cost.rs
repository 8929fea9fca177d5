//! What an accuracy costs by each method.

use anyhow::Result;
use lab::{compiled, streams, truncation, weak_observables};
use mc::{
    Expect, Observable, Observe,
    multilevel::{Coupling, Estimator, Expectation, ExpectationSettings, expectation},
};
use noise::StreamKey;
use schemes::Sexp;
use systems::{Cosine, Problem, RigidBody, paper::rigid_body_three_noises};
use verify::{Stopwatch, rigid_body_expectations};

use crate::{
    line::slope,
    one_level::one_level,
    results::{Cost, Known, Method, Slope, Twelve},
};

/// Steps on [0, 1] of the coarsest level of random points, as in the supplement of the
/// reproduction.
const COARSEST_STEPS: u64 = 2;
/// The accuracies of the methods, and the one of the twelve test functions.
const SINGLE: &[f64] = &[1e-2, 3e-3, 1e-3, 3e-4, 1e-4];
const MULTILEVEL: &[f64] = &[1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 3e-5];
const QUASI: &[f64] = &[1e-3, 3e-4, 1e-4, 3e-5, 1e-5, 3e-6, 1e-6];
const OF_TWELVE: f64 = 1e-5;
/// No run of random points may take longer, as far as the run before it tells, and none of Sobol
/// points.
const LONGEST_S: f64 = 20.0;
const LONGEST_QUASI_S: f64 = 45.0;
/// Path-steps after which a run with Sobol points ends.
pub const MOST_STEPS: u64 = 3_000_000_000;

type Body = Problem<RigidBody<3>, Cosine, 3>;

/// The degree of the spherical harmonics: 64 is 8e-13 away from 96, which is exact to round-off.
pub fn degree(quick: bool) -> usize {
    if quick { 64 } else { 96 }
}

fn cos_y3() -> Observable<3> {
    Observable { name: "cos y3", function: |y| real::elementary::cos(y[2]) }
}

/// What a method found for E[cos y₃].
pub struct Found {
    pub value: f64,
    pub half_width: f64,
    pub reached: bool,
    pub path_steps: u64,
    pub finest_steps: u64,
    pub decisions: Vec<String>,
}

impl Found {
    fn of(found: Expectation) -> Self {
        let (reached, path_steps, estimate) = (found.reached(), found.cost, &found.estimates[0]);
        let finest = found.levels.iter().map(|level| level.tau).fold(f64::INFINITY, f64::min);
        let finest_steps = (1.0 / finest).round() as u64;
        let (value, half_width) = (estimate.value, estimate.half_width());
        let decisions = found.decisions;
        Self { value, half_width, reached, path_steps, finest_steps, decisions }
    }
}

/// A result with its wall time and processor time.
type Timed<T> = (T, f64, f64);

fn timed<T>(run: impl FnOnce() -> Result<T>) -> Result<Timed<T>> {
    let watch = Stopwatch::start();
    let found = run()?;
    Ok((found, watch.wall_s(), watch.thread_s()))
}

/// All methods, and the twelve test functions.
pub fn measure(seed: u64, quick: bool) -> Result<(Vec<Method>, Twelve)> {
    let problem = rigid_body_three_noises(1.0);
    let exact = rigid_body_expectations(&problem, degree(quick), &[cos_y3()])[0];
    let random = |estimator: Estimator, first: u64| {
        let problem = &problem;
        move |number: u64, accuracy: f64| {
            let key = key(seed, first + number);
            let settings = ExpectationSettings {
                max_cost: 1 << 40,
                estimator,
                ..ExpectationSettings::new(key, truncation(), COARSEST_STEPS, Coupling::Antithetic)
            };
            let (sexp, observables) = (compiled(Sexp), [cos_y3()]);
            let progress = |_| ();
            let run = || {
                expectation(sexp.as_ref(), problem, &observables, accuracy, &settings, &progress)
            };
            timed(|| Ok(Found::of(run()?)))
        }
    };
    let one = |number: u64, accuracy: f64| {
        timed(|| one_level(&problem, key(seed, 24 + number), &cos_y3(), accuracy))
    };
    let chosen = |number: u64, accuracy: f64| {
        let run = || by_expect(&problem, key(seed, 32 + number), &[cos_y3()], accuracy);
        timed(|| Ok(Found::of(run()?)))
    };
    let accuracies = |all: &'static [f64]| if quick { &all[..3] } else { all };
    let single = random(Estimator::SinglePaths, 0);
    let levels = random(Estimator::Multilevel, 16);
    // Half of the half-width costs 8, 4 and at most 4 times as much.
    let methods = vec![
        method("single paths", accuracies(SINGLE), (3, LONGEST_S), exact, single)?,
        method("multilevel", accuracies(MULTILEVEL), (2, LONGEST_S), exact, levels)?,
        method("quasi-Monte Carlo", accuracies(QUASI), (2, LONGEST_QUASI_S), exact, one)?,
        method("Expect", accuracies(QUASI), (2, LONGEST_QUASI_S), exact, chosen)?,
    ];
    let observables = weak_observables();
    let accuracy = if quick { 1e-3 } else { OF_TWELVE };
    let run = || by_expect(&problem, key(seed, 48), &observables, accuracy);
    let (found, wall_s, processor_s) = timed(run)?;
    let exact = rigid_body_expectations(&problem, degree(quick), &observables);
    let known = |(estimate, exact): (&mc::multilevel::Estimate, f64)| Known {
        name: estimate.name.clone(),
        estimate: estimate.value,
        half_width: estimate.half_width(),
        exact,
    };
    let estimates = found.estimates.iter().zip(exact).map(known).collect();
    let path_steps = found.cost;
    Ok((methods, Twelve { accuracy, path_steps, wall_s, processor_s, estimates }))
}

fn key(seed: u64, part: u64) -> StreamKey {
    StreamKey { seed, experiment: streams::EXPECTATION_COST + part }
}

fn by_expect(
    problem: &Body,
    key: StreamKey,
    observables: &[Observable<3>],
    accuracy: f64,
) -> Result<Expectation> {
    let observables: Vec<&dyn Observe> =
        observables.iter().map(|observable| observable as &dyn Observe).collect();
    let expect = Expect::by_parts(problem).with_key(key).with_max_cost(MOST_STEPS);
    Ok(expect.run(&observables, accuracy, &|_| ())?)
}

/// The rows of a method. Its cost is taken to grow with the half-width to the power −`power` when
/// the next row is judged too long.
fn method(
    name: &'static str,
    accuracies: &[f64],
    (power, longest_s): (i32, f64),
    exact: f64,
    run: impl Fn(u64, f64) -> Result<Timed<Found>>,
) -> Result<Method> {
    let (mut rows, mut stopped, mut decisions) = (Vec::<Cost>::new(), None, Vec::new());
    for (number, &accuracy) in (0..).zip(accuracies) {
        if let Some(last) = rows.last() {
            let expected = last.processor_s * (last.half_width / accuracy).powi(power);
            if expected > longest_s {
                stopped = Some(format!(
                    "No row from ε = {accuracy:.0e} on: as the row before tells, it would take some \
                     {expected:.0} s of processor time, and {longest_s} s are the limit of a run here."
                ));
                break;
            }
        }
        let (found, wall_s, processor_s) = run(number, accuracy)?;
        rows.push(Cost {
            accuracy,
            estimate: found.value,
            half_width: found.half_width,
            error: found.value - exact,
            reached: found.reached,
            path_steps: found.path_steps,
            finest_steps: found.finest_steps,
            wall_s,
            processor_s,
        });
        decisions = found.decisions;
    }
    let path_steps = exponent(&rows, |row| row.path_steps as f64);
    let processor_s = exponent(&rows, |row| row.processor_s);
    let beyond = &rows[pilots(&rows)..];
    let beyond_pilot = exponent(beyond, |row| row.path_steps as f64);
    let beyond_pilot_s = exponent(beyond, |row| row.processor_s);
    Ok(Method {
        name,
        rows,
        path_steps,
        processor_s,
        beyond_pilot,
        beyond_pilot_s,
        stopped,
        decisions,
    })
}

/// How many of the first rows the pilot makes: those that cost at most a fifth more than the first.
/// None where all do.
fn pilots(rows: &[Cost]) -> usize {
    let least = rows.first().map_or(0, |row| row.path_steps);
    rows.iter().position(|row| row.path_steps > least + least / 5).unwrap_or(0)
}

/// The exponent of a cost in ε.
fn exponent(rows: &[Cost], cost: fn(&Cost) -> f64) -> Option<Slope> {
    let point = |row: &Cost| (row.accuracy.ln(), cost(row).ln());
    slope(&rows.iter().map(point).collect::<Vec<_>>())
}
