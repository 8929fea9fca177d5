//! What a path-step of `heun` costs on the rigid body with three noises and with one, and a study
//! of three observables: nanoseconds on one thread, the least of many runs.
//!
//! ```text
//! cargo run --release -p casimir-mc --example ladder_cost
//! ```

use std::time::Instant;

use mc::{Ladder, Observable, Run, Setup, StudySettings, WorstTimes, bind, study};
use noise::{StreamKey, Truncation};
use schemes::Heun;
use systems::{Constant, PoissonSystem, Problem, RigidBody};

const STEPS: u64 = 512;
const PATHS: u64 = 512;
const REPETITIONS: usize = 400;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let moments = [2.0, 1.0, 2.0 / 3.0];
    let three = RigidBody::three_noises(moments, [1.0, 2.0, 3.0])?;
    let one = RigidBody::one_noise(moments, 1.0)?;
    let y0 = [1.1f64.cos(), 0.0, 1.1f64.sin()];
    let three = Problem::new(three, Constant::new(0.5)?, y0, 1.0)?;
    let one = Problem::new(one, Constant::new(0.5)?, y0, 1.0)?;
    rayon::ThreadPoolBuilder::new().num_threads(1).build_global()?;
    measure("three noises", &three)?;
    measure("one noise", &one)?;
    Ok(())
}

fn measure<S: PoissonSystem<3, M>, const M: usize>(
    name: &str,
    problem: &Problem<S, Constant, 3>,
) -> Result<(), Box<dyn std::error::Error>> {
    let key = StreamKey { seed: 1, experiment: 1 };
    let ladder = |levels: usize, truncation| {
        let runs = (0..=levels).map(|level| Run::new(bind(problem, &Heun), level)).collect();
        Ladder::new(&mc::Problem::of(problem), STEPS, levels, truncation, key, runs)
    };
    for levels in [0, 4] {
        let ladder = ladder(levels, Truncation::new(4)?)?;
        let steps = PATHS * ladder.steps_per_path();
        let new = || WorstTimes::new(Vec::new(), ladder.coarse_steps());
        let time = least(|| assert_eq!(ladder.run(PATHS, new, &|_| ()).failed, 0));
        println!("{name}, {levels} levels: {:.3} ns", 1e9 * time / steps as f64);
    }
    let observables = [
        Observable { name: "y1", function: |y: [f64; 3]| y[0] },
        Observable { name: "y3 squared", function: |y: [f64; 3]| y[2] * y[2] },
        Observable { name: "energy", function: |y: [f64; 3]| y[0] * y[0] + y[1] * y[2] },
    ];
    let settings = StudySettings {
        pilot: 128,
        ..StudySettings::new(STEPS, 64, PATHS, Truncation::none(), key)
    };
    let time = least(|| {
        let result = study(&Setup::of(problem, &Heun), &observables, &settings, &|_| ());
        assert_eq!(result.map(|result| result.losses.failed), Ok(0));
    });
    let steps = STEPS * (PATHS + settings.pilot);
    println!("{name}, study: {:.3} ns", 1e9 * time / steps as f64);
    Ok(())
}

fn least(mut work: impl FnMut()) -> f64 {
    let times = (0..REPETITIONS).map(|_| {
        let start = Instant::now();
        work();
        start.elapsed().as_secs_f64()
    });
    times.fold(f64::INFINITY, f64::min)
}
