//! Multilevel Monte Carlo: do the intervals cover, does the cost grow as it should, and are wrong
//! couplings noticed.
//!
//! The bounds of the coverage tests are each exceeded by a right program with probability 10⁻⁴ or
//! less, and there are 24 of them. Other ranges are derived where they stand, or are several times
//! wider than the spread over seeds.

use std::cell::Cell;
use std::sync::atomic::{AtomicU64, Ordering};

use mc::multilevel::{
    Coupling, Estimate, Estimator, Expectation, ExpectationSettings, MultilevelError, Warning,
    expectation,
};
use mc::{LadderError, Observable, Setup};
use noise::{BlockNoise, Noise, NoiseError, StreamKey, Truncation};
use nonlin::{BlockStatus, Method, Solution, Solver};
use real::{Block, Real};
use schemes::{Scheme, Sexp, SexpLevy, Step, WithSolver};
use systems::{Constant, Cosine, PoissonSystem, Problem, RigidBody};

use crate::explosive::Explosive;

fn settings(seed: u64, coupling: Coupling) -> ExpectationSettings {
    ExpectationSettings::new(
        StreamKey { seed, experiment: 1 },
        Truncation::new(4).unwrap(),
        4,
        coupling,
    )
}

type Body = Problem<RigidBody<3>, Cosine, 3>;

fn body() -> Body {
    let system = RigidBody::three_noises([2.0, 1.0, 2.0 / 3.0], [1.0, 2.0, 3.0]).unwrap();
    Problem::new(system, Cosine::new(0.5, 2.0).unwrap(), [1.1f64.cos(), 0.0, 1.1f64.sin()], 1.0)
        .unwrap()
}

const COS_Y3: [Observable<3>; 1] = [Observable { name: "cos y3", function: |y| y[2].cos() }];

/// Noise σ in every rotation, and one rotation about the third axis as drift.
const SIGMA: f64 = 0.5;
const OMEGA: f64 = 0.7;

/// B(y)v = y × v with H₀ = ωy₃ and Hₘ = σyₘ: Brownian motion on the rotations, whose axes do not
/// commute.
struct Rotations;

impl PoissonSystem<3, 3> for Rotations {
    fn name(&self) -> &'static str {
        "rotations"
    }
    #[inline(always)]
    fn structure<R: Real>(&self, y: [R; 3], v: [R; 3]) -> [R; 3] {
        [y[1] * v[2] - y[2] * v[1], y[2] * v[0] - y[0] * v[2], y[0] * v[1] - y[1] * v[0]]
    }
    #[inline(always)]
    fn energy<R: Real>(&self, y: [R; 3], dt: f64, dw: [f64; 3]) -> R {
        y[0] * (SIGMA * dw[0]) + y[1] * (SIGMA * dw[1]) + y[2] * (OMEGA * dt + SIGMA * dw[2])
    }
    #[inline(always)]
    fn averaged_gradient<R: Real>(&self, _a: [R; 3], _b: [R; 3], dt: f64, dw: [f64; 3]) -> [R; 3] {
        [
            R::constant(SIGMA * dw[0]),
            R::constant(SIGMA * dw[1]),
            R::constant(OMEGA * dt + SIGMA * dw[2]),
        ]
    }
}

/// Damping and start of the rotations, on [0, 1].
const GAMMA: f64 = 0.3;
const START: [f64; 3] = [0.6, 0.0, 0.8];

fn rotations() -> Problem<Rotations, Constant, 3> {
    Problem::new(Rotations, Constant::new(GAMMA).unwrap(), START, 1.0).unwrap()
}

const MOMENTS: [Observable<3>; 2] = [
    Observable { name: "y1", function: |y| y[0] },
    Observable { name: "y3^2", function: |y| y[2] * y[2] },
];

/// E of [`MOMENTS`] at T = 1. The Itô correction ½σ²Σ (y × eₘ) × eₘ = −σ²y commutes with the drift,
/// so E[y] is rotated by ω and decays with σ² + γ. The noise is half the Laplacian of the sphere
/// times σ², of which y₃² − |y|²/3 is an eigenfunction with the eigenvalue −6, and the drift leaves
/// it alone.
fn exact_moments() -> [f64; 2] {
    let square = START.iter().map(|y| y * y).sum::<f64>();
    let second = square / 3.0 + (START[2] * START[2] - square / 3.0) * (-3.0 * SIGMA * SIGMA).exp();
    [
        (START[0] * OMEGA.cos() + START[1] * OMEGA.sin()) * (-SIGMA * SIGMA - GAMMA).exp(),
        second * (-2.0 * GAMMA).exp(),
    ]
}

