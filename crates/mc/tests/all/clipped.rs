//! Increments that are clipped, and such as are no numbers; streams that are those of others.

use std::sync::Arc;

use mc::{
    Along, Ladder, LadderError, Observe, Passage, Problem, Run, Setup, Simulation, Statistic, View,
    bind,
};
use noise::{StepNoise, StreamKey, Truncation};
use real::{PathMask, Row};
use schemes::Sexp;
use systems::{Constant, Pendulum, run_time::Compiled};

const KEY: StreamKey = StreamKey { seed: 1, experiment: 0 };

fn pendulum(t_end: f64) -> systems::Problem<Pendulum, Constant, 2> {
    let (system, damping) = (Pendulum::new(1.0).unwrap(), Constant::new(0.0).unwrap());
    systems::Problem::new(system, damping, [1.0, 0.0], t_end).unwrap()
}

/// Of paths that end at a positive angle after a clipped increment: all, and those that passed.
#[derive(Default)]
struct Clipped([u64; 2]);

impl Statistic for Clipped {
    fn observe(&mut self, view: &View<'_>) {
        let state = view.state(0);
        let up = view.clipped[0].and(view.live).paths().filter(|&p| state[1][p] > 0.0);
        up.for_each(|p| {
            self.0[0] += 1;
            self.0[1] += u64::from(state.get(2).is_some_and(|crossed| crossed[p] > 0.0));
        });
    }
    fn merge(&mut self, later: Self) {
        (0..2).for_each(|n| self.0[n] += later.0[n]);
    }
}

/// The angle beyond 1.14, of states with or without what is collected.
struct Beyond;

impl Observe for Beyond {
    fn name(&self) -> &str {
        "φ"
    }
    fn evaluate(&self, state: &[Row], _: PathMask, values: &mut Row) {
        *values = state[1].map(|angle| angle - 1.14);
    }
}

#[test]
fn paths_with_increments_that_are_no_numbers_fail() {
    let problem = pendulum(1.0);
    let runs = vec![Run::new(bind(&problem, &Sexp), 0)];
    let on = Problem::of(&problem);
    let ladder = Ladder::new(&on, 8, 0, Truncation::new(4).unwrap(), KEY, runs).unwrap();
    let wrong = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY];
    let ladder = ladder.with_noise(move |first| {
        Box::new(move |noise: &mut StepNoise| {
            noise.increments[0].fill(0.01);
            if first == 32 {
                noise.increments[0][..3].copy_from_slice(&wrong);
            }
        })
    });
    let measured = ladder.run(96, Clipped::default);
    assert_eq!(
        (measured.failed, &measured.clipped[..], measured.statistic.0),
        (3, &[0][..], [0; 2])
    );
    let mut failed: Vec<u64> = measured.failures.iter().map(|failure| failure.path).collect();
    failed.sort_unstable();
    assert_eq!(failed, [32, 33, 34]);
}

/// One step of size ½ with A = 1.18, so that 12 % of the paths have the same largest increment.
/// They pass the angle 1.14 within the step with the probability exp(−2ab/sτ) ≈ ½ each, where the
/// angle is a below it at first, b at the end, and s = 1. The share of 4096·0.12 paths has the
/// deviation 0.023.
#[test]
fn clipped_paths_pass_independently() {
    let problem = pendulum(0.5);
    let system = Compiled::new(Pendulum::new(1.0).unwrap(), problem.y0());
    let gradient = |_: &[Row], out: &mut [Row]| out[1].fill(1.0);
    let (phi, gradient) = (Arc::new(Beyond), Some(Arc::new(gradient) as _));
    let passage = Along::Passage(Passage { phi, gradient, stops: false });
    let setup = Setup::of(&problem, &Sexp).collecting(&system, vec![passage]);
    let runs = vec![Run::new(setup.scheme, 0)];
    let truncation = Truncation::new(1).unwrap();
    let on = Problem::of(&problem);
    let ladder = Ladder::new(&on, 1, 0, truncation, KEY, runs).unwrap();
    let [all, passed] = ladder.run(4096, Clipped::default).statistic.0;
    let share = passed as f64 / all as f64;
    assert!((400..600).contains(&all) && (0.35..0.65).contains(&share), "{passed} of {all}");
}

#[test]
fn experiments_with_the_streams_of_something_else_are_refused() {
    let (problem, truncation) = (pendulum(1.0), Truncation::new(4).unwrap());
    let on = Problem::of(&problem);
    // Those of areas, and of the check of steps.
    for experiment in [1 << 62, 1 << 46] {
        let key = StreamKey { seed: 1, experiment };
        let runs = vec![Run::new(bind(&problem, &Sexp), 0)];
        let ladder = Ladder::new(&on, 8, 0, truncation, key, runs).err();
        assert!(matches!(ladder, Some(LadderError::Noise(_))), "{ladder:?}");
        let simulation = Simulation::new(Setup::of(&problem, &Sexp), truncation);
        let error = simulation.paths(8, key, 0..1).unwrap_err().to_string();
        assert!(error.contains("experiment number must be below 2^40"), "{error}");
    }
}
