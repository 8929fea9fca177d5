//! Weak order two of `nv` on systems from texts, and its limit; and that of `baoab`.
//!
//! Errors of order τ² are lost in the noise of random paths, so paths are integrals over Sobol
//! points, as in the supplement `rigid-body-weak-two` of `verify`. A difference between step sizes
//! is averaged over both orders of the noises, and the fine path of the other order has the
//! increments of each coarse step swapped: its variance falls like τ². Flows are exact, so that the
//! error of the average has even powers of τ. Each difference has scrambles of its own, whose means
//! are the samples.

use std::sync::Arc;

use mc::{Friction, Setup};
use noise::{QuasiWiener, StepNoise, StreamKey};
use nonlin::BlockStatus;
use real::{Row, WIDTH};
use schemes::{
    About, Baoab, Heun, Nv, Step, Stepper, Sweep,
    run_time::{Scheme, SchemeError},
};
use stats::{Against, CrossMoments, Expansion, Rate, diagonal, fit_weak};
use systems::run_time::{Problem, System};

use crate::{SPIN, constant, problem, texts};

/// Steps of the coarse paths on [0, 1].
const STEPS: [u64; 4] = [2, 4, 8, 16];
/// Samples of a difference.
const SCRAMBLES: u64 = 64;
/// An interval of this confidence misses by chance in 1e-6 of all cases if errors are normal, and
/// in 1e-5 by Student's law of 63 degrees of freedom.
const CONFIDENCE: f64 = 1.0 - 1e-6;
/// As many standard errors are exceeded by chance in 1e-5 of all cases, by the same law.
const ERRORS: f64 = 4.8;

/// A system from texts with a function φ of its state.
struct Case {
    name: &'static str,
    problem: Problem,
    friction: Vec<Friction>,
    phi: fn(&[f64]) -> f64,
    /// Points of a scramble, so that the error of φ stands out of the noise.
    points: u64,
}

/// Six systems with noises of this size.
fn cases(size: f64) -> [Case; 6] {
    let of = |state: &str, b: &[&str], energy: &str, noises: &[&str], rate: f64, y0: &[f64]| {
        let noises: Vec<String> = noises.iter().map(|text| format!("{size}*({text})")).collect();
        let noises: Vec<&str> = noises.iter().map(String::as_str).collect();
        problem(&texts(state, b, energy, &noises), rate, y0, 1.0)
    };
    let case =
        |name, problem, points, phi| Case { name, problem, friction: Vec::new(), phi, points };
    let body = of(
        "x y z",
        &SPIN,
        "0.6*x^2 + 1.2*y^2 + 1.8*z^2",
        &["x^2/4", "y^2/8", "z^2/12"],
        0.2,
        &[0.45, 0.0, 0.89],
    );
    let species = of(
        "x y z",
        &["x*y 0.5*x*z", "-0.7*y*z"],
        "2*(x - ln(x)) + y - ln(y) + 3*(z - ln(z))",
        &["0.3*ln(y)", "0.4*x"],
        0.0,
        &[0.7, 0.8, 0.9],
    );
    let light = of("x y z", &["-z y", "0"], "x^2/2 + z", &["z"], 0.2, &[1.0, 0.5, 0.8]);
    let particle = of(
        "x y u v",
        &["0 1 0", "0 1", "1.5+0.5*x"],
        "(u^2 + v^2)/2 + (x^2 + y^2)/2",
        &["0.5*x", "0.5*y"],
        0.1,
        &[1.0, 0.0, 0.0, 0.5],
    );
    let star = of(
        "q1 q2 p1 p2",
        &["0 1 0", "0 1", "0"],
        "(p1^2 + p2^2)/2 + (q1^2 + q2^2)/2 + q1^2*q2 - q2^3/3",
        &["0.3*q1 + 0.2*q1^2", "0.3*q2"],
        0.0,
        &[0.5, 0.1, 0.35, 0.1],
    );
    let spins = of(
        "x1 y1 z1 x2 y2 z2",
        &["-z1 y1 0 0 0", "-x1 0 0 0", "0 0 0", "-z2 y2", "-x2"],
        "1.8*(x1*x2 + y1*y2 + z1*z2) - 0.8*z1 + 0.6*x2^2",
        &["0.6*x1", "0.5*z2"],
        0.0,
        &[0.6, 0.0, 0.8, 0.0, 1.0, 0.0],
    );
    let friction = Friction { damping: Arc::new(constant(0.5)), components: vec![2, 3] };
    [
        case("rigid body", body, 512, |y| y[0]),
        case("species", species, 256, |y| y[2]),
        case("light", light, 128, |y| y[2]),
        case("charged particle", particle, 64, |y| y[1] * y[1]),
        Case {
            friction: vec![friction],
            ..case("Hénon–Heiles, friction", star, 64, |y| y[3] * y[3])
        },
        case("two spins", spins, 256, |y| y[4]),
    ]
}