/// The k with P(X ≤ k) ≥ `level` for the first time, X binomial.
fn binomial_quantile(n: u32, p: f64, level: f64) -> u32 {
    let mut probability = (1.0 - p).powi(n as i32);
    let mut sum = probability;
    let mut k = 0;
    while sum < level {
        probability *= f64::from(n - k) / f64::from(k + 1) * p / (1.0 - p);
        sum += probability;
        k += 1;
    }
    k
}

/// Standard normal quantile of 1 − 5·10⁻⁵.
const Z: f64 = 3.89;

/// 200 results against the truth.
fn check_coverage(name: &str, run: impl Fn(u64) -> Expectation) {
    const REPLICATIONS: u32 = 200;
    let n = f64::from(REPLICATIONS);
    let results: Vec<Expectation> = (0..u64::from(REPLICATIONS)).map(run).collect();
    for (k, exact) in exact_moments().into_iter().enumerate() {
        let what = format!("{name}, {}", MOMENTS[k].name);
        let (mut outside, mut outside_statistical, mut sum, mut squares, mut bias) =
            (0, 0, 0.0, 0.0, 0.0);
        for result in &results {
            assert!(result.reached(), "{what}: {result:?}");
            let estimate = &result.estimates[k];
            let (lower, upper) = estimate.interval();
            outside += u32::from(exact < lower || exact > upper);
            let error = (estimate.value - exact) / estimate.standard_error;
            outside_statistical += u32::from(error.abs() > 1.96);
            sum += error;
            squares += error * error;
            bias += estimate.bias_bound / estimate.standard_error;
        }
        // The interval covers with 95 % or more.
        assert!(
            outside <= binomial_quantile(REPLICATIONS, 0.05, 1.0 - 1e-4),
            "{what}: {outside} of {n} miss"
        );
        // Without the bound on the bias it misses with 5 % or more: it is not that wide for
        // nothing.
        let fewest = binomial_quantile(REPLICATIONS, 0.05, 1e-4);
        assert!(
            outside_statistical >= fewest,
            "{what}: {outside_statistical} of {n} miss statistically"
        );
        // Errors spread as the standard errors say: s² of 200 normals is within 1 ± z√(2/199).
        let (mean, variance) = (sum / n, (squares - sum * sum / n) / (n - 1.0));
        assert!(
            (variance - 1.0).abs() < Z * (2.0 / (n - 1.0)).sqrt(),
            "{what}: variance {variance}"
        );
        // What they have in common is within the bound on the bias.
        assert!(mean.abs() < bias / n + Z / n.sqrt(), "{what}: mean {mean}, bound {}", bias / n);
    }
}

#[test]
fn intervals_cover_the_truth() {
    let problem = rotations();
    for coupling in [Coupling::Antithetic, Coupling::Plain] {
        check_coverage(&format!("{coupling:?}"), |seed| {
            let settings = ExpectationSettings { pilot: 256, ..settings(seed, coupling) };
            expectation(&Setup::of(&problem, &Sexp), &MOMENTS, 0.015, &settings, &|_| ()).unwrap()
        });
    }
}

#[test]
fn intervals_of_single_paths_cover_the_truth() {
    let problem = rotations();
    check_coverage("single paths", |seed| {
        let settings = ExpectationSettings {
            estimator: Estimator::SinglePaths,
            pilot: 256,
            ..settings(seed, Coupling::Antithetic)
        };
        expectation(&Setup::of(&problem, &Sexp), &MOMENTS, 0.015, &settings, &|_| ()).unwrap()
    });
}

const ESTIMATORS: [Estimator; 2] = [Estimator::Multilevel, Estimator::SinglePaths];

