//! Expectations with everything chosen: exact values, the same bits for any threads and flows, and
//! what is done where a scheme is not for a system.

use std::{
    fs,
    sync::{
        Arc,
        atomic::{AtomicU64, Ordering},
    },
    time::Duration,
};

use expectation::{Expect, ExpectSettings, WarningKind};
use mc::{
    Checkpoint, Observable, RunError, Setup,
    parts::{Program, Stop},
};
use real::Real;
use schemes::Sexp;
use systems::{Constant, LotkaVolterra, PoissonSystem, Problem, run_time::Compiled};

use crate::{
    explosive::Explosive, failing::Walled, ladder::body, statistical::random_points::warns,
};

/// E cos y₃ of [`body`], by eigenfunctions on the sphere (`analysis::sphere`).
const EXACT: f64 = 0.797_719_94;

const COS_Y3: Observable<3> = Observable { name: "cos y3", function: |y| y[2].cos() };

#[test]
fn three_noises_that_do_not_commute() {
    let problem = body();
    let found = Expect::by_parts(&problem).run(&[&COS_Y3], 1e-4).unwrap();
    let estimate = &found.estimates[0];
    // With 95 % the interval contains the value; a seed that fails would be one of twenty.
    assert!(found.reached() && found.warnings.is_empty(), "{:?}", found.warnings);
    assert!((estimate.value - EXACT).abs() < estimate.half_width(), "{estimate:?}");
    assert!(estimate.half_width() <= 1e-4 && estimate.quantile > 2.0);
    // Random points on levels take some hundred times as much.
    assert!(found.cost < 2_000_000, "{}", found.cost);
    assert_eq!(found.scheme, "nv");
    // Without parts the scheme and its bias are others, and the truth is the same.
    let general = Expect::new(&problem).run(&[&COS_Y3], 1e-4).unwrap();
    assert!(general.reached() && general.scheme == "sexp-li", "{general:?}");
    assert!((general.estimates[0].value - EXACT).abs() < general.estimates[0].half_width());
    assert!(general.cost < 2_000_000, "{}", general.cost);
    // E[φ(y(T))] − E[φ(y_τ)] is near 1.52e-3 τ.
    let (bias, tau) = (general.estimates[0].bias, general.levels.last().unwrap().tau);
    assert!((bias / tau - 1.52e-3).abs() < 0.5e-3, "{bias}, {tau}");
}

/// B(y) = (1 + y₃²)·(y × ·), with the Casimir ½|y|² named: not affine, and not linear.
#[derive(Clone)]
struct Curved;

impl PoissonSystem<3, 2> for Curved {
    fn name(&self) -> &'static str {
        "curved"
    }
    fn structure<R: Real>(&self, y: [R; 3], v: [R; 3]) -> [R; 3] {
        let factor = y[2] * y[2] + 1.0;
        let cross =
            [y[1] * v[2] - y[2] * v[1], y[2] * v[0] - y[0] * v[2], y[0] * v[1] - y[1] * v[0]];
        cross.map(|x| x * factor)
    }
    fn energy<R: Real>(&self, y: [R; 3], dt: f64, dw: [f64; 2]) -> R {
        y[2] * dt + y[0] * (0.5 * dw[0]) + y[2] * (0.5 * dw[1])
    }
}

#[test]
fn where_sexp_li_is_refused_sexp_is_taken() {
    let problem = Problem::new(Curved, Constant::new(0.1).unwrap(), [0.6, 0.0, 0.8], 0.5).unwrap();
    let square =
        Observable { name: "|y|²", function: |y: [f64; 3]| y.iter().map(|y| y * y).sum() };
    let first = Observable { name: "y1", function: |y: [f64; 3]| y[0] };
    let found = Expect::new(&problem).run(&[&square, &first], 3e-3).unwrap();
    assert_eq!(found.scheme, "sexp");
    // |y|² is damped by e^{−2γT} on every path.
    let exact = (-0.1f64).exp();
    assert!((found.estimates[0].value - exact).abs() < 1e-12);
    assert!(found.estimates[1].half_width() <= 3e-3);
}

