//! The parts of an inspection on systems that are solved by hand.

pub mod by_hand;
mod words;

use std::sync::Mutex;

use real::{Bounded, Degree, Real};
use systems::{
    Constant, Cosine, Damping, Pendulum, Poisson3, RigidBody, SystemError, paper::valid,
};

use super::{
    erased::Function,
    points::{Purpose, Random},
    *,
};

/// A plane that turns with the angle dt, on y₁ > `edge`, with a noise that does nothing.
struct Plane {
    edge: f64,
}

impl PoissonSystem<2, 1> for Plane {
    fn name(&self) -> &'static str {
        "plane"
    }
    fn structure<R: Real>(&self, _y: [R; 2], v: [R; 2]) -> [R; 2] {
        [-v[1], v[0]]
    }
    fn energy<R: Real>(&self, y: [R; 2], dt: f64, _dw: [f64; 1]) -> R {
        (y[0] * y[0] + y[1] * y[1]) * (0.5 * dt)
    }
    fn check_domain(&self, y: [f64; 2]) -> Result<(), SystemError> {
        if y[0] > self.edge {
            Ok(())
        } else {
            Err(SystemError::OutsideDomain { component: 1, value: y[0], domain: "y1 > edge" })
        }
    }
}

const EVERYWHERE: Plane = Plane { edge: f64::NEG_INFINITY };

/// H₀ = y₁⁴ + 2y₂⁴ + 2y₃⁴ and H₁ = −H₀ on so(3).
struct Quartic;

impl PoissonSystem<3, 1> for Quartic {
    fn name(&self) -> &'static str {
        "quartic"
    }
    fn structure<R: Real>(&self, y: [R; 3], v: [R; 3]) -> [R; 3] {
        [y[1] * v[2] - y[2] * v[1], y[2] * v[0] - y[0] * v[2], y[0] * v[1] - y[1] * v[0]]
    }
    fn energy<R: Real>(&self, y: [R; 3], dt: f64, dw: [f64; 1]) -> R {
        (y[0].powi(4) + y[1].powi(4) * 2.0 + y[2].powi(4) * 2.0) * (dt - dw[0])
    }
}

#[test]
fn random_numbers_are_uniform_and_purposes_differ() {
    let mut random = Random::new(Purpose::Points);
    let numbers: Vec<f64> = (0..4000).map(|_| random.uniform()).collect();
    assert!(numbers.iter().all(|x| (-1.0..1.0).contains(x)));
    // Mean 0 ± 1/√(3·4000) and mean square ⅓ ± √(4/45/4000), five of them.
    let mean = |power: i32| numbers.iter().map(|x| x.powi(power)).sum::<f64>() / 4000.0;
    assert!(mean(1).abs() < 5.0 * 0.0092 && (mean(2) - 1.0 / 3.0).abs() < 5.0 * 0.0048);
    assert_ne!(Random::new(Purpose::Around).uniform(), numbers[0]);
}

#[test]
fn points_fill_their_region() {
    let system = Erased::<_, 2, 1>(&EVERYWHERE);
    let of = |region| Points::new(&system, region, None).unwrap();
    let ball = of(Region::Ball(3.0));
    assert_eq!((ball.for_suprema.len(), ball.for_identities.len()), (400, 24));
    assert!(ball.everywhere && ball.pilot.is_none());
    // Shares of 400: a quarter on the circle, the rest uniform in area; five standard deviations
    // are at most 0.125.
    let share = |inside: &dyn Fn(f64) -> bool| {
        ball.for_suprema.iter().filter(|y| inside(norm(y))).count() as f64 / 400.0
    };
    assert_eq!(share(&|r| r <= 3.0 * (1.0 + 1e-15)), 1.0);
    for (found, exact) in [
        (share(&|r| r > 3.0 * (1.0 - 1e-12)), 0.25),
        (share(&|r| r < 1.5), 0.75 * 0.25),
        (share(&|r| r < 2.5), 0.75 * 25.0 / 36.0),
    ] {
        assert!((found - exact).abs() < 0.1, "{found} {exact}");
    }
    let square = of(Region::Box(3.0));
    let corner = |y: &&Vec<f64>| y[0] > 1.5 && y[1] < -1.5;
    let corners = square.for_suprema.iter().filter(corner).count() as f64 / 400.0;
    assert!((corners - 1.0 / 16.0).abs() < 0.06, "{corners}");
    assert!(square.for_suprema.iter().flatten().all(|x| x.abs() <= 3.0));
    assert_eq!(Region::Box(2.0).to_string(), "|yᵢ| ≤ 2");
    assert_eq!(Region::Ball(0.5).to_string(), "‖y‖ ≤ 0.5000");
}