#[test]
fn the_interval_holds_where_the_bias_is_most_of_it() {
    let problem = rotations();
    let settings = ExpectationSettings {
        coarsest_steps: 2,
        max_level: 3,
        ..settings(2, Coupling::Antithetic)
    };
    for estimator in ESTIMATORS {
        let settings = ExpectationSettings { estimator, ..settings };
        let result =
            expectation(&Setup::of(&problem, &Sexp), &MOMENTS, 5e-4, &settings, &|_| ()).unwrap();
        assert!(
            result.warnings.contains(&Warning::LevelLimit { level: 3 }) && !result.reached(),
            "{result:?}"
        );
        for (estimate, exact) in result.estimates.iter().zip(exact_moments()) {
            let error = exact - estimate.value;
            let statistical = Z * estimate.standard_error;
            // The bias is there, it has the sign and the size that the last difference says, and
            // the interval holds.
            assert!(error.abs() > 1.96 * estimate.standard_error, "{estimate:?}, error {error}");
            assert!(
                (error - estimate.bias).abs() < statistical + 0.3 * estimate.bias.abs(),
                "{estimate:?}, error {error}"
            );
            assert!(error.abs() < estimate.bias_bound + statistical, "{estimate:?}, error {error}");
        }
    }
}

#[test]
fn threads_do_not_change_a_bit() {
    let problem = body();
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            ESTIMATORS.map(|estimator| {
                expectation(
                    &Setup::of(&problem, &Sexp),
                    &COS_Y3,
                    1e-3,
                    &ExpectationSettings { estimator, ..settings(3, Coupling::Antithetic) },
                    &|_| (),
                )
                .unwrap()
            })
        })
    };
    let one = run(1);
    assert!(one.iter().all(Expectation::reached));
    for threads in [2, 3] {
        assert_eq!(one, run(threads), "{threads} threads");
    }
}

#[test]
fn the_twin_doubles_the_order_of_the_variance() {
    let problem = body();
    for (coupling, accuracy, range) in
        [(Coupling::Antithetic, 2e-4, 1.8..=2.35), (Coupling::Plain, 4e-4, 0.9..=1.1)]
    {
        let result = expectation(
            &Setup::of(&problem, &Sexp),
            &COS_Y3,
            accuracy,
            &settings(4, coupling),
            &|_| (),
        )
        .unwrap();
        assert!(result.reached() && result.warnings.is_empty(), "{coupling:?}: {result:?}");
        let beta = result.estimates[0].beta.unwrap();
        assert!(range.contains(&beta.value), "{coupling:?}: {beta:?}");
        assert!(beta.lower < *range.end() && beta.upper > *range.start(), "{coupling:?}: {beta:?}");
    }
}

#[test]
fn the_cost_grows_as_the_accuracy_squared() {
    let problem = body();
    let accuracies = [1e-3, 5e-4, 2.5e-4];
    let costs = |method: fn(f64, &Body, &ExpectationSettings) -> u64| {
        accuracies.map(|accuracy| {
            method(
                accuracy,
                &problem,
                &ExpectationSettings { pilot: 128, ..settings(5, Coupling::Antithetic) },
            ) as f64
        })
    };
    let multilevel = costs(|accuracy, problem, settings| {
        let result =
            expectation(&Setup::of(problem, &Sexp), &COS_Y3, accuracy, settings, &|_| ()).unwrap();
        assert!(result.reached() && result.warnings.is_empty(), "{:?}", result.warnings);
        result.cost
    });
    let plain = costs(|accuracy, problem, settings| {
        let settings = ExpectationSettings { estimator: Estimator::SinglePaths, ..*settings };
        let result =
            expectation(&Setup::of(problem, &Sexp), &COS_Y3, accuracy, &settings, &|_| ()).unwrap();
        assert!(result.reached() && result.warnings.is_empty(), "{:?}", result.warnings);
        result.cost
    });
    // The standard error may have 3/4 to all of the accuracy, which is a factor (4/3)² in the
    // number of samples. Levels that are added later have less than a tenth of Σ√(VC), or a fifth
    // of its square. Pilots only lower the growth.
    let margin = (4.0f64 / 3.0).powi(2);
    for pair in [0..2, 1..3, 0..3] {
        let (first, last) = (pair.start, pair.end - 1);
        let square = (accuracies[first] / accuracies[last]).powi(2);
        let growth = multilevel[last] / multilevel[first];
        assert!(growth < square * margin * 1.2 && growth > square / margin / 1.2, "{multilevel:?}");
    }
    // Single paths take ε⁻³: 64-fold in place of 16-fold, with the same margin and half or twice
    // the steps.
    let growth = plain[2] / plain[0];
    assert!(growth > 64.0 / margin / 2.0 && growth < 64.0 * margin * 2.0, "{plain:?}");
    assert!(plain[2] > 8.0 * multilevel[2], "{plain:?} {multilevel:?}");
}

