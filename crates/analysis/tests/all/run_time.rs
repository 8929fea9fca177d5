//! Orders on systems from texts: those of the compiled systems, with wrong schemes as twins.

use std::sync::Arc;

use analysis::{
    Decision, Exact, Limit, Order, ReferenceSolution, StepSizes,
    exact::{RandomTime, solution},
    strong_order, weak_order,
};
use formula::{Definition, FormulaSystem};
use mc::{LadderError, Observable, RowFunction, Setup, bind};
use noise::{StreamKey, Truncation};
use real::Row;
use schemes::{EulerMaruyama, Explicit, Heun, Increment, Midpoint, Scheme, Sexp, SexpLi, run_time};
use stats::Point;
use systems::{Constant, Pendulum, PoissonSystem, Problem, RigidBody, run_time as systems_at};

/// Texts of a system.
pub fn texts(state: &str, structure: &[&str], energy: &str, noises: &[&str]) -> Definition {
    let words = |text: &str| text.split_whitespace().map(String::from).collect::<Vec<_>>();
    Definition {
        name: "texts".into(),
        state: words(state),
        structure: structure.iter().map(|row| words(row)).collect(),
        energy: energy.into(),
        noises: noises.iter().map(|noise| noise.to_string()).collect(),
        ..Definition::default()
    }
}

/// The problem with the texts instead of the system that the compiler knows.
pub fn of_texts<S: PoissonSystem<D, M>, const D: usize, const M: usize>(
    definition: &Definition,
    problem: &Problem<S, Constant, D>,
) -> systems_at::Problem {
    let system = FormulaSystem::new(definition, &problem.y0()).unwrap();
    let (damping, y0) = (*problem.damping(), problem.y0().to_vec());
    systems_at::Problem::new(Arc::new(system), Arc::new(damping), y0, problem.t_end()).unwrap()
}

fn constant(rate: f64) -> Constant {
    Constant::new(rate).unwrap()
}

/// The rigid body with this number of noises, of three.
pub fn body_definition(noises: usize) -> Definition {
    let all = ["y1^2/2", "y2^2/4", "y3^2/6"];
    texts("y1 y2 y3", &["-y3 y2", "-y1"], "(y1^2/2 + y2^2 + 2*y3^2)/2", &all[..noises])
}

/// The same, compiled and from texts.
pub fn body<const M: usize>(
    body: RigidBody<M>,
    damping: f64,
) -> (Problem<RigidBody<M>, Constant, 3>, systems_at::Problem) {
    let problem = Problem::new(body, constant(damping), [0.5, 0.6, 0.62], 1.0).unwrap();
    let other = of_texts(&body_definition(M), &problem);
    (problem, other)
}

pub fn one_noise() -> RigidBody<1> {
    RigidBody::one_noise([2.0, 1.0, 0.5], 1.0).unwrap()
}

pub fn three_noises() -> RigidBody<3> {
    RigidBody::three_noises([2.0, 1.0, 0.5], [1.0, 2.0, 3.0]).unwrap()
}

/// The damped pendulum, compiled and from texts.
pub fn pendulum(damping: f64) -> (Problem<Pendulum, Constant, 2>, systems_at::Problem) {
    let problem =
        Problem::new(Pendulum::new(0.5).unwrap(), constant(damping), [0.2, 1.0], 1.0).unwrap();
    let definition = texts("p q", &["-1"], "p^2/2 - cos(q)", &["0.5*(p^2/2 - cos(q))"]);
    let other = of_texts(&definition, &problem);
    (problem, other)
}

fn sizes(coarsest_steps: u64) -> StepSizes {
    let key = StreamKey { seed: 5, experiment: 13 };
    let sizes = StepSizes::new(coarsest_steps, Truncation::new(4).unwrap(), key);
    StepSizes { samples: 400, ..sizes }
}

/// The strong order of a scheme for systems known at run time.
fn strong(
    problem: &systems_at::Problem,
    scheme: &dyn run_time::Scheme,
    sizes: &StepSizes,
) -> Order {
    let setup = Setup::at_run_time(problem, scheme).unwrap();
    strong_order(&setup, sizes, &ReferenceSolution::at_run_time(problem).unwrap()).unwrap()
}