#[test]
fn points_lie_in_the_domain_and_around_the_start() {
    let plane = Plane { edge: 1.0 };
    let system = Erased::<_, 2, 1>(&plane);
    let y0 = [1.001, 2.0];
    let points = Points::new(&system, Region::Ball(4.0), Some(&y0)).unwrap();
    assert!(!points.everywhere && points.for_suprema.iter().all(|y| y[0] > 1.0));
    let pilot = Pilot { paths: 1, states: 1, until: 2.0 };
    let points = points.with_paths(&system, &y0, (pilot, vec![vec![5.0, 5.0]]));
    // The start, four points at smaller and smaller distances, and the path.
    assert_eq!(points.for_identities.len(), 24 + 1 + 4 + 1);
    assert_eq!((&points.for_identities[24][..], points.pilot), (&y0[..], Some(pilot)));
    for (y, distance) in points.for_identities[25..29].iter().zip([1.0, 0.1, 0.01, 1e-3]) {
        let away = (y[0] - y0[0]).hypot(y[1] - y0[1]);
        let length = norm(&y0) * distance * 2f64.sqrt();
        assert!(y[0] > 1.0 && 0.0 < away && away <= length, "{y:?} {away} {length}");
    }
    assert_eq!(points.for_identities[29], [5.0, 5.0]);
    // Nowhere in a small ball about zero.
    let none = Points::new(&system, Region::Ball(0.5), None).err();
    assert_eq!(none, Some(InspectError::NoPoints { found: 0, wanted: 24 }));
}

#[test]
fn pilot_paths_follow_the_midpoint_rule_with_damping() {
    // A step turns by 2 atan(τ/2) and shrinks by exp(−∫γ): 128 steps, of which every 16th is kept.
    let (damping, y0, t_end) = (valid(Cosine::new(0.5, 2.0)), [0.6, 0.8], 3.0f64);
    let problem = valid(Problem::new(EVERYWHERE, damping, y0, t_end));
    let (pilot, states) = pilot_paths(&problem);
    assert_eq!(pilot, Pilot { paths: 4, states: 32, until: 3.0 });
    let turn = 2.0 * (0.5 * t_end / 128.0).atan();
    for (n, y) in states.iter().enumerate() {
        let steps = 16.0 * (n % 8 + 1) as f64;
        let size = (-0.25 * (2.0 * steps * t_end / 128.0).sin()).exp();
        let (sin, cos) = (steps * turn).sin_cos();
        let exact = [size * (0.6 * cos - 0.8 * sin), size * (0.6 * sin + 0.8 * cos)];
        assert!((y[0] - exact[0]).hypot(y[1] - exact[1]) < 1e-12, "{n}: {y:?} {exact:?}");
    }
    // Paths end where they leave the domain: y₁ = 0 after a quarter turn less the start's angle.
    let half = Plane { edge: 0.0 };
    let undamped = valid(Constant::new(0.0));
    let (pilot, states) = pilot_paths(&valid(Problem::new(half, undamped, y0, t_end)));
    let leaves = (0.75f64).atan();
    assert!((0.0..2.0 * t_end / 128.0).contains(&(leaves - pilot.until)), "{pilot:?} {leaves}");
    assert_eq!((pilot.states, states.len()), (4, 4));
}