/// Sexp with something done to the increments, which may depend on the step size.
struct Altered<F>(F);

impl<S: PoissonSystem<D, M>, F: Fn(f64) -> f64 + Send + Sync, const D: usize, const M: usize>
    Scheme<S, D, M> for Altered<F>
{
    fn id(&self) -> &'static str {
        "altered"
    }
    fn reads_areas(&self) -> bool {
        false
    }
    fn clips_increments(&self) -> bool {
        true
    }
    fn step_block(
        &self,
        system: &S,
        step: &Step,
        noise: &BlockNoise<M>,
        y: &mut Block<D>,
        status: &mut BlockStatus,
    ) {
        let factor = (self.0)(step.tau);
        let altered = noise.increments.map(|row| row.map(|w| factor * w));
        Sexp.step_block(system, step, &BlockNoise::increments(&altered), y, status);
    }
    fn step(&self, system: &S, step: &Step, noise: &Noise<M>, y: [f64; D]) -> Solution<D> {
        let factor = (self.0)(step.tau);
        let altered = Noise::increments(noise.increments.map(|w| factor * w));
        Sexp.step(system, step, &altered, y)
    }
}

#[test]
fn paths_that_do_not_share_their_noise_are_noticed() {
    let problem = body();
    // −ΔW on every second level: each level has the right law, and no two neighbours are coupled.
    let alternating =
        Altered(|tau: f64| if (4.0 * tau).log2().rem_euclid(2.0) == 0.0 { 1.0 } else { -1.0 });
    let settings =
        ExpectationSettings { max_cost: 20_000_000, ..settings(6, Coupling::Antithetic) };
    let result =
        expectation(&Setup::of(&problem, &alternating), &COS_Y3, 1e-3, &settings, &|_| ()).unwrap();
    assert!(result.estimates[0].beta.unwrap().upper < 0.5, "{result:?}");
    // The law is right, so nothing else is wrong.
    assert!(!result.warnings.iter().any(|warning| matches!(warning, Warning::Inconsistent { .. })));
    let same = Altered(|_| 1.0);
    let result =
        expectation(&Setup::of(&problem, &same), &COS_Y3, 1e-3, &settings, &|_| ()).unwrap();
    assert!(result.warnings.is_empty(), "{:?}", result.warnings);
    assert!(result.estimates[0].beta.unwrap().lower > 1.0, "{result:?}");
}

#[test]
fn a_lower_weak_order_is_noticed() {
    let problem = rotations();
    // Noise that is too large by √τ/2: E[φ] is off by a multiple of √τ.
    let rough = Altered(|tau: f64| 1.0 + 0.5 * tau.sqrt());
    let y1 = &MOMENTS[..1];
    let settings = ExpectationSettings { max_level: 10, ..settings(7, Coupling::Antithetic) };
    let result = expectation(&Setup::of(&problem, &rough), y1, 5e-3, &settings, &|_| ()).unwrap();
    let order = |warning: &Warning| matches!(warning, Warning::WeakOrder { alpha, .. } if alpha.upper < 0.75);
    assert!(result.warnings.iter().any(order), "{result:?}");
    // The bias is judged by the observed order: the interval still holds.
    let (lower, upper) = result.estimates[0].interval();
    assert!(lower < exact_moments()[0] && exact_moments()[0] < upper, "{result:?}");
    // Told the truth, there is nothing to warn of.
    let settings = ExpectationSettings { weak_order: 0.5, ..settings };
    let result = expectation(&Setup::of(&problem, &rough), y1, 5e-3, &settings, &|_| ()).unwrap();
    assert!(
        !result.warnings.iter().any(|warning| matches!(warning, Warning::WeakOrder { .. })),
        "{result:?}"
    );
}

thread_local! {
    static LAST_TAU: Cell<f64> = const { Cell::new(0.0) };
}