/// `nv` with all of the drift before the noises: of weak order one.
struct InTurn(Nv);

impl Scheme for InTurn {
    fn about(&self) -> About {
        About::new("in turn")
    }

    fn stepper<'a>(&'a self, system: &'a dyn System) -> Result<Box<dyn Stepper + 'a>, SchemeError> {
        let nothing = StepNoise::zero(system.description().noises);
        Ok(Box::new(DriftThenNoises { nv: self.0.stepper(system)?, nothing }))
    }
}

struct DriftThenNoises<'a> {
    nv: Box<dyn Stepper + 'a>,
    nothing: StepNoise,
}

impl Stepper for DriftThenNoises<'_> {
    fn state(&self) -> &[Row] {
        self.nv.state()
    }
    fn state_mut(&mut self) -> &mut [Row] {
        self.nv.state_mut()
    }
    fn step(&mut self, step: &Step, noise: &StepNoise, status: &mut BlockStatus) {
        self.nv.step(step, &self.nothing, status);
        let mut instant = *step;
        (instant.tau, instant.first_decay, instant.second_decay) = (1e-200, 1.0, 1.0);
        self.nv.step(&instant, noise, status);
    }
}

/// 32 paths with steps of equal length on [0, 1].
struct Paths<'a> {
    setup: &'a Setup<'a>,
    paths: Box<dyn Stepper + 'a>,
    steps: Vec<Step>,
}

impl<'a> Paths<'a> {
    fn new(setup: &'a Setup<'a>, steps: u64) -> Self {
        let step = |n| Step::new(setup.problem.damping, n, 1.0 / steps as f64).unwrap();
        let paths = setup.scheme.start(&setup.start());
        Self { setup, paths, steps: (0..steps).map(step).collect() }
    }

    /// The mean of φ at the end, from increments of as many or finer steps; those of each two steps
    /// may be swapped.
    fn mean(&mut self, phi: fn(&[f64]) -> f64, increments: &[Row], swapped: bool) -> f64 {
        let noises = self.setup.problem.noises;
        let each = increments.len() / self.steps.len();
        let (mut noise, mut status) = (StepNoise::zero(noises), BlockStatus::explicit());
        self.paths.state_mut().copy_from_slice(&self.setup.start());
        for (n, step) in self.steps.iter().enumerate() {
            let first = each * if swapped { n ^ 1 } else { n };
            for (m, sum) in noise.increments.iter_mut().enumerate() {
                let rows = increments[first..first + each].iter().skip(m).step_by(noises);
                *sum = [0.0; WIDTH];
                rows.for_each(|row| sum.iter_mut().zip(row).for_each(|(sum, dw)| *sum += dw));
            }
            self.paths.step(step, &noise, &mut status);
            assert!(status.failed.is_empty());
        }
        let state = self.paths.state();
        let at = |p: usize| state.iter().map(|row| row[p]).collect::<Vec<_>>();
        (0..WIDTH).map(|p| phi(&at(p))).sum::<f64>() / WIDTH as f64
    }
}

/// Moments over scrambles of the mean over points of a function of increments.
fn moments(
    Case { problem, points, .. }: &Case,
    (key, steps): (StreamKey, u64),
    mut of: impl FnMut(&[Row]) -> f64,
) -> CrossMoments {
    let mut moments = CrossMoments::new(1);
    let noises = problem.system().description().noises;
    for scramble in 0..SCRAMBLES {
        let wiener = QuasiWiener::new(key, scramble, steps, noises, 1.0).unwrap();
        let mut increments = vec![[0.0; WIDTH]; wiener.dimensions()];
        let blocks = (0..*points).step_by(WIDTH).map(|first| {
            wiener.block(first, &mut increments);
            of(&increments)
        });
        moments.add(&[blocks.sum::<f64>() * WIDTH as f64 / *points as f64]);
    }
    moments
}

fn setup<'a>(case: &'a Case, scheme: &'a dyn Scheme) -> Setup<'a> {
    Setup::at_run_time(&case.problem, scheme).unwrap().with_friction(&case.friction)
}