/// y₂ = W.
struct Walk;

impl PoissonSystem<2, 1> for Walk {
    fn name(&self) -> &'static str {
        "walk"
    }
    fn structure<R: Real>(&self, _y: [R; 2], v: [R; 2]) -> [R; 2] {
        [-v[1], v[0]]
    }
    fn energy<R: Real>(&self, y: [R; 2], _dt: f64, dw: [f64; 1]) -> R {
        y[0] * dw[0]
    }
}

#[test]
fn the_noise_of_pilot_paths_grows_as_the_root_of_time() {
    let walk = |t_end: f64| {
        let undamped = valid(Constant::new(0.0));
        pilot_paths(&valid(Problem::new(Walk, undamped, [0.0; 2], t_end))).1
    };
    let (one, four) = (walk(1.0), walk(4.0));
    for (short, long) in one.iter().zip(&four) {
        assert!((long[1] - 2.0 * short[1]).abs() < 1e-12 && short[0] == 0.0, "{short:?} {long:?}");
    }
    // 32 increments of variance 1/8 between the states kept: their mean square has the standard
    // deviation 1/32.
    let before = |n: usize| if n.is_multiple_of(8) { 0.0 } else { one[n - 1][1] };
    let square = (0..32).map(|n| (one[n][1] - before(n)).powi(2)).sum::<f64>() / 32.0;
    assert!((0.03..0.28).contains(&square), "{square}");
}

/// An integral that records at which times the rate is asked for.
struct Watched(Mutex<Vec<f64>>);

impl Damping for Watched {
    fn rate(&self, t: f64) -> f64 {
        self.0.lock().unwrap().push(t);
        1.0 - 2.0 * t
    }
    fn integral(&self, a: f64, b: f64) -> f64 {
        (b - a) * (1.0 - a - b)
    }
    fn describe(&self) -> String {
        "γ = 1 − 2t".into()
    }
}

#[test]
fn the_integral_of_a_damping_is_looked_at_closely() {
    let watched = Watched(Mutex::new(Vec::new()));
    let found = DampingIntegral::of(&watched, 2.0);
    assert!(found.agrees.holds() && found.rough == 0 && found.relative < 1e-12, "{found:?}");
    // ∫ = t − t²: −2 at the end, which is the least.
    let ends = [found.given, found.expected, found.least];
    assert!(ends.iter().all(|x| (x + 2.0).abs() < 1e-3) && (found.given + 2.0).abs() < 1e-12);
    assert!((found.expected + 2.0).abs() < 1e-12 && found.least <= -2.0);
    assert_eq!((found.longest_step, found.t_end), (Some(2.0), 2.0));
    let mut times = watched.0.into_inner().unwrap();
    times.sort_by(f64::total_cmp);
    let gap = times.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max);
    assert!((0.5..2.0).contains(&(gap / found.resolution)), "{gap} {}", found.resolution);
    assert!(times[0] >= 0.0 && times[times.len() - 1] <= 2.0);
    let text = found.to_string();
    assert!(text.starts_with("rate and integral agree to") && !text.contains("steps of"), "{text}");
    // What is printed of others.
    let shorter = DampingIntegral { longest_step: Some(0.5), ..found };
    let line = "\n           and to 1e-6 for steps of 5.00e-1, and of halves of it";
    assert!(shorter.to_string().ends_with(line), "{shorter}");
    let wrong = DampingIntegral {
        agrees: Status::Refuted,
        defect: 0.25,
        at: 0.5,
        given: 1.0,
        expected: 2.0,
        longest_step: None,
        ..found
    };
    let text = "rate and integral DISAGREE by 2.5e-1 in a step from t = 0.5000 on\n           \
                ∫₀ᵀγ = 1.000000 in 1024 steps, 2.000000 by quadrature";
    let none = "\n           and not to 1e-6 for steps of T/1024";
    assert_eq!(wrong.to_string(), format!("{text}{none}"));
    let rough = DampingIntegral { rough: 1, ..wrong };
    assert_eq!(rough.to_string(), format!("{text}, and the rate jumps or has pulses{none}"));
}

