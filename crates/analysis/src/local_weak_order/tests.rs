//! Local orders of schemes that have them, and of twins that have not.

use formula::{Definition, FormulaSystem};
use mc::{Setup, bind};
use noise::{BlockNoise, Noise};
use nonlin::{BlockStatus, Outcome, Solution};
use real::{Block, Real, WIDTH};
use schemes::{
    EulerMaruyama, Heun, Midpoint, Nv, Scheme, Sexp, SexpLevy, SexpLi, Split, Step, Sweep,
};
use systems::{
    Constant, IntegerExponents, LotkaVolterra, MaxwellBloch, Poisson3, PoissonSystem, Problem,
    RigidBody, paper, run_time,
};

use super::*;

/// The order of compiled schemes.
fn local_weak_order<S: PoissonSystem<D, M>, G: Damping, const D: usize, const M: usize>(
    schemes: &[&dyn Scheme<S, D, M>],
    problem: &Problem<S, G, D>,
) -> Result<LocalWeakOrder, LocalWeakOrderError> {
    let schemes: Vec<_> = schemes.iter().map(|scheme| bind(problem, *scheme)).collect();
    super::local_weak_order(&mc::Problem::of(problem), &schemes)
}

type Body = RigidBody<3>;

fn body() -> Problem<Body, Constant, 3> {
    let body = paper::valid(RigidBody::three_noises(paper::INERTIA, paper::NOISE_INERTIA));
    let damping = paper::valid(Constant::new(0.2));
    paper::valid(Problem::new(body, damping, paper::rigid_body_start(), 1.0))
}

#[track_caller]
fn assert_order(found: Result<LocalWeakOrder, LocalWeakOrderError>, order: f64) {
    let found = found.unwrap_or_else(|error| panic!("{error}"));
    assert!((found.order - order).abs() < 0.05, "{found}: {:?}", slope::slopes(&found.errors));
}

#[test]
fn schemes_on_the_rigid_body_have_local_order_two() {
    let problem = body();
    let linear = SexpLi::new(problem.system(), problem.y0()).unwrap();
    let all: [&dyn Scheme<Body, 3, 3>; 6] =
        [&Sexp, &linear, &Split, &Heun, &EulerMaruyama, &Midpoint];
    for scheme in all {
        assert_order(local_weak_order(&[scheme], &problem), 2.0);
    }
}

/// Rotations about the axes in a symmetric order or in both orders, with halves of the damping, and
/// what can be wrong with them.
#[derive(Clone, Copy, Default)]
struct Rotations {
    backwards: bool,
    /// Rotations by Cayley's map with half of the angle instead of its tangent.
    cayley: bool,
    /// P1(½)P2(½)P3(1)P2(½)P1(½), with the same increments in both halves.
    symmetric: bool,
    /// The whole damping before everything else.
    damped_first: bool,
}

impl Rotations {
    fn rotated(cayley: bool, axis: usize, y: [f64; 3], k: f64) -> [f64; 3] {
        let (j, l, angle) = ((axis + 1) % 3, (axis + 2) % 3, k * y[axis]);
        let (sin, cos) = match cayley {
            false => angle.sin_cos(),
            true => {
                let (half, size) = (0.5 * angle, 1.0 + 0.25 * angle * angle);
                (2.0 * half / size, (1.0 - half * half) / size)
            }
        };
        let mut z = y;
        (z[j], z[l]) = (cos * y[j] + sin * y[l], cos * y[l] - sin * y[j]);
        z
    }

    fn drift(y: [f64; 3], tau: f64) -> [f64; 3] {
        let parts = [(0, 0.5), (1, 0.5), (2, 1.0), (1, 0.5), (0, 0.5)];
        let turn = |y, (axis, part): (usize, f64)| {
            Self::rotated(false, axis, y, part * tau / paper::INERTIA[axis])
        };
        parts.into_iter().fold(y, turn)
    }
}

