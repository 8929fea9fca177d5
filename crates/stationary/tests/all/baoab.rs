//! The exact step of friction and noise.

use std::sync::Arc;

use mc::Setup;
use noise::StepNoise;
use nonlin::BlockStatus;
use real::WIDTH;
use schemes::{Baoab, Split, Step};
use systems::{Constant, Damping, run_time::Problem};

use crate::{problem, texts};

const KT: f64 = 0.8;
const RATE: f64 = 0.7;
const MASS: f64 = 2.0;

/// Langevin dynamics in a potential kq²/2 to 1e-13, which is a kick and no part of an exact flow.
fn oscillator(k: f64, noise: f64) -> Problem {
    let energy = format!("p^2/(2*{MASS}) - {k}*1e12*cos(1e-6*q)");
    let mut definition = texts("q p", &["1"], &energy, &[]);
    let size = noise * (2.0 * RATE * MASS * KT).sqrt();
    definition.noises = vec![format!("{size:?}*q")];
    problem(&definition, &[0.0, 0.0], 1.0)
}

fn friction() -> mc::Friction {
    mc::Friction { damping: Arc::new(Constant::new(RATE).unwrap()), components: vec![1] }
}

/// A step y′ = Ay + bξ with a normal ξ: the columns of A, and b.
fn map(setup: &Setup<'_>, tau: f64) -> [[f64; 2]; 3] {
    let mut paths = setup.scheme.start(&setup.start());
    let still = Constant::new(0.0).unwrap();
    let step = Step::new(&still as &dyn Damping, 0, tau).unwrap();
    let mut noise = StepNoise::zero(1);
    // Paths 0 and 1 begin with units, path 2 has the noise.
    for p in 0..WIDTH {
        (0..2).for_each(|i| paths.state_mut()[i][p] = f64::from(u8::from(i == p)));
    }
    noise.increments[0][2] = tau.sqrt();
    let mut status = BlockStatus::explicit();
    paths.step(&step, &noise, &mut status);
    assert!(status.failed.is_empty());
    [0, 1, 2].map(|p| [0, 1].map(|i| paths.state()[i][p]))
}

/// The stationary covariance ⟨qq⟩, ⟨qp⟩, ⟨pp⟩ of a step: S = Σ Aⁿbbᵀ(Aᵀ)ⁿ, by squaring.
fn covariance([first, second, b]: [[f64; 2]; 3]) -> [f64; 3] {
    let mut a = [[first[0], second[0]], [first[1], second[1]]];
    let mut s = [[b[0] * b[0], b[0] * b[1]], [b[1] * b[0], b[1] * b[1]]];
    let product = |x: [[f64; 2]; 2], y: [[f64; 2]; 2]| {
        [0, 1].map(|i| [0, 1].map(|j| x[i][0] * y[0][j] + x[i][1] * y[1][j]))
    };
    for _ in 0..40 {
        let turned = product(product(a, s), [[a[0][0], a[1][0]], [a[0][1], a[1][1]]]);
        s = [0, 1].map(|i| [0, 1].map(|j| s[i][j] + turned[i][j]));
        a = product(a, a);
    }
    [s[0][0], s[0][1], s[1][1]]
}

/// ⟨q²⟩ = kT/k at every stable step (Leimkuhler and Matthews 2013); ⟨p²⟩ = mkT(1 − (ωτ)²/4).
#[test]
fn positions_of_an_oscillator_are_exact_at_every_stable_step() {
    let (k, baoab) = (3.0, Baoab::new([(friction().damping, friction().components)]));
    let exact = oscillator(k, 1.0);
    let setup = Setup::at_run_time(&exact, &baoab).unwrap();
    let omega = (k / MASS).sqrt();
    for x in [0.05, 0.5, 1.0, 1.9] {
        let [qq, qp, pp] = covariance(map(&setup, x / omega));
        let kinetic = MASS * KT * (1.0 - x * x / 4.0);
        assert!((qq * k / KT - 1.0).abs() < 1e-11, "{x}: {qq}");
        assert!((pp / kinetic - 1.0).abs() < 1e-11 && qp.abs() < 1e-11, "{x}: {pp} {qp}");
    }
    // The twins: noise that is a little too weak, and friction around flows with the noise.
    let weak = oscillator(k, 0.99);
    let weak = Setup::at_run_time(&weak, &baoab).unwrap();
    assert!((covariance(map(&weak, 0.5))[0] * k / KT - 1.0).abs() > 1e-2);
    let around = [friction()];
    let around = Setup::at_run_time(&exact, &Split).unwrap().with_friction(&around);
    assert!((covariance(map(&around, 0.5))[0] * k / KT - 1.0).abs() > 1e-3);
}