fn bounded(value: f64, error: f64, degree: u32) -> Bounded {
    Bounded { value, error, degree: Degree::of(degree) }
}

#[test]
fn a_finding_keeps_the_largest_defect_beyond_its_bound() {
    let mut finding = Finding::default();
    finding.record(bounded(1e-16, 2e-16, 1), 1.0, &[1.0]);
    assert!(finding.status == Status::Found && finding.at == [1.0] && finding.points == 1);
    // More points than the degree show a polynomial identity; one point is counted once.
    finding.record(bounded(-3e-16, 4e-16, 1), 2.0, &[2.0]);
    finding.record(bounded(0.0, 1e-17, 1), 0.5, &[2.0]);
    assert!(finding.status == Status::Shown && finding.points == 2);
    assert_eq!((finding.defect, finding.round_off, finding.scale), (3e-16, 4e-16, 2.0));
    assert_eq!(finding.at, [2.0]);
    assert_eq!(finding.to_string(), "shown, to 4e-16");
    // A defect refutes, the largest is kept, and what comes later does not take it back.
    for (value, y) in [(-1e-3, 3.0), (5e-3, 4.0), (2e-3, 5.0), (0.0, 6.0)] {
        finding.record(bounded(value, 1e-16, 1), 2.0, &[y]);
    }
    assert!(finding.refuted() && !finding.holds());
    assert_eq!((finding.defect, &finding.at[..], finding.points), (5e-3, &[4.0][..], 6));
    finding.record(bounded(f64::NAN, 0.0, 1), 1.0, &[7.0]);
    assert_eq!((finding.defect, finding.round_off), (5e-3, 1e-16));
    assert_eq!(finding.to_string(), "defect 5.0e-3 at [4.000], round-off 1e-16");
}

#[test]
fn a_finding_with_much_round_off_tells_nothing() {
    let of = |error: f64, scale: f64| {
        let mut finding = Finding::default();
        finding.record(bounded(0.0, error, 5), scale, &[1.0]);
        finding
    };
    // Above 1e-11 of the terms.
    assert_eq!(of(0.9e-11, 1.0).status, Status::Found);
    assert_eq!(of(2.2e-11, 2.0).status, Status::Unknown);
    assert_eq!(of(0.0, 0.0).status, Status::Found);
    assert_eq!(of(0.9e-11, 1.0).to_string(), "found at 1 points, to 9e-12");
    let unknown = of(f64::INFINITY, 1.0);
    assert_eq!((unknown.status, unknown.at.as_slice()), (Status::Unknown, &[1.0][..]));
    assert_eq!(unknown.to_string(), "too much round-off, inf, at [1.000]");
    assert_eq!(Finding::default().to_string(), "shown");
    let mut compared = Finding::default();
    let exact = |x: f64| Bounded::exact(x);
    compared.compare(&[exact(1.0), exact(2.0)], &[exact(1.0), exact(2.5)], &[1.0]);
    assert!(compared.refuted() && compared.defect == 0.5 && compared.scale == 4.5);
}

