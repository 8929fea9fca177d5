//! Orders on systems whose orders and exact solutions are known, with the false answers of simpler
//! rules as twins.

use std::sync::Arc;

use analysis::{
    Decision, Exact, Limit, Order, Referee, SolverStates, StepSizes, strong_order, weak_order,
};
use mc::{LadderError, Observable, Observe, Setup, TimeChange};
use noise::{StreamKey, Truncation};
use real::Row;
use schemes::{
    EulerMaruyama, Explicit, Heun, Increment, Midpoint, Nv, Sexp, SexpLi, run_time::Scheme,
};
use stats::Point;
use systems::{Cosine, run_time::Problem};

use crate::{SPIN, kubo, problem, system, texts};

/// A spin with linear noises about the third axis and about one that leans by `angle`.
fn leaning(angle: f64) -> Problem {
    let noise = format!("z + {angle}*x");
    let spin = texts("x y z", &SPIN, "(x^2 + y^2/2 + z^2/3)/2", &["z", &noise]);
    problem(&spin, 0.0, &[0.5, 0.6, 0.62], 1.0)
}

fn sizes(coarsest_steps: u64, seed: u64) -> StepSizes {
    let key = StreamKey { seed, experiment: 7 };
    StepSizes::new(coarsest_steps, Truncation::new(4).unwrap(), key)
}

fn strong(scheme: &dyn Scheme, problem: &Problem, sizes: &StepSizes) -> Order {
    let setup = Setup::at_run_time(problem, scheme).unwrap();
    strong_order(&setup, sizes).unwrap()
}

fn weak(scheme: &dyn Scheme, problem: &Problem, phi: &dyn Observe, sizes: &StepSizes) -> Order {
    let setup = Setup::at_run_time(problem, scheme).unwrap();
    weak_order(&setup, phi, sizes, None).unwrap()
}

/// The first component.
fn first() -> Observable<2> {
    Observable { name: "first", function: |y| y[0] }
}

/// Strong orders on four noises.
fn four(scheme: &dyn Scheme, problem: &Problem, coarsest_steps: u64) -> [Order; 4] {
    [1, 2, 3, 4].map(|seed| strong(scheme, problem, &sizes(coarsest_steps, seed)))
}

fn fitted(order: &Order) -> f64 {
    order.rate.as_ref().unwrap().estimate
}

fn covers(order: &Order, exact: f64) -> bool {
    order.rate.as_ref().unwrap().covers(exact)
}

#[test]
#[ignore = "long: run by the gate"]
fn orders_of_schemes_on_a_turning_plane() {
    let problem = kubo(1.0, 1.0);
    let li = SexpLi::at_run_time(problem.system()).unwrap();
    let schemes: [(&dyn Scheme, f64); 5] =
        [(&Sexp, 1.0), (&li, 1.0), (&Midpoint, 1.0), (&Heun, 1.0), (&EulerMaruyama, 0.5)];
    for (scheme, order) in schemes {
        for measured in four(scheme, &problem, 32) {
            assert_eq!(measured.order(), Some(order), "{}: {measured}", scheme.about().id);
            assert!(covers(&measured, order), "{measured}");
            assert!(matches!(measured.limit, Limit::Consistent { .. }), "{measured}");
        }
    }
    // Without noise all paths are the same, so no quantile has finite degrees of freedom.
    let order = strong(&Heun, &kubo(1.0, 0.0), &sizes(8, 1));
    assert_eq!(order.order(), Some(2.0), "{order}");
}

/// Heun's scheme, and Euler–Maruyama from the middle of the time on.
struct LateEuler;

impl Explicit for LateEuler {
    const ID: &'static str = "late Euler";

    #[inline(always)]
    fn advance<H: Increment>(&self, h: H, y: H::Vector) -> H::Vector {
        if h.step().t < 0.5 { Heun.advance(h, y) } else { EulerMaruyama.advance(h, y) }
    }
}