/// Sexp that keeps what it must not keep: a step after a step of another size comes out a little
/// too short, as it might with a factorisation that is reused where it does not apply. Alone on a
/// level it does nothing wrong.
struct Remembering;

impl<S: PoissonSystem<D, M>, const D: usize, const M: usize> Scheme<S, D, M> for Remembering {
    fn id(&self) -> &'static str {
        "remembering"
    }
    fn reads_areas(&self) -> bool {
        false
    }
    fn clips_increments(&self) -> bool {
        true
    }
    fn step_block(
        &self,
        system: &S,
        step: &Step,
        noise: &BlockNoise<M>,
        y: &mut Block<D>,
        status: &mut BlockStatus,
    ) {
        Sexp.step_block(system, step, noise, y, status);
        let before = LAST_TAU.replace(step.tau);
        if before < step.tau && before > 0.0 {
            y.0.iter_mut().flatten().for_each(|component| *component *= 1.0 - 0.02 * step.tau);
        }
    }
    fn step(&self, system: &S, step: &Step, noise: &Noise<M>, y: [f64; D]) -> Solution<D> {
        Sexp.step(system, step, noise, y)
    }
}

#[test]
fn levels_that_do_not_telescope_are_noticed() {
    let problem = body();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let settings = ExpectationSettings { max_cost: 5_000_000, ..settings(8, Coupling::Antithetic) };
    let run = |scheme: &dyn Scheme<RigidBody<3>, 3, 3>| {
        pool.install(|| {
            expectation(&Setup::of(&problem, scheme), &COS_Y3, 2e-4, &settings, &|_| ()).unwrap()
        })
    };
    let wrong = run(&Remembering);
    let inconsistent =
        |warning: &Warning| matches!(warning, Warning::Inconsistent { level: 1, .. });
    assert!(wrong.warnings.iter().any(inconsistent), "{:?}", wrong.warnings);
    let right = run(&Sexp);
    assert!(right.warnings.is_empty(), "{:?}", right.warnings);
    // The error is beyond the accuracy, which is what makes the check worth having.
    assert!((wrong.estimates[0].value - right.estimates[0].value).abs() > 2e-4);
}

#[test]
fn a_limit_ends_the_computation_and_nothing_is_lost() {
    let problem = body();
    let limited = |estimator: Estimator, max_cost: u64| {
        let settings =
            ExpectationSettings { estimator, max_cost, ..settings(9, Coupling::Antithetic) };
        let done = AtomicU64::new(0);
        let progress = |steps: u64| {
            done.fetch_add(steps, Ordering::Relaxed);
        };
        let result = expectation(&Setup::of(&problem, &Sexp), &COS_Y3, 1e-5, &settings, &progress);
        if let Ok(result) = &result {
            // Every path-step is counted, and those that progress was told of are all.
            assert_eq!(done.into_inner(), result.cost);
            let levels = result
                .levels
                .iter()
                .map(|level| (level.samples + level.failed) * level.cost_per_path);
            assert_eq!(levels.sum::<u64>(), result.cost);
            assert!(result.cost <= max_cost && !result.reached());
            assert!(
                result.warnings.contains(&Warning::CostLimit { max_cost }),
                "{:?}",
                result.warnings
            );
            // 0.7977 ± 0.0001 by a run of 10⁷ path-steps.
            let estimate = &result.estimates[0];
            let margin = 1e-4 + estimate.bias_bound + Z * estimate.standard_error;
            assert!((estimate.value - 0.7977).abs() < margin, "{result:?}");
        }
        result
    };
    for estimator in ESTIMATORS {
        for max_cost in [80_000, 100_000, 300_000, 1_000_000] {
            let result = limited(estimator, max_cost).unwrap();
            // What is not used is too little for a pilot on the next level.
            assert!(result.cost > max_cost / 2, "{} of {max_cost}", result.cost);
        }
        let result = limited(estimator, 10_000);
        assert!(
            matches!(result, Err(MultilevelError::PilotCost { max_cost: 10_000, .. })),
            "{result:?}"
        );
    }
    let settings = ExpectationSettings { max_level: 3, ..settings(9, Coupling::Antithetic) };
    for estimator in ESTIMATORS {
        let settings = ExpectationSettings { estimator, ..settings };
        let result =
            expectation(&Setup::of(&problem, &Sexp), &COS_Y3, 2e-4, &settings, &|_| ()).unwrap();
        assert!(
            result.warnings.contains(&Warning::LevelLimit { level: 3 }),
            "{:?}",
            result.warnings
        );
        assert!(!result.reached() && result.estimates[0].bias_bound > 5e-5);
    }
}

