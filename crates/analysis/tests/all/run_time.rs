//! Orders on systems from texts are those of the compiled systems.

use analysis::{Decision, Order, StepSizes, strong_order, weak_order};
use mc::{Observable, Setup};
use noise::{StreamKey, Truncation};
use schemes::{EulerMaruyama, Heun, Scheme, Sexp, run_time};
use stats::Point;
use systems::{Constant, Pendulum, PoissonSystem, Problem, RigidBody, run_time as at_run_time};

use crate::{
    SPIN, constant,
    orders::{strong, weak},
    problem, texts,
};

type Both<S, const D: usize> = (Problem<S, Constant, D>, at_run_time::Problem);

/// The rigid body with three noises, compiled and from texts.
fn body() -> Both<RigidBody<3>, 3> {
    let y0 = [0.5, 0.6, 0.62];
    let body = RigidBody::three_noises([2.0, 1.0, 0.5], [1.0, 2.0, 3.0]).unwrap();
    let noises = ["x^2/2", "y^2/4", "z^2/6"];
    let definition = texts("x y z", &SPIN, "(x^2/2 + y^2 + 2*z^2)/2", &noises);
    (Problem::new(body, constant(0.1), y0, 1.0).unwrap(), problem(&definition, 0.1, &y0, 1.0))
}

/// The damped pendulum, compiled and from texts.
fn pendulum() -> Both<Pendulum, 2> {
    let (pendulum, y0) = (Pendulum::new(0.5).unwrap(), [0.2, 1.0]);
    let definition = texts("p q", &["-1"], "p^2/2 - cos(q)", &["0.5*(p^2/2 - cos(q))"]);
    (Problem::new(pendulum, constant(0.3), y0, 1.0).unwrap(), problem(&definition, 0.3, &y0, 1.0))
}

fn sizes(coarsest_steps: u64) -> StepSizes {
    let key = StreamKey { seed: 5, experiment: 13 };
    let sizes = StepSizes::new(coarsest_steps, Truncation::new(4).unwrap(), key);
    StepSizes { samples: 400, ..sizes }
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

/// The strong order on texts, compared with that on the compiled system.
fn same_strong<S: PoissonSystem<D, M>, const D: usize, const M: usize>(
    (compiled, texts): &Both<S, D>,
    (one, other): (&dyn Scheme<S, D, M>, &dyn run_time::Scheme),
    sizes: &StepSizes,
) -> Option<f64> {
    let order = strong(other, texts, sizes);
    check_same(&strong_order(&Setup::of(compiled, one), sizes).unwrap(), &order);
    order.order()
}

#[test]
fn orders_on_texts_are_those_on_compiled_systems() {
    let (pendulum, body) = (pendulum(), body());
    // One noise commutes with itself, three of the body do not.
    let sexp: (&dyn Scheme<_, 2, 1>, &dyn run_time::Scheme) = (&Sexp, &Sexp);
    for (schemes, order) in [(sexp, 1.0), ((&EulerMaruyama, &EulerMaruyama), 0.5)] {
        assert_eq!(same_strong(&pendulum, schemes, &sizes(16)), Some(order));
    }
    assert_eq!(same_strong::<_, 3, 3>(&body, (&Heun, &Heun), &sizes(32)), Some(0.5));
    // Weak orders.
    let phi = Observable { name: "φ", function: |y: [f64; 3]| y[0] + y[1] * y[1] };
    let sizes = StepSizes { samples: 20_000, levels: 4, refinement: 1, ..sizes(2) };
    let one = weak_order(&Setup::of(&body.0, &Heun), &phi, &sizes, None).unwrap();
    check_same(&one, &weak(&Heun, &body.1, &phi, &sizes));
}
