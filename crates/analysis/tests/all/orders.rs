//! Orders on systems whose orders and exact solutions are known, with the false answers of simpler
//! rules as twins.

use analysis::{Decision, Limit, Order, ReferenceSolution, StepSizes, strong_order, weak_order};
use mc::{Ladder, LadderError, Observable, Reference, Run, Setup, StrongErrors, bind};
use noise::{StreamKey, Truncation};
use real::Real;
use schemes::{EulerMaruyama, Explicit, Heun, Increment, Midpoint, Scheme, Sexp};
use stats::{Point, root_mean_squares};
use systems::{Constant, Cosine, PoissonSystem, Problem};

/// Kubo's oscillator: the plane turns by ω dt + σ dW.
pub struct Kubo {
    omega: f64,
    sigma: f64,
}

impl PoissonSystem<2, 1> for Kubo {
    fn name(&self) -> &'static str {
        "kubo"
    }
    fn structure<R: Real>(&self, _: [R; 2], v: [R; 2]) -> [R; 2] {
        [-v[1], v[0]]
    }
    fn energy<R: Real>(&self, y: [R; 2], dt: f64, dw: [f64; 1]) -> R {
        (y[0] * y[0] + y[1] * y[1]) * (0.5 * (self.omega * dt + self.sigma * dw[0]))
    }
}

/// A rigid body with linear noises about the third axis and about one that leans by `angle`.
struct Leaning {
    angle: f64,
}

impl PoissonSystem<3, 2> for Leaning {
    fn name(&self) -> &'static str {
        "leaning noise"
    }
    fn structure<R: Real>(&self, y: [R; 3], v: [R; 3]) -> [R; 3] {
        [y[1] * v[2] - y[2] * v[1], y[2] * v[0] - y[0] * v[2], y[0] * v[1] - y[1] * v[0]]
    }
    fn energy<R: Real>(&self, y: [R; 3], dt: f64, dw: [f64; 2]) -> R {
        (y[0] * y[0] + y[1] * y[1] * 0.5 + y[2] * y[2] * (1.0 / 3.0)) * (0.5 * dt)
            + y[2] * (dw[0] + dw[1])
            + y[0] * (self.angle * dw[1])
    }
}

pub fn kubo(omega: f64, sigma: f64) -> Problem<Kubo, Constant, 2> {
    Problem::new(Kubo { omega, sigma }, Constant::new(0.0).unwrap(), [1.0, 0.0], 1.0).unwrap()
}

fn leaning(angle: f64) -> Problem<Leaning, Constant, 3> {
    let y0 = [0.5, 0.6, 0.62];
    Problem::new(Leaning { angle }, Constant::new(0.0).unwrap(), y0, 1.0).unwrap()
}

fn sizes(coarsest_steps: u64, seed: u64) -> StepSizes {
    let key = StreamKey { seed, experiment: 7 };
    StepSizes::new(coarsest_steps, Truncation::new(4).unwrap(), key)
}

fn strong<S: PoissonSystem<D, M>, const D: usize, const M: usize>(
    scheme: &dyn Scheme<S, D, M>,
    problem: &Problem<S, Constant, D>,
    coarsest_steps: u64,
) -> [Order; 4] {
    [1, 2, 3, 4].map(|seed| {
        strong_order(
            &Setup::of(problem, scheme),
            &sizes(coarsest_steps, seed),
            &ReferenceSolution::independent(problem),
        )
        .unwrap()
    })
}

fn fitted(order: &Order) -> f64 {
    order.rate.as_ref().unwrap().estimate
}

#[test]
fn orders_of_schemes_on_a_turning_plane() {
    let problem = kubo(1.0, 1.0);
    let schemes: [(&dyn Scheme<Kubo, 2, 1>, f64); 4] =
        [(&Sexp, 1.0), (&Midpoint, 1.0), (&Heun, 1.0), (&EulerMaruyama, 0.5)];
    for (scheme, order) in schemes {
        for measured in strong(scheme, &problem, 32) {
            assert_eq!(measured.order(), Some(order), "{}: {measured}", scheme.id());
            assert!(measured.rate.as_ref().unwrap().covers(order), "{measured}");
            assert!(matches!(measured.limit, Limit::Consistent { .. }), "{measured}");
        }
    }
}

#[test]
fn a_small_term_of_low_order_is_found_in_one_step() {
    // The noises nearly commute: at these steps the points fall as for order one or so, and a fit
    // alone would say that (the twin).
    for measured in strong(&Sexp, &leaning(0.03), 16) {
        assert!(fitted(&measured) > 0.8, "{measured}");
        assert_eq!(measured.order(), Some(0.5), "{measured}");
        assert!(measured.rate.as_ref().unwrap().covers(0.5));
    }
    // Noises about axes that are 1e-3 apart.
    for measured in strong(&Sexp, &leaning(1e-3), 8) {
        assert_eq!(measured.order(), Some(0.5), "{measured}");
    }
}