#[test]
fn large_steps_on_which_paths_fail_are_left_out() {
    // The stages of Runge and Kutta overflow here with large noise.
    let system = LotkaVolterra::<2, 2>::new(1.0).unwrap();
    let problem = Problem::new(system, Constant::new(0.0).unwrap(), [0.9, 1.1, 0.8], 1.0).unwrap();
    let h = Observable { name: "H", function: |y: [f64; 3]| y[0].powi(2) * y[1].powi(2) * y[2] };
    let found = Expect::new(&problem).run(&[&h], 0.1).unwrap();
    // Drift and noise are the same H: it is constant.
    let (exact, estimate) = (0.81 * 1.21 * 0.8, &found.estimates[0]);
    assert!(found.reached() && (estimate.value - exact).abs() < estimate.half_width(), "{found}");
    assert!(found.levels[0].tau <= 0.25, "{:?}", found.levels[0]);
}

/// H₀ = ½(q² + p²), and H₁ = σq if there is noise: constant B.
#[derive(Clone)]
struct Oscillator<const M: usize>(f64);

impl<const M: usize> PoissonSystem<2, M> for Oscillator<M> {
    fn name(&self) -> &'static str {
        "oscillator"
    }
    fn structure<R: Real>(&self, _: [R; 2], v: [R; 2]) -> [R; 2] {
        [v[1], -v[0]]
    }
    fn energy<R: Real>(&self, y: [R; 2], dt: f64, dw: [f64; M]) -> R {
        (y[0] * y[0] + y[1] * y[1]) * (0.5 * dt) + y[0] * (self.0 * dw.iter().sum::<f64>())
    }
}

fn oscillator<const M: usize>(gamma: f64, t_end: f64) -> Problem<Oscillator<M>, Constant, 2> {
    let damping = Constant::new(gamma).unwrap();
    Problem::new(Oscillator(0.5), damping, [1.0, 0.0], t_end).unwrap()
}

const Q: Observable<2> = Observable { name: "q", function: |y| y[0] };
const P: Observable<2> = Observable { name: "p", function: |y| y[1] };
const P_SQUARED: Observable<2> = Observable { name: "p²", function: |y| y[1] * y[1] };

#[test]
fn without_noise_one_path_is_extrapolated() {
    for (gamma, t_end, accuracy) in [(0.0, 1.0, 1e-4), (0.0, 50.0, 1e-9), (0.3, 4.0, 1e-12)] {
        let problem = oscillator::<0>(gamma, t_end);
        let chosen = Expect::new(&problem).run(&[&Q, &P], accuracy).unwrap();
        let given = Expect::with_scheme(Setup::of(&problem, &Sexp))
            .with(ExpectSettings { coarsest_steps: 128, ..Default::default() });
        let given = given.run(&[&Q, &P], accuracy).unwrap();
        for found in [chosen, given] {
            assert!(found.reached() && found.warnings.is_empty(), "{found}");
            assert!(found.cost < 1_000_000, "{found}");
            let decay = f64::exp(-gamma * t_end);
            for (estimate, exact) in
                found.estimates.iter().zip([t_end.cos() * decay, -t_end.sin() * decay])
            {
                let error = (estimate.value - exact).abs();
                assert!(error <= estimate.half_width(), "{error:e} {estimate:?}");
                // The last value alone is none.
                assert!(estimate.bias.abs() > estimate.half_width(), "{estimate:?}");
            }
        }
    }
}

/// An accuracy below rounding errors is refused after the pilot, with their size.
#[test]
fn rounding_errors_refuse_an_accuracy() {
    let found = Expect::new(&oscillator::<0>(0.0, 1.0)).run(&[&Q], 1e-17).unwrap();
    assert!(!found.reached() && warns(&found, WarningKind::OutOfReach), "{found}");
    assert!(found.cost < 1000 && found.to_string().contains("rounding errors"), "{found}");
}

#[test]
fn strong_damping_is_resolved_or_refused() {
    // Var p = σ²∫e^{−2γs}cos² s ds; schemes of any step size far above 1/γ agree on zero.
    let gamma = 50.0;
    let variance = 0.125 * (0.5 / gamma + 0.5 * gamma / (gamma * gamma + 1.0));
    let found = Expect::new(&oscillator::<1>(gamma, 1.0)).run(&[&P, &P_SQUARED], 1e-3).unwrap();
    assert!(found.reached(), "{found}");
    for (estimate, exact) in found.estimates.iter().zip([0.0, variance]) {
        assert!((estimate.value - exact).abs() <= estimate.half_width(), "{found}");
    }
    let found = Expect::new(&oscillator::<1>(1e7, 1.0)).run(&[&P_SQUARED], 1e-4).unwrap();
    assert!(!found.reached() && found.cost < 1_000_000, "{found}");
    assert!(warns(&found, WarningKind::OutOfReach), "{found}");
}