#[test]
#[ignore = "long: run by the gate"]
fn a_small_term_of_low_order_is_found_in_one_step() {
    // At these steps the points fall faster, and a fit alone would say that (the twin): noises
    // about axes that nearly are one; the drift's error of order two hides that of weak noise.
    let cases: [(&dyn Scheme, Problem, u64, f64, f64); 7] = [
        (&Sexp, leaning(0.03), 16, 0.8, 0.5),
        (&Sexp, leaning(1e-3), 8, 0.8, 0.5),
        (&Sexp, kubo(6.0, 0.1), 8, 1.3, 1.0),
        (&Sexp, kubo(6.0, 1e-3), 8, 1.9, 1.0),
        (&Sexp, kubo(6.0, 1e-5), 8, 1.9, 1.0),
        (&EulerMaruyama, kubo(1.0, 0.03), 16, 0.9, 0.5),
        (&LateEuler, kubo(1.0, 0.1), 16, 0.5, 0.5),
    ];
    for (scheme, problem, steps, at_least, order) in cases {
        for measured in four(scheme, &problem, steps) {
            assert!(fitted(&measured) > at_least, "{measured}");
            assert_eq!(measured.order(), Some(order), "{measured}");
            assert!(covers(&measured, order), "{measured}");
        }
    }
    // A weak order: the error of the drift has order two, that of the noise of 3 % order one.
    let many = StepSizes { samples: 4000, ..sizes(16, 1) };
    let order = weak(&Heun, &kubo(6.0, 0.03), &first(), &many);
    assert!(order.to_string().contains("a lower order may have a tenth"), "{order}");
}

/// Euler's scheme with a part of the Itô correction, and damping times a factor.
pub struct Wrong {
    pub correction: f64,
    pub damping: f64,
}

impl Explicit for Wrong {
    const ID: &'static str = "wrong";

    #[inline(always)]
    fn advance<H: Increment>(&self, h: H, y: H::Vector) -> H::Vector {
        let step = h.step();
        let (tau, rate) = (step.tau, step.rate_at_start);
        let undamped = y + (h.field(y) + h.ito_correction(y) * (self.correction * tau));
        undamped - y * (self.damping * rate * tau)
    }
}

fn corrected(correction: f64) -> Wrong {
    Wrong { correction, damping: 1.0 }
}

#[test]
fn convergence_to_something_else_is_no_order() {
    let plane = kubo(1.0, 1.0);
    for measured in four(&corrected(0.0), &plane, 32) {
        assert_eq!(measured.decision, Decision::WrongLimit, "{measured}");
        // The correction is ½ of y.
        let Limit::Inconsistent { defect } = measured.limit else { panic!("{measured}") };
        assert!((0.45..0.55).contains(&defect), "{measured}");
        // The twin: its differences have an order.
        assert!(covers(&measured, 0.5), "{measured}");
    }
    // A hundredth of the correction is missing: at these steps paths tell nothing.
    for (part, decision) in [(0.99, None), (1.0, Some(0.5))] {
        for measured in four(&corrected(part), &plane, 16) {
            assert_eq!(measured.order(), decision, "{measured}");
            let wrong = measured.decision == Decision::WrongLimit;
            assert_eq!(wrong, decision.is_none(), "{measured}");
        }
    }
    // A missing correction, a hundredth of it, and damping that is wrong by a hundredth, where
    // noises do not commute.
    let body = texts("x y z", &SPIN, "x^2/4 + y^2/2 + z^2", &["x^2/2", "y^2/4", "z^2/6"]);
    let body = problem(&body, 0.5, &[0.5, 0.6, 0.62], 1.0);
    let few = StepSizes { samples: 400, ..sizes(32, 5) };
    for (correction, damping) in [(0.0, 1.0), (0.99, 1.0), (1.0, 1.01)] {
        let order = strong(&Wrong { correction, damping }, &body, &few);
        assert_eq!(order.decision, Decision::WrongLimit, "{correction} {damping}: {order}");
        assert!(covers(&order, 0.5), "{order}");
    }
    assert_eq!(strong(&corrected(1.0), &body, &few).order(), Some(0.5));
    // The law is wrong, too.
    let many = StepSizes { samples: 20_000, ..sizes(8, 1) };
    let wrong = weak(&corrected(0.0), &plane, &first(), &many);
    assert_eq!(wrong.decision, Decision::WrongLimit, "{wrong}");
    let right = weak(&Midpoint, &plane, &first(), &many);
    assert!(matches!(right.limit, Limit::Consistent { .. }) && covers(&right, 1.0), "{right}");
}

