//! Orders of what paths collect: its equations are part of the coefficients.

use std::sync::Arc;

use analysis::{Limit, StepSizes, strong_order, weak_order};
use mc::{Along, Coefficients, Observe, OfStates, Passage, Setup};
use noise::{StreamKey, Truncation};
use real::{PathMask, Row};
use schemes::Heun;

use crate::{problem, texts};

/// A row of the state, less a level.
struct Above(usize, f64);

impl Observe for Above {
    fn name(&self) -> &str {
        "above"
    }

    fn evaluate(&self, y: &[Row], _: PathMask, values: &mut Row) {
        *values = y[self.0].map(|y| y - self.1);
    }
}

fn passage(level: f64, stops: bool) -> Along {
    let phi: OfStates = Arc::new(Above(0, level));
    Along::Passage(Passage { phi, gradient: None, stops })
}

/// Time, ∫q dt, and the first passages of q through 0.9, which is seen, and 5, which stops.
fn quantities() -> Vec<Along> {
    let q: OfStates = Arc::new(Above(0, 0.0));
    vec![Along::Time, Along::Integral(q), passage(0.9, false), passage(5.0, true)]
}

/// An oscillator with noise and damping.
fn damped() -> systems::run_time::Problem {
    let texts = texts("q p", &["1"], "(p^2 + q^2)/2", &["0.3*(p^2 + q^2)/2"]);
    problem(&texts, 0.4, &[0.5, 0.2], 1.0)
}

#[test]
fn coefficients_of_what_is_collected() {
    let damped = damped();
    let plain = Setup::at_run_time(&damped, &Heun).unwrap();
    let setup = plain.clone().collecting(damped.system(), quantities());
    // Starts with nothing; of the first passage, whose function is negative, no more.
    let start: Vec<f64> = setup.start().iter().map(|row| row[0]).collect();
    assert_eq!(start, [0.5, 0.2, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    let state = [0.7, -0.3];
    let own = (plain.problem.coefficients)(0.2, &state);
    let at = |crossed: [f64; 2]| {
        let [seen, stopped] = crossed;
        let y = [0.7, -0.3, 0.2, 0.1, seen, 0.2, stopped, 0.2];
        // Less γy, as of the state.
        let Coefficients { mut drift, noises, correction } = (setup.problem.coefficients)(0.2, &y);
        drift.iter_mut().zip(y).for_each(|(drift, y)| *drift -= 0.4 * y);
        (drift, noises, correction)
    };
    let (drift, noises, correction) = at([0.0; 2]);
    let close = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-15);
    let moves = [own.drift[0] - 0.4 * 0.7, own.drift[1] + 0.4 * 0.3];
    let of_state = |state: &[f64]| [state, &[0.0; 6]].concat();
    assert!(close(&drift, &[&moves[..], &[1.0, 0.7, 0.0, 1.0, 0.0, 1.0]].concat()), "{drift:?}");
    assert_eq!((&noises[0], &correction), (&of_state(&own.noises[0]), &of_state(&own.correction)));
    // A passage ends its own time, and the motion of a path that stays.
    let (drift, noises, _) = at([1.0, 0.0]);
    assert!(close(&drift, &[&moves[..], &[1.0, 0.7, 0.0, 0.0, 0.0, 1.0]].concat()), "{drift:?}");
    assert_eq!(noises[0], of_state(&own.noises[0]));
    let (drift, noises, correction) = at([0.0, 1.0]);
    assert!(close(&drift, &[0.0, 0.0, 1.0, 0.7, 0.0, 1.0, 0.0, 0.0]), "{drift:?}");
    assert_eq!((&noises[0], &correction), (&vec![0.0; 8], &vec![0.0; 8]));
}

#[test]
fn orders_with_what_is_collected_and_the_twin_of_another_equation() {
    let damped = damped();
    let setup = Setup::at_run_time(&damped, &Heun).unwrap();
    let key = StreamKey { seed: 3, experiment: 7 };
    let sizes = StepSizes { samples: 400, ..StepSizes::new(8, Truncation::none(), key) };
    let smooth = setup.clone().collecting(damped.system(), quantities()[..2].to_vec());
    let strong = strong_order(&smooth, &sizes).unwrap();
    assert_eq!(strong.order(), Some(1.0), "{strong}");
    let all = setup.collecting(damped.system(), quantities());
    let weak = |setup: &Setup<'_>| weak_order(setup, &Above(3, 0.0), &sizes, None).unwrap().limit;
    let limit = weak(&all);
    assert!(matches!(limit, Limit::Consistent { .. }), "{limit:?}");
    let mut other = all.clone();
    let right = all.problem.coefficients;
    other.problem.coefficients = Arc::new(move |t, y| {
        let mut at = right(t, y);
        at.drift[3] += 0.01;
        at
    });
    let limit = weak(&other);
    assert!(matches!(limit, Limit::Inconsistent { .. }), "{limit:?}");
}