#[test]
fn a_constant_matrix_has_a_conformal_scheme() {
    let problem = oscillator::<1>(0.0, 1.0);
    let system = Arc::new(Compiled::new(problem.system().clone(), problem.y0()));
    let damping = Arc::new(Constant::new(0.0).unwrap());
    let problem = systems::run_time::Problem::new(system, damping, vec![1.0, 0.0], 1.0).unwrap();
    let found = Expect::at_run_time(&problem).unwrap().run(&[&Q], 1e-2).unwrap();
    let (truth, estimate) = (1f64.cos(), &found.estimates[0]);
    assert!(found.reached() && found.scheme == "sexp", "{found}");
    assert!((estimate.value - truth).abs() <= estimate.half_width(), "{found}");
}

#[test]
fn what_is_out_of_reach_is_said_early() {
    let found = Expect::new(&oscillator::<1>(0.1, 1.0)).run(&[&Q, &P], 1e-14).unwrap();
    let named = warns(&found, WarningKind::OutOfReach);
    assert!(!found.reached() && named, "{found}");
    // One in a hundred of the path-steps that are allowed.
    assert!(found.cost < 100_000_000, "{found}");
    let truths = [1f64.cos(), -(1f64.sin())].map(|x| x * (-0.1f64).exp());
    for (estimate, truth) in found.estimates.iter().zip(truths) {
        assert!((estimate.value - truth).abs() < 1.5 * estimate.half_width(), "{found}");
    }
}

const COS_SQUARED: Observable<2> =
    Observable { name: "cos²", function: |y| 1.0 / (1.0 + y[1] * y[1]) };

#[test]
fn the_limit_is_for_all_attempts_together() {
    for max_cost in [300_000, 1_000_000] {
        let done = AtomicU64::new(0);
        let progress = |work| _ = done.fetch_add(work, Ordering::Relaxed);
        // y₂ = tan(θ₀ + t + W) from θ₀ = −0.46 on.
        let damping = Constant::new(0.0).unwrap();
        let problem = Problem::new(Explosive, damping, [0.1, -0.5], 1.0).unwrap();
        let settings = ExpectSettings { max_cost, ..Default::default() };
        let mut expect = Expect::new(&problem).with(settings);
        expect.counted = Box::new(progress);
        let found = expect.run(&[&COS_SQUARED], 1e-2);
        let done = done.load(Ordering::Relaxed);
        assert!(done <= max_cost, "{done}");
        match found {
            Ok(found) => assert!(found.cost == done && !found.reached(), "{found} {done}"),
            Err(error) => assert!(matches!(error, RunError::PilotCost { .. }), "{error}"),
        }
    }
}

#[test]
fn few_failed_paths_widen_the_interval() {
    let problem = Problem::new(Walled(3.5), Constant::new(0.0).unwrap(), [0.0, 0.0], 1.0).unwrap();
    let cosine = Observable { name: "cos p", function: |y: [f64; 2]| y[1].cos() };
    let found = Expect::new(&problem).run(&[&cosine], 0.03).unwrap();
    let estimate = &found.estimates[0];
    assert!(found.reached() && estimate.failed > 0, "{found}");
    assert!(found.scheme == "sexp-li" && found.levels[0].tau == 1.0, "{found}");
    let truth = f64::exp(-0.5);
    assert!((estimate.value - truth).abs() <= estimate.half_width(), "{found}");
    assert!(estimate.bias_bound > 2e-4, "{found}");
}

