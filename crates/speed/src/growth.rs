//! More samples, more steps, more levels: is time linear, is memory flat?

use lab::Compiled;
use mc::Run;
use schemes::Sexp;
use systems::{Problem, RigidBody};

use crate::memory::{forget_peak, peak_memory_mb};
use crate::rows::{ladder, pool, run_once, time_on_one_thread};
use crate::systems_list::{momentum, rigid_body};
use crate::workload::TAU;
use crate::{GrowthRow, SpeedError, Workload};

/// Each of the three is multiplied by this, four times over; levels are counted up instead.
const FACTOR: u64 = 4;
const SIZES: u32 = 5;
/// The most levels: the coarsest of the 256 steps of the full workload must be smaller than one, or
/// truncation is not defined.
const MOST_LEVELS: usize = 6;

/// A size: how many paths of how many steps on how many levels above the finest.
struct Size {
    grows: &'static str,
    value: u64,
    paths: u64,
    steps: u64,
    levels: usize,
}

fn sizes(workload: &Workload) -> Vec<Size> {
    let Workload { paths, steps, .. } = *workload;
    let smallest = |number: u64| number.div_ceil(FACTOR.pow(SIZES - 1));
    let mut sizes = Vec::new();
    for k in 0..SIZES {
        let value = smallest(paths) * FACTOR.pow(k);
        sizes.push(Size { grows: "samples", value, paths: value, steps, levels: 0 });
    }
    // As much work as one of the larger sample sizes, whatever the number of steps.
    for k in 0..SIZES {
        let value = smallest(steps * FACTOR) * FACTOR.pow(k);
        sizes.push(Size {
            grows: "steps",
            value,
            paths: paths.div_ceil(FACTOR * FACTOR),
            steps: value,
            levels: 0,
        });
    }
    let most = MOST_LEVELS.min(steps.trailing_zeros() as usize);
    for levels in (0..=most).step_by(2) {
        sizes.push(Size {
            grows: "levels",
            value: levels as u64,
            paths: paths.div_ceil(FACTOR),
            steps,
            levels,
        });
    }
    sizes
}

pub(crate) fn rows(
    workload: &Workload,
    progress: &(dyn Fn(&str) + Sync),
) -> Result<Vec<GrowthRow>, SpeedError> {
    let one = pool(1)?;
    let sexp = RigidBody::<3>::sexp(Sexp::default());
    let mut rows = Vec::new();
    for Size { grows, value, paths, steps, levels } in sizes(workload) {
        progress(&format!("{value} {grows}"));
        let (body, damping) = rigid_body()?;
        let problem = Problem::new(body, damping, momentum(), steps as f64 * TAU)?;
        let ladder = ladder(
            &problem,
            steps,
            levels,
            (0..=levels).map(|level| Run::new(sexp.as_ref(), level)).collect(),
        )?;
        let path_steps = ladder.steps_per_path() * paths;
        let forgotten = forget_peak();
        one.install(|| run_once(&ladder, paths));
        let peak = if forgotten { peak_memory_mb() } else { None };
        let (times, _) = time_on_one_thread(&one, &ladder, paths, workload.repetitions);
        rows.push(GrowthRow {
            grows: grows.to_owned(),
            value,
            path_steps,
            ns_per_path_step: times.thread.scaled(1e9 / path_steps as f64),
            peak_memory_mb: peak,
        });
    }
    Ok(rows)
}