impl Scheme<Body, 3, 3> for Rotations {
    fn id(&self) -> &'static str {
        "rotations"
    }
    fn reads_areas(&self) -> bool {
        false
    }
    fn clips_increments(&self) -> bool {
        false
    }
    fn step_block(
        &self,
        system: &Body,
        step: &Step,
        noise: &BlockNoise<3>,
        y: &mut Block<3>,
        status: &mut BlockStatus,
    ) {
        for p in 0..WIDTH {
            y.set_path(p, self.step(system, step, &noise.path(p), y.path(p)).z);
        }
        *status = BlockStatus::explicit();
    }
    fn step(&self, _: &Body, step: &Step, noise: &Noise<3>, y: [f64; 3]) -> Solution<3> {
        let (before, first, second) = match self.damped_first {
            true => (step.first_decay * step.second_decay, 1.0, 1.0),
            false => (1.0, step.first_decay, step.second_decay),
        };
        let order = match (self.symmetric, self.backwards) {
            (true, _) => vec![(0, 0.5), (1, 0.5), (2, 1.0), (1, 0.5), (0, 0.5)],
            (false, false) => vec![(0, 1.0), (1, 1.0), (2, 1.0)],
            (false, true) => vec![(2, 1.0), (1, 1.0), (0, 1.0)],
        };
        let turn = |y, (axis, part): (usize, f64)| {
            let angle = part * noise.increments[axis] / paper::NOISE_INERTIA[axis];
            Self::rotated(self.cayley, axis, y, angle)
        };
        let y = y.map(|y| before * y);
        let start = Self::drift(y, 0.5 * step.tau).map(|y| first * y);
        let turned = order.into_iter().fold(start, turn).map(|y| second * y);
        let z = Self::drift(turned, 0.5 * step.tau);
        Solution { z, outcome: Outcome::Fast { iterations: 1 } }
    }
}

/// The local order of the mean over both orders of the noises.
fn of_both(one: Rotations) -> Result<LocalWeakOrder, LocalWeakOrderError> {
    local_weak_order(&[&one, &Rotations { backwards: true, ..one }], &body())
}

#[test]
fn the_mean_over_both_orders_of_the_flows_has_local_order_three() {
    assert_order(of_both(Rotations::default()), 3.0);
    for backwards in [false, true] {
        let one = Rotations { backwards, ..Rotations::default() };
        assert_order(local_weak_order(&[&one], &body()), 2.0);
    }
}

#[test]
fn orders_are_those_of_any_state_size_and_damping() {
    let starts = [[1e-3, -2e-3, 5e-4], [40.0, 0.0, -70.0], [0.3, 0.4, 1.2]];
    for (start, gamma) in starts.into_iter().zip([0.0, 3.0, -1.0]) {
        let (body, damping) = (*body().system(), paper::valid(Constant::new(gamma)));
        let problem = paper::valid(Problem::new(body, damping, start, 1.0));
        let one = Rotations::default();
        let both = local_weak_order(&[&one, &Rotations { backwards: true, ..one }], &problem);
        assert_order(both, 3.0);
        assert_order(local_weak_order(&[&one], &problem), 2.0);
        assert_order(local_weak_order(&[&Sexp], &problem), 2.0);
    }
}

#[test]
fn a_wrong_term_that_hides_in_weak_noise_is_found() {
    // At |y| = 0.01 the noise is 10⁻⁴ times the damping, and what it does wrong below round-off.
    let start = [0.003, -0.0057, 0.0084];
    let damping = paper::valid(Constant::new(0.8));
    let problem = paper::valid(Problem::new(*body().system(), damping, start, 1.0));
    let wrong = Rotations { cayley: true, ..Rotations::default() };
    let found = local_weak_order(&[&wrong, &Rotations { backwards: true, ..wrong }], &problem);
    assert!(found.as_ref().is_ok_and(|found| found.amplification > 1.0), "{found:?}");
    assert_order(found, 2.0);
    let right = Rotations::default();
    let both = [right, Rotations { backwards: true, ..right }];
    assert_order(local_weak_order(&[&both[0], &both[1]], &problem), 3.0);
    assert_order(local_weak_order(&[&EulerMaruyama], &problem), 2.0);
}

/// The local order of both orders of the noises together, and of the first alone.
macro_rules! orders_of {
    ($nv:expr, $problem:expr) => {{
        let nv = $nv;
        let (forward, backward) = (nv.with_sweep(Sweep::Forward), nv.with_sweep(Sweep::Backward));
        [
            local_weak_order(&[&forward, &backward], $problem),
            local_weak_order(&[&forward], $problem),
        ]
    }};
}