/// Stopped at several places, again and again, and each time gone on from the file: in the pilot,
/// which is nearly all for the first accuracy, and in rounds.
#[test]
fn who_goes_on_has_the_same_bits() {
    let folder = tempfile::tempdir().unwrap();
    let problem = body();
    let checkpoint = |input: &str| {
        let file = folder.path().join("kept/samples.bin");
        Checkpoint::new(file, Program { input: input.into(), ..Program::default() })
    };
    for (accuracy, pilots) in [(1e-2, 2), (1e-5, 0)] {
        let whole = Expect::new(&problem).run(&[&COS_Y3], accuracy).unwrap();
        let (mut stops, mut before) = (0, 0);
        let found = loop {
            let stop = Stop::default();
            let done = AtomicU64::new(0);
            let progress = |steps: u64| {
                if done.fetch_add(steps, Ordering::Relaxed) > whole.cost / 5 {
                    stop.now();
                }
            };
            let settings = ExpectSettings { stop: stop.clone(), ..Default::default() };
            let keeping = checkpoint("cos y3");
            let mut expect = Expect::new(&problem).with(settings);
            expect.checkpoint = Some(&keeping);
            expect.counted = Box::new(progress);
            let found = expect.run(&[&COS_Y3], accuracy);
            if !stop.is_asked() {
                break found.unwrap();
            }
            match found {
                Err(error) => {
                    assert_eq!(error, RunError::Stopped);
                    before += 1;
                }
                Ok(found) => assert!(!found.reached() && warns(&found, WarningKind::Stopped)),
            }
            assert!(keeping.holds().unwrap());
            // Another expectation does not take the samples.
            let another = checkpoint("p");
            let mut other = Expect::new(&problem);
            other.checkpoint = Some(&another);
            let refused = other.run(&[&COS_Y3], accuracy);
            assert!(matches!(refused, Err(RunError::Checkpoint(_))));
            stops += 1;
            assert!(stops < 20, "it does not get on");
        };
        assert!(stops > 2 && before >= pilots, "{stops} stops, {before} in the pilot");
        assert!(found == whole, "{found} {whole}");
        assert!(!checkpoint("").file().exists());
    }
}

/// A copy of the file at any time is what a kill would leave.
#[test]
fn samples_are_kept_every_few_seconds() {
    let folder = tempfile::tempdir().unwrap();
    let problem = body();
    let (file, copy) = (folder.path().join("samples.bin"), folder.path().join("copy.bin"));
    let mut often = Checkpoint::new(&file, Program::default());
    often.interval = Duration::from_millis(10);
    let (calls, seen) = (AtomicU64::new(0), AtomicU64::new(0));
    let told = |_| {
        let call = calls.fetch_add(1, Ordering::Relaxed);
        if call.is_multiple_of(64) && fs::copy(&file, &copy).is_ok() {
            seen.fetch_add(1, Ordering::Relaxed);
        }
    };
    let kept = |checkpoint, counted| {
        let mut expect = Expect::new(&problem);
        (expect.checkpoint, expect.counted) = (Some(checkpoint), counted);
        expect.run(&[&COS_Y3], 1e-5).unwrap()
    };
    let whole = kept(&often, Box::new(told));
    assert!(seen.load(Ordering::Relaxed) > 3 && !file.exists());
    let left = Checkpoint::new(&copy, Program::default());
    let counted = AtomicU64::new(0);
    let count = |steps| _ = counted.fetch_add(steps, Ordering::Relaxed);
    let found = kept(&left, Box::new(count));
    assert_eq!(found, whole);
    assert!(counted.load(Ordering::Relaxed) < whole.cost);
}

#[test]
fn who_is_stopped_keeps_the_estimates_so_far() {
    let problem = oscillator::<1>(0.1, 1.0);
    let stop = Stop::default();
    let done = AtomicU64::new(0);
    let progress = |work: u64| {
        if done.fetch_add(work, Ordering::Relaxed) > 20_000_000 {
            stop.now();
        }
    };
    let settings =
        || ExpectSettings { max_cost: u64::MAX, stop: stop.clone(), ..Default::default() };
    let expect = || {
        let mut expect = Expect::new(&problem).with(settings());
        expect.counted = Box::new(progress);
        expect.run(&[&Q], 1e-7)
    };
    let found = expect().unwrap();
    assert!(!found.reached() && warns(&found, WarningKind::Stopped), "{found}");
    assert!(found.estimates[0].half_width() < 1e-2, "{found}");
    assert_eq!(expect(), Err(RunError::Stopped));
}

#[test]
fn alike_warnings_are_one_sentence() {
    let rare = |name| Observable { name, function: |y: [f64; 2]| f64::from(u8::from(y[0] > 9.0)) };
    let found =
        Expect::new(&oscillator::<1>(0.1, 1.0)).run(&[&rare("a"), &rare("b")], 0.5).unwrap();
    let text = found.to_string();
    assert_eq!(text.matches("samples carry the variance").count(), 1, "{text}");
    assert!(text.contains("warning: a, b: "), "{text}");
}