#[test]
fn weak_noise_is_found_in_one_step() {
    // The drift's error of order two hides that of the noise.
    for (sigma, points) in [(0.1, 1.3), (1e-3, 1.9), (1e-5, 1.9)] {
        for measured in strong(&Sexp, &kubo(6.0, sigma), 8) {
            assert!(fitted(&measured) > points, "{measured}");
            assert_eq!(measured.order(), Some(1.0), "{measured}");
        }
    }
    for measured in strong(&EulerMaruyama, &kubo(1.0, 0.03), 16) {
        assert!(fitted(&measured) > 0.9, "{measured}");
        assert_eq!(measured.order(), Some(0.5), "{measured}");
    }
}

/// Euler's scheme with this part of the Itô correction.
struct Corrected(f64);

impl Explicit for Corrected {
    const ID: &'static str = "corrected";

    #[inline(always)]
    fn advance<H: Increment>(&self, h: H, y: H::Vector) -> H::Vector {
        y + (h.field(y) + h.ito_correction(y) * (self.0 * h.step().tau))
    }
}

#[test]
fn convergence_to_something_else_is_no_order() {
    let problem = kubo(1.0, 1.0);
    for measured in strong(&Corrected(0.0), &problem, 32) {
        assert_eq!(measured.decision, Decision::WrongLimit, "{measured}");
        // |y| grows by e^{σ²T/2}: the distance is of size one half.
        let Limit::Differs { distance, .. } = measured.limit else { panic!("{measured}") };
        assert!((0.3..1.5).contains(&distance), "{measured}");
        // The twin: its differences have an order.
        assert!(measured.rate.as_ref().unwrap().covers(0.5), "{measured}");
    }
    let q = Observable { name: "q", function: |y: [f64; 2]| y[0] };
    let many = StepSizes { samples: 20_000, ..sizes(8, 1) };
    let independent = ReferenceSolution::independent(&problem);
    let wrong = weak_order(&Setup::of(&problem, &Corrected(0.0)), &q, &many, &independent).unwrap();
    assert_eq!(wrong.decision, Decision::WrongLimit, "{wrong}");
    let right = weak_order(&Setup::of(&problem, &Midpoint), &q, &many, &independent).unwrap();
    assert!(matches!(right.limit, Limit::Consistent { .. }), "{right}");
    assert!(right.rate.as_ref().unwrap().covers(1.0), "{right}");
}

#[test]
fn a_limit_inside_the_errors_is_seen_in_single_steps() {
    // A hundredth of the Itô correction is missing: at these steps paths tell nothing.
    let problem = kubo(1.0, 1.0);
    for measured in strong(&Corrected(0.99), &problem, 16) {
        assert_eq!(measured.decision, Decision::WrongLimit, "{measured}");
    }
    for measured in strong(&Corrected(1.0), &problem, 16) {
        assert_eq!(measured.order(), Some(0.5), "{measured}");
    }
}

/// Kubo's oscillator beside a component that does not move.
struct Beside;

impl PoissonSystem<3, 1> for Beside {
    fn name(&self) -> &'static str {
        "kubo beside a constant"
    }
    fn structure<R: Real>(&self, _: [R; 3], v: [R; 3]) -> [R; 3] {
        [-v[1], v[0], R::zero()]
    }
    fn energy<R: Real>(&self, y: [R; 3], dt: f64, dw: [f64; 1]) -> R {
        (y[0] * y[0] + y[1] * y[1]) * (0.5 * (dt + dw[0]))
    }
}