/// Numbers that agree to this part of the larger.
fn near(a: f64, b: f64, part: f64) -> bool {
    a == b || (a - b).abs() <= part * a.abs().max(b.abs())
}

/// The same decision from errors that agree to round-off.
fn check_same(one: &Order, other: &Order) {
    let said = format!("{one}\n{other}");
    let order = |order: &Order| match order.decision {
        Decision::Order { order, shown } => Some((order, shown)),
        _ => None,
    };
    assert_eq!(order(one), order(other), "{said}");
    let kind = |order: &Order| {
        (std::mem::discriminant(&order.decision), std::mem::discriminant(&order.limit))
    };
    assert_eq!(kind(one), kind(other), "{said}");
    let step = |order: &Order| order.one_step.map(|step| (step.order, step.amplification));
    assert_eq!(step(one), step(other), "{said}");
    assert_eq!((one.failed, one.points.len()), (other.failed, other.points.len()));
    for points in one.points.iter().zip(&other.points) {
        let (Point::Error { tau, value, se, .. }, Point::Error { tau: t, value: v, se: s, .. }) =
            points
        else {
            panic!("{points:?}")
        };
        // Implicit equations are solved to 1e-13 or so; errors of a hundredth lose two digits.
        assert!(tau == t && near(*value, *v, 1e-8) && near(*se, *s, 1e-6), "{points:?}\n{said}");
    }
    let rates = one.rate.as_ref().zip(other.rate.as_ref());
    let (a, b) = rates.map(|(a, b)| (a.estimate, b.estimate)).unwrap_or_default();
    assert!((a - b).abs() < 1e-6 && one.rate.is_some() == other.rate.is_some(), "{said}");
}

/// Checks the strong orders of schemes that both kinds of systems have.
fn check_strong<S: PoissonSystem<D, M>, const D: usize, const M: usize>(
    (compiled, texts): &(Problem<S, Constant, D>, systems_at::Problem),
    steps: u64,
    expected: [f64; 4],
) {
    let one: [&dyn Scheme<S, D, M>; 4] = [&Sexp, &Midpoint, &Heun, &EulerMaruyama];
    let other: [&dyn run_time::Scheme; 4] = [&Sexp, &Midpoint, &Heun, &EulerMaruyama];
    for ((one, other), expected) in one.into_iter().zip(other).zip(expected) {
        let order = strong(texts, other, &sizes(steps));
        assert_eq!(order.order(), Some(expected), "{}: {order}", one.id());
        assert!(matches!(order.limit, Limit::Consistent { .. }), "{order}");
        check_same(
            &strong_order(
                &Setup::of(compiled, one),
                &sizes(steps),
                &ReferenceSolution::independent(compiled),
            )
            .unwrap(),
            &order,
        );
    }
}

#[test]
fn strong_orders_of_texts_are_those_of_compiled_systems() {
    // One noise of both commutes with itself, three of the body do not.
    check_strong(&body(one_noise(), 0.1), 16, [1.0, 1.0, 1.0, 0.5]);
    check_strong(&body(three_noises(), 0.0), 32, [0.5; 4]);
    check_strong(&pendulum(0.3), 16, [1.0, 1.0, 1.0, 0.5]);
}

#[test]
fn a_linearly_implicit_scheme_of_texts_has_its_order() {
    let (compiled, texts) = body(one_noise(), 0.1);
    let scheme = SexpLi::at_run_time(texts.system()).unwrap();
    let order = strong(&texts, &scheme, &sizes(16));
    assert_eq!(order.order(), Some(1.0), "{order}");
    let one = SexpLi::new(compiled.system(), compiled.y0()).unwrap();
    check_same(
        &strong_order(
            &Setup::of(&compiled, &one),
            &sizes(16),
            &ReferenceSolution::independent(&compiled),
        )
        .unwrap(),
        &order,
    );
}

/// y₁ + y₂² of rows.
fn first_and_square(y: &[Row], values: &mut Row) {
    *values = std::array::from_fn(|p| y[0][p] + y[1][p] * y[1][p]);
}