#[test]
fn minima_on_the_sphere_are_those_by_hand() {
    let minimum = |f: &dyn Function, system: &dyn System| {
        let points = Points::new(system, Region::Box(2.0), None).unwrap();
        Shape::of(f, system, &points)
    };
    // y₁ + y₂ + y₃ has −√3; ½(y₁ + y₂ + y₃)² has zero.
    let poisson = valid(Poisson3::new(1.0));
    let system = Erased::<_, 3, 1>(&poisson);
    let claims = system.invariants();
    let linear = minimum(&*claims[1].1, &system);
    let least = linear.minimum.unwrap();
    assert_eq!((linear.kind, linear.degree), (Kind::Linear, Some(1.0)));
    assert!((least.value + 3f64.sqrt()).abs() <= least.error && least.error < 1e-14, "{least:?}");
    assert!(least.error > 0.0 && least.positive == Status::Refuted && !least.in_domain_only);
    let square = minimum(&*claims[0].1, &system);
    let least = square.minimum.unwrap();
    assert_eq!((square.kind, least.positive), (Kind::Quadratic, Status::Unknown));
    assert!(least.value.abs() <= least.error && least.to_string().starts_with("0 to"));
    // x⁴ + 2y⁴ + 2z⁴ with squares ½, ¼, ¼ has ½, and its negative −2 on the axes.
    let quartic = Erased::<_, 3, 1>(&Quartic);
    let system: &dyn System = &quartic;
    let [h0, h1] = [0, 1].map(|m| minimum(&*system.hamiltonian(m), system));
    assert_eq!((h0.kind, h0.degree, h1.degree), (Kind::Homogeneous, Some(4.0), Some(4.0)));
    let [least, below] = [h0, h1].map(|shape| shape.minimum.unwrap());
    assert!((least.value - 0.5).abs() < 1e-9 && least.positive == Status::Found, "{least:?}");
    assert!((below.value + 2.0).abs() < 1e-9 && below.positive == Status::Refuted, "{below:?}");
    assert_eq!(least.to_string(), "5.0000e-1 > 0 (found by search)");
    assert_eq!(below.to_string(), "-2.0000e0");
    let unclear = Minimum { value: 1e-3, positive: Status::Unknown, in_domain_only: true, ..least };
    assert_eq!(unclear.to_string(), "1.0e-3, sign cannot be told on the domain");
}

#[test]
fn the_contraction_constant_adds_slopes_and_sizes() {
    // L_m = ½·2·gradient + 3·hessian: 0.1 + 0.6 = 0.7 for H₀, 0.3 + 1.2 and 0.5 + 1.8 for noises.
    let found = Solvability {
        region: Region::Ball(1.0),
        points: 1,
        structure: 3.0,
        structure_slope: 2.0,
        gradients: vec![0.1, 0.3, 0.5],
        hessians: vec![0.2, 0.4, 0.6],
    };
    for (k, tau) in [(1, 0.1), (4, 0.01)] {
        let clip = (2.0 * f64::from(k) * tau * f64::ln(1.0 / tau)).sqrt();
        let exact = tau * 0.7 + clip * (1.5 + 2.3);
        assert!((found.contraction(k, tau) / exact - 1.0).abs() < 1e-12, "{k} {tau}");
    }
    // Norms of so(3): ‖B(y)‖ = |y| and the slopes ∂B/∂y_l as one matrix of nine rows have norm √2.
    let body = valid(RigidBody::one_noise([1.0, 2.0, 4.0], 5.0));
    let system = Erased::<_, 3, 1>(&body);
    let points = Points::new(&system, Region::Ball(2.0), None).unwrap();
    let norms = Solvability::of(&system, &points);
    assert!((norms.structure - 2.0).abs() < 1e-12, "{norms:?}");
    assert!((norms.structure_slope - 2f64.sqrt()).abs() < 1e-12, "{norms:?}");
    assert!((norms.hessians[0] - 1.0).abs() < 1e-12 && (norms.hessians[1] - 0.2).abs() < 1e-12);
    // |∇H₀| ≤ 2, nearly attained at 400 points; |∇H₁| is 2/5 at most.
    assert!(norms.gradients[0] <= 2.0 && norms.gradients[0] > 1.8, "{norms:?}");
    assert!(norms.gradients[1] <= 0.4 && norms.gradients[1] > 0.36, "{norms:?}");
}