#[test]
fn a_large_component_hides_no_wrong_limit() {
    // A tenth of the Itô correction is missing, which is round-off of the third component.
    let beside = texts("p q r", &["-1 0", "0"], "(p^2 + q^2)/2", &["(p^2 + q^2)/2"]);
    let of = |size: f64| problem(&beside, 0.0, &[1.0, 0.0, size], 1.0);
    for measured in four(&corrected(0.9), &of(1e12), 16) {
        assert_eq!(measured.order(), None, "{measured}");
        // The twin: the order of its differences is nearest to ½.
        assert!((fitted(&measured) - 0.5).abs() < 0.25, "{measured}");
    }
    for measured in four(&corrected(1.0), &of(1e4), 16) {
        assert_eq!(measured.order(), Some(0.5), "{measured}");
    }
}

/// Heun's scheme with −h for h: the right law where there is noise alone, and the wrong paths.
struct Flipped;

impl Explicit for Flipped {
    const ID: &'static str = "flipped";

    #[inline(always)]
    fn advance<H: Increment>(&self, h: H, y: H::Vector) -> H::Vector {
        let first = h.field(y);
        y - (first + h.field(y - first)) * 0.5
    }
}

#[test]
fn a_law_may_be_right_where_paths_are_wrong() {
    let many = StepSizes { samples: 5000, levels: 4, refinement: 1, ..sizes(2, 1) };
    let of = |omega: f64| weak(&Flipped, &kubo(omega, 1.0), &first(), &many);
    assert!(matches!(of(0.0).limit, Limit::Consistent { .. }), "{}", of(0.0));
    assert_eq!(of(1.0).decision, Decision::WrongLimit, "{}", of(1.0));
    let strong = strong(&Flipped, &kubo(0.0, 1.0), &sizes(16, 1));
    assert_eq!(strong.decision, Decision::WrongLimit, "{strong}");
}

#[test]
fn a_damping_that_the_steps_do_not_resolve_leaves_orders_undecided() {
    // Rates at multiples of 1/256 are all one.
    let plane = texts("p q", &["-1"], "(p^2 + q^2)/2", &["(p^2 + q^2)/2"]);
    let (y0, fast) = ([1.0, 0.0], Cosine::new(1.0, 512.0 * std::f64::consts::PI).unwrap());
    let plane = Arc::new(system(&plane, &y0));
    let problem = Problem::new(plane, Arc::new(fast), y0.into(), 1.0).unwrap();
    let few = StepSizes { levels: 4, refinement: 0, ..sizes(8, 1) };
    let order = strong(&Heun, &problem, &few);
    assert!(order.to_string().starts_with("undecided: the steps resolve the damping"), "{order}");
    // `sexp` reads the integral, and its limit is right, whatever `heun` does.
    let order = strong(&Sexp, &problem, &few);
    assert!(order.decision != Decision::WrongLimit, "{order}");
}

#[test]
fn a_budget_is_spent_until_the_order_is_decided() {
    let problem = kubo(1.0, 1.0);
    let few = StepSizes { samples: 32, levels: 3, refinement: 1, ..sizes(16, 1) };
    let order = strong(&Sexp, &problem, &few.clone().within(50_000_000));
    assert_eq!(order.order(), Some(1.0), "{order}");
    let once = [few.clone().within(1), few].map(|sizes| strong(&Sexp, &problem, &sizes).decision);
    assert_eq!(once[0], once[1]);
    // The mean of q needs many paths where its differences are small.
    let few = StepSizes { samples: 250, levels: 4, refinement: 1, ..sizes(4, 1) };
    let of = |budget: u64| weak(&Midpoint, &problem, &first(), &few.clone().within(budget));
    assert_eq!(of(1).order(), None, "{}", of(1));
    assert_eq!(of(200_000_000).order(), Some(1.0), "{}", of(200_000_000));
    // Too few step sizes are refused.
    let few = StepSizes { levels: 2, refinement: 1, ..sizes(16, 1) };
    let setup = Setup::at_run_time(&problem, &Sexp).unwrap();
    let error = strong_order(&setup, &few).unwrap_err();
    assert!(matches!(error, LadderError::StepSizes { given: 3, from: 4, .. }), "{error}");
}