#[test]
fn nv_has_local_order_three() {
    let problem = body();
    for [both, one] in [
        orders_of!(Nv::of_parts(), &problem),
        orders_of!(Nv::new(problem.system(), problem.y0()).unwrap(), &problem),
    ] {
        assert_order(both, 3.0);
        assert_order(one, 2.0);
    }
    // One noise needs no second order.
    let damping = || paper::valid(Constant::new(0.2));
    let laser = paper::valid(Problem::new(MaxwellBloch, damping(), paper::POISSON_START, 1.0));
    let system = paper::valid(LotkaVolterra::<IntegerExponents<1, 1>>::integer(1.0));
    let start = paper::LOTKA_VOLTERRA_START;
    let populations = paper::valid(Problem::new(system, damping(), start, 1.0));
    for [both, one] in [
        orders_of!(Nv::of_parts(), &laser),
        orders_of!(Nv::new(laser.system(), laser.y0()).unwrap(), &laser),
        orders_of!(Nv::new(populations.system(), populations.y0()).unwrap(), &populations),
    ] {
        assert_order(both, 3.0);
        assert_order(one, 3.0);
    }
}

#[test]
fn twins_with_one_mistake_have_local_order_two() {
    let right = Rotations::default();
    assert_order(of_both(Rotations { cayley: true, ..right }), 2.0);
    assert_order(of_both(Rotations { symmetric: true, ..right }), 2.0);
    assert_order(of_both(Rotations { damped_first: true, ..right }), 2.0);
}

#[test]
fn other_polynomial_systems_have_their_orders() {
    let damping = || paper::valid(Constant::new(0.2));
    let laser = paper::valid(Problem::new(MaxwellBloch, damping(), paper::POISSON_START, 1.0));
    assert_order(local_weak_order(&[&Sexp], &laser), 2.0);
    // The noise is in one of the two flows only, which is exact in law: a Strang splitting of the
    // generator.
    assert_order(local_weak_order(&[&Split], &laser), 3.0);
    let start = paper::LOTKA_VOLTERRA_START;
    let system = paper::valid(LotkaVolterra::<IntegerExponents<1, 1>>::integer(1.0));
    let populations = paper::valid(Problem::new(system, damping(), start, 1.0));
    assert_order(local_weak_order(&[&Sexp], &populations), 2.0);
    assert_order(local_weak_order(&[&Heun], &populations), 2.0);
    let system = paper::valid(LotkaVolterra::<IntegerExponents<2, 2>>::integer(1.0));
    let populations = paper::valid(Problem::new(system, damping(), start, 1.0));
    let found = local_weak_order(&[&Sexp], &populations);
    assert_eq!(found.as_ref().ok().map(|found| found.degree), Some(2));
    assert_order(found, 2.0);
}

#[test]
fn what_it_cannot_measure_has_an_error_that_says_why() {
    let problem = body();
    let areas =
        local_weak_order(&[&Sexp, &SexpLevy::new(problem.system(), problem.y0())], &problem)
            .unwrap_err();
    assert_eq!(areas, LocalWeakOrderError::ReadsAreas { scheme: "sexp-levy" });
    let none: &[&dyn Scheme<Body, 3, 3>] = &[];
    assert_eq!(local_weak_order(none, &problem).unwrap_err(), LocalWeakOrderError::NoScheme);
    let changing = local_weak_order(&[&Sexp], &paper::rigid_body_three_noises(1.0)).unwrap_err();
    assert!(matches!(changing, LocalWeakOrderError::Damping { start: 0.5, .. }), "{changing}");
    let system = paper::valid(Poisson3::new(1.0));
    let damping = paper::valid(Constant::new(0.2));
    let sine = paper::valid(Problem::new(system, damping, paper::POISSON_START, 1.0));
    let error = local_weak_order(&[&Sexp], &sine).unwrap_err();
    assert!(error.to_string().contains("no polynomial of degree 6 or less"), "{error}");
}

/// Damping alone.
struct Damped;

impl PoissonSystem<2, 1> for Damped {
    fn name(&self) -> &'static str {
        "damped"
    }
    fn structure<R: Real>(&self, _y: [R; 2], v: [R; 2]) -> [R; 2] {
        [v[1], -v[0]]
    }
    fn energy<R: Real>(&self, _y: [R; 2], _dt: f64, _dw: [f64; 1]) -> R {
        R::zero()
    }
}