/// The weak order of the mean over two schemes, whose error has these powers of τ.
fn order(case: &Case, schemes: [&dyn Scheme; 2], powers: Expansion) -> Rate {
    let setups = schemes.map(|scheme| setup(case, scheme));
    let (mut errors, mut variances) = (Vec::new(), Vec::new());
    for steps in STEPS {
        let with = |setup| [steps, 2 * steps].map(|steps| Paths::new(setup, steps));
        let mut paths = setups.each_ref().map(with);
        let at = (StreamKey { seed: 1, experiment: steps }, 2 * steps);
        let found = moments(case, at, |increments| {
            let difference = |(k, [coarse, fine]): (usize, &mut [Paths<'_>; 2])| {
                let fine = fine.mean(case.phi, increments, k == 1);
                0.5 * (coarse.mean(case.phi, increments, false) - fine)
            };
            paths.iter_mut().enumerate().map(difference).sum()
        });
        errors.push(found.mean(0));
        variances.push(found.covariance_of_means(0, 0));
    }
    let taus = STEPS.map(|steps| 1.0 / steps as f64);
    fit_weak(&taus, &errors, &diagonal(&variances), Against::HalfStep, powers).unwrap()
}

/// The interval of an order, which is printed with that of 95 %.
fn interval(name: &str, rate: &Rate) -> (f64, f64) {
    println!("{name:24} {:.3} [{:.3}, {:.3}]", rate.estimate, rate.lo, rate.hi);
    rate.interval(CONFIDENCE)
}

#[test]
fn nv_has_weak_order_two_on_texts() {
    let [forward, backward] = [Sweep::Forward, Sweep::Backward].map(|sweep| Nv { sweep });
    let (in_turn, even, every) =
        (InTurn(Nv::default()), Expansion::EvenPowers, Expansion::EveryPower);
    for case in cases(1.0) {
        let found = order(&case, [&forward, &backward], even);
        let (lo, hi) = interval(case.name, &found);
        assert!(!found.misfits() && lo <= 2.0 && 2.0 <= hi, "{}: {found:?}", case.name);
        assert!(1.5 < lo && hi < 2.5, "{}: {found:?}", case.name);
        let found = order(&case, [&in_turn, &in_turn], every);
        let (_, hi) = interval("  twin", &found);
        assert!(found.misfits() || hi < 2.0, "{}: {found:?}", case.name);
    }
}

/// Two particles on quartic springs with friction and noise of their momenta.
#[test]
fn baoab_has_weak_order_two_on_langevin_dynamics() {
    let definition = texts(
        "q1 q2 p1 p2",
        &["0 1 0", "0 1", "0"],
        "p1^2/2 + p2^2/4 + q1^4/4 + q2^2 + q1*q2/2",
        &["1.1*q1", "0.7*q2"],
    );
    let friction = [(2, 0.9), (3, 0.4)].map(|(component, rate)| Friction {
        damping: Arc::new(constant(rate)),
        components: vec![component],
    });
    let of = friction.clone().map(|one| (one.damping, one.components));
    let baoab = Baoab::new(of);
    let phi = |y: &[f64]| y[0] * y[0] + y[3];
    let problem = || problem(&definition, 0.0, &[0.8, -0.3, 0.2, 0.5], 1.0);
    let case = Case { name: "baoab", problem: problem(), friction: Vec::new(), phi, points: 256 };
    let found = order(&case, [&baoab, &baoab], Expansion::EvenPowers);
    let (lo, hi) = interval(case.name, &found);
    assert!(!found.misfits() && lo <= 2.0 && 2.0 <= hi, "{found:?}");
    assert!(1.5 < lo && hi < 2.5, "{found:?}");
    let in_turn = InTurn(Nv::default());
    let case = Case { friction: friction.to_vec(), ..case };
    let found = order(&case, [&in_turn, &in_turn], Expansion::EveryPower);
    let (_, hi) = interval("  twin", &found);
    assert!(found.misfits() || hi < 2.0, "{found:?}");
}

/// Whether means of `nv`, and of Heun's scheme with noises of another size, are the same. They are
/// extrapolated, on the same noise; an extrapolation is off by less than what it corrects.
fn agree(case: &Case, size: f64) -> bool {
    let other = cases(size).into_iter().find(|other| other.name == case.name).unwrap();
    let nv = Nv::default();
    let [nv, heun] = [setup(case, &nv), setup(&other, &Heun)];
    let mut nv = [8, 16].map(|steps| Paths::new(&nv, steps));
    let mut heun = [32, 64].map(|steps| Paths::new(&heun, steps));
    let mut corrections = [0.0; 2];
    let at = (StreamKey { seed: 1, experiment: 0 }, 64);
    let found = moments(case, at, |increments| {
        let mut mean = |paths: &mut Paths<'_>| paths.mean(case.phi, increments, false);
        let [[a, b], [c, d]] = [nv.each_mut().map(&mut mean), heun.each_mut().map(&mut mean)];
        let [one, other] = [(b - a) / 3.0, d - c];
        corrections[0] += one;
        corrections[1] += other;
        b + one - (d + other)
    });
    let blocks = SCRAMBLES as f64 * case.points as f64 / WIDTH as f64;
    let correction: f64 = corrections.iter().map(|sum| (sum / blocks).abs()).sum();
    found.mean(0).abs() < ERRORS * found.standard_error(0) + correction
}

#[test]
fn nv_has_the_limit_of_heun_on_texts() {
    for case in cases(1.0) {
        let case = Case { points: 64, phi: |y| y[0].cos(), ..case };
        assert!(agree(&case, 1.0), "{}", case.name);
        // The twin: noises that are smaller by a third.
        assert!(!agree(&case, 0.7), "{}", case.name);
    }
}