#[test]
fn a_function_that_a_scheme_keeps_has_no_order() {
    let oscillator = texts("q p", &["1"], "(p^2+q^2)/2", &["0.1*(p^2+q^2)/2"]);
    let oscillator = problem(&oscillator, 0.0, &[1.0, 0.0], 2.0);
    let energy = |y: [f64; 2]| 0.5 * (y[0].powi(2) + y[1].powi(2));
    let phi = Observable { name: "energy", function: energy };
    let few = StepSizes { samples: 400, ..sizes(8, 5) }.within(4_000_000);
    let kept = weak(&Sexp, &oscillator, &phi, &few);
    assert_eq!(kept.decision, Decision::Kept, "{kept}");
    assert!(!kept.to_string().contains("finer"), "{kept}");
    // The twin does not keep it.
    assert_ne!(weak(&Heun, &oscillator, &phi, &few).decision, Decision::Kept);
    // A turn by w dt + s dW is one exact flow; `sexp` turns by another angle.
    let [exact, twin] =
        [strong(&Nv::default(), &oscillator, &few), strong(&Sexp, &oscillator, &few)];
    assert_eq!(exact.decision, Decision::Kept, "{exact}");
    assert_ne!(twin.decision, Decision::Kept, "{twin}");
    assert!(!exact.to_string().contains("undecided"), "{exact}");
}

#[test]
fn a_solution_that_ends_is_said_to_end() {
    // dq/dt = q² from q = 1: q is infinite at t = 1.
    let growth = problem(&texts("q p", &["1"], "q^2*p", &["0.1*q"]), 0.0, &[1.0, 0.5], 5.0);
    for scheme in [&Heun as &dyn Scheme, &Sexp] {
        let order = strong(scheme, &growth, &sizes(64, 5).within(10_000_000));
        let Decision::Undecided { because, .. } = &order.decision else { panic!("{order}") };
        assert!(because.starts_with("32 of 32 paths failed, the first at t = "), "{order}");
        assert!(because.contains("the solution may end"), "{order}");
        // Few paths show it: no budget is spent on steps that fail.
        assert!(order.failed <= 32, "{order}");
    }
}

/// The angle of the plane that is turned by dt + dW, for finest steps of this length.
struct Angle(f64);

impl TimeChange for Angle {
    fn advance(&self, _n: u64, dw: &[Row], _normals: &Row, angle: &mut Row) {
        angle.iter_mut().zip(&dw[0]).for_each(|(angle, dw)| *angle += self.0 + dw);
    }
}