#[test]
fn what_does_not_vary_needs_no_samples() {
    let problem = body();
    // sexp keeps the damped Casimir to round-off, which differs from path to path.
    let still = [Observable {
        name: "C",
        function: |y: [f64; 3]| 0.5 * (y[0] * y[0] + y[1] * y[1] + y[2] * y[2]),
    }];
    let settings = settings(10, Coupling::Antithetic);
    let result =
        expectation(&Setup::of(&problem, &Sexp), &still, 1e-9, &settings, &|_| ()).unwrap();
    assert!(result.reached() && result.warnings.is_empty(), "{result:?}");
    // The pilot, and the third difference that the bias is judged by.
    assert_eq!(result.levels.len(), 4);
    assert!(
        result.estimates.iter().all(|estimate| estimate.alpha.is_none() && estimate.beta.is_none())
    );
    let law = 0.5 * (-0.5 * 2.0f64.sin()).exp();
    assert!((result.estimates[0].value - law).abs() < 1e-13);
}

#[test]
fn the_accuracy_holds_for_each_test_function() {
    let problem = body();
    let several = [
        Observable { name: "y1", function: |y: [f64; 3]| y[0] },
        Observable { name: "y2", function: |y| y[1] },
        Observable { name: "y2^2", function: |y| y[1] * y[1] },
    ];
    let settings = settings(11, Coupling::Antithetic);
    let together =
        expectation(&Setup::of(&problem, &Sexp), &several, 4e-3, &settings, &|_| ()).unwrap();
    assert!(together.reached(), "{together:?}");
    for (k, one) in several.iter().enumerate() {
        let alone =
            expectation(&Setup::of(&problem, &Sexp), &[*one], 4e-3, &settings, &|_| ()).unwrap();
        assert!(alone.reached() && alone.cost <= together.cost, "{}", one.name);
        let difference = (alone.estimates[0].value - together.estimates[k].value).abs();
        assert!(difference < 8e-3, "{}: {difference}", one.name);
    }
}

#[test]
fn paths_that_fail_are_counted_and_reported() {
    let problem = Problem::new(Explosive, Constant::new(0.0).unwrap(), [0.1, -0.5], 0.5).unwrap();
    let sexp = WithSolver { formula: Sexp, solver: Solver::new(Method::Newton) };
    let bounded =
        [Observable { name: "bounded", function: |y: [f64; 2]| 1.0 / (1.0 + y[1] * y[1]) }];
    let settings = ExpectationSettings { max_cost: 400_000, ..settings(13, Coupling::Plain) };
    let result =
        expectation(&Setup::of(&problem, &sexp), &bounded, 0.02, &settings, &|_| ()).unwrap();
    let failed: u64 = result.levels.iter().map(|level| level.failed).sum();
    assert!(failed > 0);
    for level in result.levels.iter().filter(|level| level.failed > 0) {
        let warning = Warning::FailedPaths { level: level.level, failed: level.failed };
        assert!(result.warnings.contains(&warning), "{:?}", result.warnings);
        assert!(warning.to_string().contains(&level.failed.to_string()));
    }
    // They are reported beside the estimate that misses them.
    assert_eq!(result.estimates[0].failed, failed);
}

/// E[cos y₃] of [`body`], from the Kolmogorov equation on the sphere by spherical harmonics
/// (`analysis`).
const EXACT_COS_Y3: f64 = 0.797_719_935_281_68;