#[test]
fn a_large_component_hides_no_wrong_limit() {
    // A tenth of the Itô correction is missing, which is round-off of the third component.
    let problem = |size: f64| {
        Problem::new(Beside, Constant::new(0.0).unwrap(), [1.0, 0.0, size], 1.0).unwrap()
    };
    for measured in strong(&Corrected(0.9), &problem(1e12), 16) {
        assert_eq!(measured.order(), None, "{measured}");
        // The twin: the order of its differences is nearest to ½.
        assert!((fitted(&measured) - 0.5).abs() < 0.25, "{measured}");
    }
    for measured in strong(&Corrected(1.0), &problem(1e4), 16) {
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
    let q = Observable { name: "q", function: |y: [f64; 2]| y[0] };
    let many = StepSizes { samples: 5000, levels: 4, refinement: 1, ..sizes(2, 1) };
    let weak = |omega: f64| {
        let problem = kubo(omega, 1.0);
        let independent = ReferenceSolution::independent(&problem);
        weak_order(&Setup::of(&problem, &Flipped), &q, &many, &independent).unwrap()
    };
    assert!(matches!(weak(0.0).limit, Limit::Consistent { .. }), "{}", weak(0.0));
    assert_eq!(weak(1.0).decision, Decision::WrongLimit, "{}", weak(1.0));
    let strong = strong_order(
        &Setup::of(&kubo(0.0, 1.0), &Flipped),
        &sizes(16, 1),
        &ReferenceSolution::independent(&kubo(0.0, 1.0)),
    )
    .unwrap();
    assert_eq!(strong.decision, Decision::WrongLimit, "{strong}");
}

#[test]
fn a_weak_term_of_low_order_is_found_in_one_step() {
    // The error of the drift has order two, that of the noise of 3 % order one.
    let q = Observable { name: "q", function: |y: [f64; 2]| y[0] };
    let many = StepSizes { samples: 4000, ..sizes(16, 1) };
    let weak = |sigma: f64| {
        let problem = kubo(6.0, sigma);
        let independent = ReferenceSolution::independent(&problem);
        weak_order(&Setup::of(&problem, &Heun), &q, &many, &independent).unwrap()
    };
    let order = weak(0.03);
    assert!(matches!(order.decision, Decision::Hidden { share } if share < 0.1), "{order}");
    assert!(order.rate.as_ref().unwrap().covers(2.0), "{order}");
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
fn a_low_order_at_late_times_is_found() {
    for measured in strong(&LateEuler, &kubo(1.0, 0.1), 16) {
        assert_eq!(measured.order(), Some(0.5), "{measured}");
    }
}

#[test]
fn a_damping_that_the_steps_do_not_resolve_leaves_orders_undecided() {
    // Rates at multiples of 1/256 are all one.
    let system = Kubo { omega: 1.0, sigma: 1.0 };
    let fast = Cosine::new(1.0, 512.0 * std::f64::consts::PI).unwrap();
    let problem = Problem::new(system, fast, [1.0, 0.0], 1.0).unwrap();
    let few = StepSizes { levels: 4, refinement: 0, ..sizes(8, 1) };
    let order =
        strong_order(&Setup::of(&problem, &Heun), &few, &ReferenceSolution::independent(&problem))
            .unwrap();
    assert!(matches!(order.decision, Decision::Damping { .. }), "{order}");
    // `sexp` reads the integral, and its limit is right, whatever `heun` does.
    let order =
        strong_order(&Setup::of(&problem, &Sexp), &few, &ReferenceSolution::independent(&problem))
            .unwrap();
    assert!(order.decision != Decision::WrongLimit, "{order}");
}

/// The root-mean-square error of Euler–Maruyama on the plane turned by dt + σ dW on [0, 1]. A step
/// multiplies the state, as a complex number, by 1 − s + ia with s = σ²τ/2 and a normal of mean τ
/// and variance v = σ²τ, where the solution turns by e^{ia}; steps are independent.
fn exact_error(sigma: f64, steps: u64) -> f64 {
    let (tau, n) = (1.0 / steps as f64, steps as f64);
    let v = sigma * sigma * tau;
    let square = ((1.0 - 0.5 * v).powi(2) + tau * tau + v).powf(n);
    // E[(1 − s + ia)e^{−ia}] = (1 + v/2 + iτ) e^{−iτ − v/2}, as modulus and angle.
    let (modulus, angle) = ((1.0 + 0.5 * v).hypot(tau), (tau / (1.0 + 0.5 * v)).atan() - tau);
    let product = (n * (modulus.ln() - 0.5 * v)).exp() * (n * angle).cos();
    (square + 1.0 - 2.0 * product).sqrt()
}

#[test]
fn errors_are_errors_against_the_limit() {
    // 95 % intervals at the finest of the points in 100 measurements: more than 14 misses have
    // probability 1e-4. The twin takes the finest run for the limit.
    let (problem, scheme) = (kubo(1.0, 1.0), EulerMaruyama);
    let (mut missed, mut twin_missed) = (0, 0);
    for seed in 0..100 {
        let sizes = StepSizes { levels: 4, refinement: 1, samples: 1000, ..sizes(8, seed) };
        let covers = |points: &[Point]| points[3].covers(exact_error(1.0, 64));
        let order = strong_order(
            &Setup::of(&problem, &scheme),
            &sizes,
            &ReferenceSolution::independent(&problem),
        )
        .unwrap();
        missed += usize::from(!covers(&order.points));
        let runs = (0..5).map(|index| Run::new(bind(&problem, &scheme as _), 4 - index)).collect();
        let ladder =
            Ladder::new(&mc::Problem::of(&problem), 128, 4, sizes.truncation, sizes.key, runs)
                .unwrap();
        let series = [vec![0, 1, 2, 3]];
        let none = || StrongErrors::new(Reference::Run(4), &series, ladder.coarse_steps());
        let errors = ladder.run(1000, none, &|_| ()).statistic;
        let taus = [1.0, 0.5, 0.25, 0.125].map(|tau| tau / 8.0);
        twin_missed += usize::from(!covers(&root_mean_squares(&taus, &errors.at_end(0).errors)));
    }
    assert!(missed <= 14, "{missed} of 100");
    assert!(twin_missed > 50, "{twin_missed} of 100");
}

#[test]
fn a_problem_without_noise_has_an_order() {
    // All paths are the same, so no quantile has a finite number of degrees of freedom.
    let order = strong_order(
        &Setup::of(&kubo(1.0, 0.0), &Heun),
        &sizes(8, 1),
        &ReferenceSolution::independent(&kubo(1.0, 0.0)),
    )
    .unwrap();
    assert_eq!(order.order(), Some(2.0), "{order}");
}

#[test]
fn intervals_of_points_hold_where_the_order_does_not_show() {
    // Noise of 3 %: order ½ by one step, while the error of the drift dominates the points.
    let (problem, scheme) = (kubo(1.0, 0.03), EulerMaruyama);
    let missed = (0..40).filter(|&seed| {
        let sizes = StepSizes { levels: 4, refinement: 1, samples: 400, ..sizes(8, seed) };
        let order = strong_order(
            &Setup::of(&problem, &scheme),
            &sizes,
            &ReferenceSolution::independent(&problem),
        )
        .unwrap();
        !order.points[3].covers(exact_error(0.03, 64))
    });
    // 2 of 40 expected at most; more than 8 have probability 2e-4.
    let missed = missed.count();
    assert!(missed <= 8, "{missed} of 40");
}

#[test]
fn a_budget_is_spent_until_the_order_is_decided() {
    let problem = kubo(1.0, 1.0);
    let few = StepSizes { samples: 32, levels: 3, refinement: 1, ..sizes(16, 1) };
    let scheme = Sexp;
    let order = strong_order(
        &Setup::of(&problem, &scheme),
        &few.within(50_000_000),
        &ReferenceSolution::independent(&problem),
    )
    .unwrap();
    assert_eq!(order.order(), Some(1.0), "{order}");
    let once = strong_order(
        &Setup::of(&problem, &scheme),
        &few.within(1),
        &ReferenceSolution::independent(&problem),
    )
    .unwrap();
    let same = strong_order(
        &Setup::of(&problem, &scheme),
        &few,
        &ReferenceSolution::independent(&problem),
    )
    .unwrap();
    assert_eq!(once.decision, same.decision);
    // The mean of q needs many paths where its differences are small.
    let q = Observable { name: "q", function: |y: [f64; 2]| y[0] };
    let few = StepSizes { samples: 250, levels: 4, refinement: 1, ..sizes(4, 1) };
    let of = |budget: u64| {
        let independent = ReferenceSolution::independent(&problem);
        let scheme = Midpoint;
        weak_order(&Setup::of(&problem, &scheme), &q, &few.within(budget), &independent).unwrap()
    };
    assert_eq!(of(1).order(), None, "{}", of(1));
    assert_eq!(of(200_000_000).order(), Some(1.0), "{}", of(200_000_000));
}

#[test]
fn too_few_step_sizes_are_refused() {
    let few = StepSizes { levels: 2, refinement: 1, ..sizes(16, 1) };
    let error = strong_order(
        &Setup::of(&kubo(1.0, 1.0), &Sexp),
        &few,
        &ReferenceSolution::independent(&kubo(1.0, 1.0)),
    )
    .unwrap_err();
    assert!(matches!(error, LadderError::StepSizes { given: 3, from: 4, .. }), "{error}");
}

#[test]
fn weak_points_are_the_errors_of_the_scheme() {
    // Without noise: Heun's errors of q against cos 1, of order two. The twin forgets what the
    // finest step leaves, a fifth of the last error.
    let problem = kubo(1.0, 0.0);
    let q = Observable { name: "q", function: |y: [f64; 2]| y[0] };
    let sizes = StepSizes { samples: 32, ..sizes(8, 1) };
    let order = weak_order(
        &Setup::of(&problem, &Heun),
        &q,
        &sizes,
        &ReferenceSolution::independent(&problem),
    )
    .unwrap();
    assert_eq!(order.points.len(), 5);
    for (point, steps) in order.points.iter().zip([8, 16, 32, 64, 128]) {
        let Point::Error { tau, value, .. } = *point else { panic!("{point:?}") };
        let path =
            mc::trajectory(&Setup::of(&problem, &Heun), steps, sizes.truncation, sizes.key, 0)
                .unwrap();
        let error = path.states[steps as usize][0] - 1f64.cos();
        assert_eq!(tau, 1.0 / steps as f64);
        assert!((value / error - 1.0).abs() < 0.05, "{steps}: {value} {error}");
    }
}