/// The first component as a function of τ, ΔW and y₁, the second as it was. NaN fails.
struct First(fn(f64, f64, f64) -> f64);

impl Scheme<Damped, 2, 1> for First {
    fn id(&self) -> &'static str {
        "first"
    }
    fn reads_areas(&self) -> bool {
        false
    }
    fn clips_increments(&self) -> bool {
        false
    }
    fn step_block(
        &self,
        system: &Damped,
        step: &Step,
        noise: &BlockNoise<1>,
        y: &mut Block<2>,
        status: &mut BlockStatus,
    ) {
        for p in 0..WIDTH {
            y.set_path(p, self.step(system, step, &noise.path(p), y.path(p)).z);
        }
        *status = BlockStatus::explicit();
        status.fail_where_not_finite(&y.0);
    }
    fn step(&self, _: &Damped, step: &Step, noise: &Noise<1>, y: [f64; 2]) -> Solution<2> {
        let z = [(self.0)(step.tau, noise.increments[0], y[0]), y[1]];
        Solution { z, outcome: Outcome::Fast { iterations: 1 } }
    }
}

/// What is found for a scheme on y′ = 0.
fn of_first(first: fn(f64, f64, f64) -> f64) -> Result<LocalWeakOrder, LocalWeakOrderError> {
    let nothing = paper::valid(Constant::new(0.0));
    let problem = paper::valid(Problem::new(Damped, nothing, [1.0, 0.0], 1.0));
    local_weak_order(&[&First(first)], &problem)
}

#[test]
fn means_decide_and_not_paths() {
    // Errors of size √τ on paths, of τ² in the mean of y₁ and of more in that of its powers.
    assert_order(of_first(|tau, _, y| y + tau * tau), 2.0);
    assert_order(of_first(|_, dw, y| y + dw), 1.0);
    assert_order(of_first(|tau, dw, y| y + tau * dw), 3.0);
    // The mean of ΔW⁵ is zero, and that of its square 945τ⁵.
    let found = of_first(|_, dw, y| y + dw.powi(5)).unwrap();
    assert!((found.order - 5.0).abs() < 0.05 && found.function == [2, 0], "{found}");
}

#[test]
fn steps_that_fail_or_show_no_order_have_an_error() {
    let exact = of_first(|_, _, y| y).unwrap_err();
    assert_eq!(exact, LocalWeakOrderError::RoundOff { got: 0, needed: 4 });
    let failing = of_first(|_, _, _| f64::NAN).unwrap_err();
    assert!(matches!(failing, LocalWeakOrderError::StepFails { scheme: "first", .. }), "{failing}");
    // Large steps may fail.
    assert_order(of_first(|tau, _, y| if tau > 0.2 { f64::NAN } else { y + tau * tau }), 2.0);
    let erratic = of_first(|tau, _, y| y + tau * tau * (1.5 + (2.0 * tau.ln()).sin()));
    assert!(matches!(erratic, Err(LocalWeakOrderError::Unclear { .. })), "{erratic:?}");
    // A small term of low order is found where it shows, and where it begins to, nothing is named.
    assert_order(of_first(|tau, _, y| y + tau.powi(3) + 1e-2 * tau * tau), 2.0);
    let begins = of_first(|tau, _, y| y + tau.powi(3) + 1e-4 * tau * tau);
    assert!(matches!(begins, Err(LocalWeakOrderError::Unclear { .. })), "{begins:?}");
}

#[test]
fn the_state_is_near_the_initial_value_and_generic() {
    let (state, scale) = generic(&[1.0, 0.0, -0.01, 3.0]);
    assert_eq!(scale, 4.0);
    assert!((1.0..1.2).contains(&state[0]) && (-0.012..-0.01).contains(&state[2]));
    assert!(state[1] > 0.1 && (3.0..3.6).contains(&state[3]));
    assert_eq!(generic(&[0.0, 0.0]).1, 1.0);
}