#[test]
fn errors_against_the_exact_solution_need_no_tail() {
    let sizes = StepSizes { samples: 4000, ..sizes(4, 3) };
    let angle = Angle(1.0 / sizes.reference_steps() as f64);
    let exact = Exact::new(&angle, |s: f64| [s.cos(), s.sin()]);
    let problem = kubo(1.0, 1.0);
    let setup = Setup::at_run_time(&problem, &Midpoint).unwrap();
    let order = weak_order(&setup, &first(), &sizes, Some(&exact)).unwrap();
    assert!(matches!(order.limit, Limit::Agrees { .. }), "{order}");
    // The twin: another solution, by far.
    let other = Exact::new(&angle, |s: f64| [s.cos() + 0.6, s.sin()]);
    let twin = weak_order(&setup, &first(), &sizes, Some(&other)).unwrap();
    assert_eq!(twin.decision, Decision::WrongLimit, "{twin}");
    // E cos(1 + W) = e^{−½} cos 1. The midpoint rule turns by 2 atan(a/2) for the increment a of
    // time and noise: its errors have the means E cos(Σ 2 atan(a/2)) less that.
    let truth = (-0.5f64).exp() * 1f64.cos();
    assert_eq!(order.points.len(), 7);
    for (point, steps) in order.points.iter().zip([4.0, 8.0, 16.0, 32.0, 64.0f64]) {
        let Point::Error { tau, value, se, lo, hi, .. } = *point else { panic!("{point:?}") };
        assert_eq!(tau, 1.0 / steps);
        // E e^{iθ} over a step by the trapezoidal rule, which is exact for normals.
        let (mut re, mut im, mut mass) = (0.0, 0.0, 0.0);
        for n in -600..=600 {
            let x = f64::from(n) * 0.01;
            let weight = (-0.5 * x * x).exp();
            let angle = 2.0 * (0.5 * (tau + tau.sqrt() * x)).atan();
            (re, im, mass) = (re + weight * angle.cos(), im + weight * angle.sin(), mass + weight);
        }
        let (size, angle) = ((re / mass).hypot(im / mass), im.atan2(re));
        let error = size.powf(steps) * (steps * angle).cos() - truth;
        assert!((value - error).abs() < 5.0 * se && se < 0.01, "{steps}: {value} {error} {se}");
        let (lo, hi) = (lo.unwrap(), hi.unwrap());
        assert!((value - lo - 1.96 * se).abs() < 1e-12 && (hi - value - 1.96 * se).abs() < 1e-12);
    }
}

/// A measurement of billions of path-steps ends when the end is asked for.
#[test]
fn a_measurement_can_be_stopped() {
    let problem = kubo(1.0, 1.0);
    let many = StepSizes { samples: 1 << 30, ..sizes(1024, 1) };
    let stop = many.stop.clone();
    std::thread::scope(|scope| {
        scope.spawn(move || {
            std::thread::sleep(std::time::Duration::from_millis(100));
            stop.now();
        });
        assert_eq!(strong(&Sexp, &problem, &many).order(), None);
    });
}

/// A solver has the same ∫W dt = Σ τ(W + ½ΔW + H) at every step size, by space-time areas H; and
/// the mean of a reference is extrapolated.
#[test]
fn what_a_referee_gives_and_compares_has_no_error_of_steps() {
    let problem = kubo(1.0, 1.0);
    let sizes = StepSizes { levels: 5, refinement: 1, ..sizes(4, 1) };
    let referee = Referee { setup: Setup::at_run_time(&problem, &Sexp).unwrap(), sizes };
    let taus = [4.0, 8.0, 16.0, 32.0, 64.0].map(|steps| 1.0 / steps);
    let noise = referee.noise(0, 32).unwrap();
    let integral = |level: usize, path: usize| {
        let steps = noise[level].increments.chunks(32).zip(noise[level].space_time.chunks(32));
        let (mut w, mut sum) = (0.0, 0.0);
        for (dw, area) in steps {
            sum += taus[level] * (w + 0.5 * dw[path] + area[path]);
            w += dw[path];
        }
        sum
    };
    for path in 0..32 {
        let exact = integral(0, path);
        for level in 1..5 {
            // Sums of 64 terms of a few units each.
            assert!((integral(level, path) - exact).abs() < 1e-13, "{level} {path}");
        }
    }
    // A solver of order one, and a reference whose error of 0.05 is twice that at twice its steps.
    let all = |y: f64| [y, 0.0].repeat(64);
    let states = SolverStates {
        start: all(1.0),
        levels: taus.map(|tau| all(0.5 + 0.1 * tau)).into(),
        reference: [all(0.55), all(0.6)],
        ..SolverStates::default()
    };
    let found = referee.judge(&[&first()], &states);
    let Limit::Agrees { distance } = found.weak[0].1.limit else { panic!("{}", found.weak[0].1) };
    assert!((distance - 0.1 / 64.0).abs() < 1e-6, "{distance}");
}