#[test]
fn a_report_says_why_a_statement_does_not_apply() {
    let pendulum = inspect(&valid(Pendulum::new(0.7))).unwrap();
    let because = |report: &Inspection, statement: &str| {
        let theorem = report.theorems.iter().find(|theorem| theorem.statement == statement);
        theorem.unwrap().because.clone()
    };
    assert_eq!(because(&pendulum, "energy-balance"), "H₀ is not homogeneous");
    assert!(
        because(&pendulum, "exact-conformal").starts_with("no linear or quadratic Casimir, and")
    );
    assert_eq!(because(&pendulum, "conformal-casimir"), "no linear or quadratic Casimir of B");
    assert!(because(&pendulum, "strong-one").starts_with("if all paths stay bounded"));
    let text = pendulum.to_string();
    for words in [
        "pendulum: D = 2, M = 1; 24 points with |yᵢ| ≤ 2\n",
        "H1       c H0 up to a constant, c = 0.",
        "Casimirs of B, linear or quadratic, coefficients to six digits: none (shown)",
        "no             energy-balance: sexp keeps the energy",
        "  1 / 1: sexp, sexp-levy, sexp-li, sexp-li-levy, split, midpoint, heun\n",
        "\n  1 / 2: nv\n  0.5 / 1: em\n",
        "sexp-li applies: B is constant in y, every step has a solution\n",
        "  sexp-li, sexp-li-levy: exact damping; explicit, since B is constant: the energy drifts\n",
        "Take sexp for paths: it damps exactly, and keeps the energy but for the noise\n",
        "No mistakes found.",
    ] {
        assert!(text.contains(words), "{words}: {text}");
    }
    let body = inspect(&valid(RigidBody::three_noises([2.0, 1.0, 0.5], [1.0, 2.0, 3.0]))).unwrap();
    let none = "there is not one noise with H₁ = c H₀";
    assert_eq!(because(&body, "energy-balance"), none);
    let text = body.to_string();
    for words in [
        "  0.5 / 1: sexp, sexp-li, split, midpoint, heun, em\n  1 / 1: sexp-levy, sexp-li-levy\n",
        "\n  0.5 / 2: nv\n",
        "do not commute: strong order 1 needs Lévy areas",
        "Take sexp-levy for paths: it keeps the Casimirs",
        "Take sexp-li for expectations: mc::expect extrapolates weak order 1;",
        "0.5 y1² + 0.5 y2² + 0.5 y3²; degree 2, m = 5.0000e-1 > 0 (shown); B∇C = 0 shown",
    ] {
        assert!(text.contains(words), "{words}: {text}");
    }
}

#[test]
fn a_problem_is_looked_at_in_twice_the_ball_of_its_start() {
    let region = |y0: [f64; 2]| {
        let problem = Problem::new(EVERYWHERE, valid(Constant::new(1.0)), y0, 1.0).unwrap();
        let report = inspect_problem(&problem).unwrap();
        assert_eq!(report.pilot, Some(Pilot { paths: 4, states: 32, until: 1.0 }));
        let text = report.to_string();
        assert!(text.contains("\n  and 32 states of 4 paths, followed to t = 1\n"), "{text}");
        (report.region, report.problem.unwrap().radius)
    };
    // |y|²/2 is no Casimir of the plane, and H₁ = 0 is no multiple of H₀ other than zero.
    let (ball, radius) = region([3.0, 4.0]);
    assert_eq!(ball, Region::Ball(10.0));
    assert!(radius.is_none_or(|radius| (radius - 5.0).abs() < 1e-6), "{radius:?}");
    assert_eq!(region([0.0, 0.0]).0, Region::Ball(2.0));
}

/// B constant with the kernel (1, −2, 0), and H₁ = H₀ + y₁ − 2y₂.
struct Kernel;

impl PoissonSystem<3, 1> for Kernel {
    fn name(&self) -> &'static str {
        "kernel"
    }
    fn structure<R: Real>(&self, _y: [R; 3], v: [R; 3]) -> [R; 3] {
        [v[2] * 2.0, v[2], -(v[0] * 2.0) - v[1]]
    }
    fn energy<R: Real>(&self, y: [R; 3], dt: f64, dw: [f64; 1]) -> R {
        let h = (y[0] * y[0] + y[1] * y[1] + y[2] * y[2] * 4.0) * 0.5;
        h * (dt + dw[0]) + (y[0] - y[1] * 2.0) * dw[0]
    }
}

