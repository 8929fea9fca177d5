//! Every constructor refuses what makes no sense, with the right error, and the error names the
//! value.

use systems::{
    Constant, Cosine, Damping, DampingFunction, Linear, LotkaVolterra, MaxwellBloch, Pendulum,
    Poisson3, PoissonSystem, Problem, RigidBody, RigidBodyEnergy, Sine, SystemError,
};

const NOT_FINITE: [f64; 3] = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY];
const NOT_POSITIVE: [f64; 5] = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 0.0, -2.5];

/// The text of the error, after checking that it names the parameter and the value.
fn named(error: SystemError, name: &str, value: f64) {
    let text = error.to_string();
    assert!(text.contains(name), "{text} does not name {name}");
    assert!(text.ends_with(&format!("{value}")), "{text} does not name {value}");
    // It is an error like any other.
    let boxed: Box<dyn std::error::Error + Send + Sync> = Box::new(error);
    assert_eq!(boxed.to_string(), text);
}

/// Refuses every `bad` value, since it must be something else, and takes every `good` one.
fn refuses<T: std::fmt::Debug>(
    (name, what): (&str, &str),
    (bad, good): (&[f64], &[f64]),
    make: impl Fn(f64) -> Result<T, SystemError>,
) {
    for &bad in bad {
        let error = make(bad).unwrap_err();
        assert!(error.0.contains(&format!("must be {what}, got")), "{error:?}");
        named(error, name, bad);
    }
    assert!(good.iter().all(|&good| make(good).is_ok()));
}

fn not_finite<T: std::fmt::Debug>(name: &str, make: impl Fn(f64) -> Result<T, SystemError>) {
    refuses((name, "finite"), (&NOT_FINITE, &[-1.5, 0.0, 2.0]), make);
}

fn not_positive<T: std::fmt::Debug>(name: &str, make: impl Fn(f64) -> Result<T, SystemError>) {
    refuses((name, "positive and finite"), (&NOT_POSITIVE, &[0.5]), make);
}

#[test]
fn systems_refuse_parameters() {
    not_finite("c", Pendulum::new);
    not_finite("c", Poisson3::new);
    not_finite("c", |c| RigidBodyEnergy::new([2.0, 1.0, 0.5], c));
    not_finite("c must", LotkaVolterra::<2, 2>::new);
    for i in 0..3 {
        let with = |value| {
            let mut inertia = [2.0, 1.0, 0.5];
            inertia[i] = value;
            inertia
        };
        let name = ["I1", "I2", "I3"][i];
        not_positive(name, |x| RigidBody::three_noises(with(x), [1.0; 3]));
        not_positive(name, |x| RigidBody::one_noise(with(x), 1.0));
        not_positive(name, |x| RigidBodyEnergy::new(with(x), 1.0));
        not_positive(["Î1", "Î2", "Î3"][i], |x| RigidBody::three_noises([1.0; 3], with(x)));
    }
    not_positive("Î1", |x| RigidBody::one_noise([1.0; 3], x));
}

#[test]
fn dampings_refuse_parameters() {
    not_finite("rate", Constant::new);
    not_finite("slope", Linear::new);
    not_finite("amplitude", |x| Sine::new(x, 1.0));
    not_finite("frequency", |x| Sine::new(1.0, x));
    not_finite("amplitude", |x| Cosine::new(x, 1.0));
    not_finite("frequency", |x| Cosine::new(1.0, x));
    for nodes in [0, 513] {
        let error = DampingFunction::new(|t| t, nodes).map(|_| ()).unwrap_err();
        assert!(error.to_string().ends_with(&format!("got {nodes}")));
    }
}

#[test]
fn dampings_say_what_they_are() {
    let described: [(&dyn Damping, &str); 6] = [
        (&Constant::new(2.0).unwrap(), "γ = 2"),
        (&Linear::new(1.0).unwrap(), "γ = t"),
        (&Linear::new(0.5).unwrap(), "γ = 0.5 t"),
        (&Sine::new(1.0, 1.0).unwrap(), "γ = sin t"),
        (&Cosine::new(0.5, 2.0).unwrap(), "γ = 0.5 cos 2 t"),
        (&DampingFunction::new(|t| t, 3).unwrap(), "γ given as a function"),
    ];
    for (damping, words) in described {
        assert_eq!(damping.describe(), words);
    }
}

#[test]
fn problems_refuse_initial_values_and_final_times() {
    let damping = Constant::new(1.0).unwrap();
    let populations = LotkaVolterra::<1, 1>::new(1.0).unwrap();
    let outside = |error: SystemError, i: usize, name: &str, bad: f64| {
        assert!(error.0.contains(&format!("got y{} = ", i + 1)), "{error:?}");
        named(error, name, bad);
    };
    for i in 0..3 {
        let with = |mut y0: [f64; 3], bad: f64| {
            y0[i] = bad;
            y0
        };
        for bad in NOT_FINITE {
            let y0 = with([1.0, 2.0, 3.0], bad);
            let error = Problem::new(MaxwellBloch, damping, y0, 1.0).unwrap_err();
            outside(error, i, &format!("y{}", i + 1), bad);
        }
        for bad in [0.0, -0.25] {
            let y0 = with([0.2, 0.4, 0.6], bad);
            let error = Problem::new(populations, damping, y0, 1.0).unwrap_err();
            outside(error, i, "y1 > 0, y2 > 0 and y3 > 0", bad);
        }
    }
    for bad in NOT_POSITIVE {
        let error = Problem::new(MaxwellBloch, damping, [1.0, 2.0, 3.0], bad).unwrap_err();
        named(error, "the final time T must be positive and finite", bad);
    }
    assert!(Problem::new(LotkaVolterra::<2, 2>::new(1.0).unwrap(), damping, [0.2; 3], 1.0).is_ok());
}

#[test]
fn a_problem_gives_back_what_it_was_made_of() {
    let (damping, y0) = (Constant::new(0.5).unwrap(), [0.2, 1.0]);
    let problem = Problem::new(Pendulum::new(0.7).unwrap(), damping, y0, 1.0).unwrap();
    assert_eq!((problem.y0(), problem.t_end()), (y0, 1.0));
    let longer = problem.until(3.0).unwrap();
    assert_eq!((longer.t_end(), longer.damping().rate(0.0)), (3.0, 0.5));
    for bad in NOT_POSITIVE {
        assert!(longer.clone().until(bad).is_err(), "{bad}");
    }
    let (_, damping, state, t_end) = longer.into_parts();
    assert_eq!((damping.rate(0.0), state, t_end), (0.5, y0, 3.0));
}

#[test]
fn parameters_are_described_to_the_last_digit() {
    let body = RigidBody::three_noises([2.0, 1.0, 0.5], [1.0, 4.0, 3.0]).unwrap();
    let text = PoissonSystem::<3, 3>::parameters(&body);
    assert_eq!(text, "1/I = [0.5, 1.0, 2.0], 1/Î = [1.0, 0.25, 0.3333333333333333]");
    let energy = RigidBodyEnergy::new([2.0, 1.0, 0.5], 0.1).unwrap();
    assert_eq!(energy.parameters(), "1/I = [0.5, 1.0, 2.0], c = 0.1");
    let populations = LotkaVolterra::<2, 2>::new(0.1).unwrap();
    assert_eq!(populations.parameters(), "a = -1, c = 0.1, p = 2, q = 2");
    assert_eq!(Pendulum::new(0.7).unwrap().parameters(), "c = 0.7");
    assert_eq!(Poisson3::new(0.7).unwrap().parameters(), "c = 0.7");
    assert_eq!(MaxwellBloch.parameters(), "");
}