const PHI: Observable<3> = Observable { name: "φ", function: |y| y[0] + y[1] * y[1] };

#[test]
fn weak_orders_of_texts_are_those_of_compiled_systems() {
    let (compiled, texts) = body(three_noises(), 0.1);
    let phi = RowFunction { name: "φ".into(), function: first_and_square };
    let sizes = StepSizes { samples: 20_000, levels: 4, refinement: 1, ..sizes(2) };
    let reference = ReferenceSolution::at_run_time(&texts).unwrap();
    let schemes: [(&dyn Scheme<_, 3, 3>, &dyn run_time::Scheme); 2] =
        [(&Heun, &Heun), (&EulerMaruyama, &EulerMaruyama)];
    for (one, other) in schemes {
        let setup = Setup::at_run_time(&texts, other).unwrap();
        let order = weak_order(&setup, &phi, &sizes, &reference).unwrap();
        assert!(matches!(order.limit, Limit::Consistent { .. }), "{order}");
        let independent = &ReferenceSolution::independent(&compiled);
        check_same(
            &weak_order(&Setup::of(&compiled, one), &PHI, &sizes, independent).unwrap(),
            &order,
        );
        // Against a scheme.
        let against = ReferenceSolution::Scheme(Setup::at_run_time(&texts, &Sexp).unwrap().scheme);
        let order = weak_order(&setup, &phi, &sizes, &against).unwrap();
        let sexp = &ReferenceSolution::Scheme(bind(&compiled, &Sexp));
        check_same(&weak_order(&Setup::of(&compiled, one), &PHI, &sizes, sexp).unwrap(), &order);
    }
}