/// so(2, 1), with the Casimir ½(y₁² + y₂² − y₃²), and B in front of which a sine stands.
struct Hyperbolic {
    sine: bool,
}

impl PoissonSystem<3, 1> for Hyperbolic {
    fn name(&self) -> &'static str {
        "hyperbolic"
    }
    fn structure<R: Real>(&self, y: [R; 3], v: [R; 3]) -> [R; 3] {
        let z = -y[2];
        let cross = [y[1] * v[2] - z * v[1], z * v[0] - y[0] * v[2], y[0] * v[1] - y[1] * v[0]];
        let factor = if self.sine { y[0].sin() + 2.0 } else { R::constant(1.0) };
        cross.map(|x| x * factor)
    }
    fn energy<R: Real>(&self, y: [R; 3], dt: f64, dw: [f64; 1]) -> R {
        y[0] * y[1] * (dt + dw[0])
    }
}

#[test]
fn casimirs_are_written_with_their_signs() {
    let report = inspect(&Kernel).unwrap();
    let formulas: Vec<_> = report.casimirs.found.iter().map(|c| c.formula.as_str()).collect();
    assert_eq!(formulas, ["y1 − 2 y2", "0.5 y1² + 2 y2² − 2 y1 y2"]);
    let [line, square] = &report.casimirs.found[..] else { panic!("{report}") };
    assert_eq!((line.degree, square.degree), (1, 2));
    assert_eq!(
        (line.form().value(&[3.0, 1.0, 7.0]), square.form().value(&[3.0, 0.0, 7.0])),
        (1.0, 4.5)
    );
    // A minimum of −√5 at (−1, 2, 0)/√5, and zero beside it.
    let least = line.minimum;
    assert!((least.value + 5f64.sqrt()).abs() < 1e-6 && least.positive == Status::Refuted);
    assert!(square.minimum.value.abs() < 1e-12 && report.casimirs.definite.is_none());
    assert!(report.bound.is_none() && report.casimirs.complete == Status::Shown, "{report}");
    // H₁ is not a multiple of H₀, though the flows are the same.
    assert_eq!(report.hamiltonians.noise_size, None);
    assert!(report.structure.constant.holds() && report.noise.commute.holds());
}

#[test]
fn an_indefinite_casimir_bounds_nothing_and_what_is_found_is_not_shown() {
    let report = inspect(&Hyperbolic { sine: false }).unwrap();
    let [casimir] = &report.casimirs.found[..] else { panic!("{report}") };
    assert_eq!(casimir.formula, "0.5 y1² + 0.5 y2² − 0.5 y3²");
    assert!((casimir.minimum.value + 0.5).abs() < 1e-14, "{report}");
    assert_eq!(casimir.minimum.positive, Status::Refuted);
    assert_eq!(report.applies("moment-bound"), Some(Applies::No));
    assert_eq!(report.applies("conformal-casimir"), Some(Applies::Yes));
    assert!(report.to_string().contains("m = -5.0000e-1; B∇C = 0 shown"), "{report}");
    // H₁ = H₀ with H₀ = y₁y₂ of degree two, whose average at the midpoint is exact.
    assert_eq!(report.applies("energy-balance"), Some(Applies::Yes));
    // With a sine in B an identity at the points is no proof.
    let report = inspect(&Hyperbolic { sine: true }).unwrap();
    assert_eq!(report.structure.skew.status, Status::Found, "{report}");
    assert_eq!(report.casimirs.found[0].formula, casimir.formula);
    let of = |statement: &str| report.theorems.iter().find(|t| t.statement == statement).unwrap();
    assert_eq!(of("conformal-casimir").applies, Applies::Conditionally);
    let words = "0.5 y1² + 0.5 y2² − 0.5 y3² (found by search)";
    assert_eq!(of("conformal-casimir").because, words);
    assert_eq!(report.orders[0].known, Status::Shown);
}
