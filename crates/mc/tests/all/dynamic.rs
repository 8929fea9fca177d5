//! Systems whose dimension and number of noises are known at run time only: the same bits as those
//! that the compiler knows, in ladders, tables, studies and expectations.

use std::sync::Arc;

use expectation::{Expect, ExpectSettings};
use mc::{Ladder, Observable, Run, Setup, Simulation, StateFunction, Statistic, View};
use noise::Truncation;
use schemes::Heun;
use study::{Study, StudySettings};
use systems::run_time::{Compiled, Problem};

use crate::{
    ladder::{Body, KEY, body},
    study::{merged, run_part},
};

/// The bits of all states at all times, path by path.
#[derive(Default, Debug, PartialEq)]
struct Bits(Vec<u64>);

impl Statistic for Bits {
    fn observe(&mut self, view: &View<'_>) {
        for run in 0..view.runs() {
            for row in view.state(run) {
                self.0.extend(view.live.paths().map(|p| row[p].to_bits()));
            }
            self.0.push(u64::from(view.clipped[run].0));
        }
    }
    fn merge(&mut self, later: Self) {
        self.0.extend(later.0);
    }
}

const PRODUCT: Observable<3> = Observable { name: "y1 y2", function: |y| y[0] * y[1] };

fn at_run_time(body: &Body) -> Problem {
    let system = Arc::new(Compiled::new(*body.system(), body.y0()));
    Problem::new(system, Arc::new(*body.damping()), body.y0().to_vec(), body.t_end()).unwrap()
}

fn k() -> Truncation {
    Truncation::new(2).unwrap()
}

#[test]
fn ladders_have_the_bits_of_compiled_systems() {
    let one = body();
    let other = at_run_time(&one);
    let bits = |Setup { problem, scheme }: Setup<'_>| {
        let run = |level| Run::new(Arc::clone(&scheme), level);
        let runs = vec![run(0), run(2), Run::swapped(Arc::clone(&scheme), 1)];
        let ladder = Ladder::new(&problem, 32, 2, k(), KEY, runs).unwrap();
        ladder.run(200, Bits::default).statistic
    };
    assert_eq!(bits(Setup::of(&one, &Heun)), bits(Setup::at_run_time(&other, &Heun).unwrap()));
}

#[test]
fn tables_and_expectations_have_the_bits_of_compiled_systems() {
    let one = body();
    let other = at_run_time(&one);
    let tables = |setup| {
        let simulation = Simulation::new(setup, k()).every(3);
        let product = StateFunction::new("y1 y2", |y: [f64; 3]| y[0] * y[1]);
        simulation.observing(product).paths(16, KEY, 5..40).unwrap()
    };
    let run_time = || Setup::at_run_time(&other, &Heun).unwrap();
    assert_eq!(tables(Setup::of(&one, &Heun)), tables(run_time()));
    for random_points in [true, false] {
        let expected = |setup| {
            let settings =
                ExpectSettings { coarsest_steps: 4, random_points, ..Default::default() };
            let expect = Expect::with_scheme(setup).with(settings);
            expect.run(&[&PRODUCT], 0.02).unwrap()
        };
        assert_eq!(expected(Setup::of(&one, &Heun)), expected(run_time()));
    }
}

/// A study, and parts of it: its files do not tell the two systems apart.
#[test]
fn studies_and_their_parts_have_the_bits_of_compiled_systems() {
    let one = body();
    let other = at_run_time(&one);
    let (one, other) = (Setup::of(&one, &Heun), Setup::at_run_time(&other, &Heun).unwrap());
    let settings = StudySettings::new(16, 4, 1000, k(), KEY);
    let [one, other] = [&one, &other].map(|it| Study::new(it, &[PRODUCT], &settings).unwrap());
    let result = one.run();
    assert_eq!(other.run(), result);
    let folder = tempfile::tempdir().unwrap();
    run_part(&one, folder.path(), 1, 2);
    run_part(&other, folder.path(), 2, 2);
    assert_eq!(merged(&other, folder.path()).unwrap(), result);
}