#[test]
fn coupling_by_areas_has_no_bias() {
    let problem = body();
    let levy = SexpLevy::new(problem.system(), problem.y0());
    let settings = settings(15, Coupling::Plain);
    let result =
        expectation(&Setup::of(&problem, &levy), &COS_Y3, 1e-4, &settings, &|_| ()).unwrap();
    let Estimate { value, standard_error, bias_bound, .. } = result.estimates[0];
    // 3.9 standard errors are a false alarm in 10⁴; areas that lack variance were off by 2.5e-4,
    // ten of them.
    assert!(
        (value - EXACT_COS_Y3).abs() <= 3.9 * standard_error + bias_bound,
        "{value} ± {standard_error}"
    );
    assert!(3.9 * standard_error + bias_bound < 2.2e-4, "{standard_error} {bias_bound}");
    // The variance falls as with the antithetic twin.
    let beta = result.estimates[0].beta.unwrap();
    assert!(beta.lower > 1.5, "{beta:?}");
    // One noise has no areas.
    let system = RigidBody::one_noise([2.0, 1.0, 2.0 / 3.0], 1.0).unwrap();
    let problem = Problem::new(system, Constant::new(0.1).unwrap(), problem.y0(), 1.0).unwrap();
    let levy = SexpLevy::new(problem.system(), problem.y0());
    let [with, without] = [
        expectation(&Setup::of(&problem, &levy), &COS_Y3, 1e-2, &settings, &|_| ()).unwrap(),
        expectation(&Setup::of(&problem, &Sexp), &COS_Y3, 1e-2, &settings, &|_| ()).unwrap(),
    ];
    assert_eq!((with.cost, with.levels), (without.cost, without.levels));
    assert_eq!(with.estimates, without.estimates);
}

#[test]
fn bad_requests_are_refused_and_name_the_value() {
    let problem = body();
    let good = settings(14, Coupling::Antithetic);
    let refuse = |accuracy: f64, observables: &[Observable<3>], settings: ExpectationSettings| {
        let error =
            expectation(&Setup::of(&problem, &Sexp), observables, accuracy, &settings, &|_| ())
                .unwrap_err();
        let settings = ExpectationSettings { estimator: Estimator::SinglePaths, ..settings };
        let plain =
            expectation(&Setup::of(&problem, &Sexp), observables, accuracy, &settings, &|_| ())
                .unwrap_err();
        assert_eq!(std::mem::discriminant(&error), std::mem::discriminant(&plain), "{plain}");
        error
    };
    let setting = |accuracy: f64, settings: ExpectationSettings| {
        let error = refuse(accuracy, &COS_Y3, settings);
        let MultilevelError::Setting { name, value, .. } = error else { panic!("{error}") };
        assert!(error.to_string().contains(&format!("got {value}")), "{error}");
        (name, value)
    };
    for accuracy in [0.0, -1.0, f64::INFINITY] {
        assert_eq!(setting(accuracy, good), ("accuracy", accuracy));
    }
    assert!(setting(f64::NAN, good).1.is_nan());
    assert_eq!(refuse(0.1, &[], good), MultilevelError::NoObservable);
    let key = StreamKey { experiment: 1 << 40, ..good.key };
    let experiment = ExpectationSettings { key, ..good };
    assert_eq!(setting(0.1, experiment), ("experiment number", 2f64.powi(40)));
    for coarsest_steps in [0, u64::MAX] {
        let settings = ExpectationSettings { coarsest_steps, ..good };
        let name = "number of coarsest steps";
        assert_eq!(setting(0.1, settings), (name, coarsest_steps as f64));
    }
    let order = ExpectationSettings { weak_order: -1.0, ..good };
    assert_eq!(setting(0.1, order), ("weak order", -1.0));
    let pilot = ExpectationSettings { pilot: 127, ..good };
    assert_eq!(setting(0.1, pilot), ("number of pilot paths", 127.0));
    for max_level in [0, 2, 25] {
        let settings = ExpectationSettings { max_level, ..good };
        assert_eq!(setting(0.1, settings), ("finest level", max_level as f64));
    }
    // One step on [0, 1] cannot be truncated.
    assert_eq!(
        refuse(0.1, &COS_Y3, ExpectationSettings { coarsest_steps: 1, ..good }),
        MultilevelError::Ladder(LadderError::Noise(NoiseError::StepOutsideUnitInterval {
            tau: 1.0
        }))
    );
    let undefined = [Observable { name: "ln y2", function: |y: [f64; 3]| y[1].ln() }];
    let error = refuse(0.1, &undefined, good);
    let MultilevelError::NotFinite { observable, .. } = error else { panic!("{error}") };
    assert_eq!(observable, "ln y2");
}