/// Without a force the momentum has the law of Ornstein and Uhlenbeck, for weak friction as well.
#[test]
fn a_free_momentum_has_the_exact_law() {
    for rate in [1e-9, 1e-3, 0.5, 20.0] {
        let damping: Arc<dyn Damping> = Arc::new(Constant::new(rate).unwrap());
        let mut definition = texts("q p", &["1"], &format!("p^2/(2*{MASS})"), &[]);
        definition.noises = vec![format!("{:?}*q", (2.0 * rate * MASS * KT).sqrt())];
        let free = problem(&definition, &[0.0, 0.0], 1.0);
        let baoab = Baoab::new([(damping, vec![1])]);
        let setup = Setup::at_run_time(&free, &baoab).unwrap();
        let tau = 0.4;
        let [_, p, b] = map(&setup, tau);
        assert!((p[1] / (-rate * tau).exp() - 1.0).abs() < 1e-14);
        let square = MASS * KT * -(-2.0 * rate * tau).exp_m1();
        // Decays are rounded to 2⁻⁵³, and ∫γ is their logarithm: 1e-16 of 1e-3 · 0.4.
        assert!((b[1] * b[1] / square - 1.0).abs() < 1e-12, "{rate}: {} {square}", b[1] * b[1]);
    }
}

/// The law of a momentum under several frictions with their noises, under damping of all
/// components, and under a friction that nothing else would notice.
#[test]
fn all_that_damps_a_momentum_counts() {
    let constant = |rate: f64| Arc::new(Constant::new(rate).unwrap()) as Arc<dyn Damping>;
    let mut definition = texts("q p", &["1"], &format!("p^2/(2*{MASS})"), &[]);
    // σ² = 2γmkT with the rates 4 and 9, 800 and 900.
    for [a, b] in [[4.0, 9.0], [800.0, 900.0]] {
        let size = |rate: f64| format!("{:?}*q", (2.0 * rate * MASS * KT).sqrt());
        definition.noises = vec![size(a), size(b)];
        let free = problem(&definition, &[0.0, 0.0], 1.0);
        let baoab = Baoab::new([(constant(a), vec![1]), (constant(b), vec![1])]);
        let setup = Setup::at_run_time(&free, &baoab).unwrap();
        let tau = 0.5;
        let mut paths = setup.scheme.start(&setup.start());
        let step = Step::new(&Constant::new(0.0).unwrap(), 0, tau).unwrap();
        let (mut noise, mut status) = (StepNoise::zero(2), BlockStatus::explicit());
        (noise.increments[0][0], noise.increments[1][1]) = (tau.sqrt(), tau.sqrt());
        paths.step(&step, &noise, &mut status);
        let square: f64 = (0..2).map(|p| paths.state()[1][p].powi(2)).sum();
        let exact = MASS * KT * -(-2.0 * (a + b) * tau).exp_m1();
        assert!((square / exact - 1.0).abs() < 1e-12, "{square} {exact}");
    }
    // Damping of all components alone.
    definition.noises = vec![format!("{:?}*q", (2.0 * RATE * MASS * KT).sqrt())];
    let damped = Problem::new(
        Arc::new(crate::system(&definition, &[0.0, 0.0])),
        constant(RATE),
        vec![0.0, 0.0],
        1.0,
    );
    let damped = damped.unwrap();
    let baoab = Baoab::default();
    let setup = Setup::at_run_time(&damped, &baoab).unwrap();
    let mut paths = setup.scheme.start(&setup.start());
    let step = Step::new(damped.damping(), 0, 0.5).unwrap();
    let (mut noise, mut status) = (StepNoise::zero(1), BlockStatus::explicit());
    noise.increments[0][0] = 0.5f64.sqrt();
    paths.step(&step, &noise, &mut status);
    let exact = MASS * KT * -(-2.0 * RATE * 0.5).exp_m1();
    assert!((paths.state()[1][0].powi(2) / exact - 1.0).abs() < 1e-12);
}

#[test]
fn noises_that_do_not_commute_are_refused() {
    let mut definition = texts("x y z", &crate::BODY, crate::ENERGY, &[]);
    definition.noises = vec!["x".into(), "y".into()];
    let body = problem(&definition, &crate::UNIT, 1.0);
    let error = Setup::at_run_time(&body, &Baoab::default()).err().unwrap();
    assert!(error.to_string().contains("do not commute; take nv"), "{error}");
}