#[test]
fn an_exact_solution_serves_texts_too() {
    let (compiled, texts) = pendulum(0.0);
    let sizes = sizes(8);
    let tau = compiled.t_end() / sizes.reference_steps() as f64;
    let time_change = RandomTime::new(compiled.damping(), 1.0, 0.5, tau);
    let solution = |s: f64| solution(&compiled, s);
    let exact = ReferenceSolution::Exact(Exact::new(&time_change, solution));
    let one = strong_order(&Setup::of(&compiled, &Heun), &sizes, &exact);
    let setup = Setup::at_run_time(&texts, &Heun).unwrap();
    let other = strong_order(&setup, &sizes, &exact).unwrap();
    assert_eq!(other.order(), Some(1.0), "{other}");
    check_same(&one.unwrap(), &other);
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

#[test]
fn what_converges_to_something_else_on_texts_is_refuted() {
    let (_, texts) = body(three_noises(), 0.5);
    let of = |correction, damping| strong(&texts, &Wrong { correction, damping }, &sizes(32));
    // A missing correction, a hundredth of it, and damping that is wrong by a hundredth.
    for (correction, damping) in [(0.0, 1.0), (0.99, 1.0), (1.0, 1.01)] {
        let order = of(correction, damping);
        assert_eq!(order.decision, Decision::WrongLimit, "{correction} {damping}: {order}");
        // The twin: its differences have an order.
        assert!(order.rate.is_some_and(|rate| rate.covers(0.5)));
    }
    let right = of(1.0, 1.0);
    assert_eq!(right.order(), Some(0.5), "{right}");
    // The law is wrong, too.
    let phi = RowFunction { name: "φ".into(), function: first_and_square };
    let scheme = Wrong { correction: 0.0, damping: 1.0 };
    let setup = Setup::at_run_time(&texts, &scheme).unwrap();
    let sizes = StepSizes { samples: 5000, ..sizes(8) };
    let reference = ReferenceSolution::at_run_time(&texts).unwrap();
    let order = weak_order(&setup, &phi, &sizes, &reference).unwrap();
    assert_eq!(order.decision, Decision::WrongLimit, "{order}");
}

#[test]
fn a_budget_is_spent_on_texts_as_on_compiled_systems() {
    let (compiled, texts) = pendulum(0.3);
    let few = StepSizes { samples: 32, levels: 3, refinement: 1, ..sizes(8) };
    let setup = Setup::at_run_time(&texts, &Heun).unwrap();
    let reference = ReferenceSolution::at_run_time(&texts).unwrap();
    let of = |budget| strong_order(&setup, &few.within(budget), &reference).unwrap();
    let enough = of(20_000_000);
    assert_eq!(enough.order(), Some(1.0), "{enough}");
    check_same(
        &strong_order(
            &Setup::of(&compiled, &Heun),
            &few.within(20_000_000),
            &ReferenceSolution::independent(&compiled),
        )
        .unwrap(),
        &enough,
    );
    check_same(
        &strong_order(
            &Setup::of(&compiled, &Heun),
            &few.within(1),
            &ReferenceSolution::independent(&compiled),
        )
        .unwrap(),
        &of(1),
    );
    let (momentum, row) = (
        Observable { name: "p", function: |y: [f64; 2]| y[0] },
        RowFunction { name: "p".into(), function: |y: &[Row], p: &mut Row| *p = y[0] },
    );
    let few = StepSizes { samples: 200, levels: 4, refinement: 1, ..sizes(4) };
    let independent = ReferenceSolution::independent(&compiled);
    check_same(
        &weak_order(&Setup::of(&compiled, &Heun), &momentum, &few.within(5_000_000), &independent)
            .unwrap(),
        &weak_order(&setup, &row, &few.within(5_000_000), &reference).unwrap(),
    );
    // Too few step sizes are refused.
    let few = StepSizes { levels: 2, refinement: 1, ..few };
    let error = strong_order(&setup, &few, &reference).unwrap_err();
    assert!(matches!(error, LadderError::StepSizes { given: 3, from: 4, .. }), "{error}");
}

#[test]
fn a_function_that_a_scheme_keeps_has_no_order() {
    let oscillator = texts("q p", &["1"], "(p^2+q^2)/2", &["0.1*(p^2+q^2)/2"]);
    let y0 = [1.0, 0.0];
    let system = FormulaSystem::new(&oscillator, &y0).unwrap();
    let none = Arc::new(constant(0.0));
    let texts = systems_at::Problem::new(Arc::new(system), none, y0.to_vec(), 2.0).unwrap();
    let energy = |y: &[Row], h: &mut Row| {
        h.iter_mut().enumerate().for_each(|(p, h)| *h = 0.5 * (y[0][p].powi(2) + y[1][p].powi(2)));
    };
    let phi = RowFunction { name: "energy".into(), function: energy };
    let reference = ReferenceSolution::at_run_time(&texts).unwrap();
    let of = |scheme: &dyn run_time::Scheme| {
        let setup = Setup::at_run_time(&texts, scheme).unwrap();
        weak_order(&setup, &phi, &sizes(8).within(4_000_000), &reference).unwrap()
    };
    let kept = of(&Sexp);
    assert_eq!(kept.decision, Decision::Kept, "{kept}");
    assert!(kept.to_string().contains("at rounding") && !kept.to_string().contains("finer"));
    // The twin does not keep it.
    assert_ne!(of(&Heun).decision, Decision::Kept);
}

#[test]
fn a_solution_that_ends_is_said_to_end() {
    // dq/dt = q² from q = 1: q is infinite at t = 1.
    let growth = texts("q p", &["1"], "q^2*p", &["0.1*q"]);
    let system = FormulaSystem::new(&growth, &[1.0, 0.5]).unwrap();
    let (none, y0) = (Arc::new(constant(0.0)), vec![1.0, 0.5]);
    let texts = systems_at::Problem::new(Arc::new(system), none, y0, 5.0).unwrap();
    let reference = ReferenceSolution::at_run_time(&texts).unwrap();
    for scheme in [&Heun as &dyn run_time::Scheme, &Sexp] {
        let setup = Setup::at_run_time(&texts, scheme).unwrap();
        let order = strong_order(&setup, &sizes(64).within(10_000_000), &reference).unwrap();
        let Decision::Failures { all: true, t } = order.decision else { panic!("{order}") };
        assert!((0.5..1.5).contains(&t), "{order}");
        assert!(order.to_string().contains("the solution itself may end"), "{order}");
        // Few paths show it: no budget is spent on steps that fail.
        assert!(order.failed <= 32, "{order}");
    }
}
