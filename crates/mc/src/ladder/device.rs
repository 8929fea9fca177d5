//! Paths that a machine beside the processor has advanced.

use std::{
    collections::BTreeMap,
    ops::Range,
    sync::{Arc, Mutex, OnceLock},
};

use nonlin::BlockStatus;
use real::{PathMask, Row, Rows, WIDTH};
use schemes::{Device, Step, Stepper, Task, TaskRun, Trajectories};

use super::{
    Ladder, View,
    driver::{GROUP_PATHS, Tally},
};
use crate::{parallel::locked, parts::Stop};

/// Most bytes of the states of a task.
const MAX_BYTES: usize = 1 << 27;
/// Fewest and most paths of a task: of fewer the processor is sooner done.
const MIN_PATHS: u64 = 1 << 11;
const MAX_PATHS: u64 = 1 << 20;
type Computed = Arc<OnceLock<Option<Trajectories>>>;

/// The paths of a ladder, whose noise is drawn and whose runs are not swapped, on a device:
/// computed ahead of the groups that read them.
pub struct Ahead<'a> {
    pub device: &'a dyn Device,
    /// Results by the first path.
    pub tasks: Mutex<BTreeMap<u64, Computed>>,
}

impl Ahead<'_> {
    /// Shows the states of a group, of all paths that are wanted, at times that are read, as the
    /// ladder does; none if the ladder has to compute it.
    pub fn march(
        &self,
        ladder: &Ladder<'_>,
        (group, all): (Range<u64>, Range<u64>),
        reads: &dyn Fn(u64) -> bool,
        observe: &mut dyn FnMut(&View<'_>),
        progress: &(dyn Fn(u64) + Sync),
        stop: &Stop,
    ) -> Option<Result<Tally, Tally>> {
        if all.end - all.start < self.device.fewest() {
            return None;
        }
        let last = ladder.finest_steps >> ladder.levels;
        let times: Vec<u64> = (1..=last).filter(|&time| reads(time)).collect();
        let rows = ladder.runs.len() * (ladder.problem.y0.len() + 1);
        let fit = MAX_BYTES / (8 * rows * times.len().max(1)) / GROUP_PATHS as usize;
        let size = (fit as u64 * GROUP_PATHS).min(MAX_PATHS);
        if size < MIN_PATHS {
            self.device.refuse("the times at which states are read are too many");
            return None;
        }
        let first = all.start + (group.start - all.start) / size * size;
        let computed = {
            let mut tasks = locked(&self.tasks);
            // Threads read groups in their order, nearly.
            while tasks.len() > rayon::current_num_threads() && !tasks.contains_key(&first) {
                tasks.pop_first();
            }
            Arc::clone(tasks.entry(first).or_default())
        };
        let paths = first..all.end.min(first + size);
        let found = computed.get_or_init(|| self.compute(ladder, paths.clone(), &times, stop));
        if stop.is_asked() {
            return Some(Err(ladder.tally()));
        }
        let found = found.as_ref().filter(|found| group.end <= found.paths.end)?;
        let tally = show(found, ladder, group.clone(), &times, observe)?;
        progress(ladder.steps_per_path() * (group.end - group.start));
        Some(Ok(tally))
    }

    fn compute(
        &self,
        ladder: &Ladder<'_>,
        paths: Range<u64>,
        times: &[u64],
        stop: &Stop,
    ) -> Option<Trajectories> {
        let runs = ladder.runs.iter().enumerate().map(|(number, run)| {
            let batch = ladder.batches.iter().find(|batch| batch.runs.contains(&number));
            let bound = batch.map_or(f64::INFINITY, |batch| batch.bound);
            TaskRun { method: &*run.scheme, level: run.level, bound }
        });
        let blocks = (paths.end - paths.start).div_ceil(WIDTH as u64);
        self.device.advance(&Task {
            runs: runs.collect(),
            dimension: ladder.problem.y0.len(),
            noises: ladder.problem.noises,
            space_time: !ladder.no_noise.space_time.is_empty(),
            finest_steps: ladder.finest_steps,
            levels: ladder.levels,
            tau: ladder.tau(0),
            key: ladder.key,
            paths: paths.start..paths.start + blocks * WIDTH as u64,
            times: times.to_vec(),
            start: &*ladder.start,
            step: &|level, n| ladder.step(level, n),
            stopped: &|| stop.is_asked(),
        })
    }
}

/// States that are shown.
struct Shown(Rows);

impl Stepper for Shown {
    fn state(&self) -> &[Row] {
        &self.0
    }

    fn state_mut(&mut self) -> &mut [Row] {
        &mut self.0
    }

    fn step(&mut self, _: &Step, _: &noise::StepNoise, _: &mut BlockStatus) {
        unreachable!("states that are shown take no step")
    }
}

/// Shows the states of a group; none if a path of it was not solved.
fn show(
    found: &Trajectories,
    ladder: &Ladder<'_>,
    group: Range<u64>,
    times: &[u64],
    observe: &mut dyn FnMut(&View<'_>),
) -> Option<Tally> {
    let count = (found.paths.end - found.paths.start) as usize;
    let [first, end] = [group.start, group.end].map(|path| (path - found.paths.start) as usize);
    if !found.solved[first..end].iter().all(|&solved| solved) {
        return None;
    }
    let (runs, dimension) = (ladder.runs.len(), ladder.problem.y0.len());
    let mut states: Vec<Box<dyn Stepper>> = Vec::new();
    states.resize_with(runs, || Box::new(Shown(Rows::zero(dimension))));
    let mut clipped = vec![PathMask::NONE; runs];
    let blocks: Vec<usize> = (first..end).step_by(WIDTH).collect();
    for time in ladder.from_start.then_some(&0).into_iter().chain(times) {
        let at = times.binary_search(time).unwrap_or_default();
        for &block in &blocks {
            let first_path = found.paths.start + block as u64;
            for (run, state) in states.iter_mut().enumerate() {
                let row = |number: usize| {
                    let row = (at * runs + run) * (dimension + 1) + number;
                    &found.values[row * count + block..][..WIDTH]
                };
                if *time == 0 {
                    state.state_mut().copy_from_slice(&(ladder.start)(run, first_path));
                } else {
                    let rows = state.state_mut().iter_mut().enumerate();
                    rows.for_each(|(i, to)| to.copy_from_slice(row(i)));
                    clipped[run] = PathMask::of(|p| row(dimension)[p] > 0.0);
                }
            }

            observe(&View {
                time: *time,
                first_path,
                states: &states,
                clipped: &clipped,
                random_time: &[0.0; WIDTH],
                live: PathMask::first(end - block),
            });
        }
    }
    let mut tally = ladder.tally();
    for batch in &ladder.batches {
        // All runs of a batch have the same increments.
        let counts = &found.clipped[batch.runs[0] * count..][first..end];
        tally.clipped[batch.level] += counts.iter().sum::<f64>() as u64;
    }
    Some(tally)
}