#[test]
fn any_number_of_noises_is_a_grid_up_to_five() {
    let problem = |noises: &[&str]| {
        let words = |texts: &[&str]| texts.iter().map(|s| s.to_string()).collect::<Vec<_>>();
        let definition = Definition {
            name: "oscillator".into(),
            state: words(&["p", "q"]),
            structure: vec![words(&["-1"])],
            energy: "p^2/2 + q^4/4".into(),
            noises: words(noises),
            ..Definition::default()
        };
        let y0 = [0.2, 1.0];
        let system = Arc::new(FormulaSystem::new(&definition, &y0).unwrap());
        let damping = Arc::new(paper::valid(Constant::new(0.5)));
        run_time::Problem::new(system, damping, y0.into(), 1.0).unwrap()
    };
    let of = |noises: &[&str]| {
        let problem = problem(noises);
        let Setup { problem, scheme } = Setup::at_run_time(&problem, &Heun).unwrap();
        super::local_weak_order(&problem, &[scheme])
    };
    // Heun's method has order two without noise.
    assert_order(of(&[]), 3.0);
    let all = ["q^2/2", "p", "p*q/2", "q", "p^2/3", "q^3/9"];
    assert_order(of(&all[..4]), 2.0);
    assert_eq!(of(&all).unwrap_err(), LocalWeakOrderError::Noises { given: 6, most: 5 });
}

/// A chain of particles with nonlinear springs in canonical coordinates p1, q1, p2, …
fn chain(particles: usize) -> run_time::Problem {
    let state: Vec<String> =
        (1..=particles).flat_map(|n| [format!("p{n}"), format!("q{n}")]).collect();
    let dimension = state.len();
    let entry = |i: usize, j: usize| if [i % 2, j] == [0, i + 1] { "-1" } else { "0" };
    let row = |i: usize| (i + 1..dimension).map(|j| entry(i, j).to_string()).collect();
    let energy = (1..=particles).map(|n| {
        let next = n % particles + 1;
        format!("p{n}^2/2 + (q{n} - q{next})^4/4")
    });
    let definition = Definition {
        name: "chain".into(),
        structure: (0..dimension - 1).map(row).collect(),
        energy: energy.collect::<Vec<_>>().join(" + "),
        noises: vec!["q1*q2".into(), "p1*q3/2".into()],
        state,
        ..Definition::default()
    };
    let y0: Vec<f64> = (1..=dimension).map(|i| (i as f64).sin()).collect();
    let system = Arc::new(FormulaSystem::new(&definition, &y0).unwrap());
    run_time::Problem::new(system, Arc::new(paper::valid(Constant::new(0.5))), y0, 1.0).unwrap()
}

#[test]
fn eight_dimensions_are_the_most() {
    let of = |particles: usize| {
        let problem = chain(particles);
        let Setup { problem, scheme } = Setup::at_run_time(&problem, &Heun).unwrap();
        super::local_weak_order(&problem, &[scheme])
    };
    assert_order(of(4), 2.0);
    assert_eq!(of(5).unwrap_err(), LocalWeakOrderError::Dimension { given: 10, most: 8 });
}

/// The heavy top in six dimensions, with three noises that do not commute.
fn heavy_top() -> Definition {
    let words = |texts: &[&str]| texts.iter().map(|text| text.to_string()).collect::<Vec<_>>();
    Definition {
        name: "heavy-top".into(),
        state: words(&["a", "b", "c", "x", "y", "z"]),
        structure: [
            &["-c", "b", "0", "-z", "y"][..],
            &["-a", "z", "0", "-x"],
            &["-y", "x", "0"],
            &["0", "0"],
            &["0"],
        ]
        .iter()
        .map(|row| words(row))
        .collect(),
        energy: "a^2/4 + b^2/2 + 3*c^2/4 + z".into(),
        noises: words(&["a^2/2 + x*y/3", "b^2/4 + x", "c^2/6 + y/2"]),
        ..Definition::default()
    }
}

#[test]
fn formulas_in_six_dimensions_have_their_orders() {
    let y0 = [0.6, 0.2, 0.8, 0.3, -0.5, 0.7];
    let system = Arc::new(FormulaSystem::new(&heavy_top(), &y0).unwrap());
    let damping = Arc::new(paper::valid(Constant::new(0.2)));
    let problem = run_time::Problem::new(system, damping, y0.into(), 1.0).unwrap();
    for scheme in [&Sexp as &dyn schemes::run_time::Scheme, &Heun] {
        let Setup { problem, scheme } = Setup::at_run_time(&problem, scheme).unwrap();
        let found = super::local_weak_order(&problem, &[scheme]);
        assert_eq!(found.as_ref().ok().map(|found| found.degree), Some(2));
        assert_order(found, 2.0);
    }
}
