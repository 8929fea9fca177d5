//! Schemes on a dyadic ladder of steps.

mod device;
pub mod driver;

use std::{
    ops::Range,
    sync::{Arc, Mutex, OnceLock},
};

use noise::{Purpose, StepNoise, StreamKey, Truncation};
use real::{PathMask, Row, WIDTH, exactly, path};
use schemes::{About, StepError, Stepper};
use serde::{Serialize, de::DeserializeOwned};

use crate::{
    LadderError, PathFailure, Problem, Run, Setup, demand,
    parallel::grow,
    parts::{Job, Stop, Work, hash},
    tree::{MergeTree, Node},
};
use device::Ahead;
use driver::{
    Batch, Failed, GROUP_BLOCKS, GROUP_PATHS, NextNoise, NoiseSource, StepTable, Tally, drawn,
    step_table,
};

/// The state of all runs on one block at the end of a coarsest step, a time of all levels.
#[derive(Clone, Copy)]
pub struct View<'a> {
    /// Number of coarsest steps done, at least 1.
    pub time: u64,
    /// Number of the first path of the block.
    pub first_path: u64,
    /// The states of the runs.
    pub states: &'a [Box<dyn Stepper + 'a>],
    /// Paths with a clipped increment so far, for each run.
    pub clipped: &'a [PathMask],
    /// The random time of each path by the [`TimeChange`] of the ladder; zero without one.
    pub random_time: &'a Row,
    /// The paths that exist and have not failed. Only these may enter a statistic.
    pub live: PathMask,
}

impl<'a> View<'a> {
    /// Number of runs.
    pub fn runs(&self) -> usize {
        self.states.len()
    }

    /// The states of a run; row i is component i of 32 paths.
    pub fn state(&self, run: usize) -> &'a [Row] {
        self.states[run].state()
    }

    /// The state of path `p` < 32 of a run.
    ///
    /// # Panics
    /// Unless D is the dimension.
    pub fn path<const D: usize>(&self, run: usize, p: usize) -> [f64; D] {
        path(exactly(self.state(run)), p)
    }
}

/// An accumulator of results over paths, for example a mean.
pub trait Statistic: Send {
    /// Adds one block at one time.
    fn observe(&mut self, view: &View<'_>);
    /// Whether it reads the states after a coarsest step.
    fn reads(&self, _time: u64) -> bool {
        true
    }
    /// Adds the results of `later` paths.
    fn merge(&mut self, later: Self);
}

/// Several statistics of the same paths.
impl<T: Statistic> Statistic for Vec<T> {
    fn observe(&mut self, view: &View<'_>) {
        self.iter_mut().for_each(|statistic| statistic.observe(view));
    }

    fn reads(&self, time: u64) -> bool {
        self.iter().any(|statistic| statistic.reads(time))
    }

    fn merge(&mut self, later: Self) {
        self.iter_mut().zip(later).for_each(|(sum, more)| sum.merge(more));
    }
}

/// A statistic whose sums can be written to a file and read back, so that it can be computed in
/// parts, see [`parts`](crate::parts).
pub trait Kept: Statistic {
    /// The sums that are written and read back. Everything else, such as observables, is in a new
    /// statistic already. Every field must be serialized: one that is skipped is lost silently.
    type Sums: Serialize + DeserializeOwned;
    /// The sums so far.
    fn sums(&self) -> &Self::Sums;
    /// The sums so far, as a place for others.
    fn sums_mut(&mut self) -> &mut Self::Sums;

    /// Identity of the statistic beside its sums, such as bins, as a hash or text; and some of the
    /// times up to `last` at which it adds something: the first and the last unless said otherwise.
    fn fixed(&self, last: u64) -> (String, Vec<u64>) {
        (String::new(), vec![1, last])
    }
}

/// A random time change along each path, driven by the untruncated increments of the finest steps.
/// The exact solution of a system with one Hamiltonian is the deterministic flow at such a time.
pub trait TimeChange: Send + Sync {
    /// Advances the random time of 32 paths over finest step number n ≥ 0 with increments `dw`, a
    /// row for each noise. `normals` are independent standard normals, for example for the part of
    /// the random time that the increments do not determine.
    fn advance(&self, n: u64, dw: &[Row], normals: &Row, random_time: &mut Row);
}

/// Several runs, each a scheme at a step size, on a dyadic ladder of steps with the same noise.
pub struct Ladder<'a> {
    problem: Problem<'a>,
    /// Function from the number of a run and of the first path of a block to its states at time 0.
    start: Box<dyn Fn(usize, u64) -> Vec<Row> + Sync + 'a>,
    /// Whether statistics see the states at time 0.
    from_start: bool,
    finest_steps: u64,
    levels: usize,
    key: StreamKey,
    noise: NoiseSource<'a>,
    /// Zero increments of all noises, with the zero areas that schemes read.
    no_noise: StepNoise,
    runs: Vec<Run<'a>>,
    batches: Vec<Batch>,
    time_change: Option<&'a dyn TimeChange>,
    described_failures: usize,
    steps: StepTable,
    /// The paths on a device, if there is one for them.
    ahead: Option<Ahead<'a>>,
    /// Bytes of stack for a group.
    stack: usize,
    pub(crate) progress: Box<dyn Fn(u64) + Sync + 'a>,
}

/// The sums of some paths.
pub type Sum<T> = (T, Tally);
/// The sums of a piece of work, on the largest subtrees that it covers.
pub type Nodes<T> = Vec<Node<Sum<T>>>;
/// Callback that sees the nodes and the next group, and says whether to go on.
pub type After<'a, T> = dyn FnMut(&[Node<Sum<T>>], u64) -> bool + 'a;

/// The results of a ladder.
#[derive(Clone, Debug)]
pub struct Measured<T> {
    /// The statistic over all paths.
    pub statistic: T,
    /// Number of failed paths.
    pub failed: u64,
    /// The first failed paths, see [`Ladder::describing`].
    pub failures: Vec<PathFailure>,
    /// Number of clipped increments on each level, counted on paths that have not failed. Zero for
    /// levels without a run that is not swapped.
    pub clipped: Vec<u64>,
}

/// Number of rows of a run on a block for each component: its state, and those that a step needs.
const STATES: usize = 16;
/// Default number of failures that are described.
const DESCRIBED_FAILURES: usize = 8;
/// Number of paths whose statistics are in a fingerprint, and of coarse steps of its states.
const PROBES: u64 = 4;
const PROBE_STEPS: u64 = 16;

impl<'a> Ladder<'a> {
    /// A ladder with `finest_steps` steps on [0, T] at level 0 and `levels` levels above it, for
    /// schemes on the system of `problem`. The noise is drawn from the streams of `key`.
    ///
    /// If a scheme reads Lévy areas, they are drawn on the finest steps by the method of Mrongowius
    /// and Rößler (2022) with an error of at most τ^{3/2}, as strong order 1 requires. Chen's
    /// relation gives the areas of coarser steps. The covariance of the drawn areas given the
    /// increments is exact for any number of terms, so it is the same for all levels.
    ///
    /// # Errors
    /// - [`LadderError::Steps`] unless `finest_steps` is a positive multiple of 2^`levels`.
    /// - [`LadderError::Level`] if a run is on a level that does not exist. A swapped run needs the
    ///   level above its own.
    /// - [`LadderError::Noise`] if the number of the experiment is not below 2⁴⁰, if the truncation
    ///   is undefined at a step size, or if the areas need too many terms.
    /// - [`LadderError::Step`] if the finest step underflows.
    pub fn new(
        problem: &Problem<'a>,
        finest_steps: u64,
        levels: usize,
        truncation: Truncation,
        key: StreamKey,
        runs: Vec<Run<'a>>,
    ) -> Result<Self, LadderError> {
        Self::of(problem, finest_steps, levels, truncation, (key, Purpose::Paths), runs)
    }

    /// A ladder as by [`new`](Self::new), with another family of paths of the experiment.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn of(
        problem: &Problem<'a>,
        finest_steps: u64,
        levels: usize,
        truncation: Truncation,
        (key, family): (StreamKey, Purpose),
        runs: Vec<Run<'a>>,
    ) -> Result<Self, LadderError> {
        let key = key.paths_of(family)?;
        let coarsest = 1u64.checked_shl(levels as u32).unwrap_or(u64::MAX);
        if finest_steps == 0 || !finest_steps.is_multiple_of(coarsest) {
            return Err(LadderError::Steps { steps: finest_steps, multiple_of: coarsest });
        }
        // The finest step may underflow.
        let finest = problem.t_end / finest_steps as f64;
        if !(finest > 0.0 && finest.is_finite()) {
            return Err(StepError { tau: finest }.into());
        }
        let reads = |of: fn(&About) -> bool| runs.iter().any(|run| of(&run.scheme.about()));
        let with_areas = reads(|about| about.reads_areas);
        let none = StepNoise::none(problem.noises, with_areas);
        let with_space_time = reads(|about| about.reads_space_time);
        let same = problem.clone();
        let mut ladder = Self {
            problem: problem.clone(),
            start: Box::new(move |_, first| same.start(key, first)),
            from_start: false,

            finest_steps,
            levels,
            key,
            noise: drawn(key, finest, with_areas.then_some(problem.noises))?,
            no_noise: if with_space_time { none.with_space_time() } else { none },
            runs: Vec::new(),
            batches: Vec::new(),
            time_change: None,
            described_failures: DESCRIBED_FAILURES,
            steps: step_table(finest_steps, levels),
            ahead: None,
            stack: runs.iter().map(|run| run.scheme.about().stack).max().unwrap_or(0),
            progress: Box::new(|_| ()),
        };
        for (number, &Run { ref scheme, level, swapped }) in runs.iter().enumerate() {
            if level + usize::from(swapped) > levels {
                return Err(LadderError::Level { level, swapped, levels });
            }
            let tau = ladder.tau(level);
            let truncation =
                if scheme.about().clips_increments { truncation } else { Truncation::none() };
            let (bound, area_bound) = (truncation.bound(tau)?, truncation.area_bound(tau)?);
            let same = |batch: &&mut Batch| {
                (batch.level, batch.swapped, batch.bound) == (level, swapped, bound)
            };
            match ladder.batches.iter_mut().find(same) {
                Some(batch) => batch.runs.push(number),
                None => {
                    let is_finest = level == 0 && !swapped && !with_areas;
                    let as_drawn = is_finest && bound == f64::INFINITY;
                    let runs = vec![number];
                    let new = Batch { level, swapped, bound, area_bound, as_drawn, runs };
                    ladder.batches.push(new);
                }
            }
        }
        // This order decides which failure is described first.
        ladder.batches.sort_by_key(|batch| (batch.due_level(), batch.swapped));
        let ahead = problem.device.filter(|device| {
            let fits = !with_areas && !runs.iter().any(|run| run.swapped);
            if !fits {
                device.refuse("it takes no Levy areas and no antithetic paths");
            }
            fits
        });
        ladder.ahead = ahead.map(|device| Ahead { device, tasks: Mutex::default() });
        ladder.runs = runs;
        Ok(ladder)
    }

    /// Refuses to run `paths` paths if their states take more memory than is free.
    ///
    /// # Errors
    /// [`LadderError::Memory`].
    pub fn fitting(self, paths: u64) -> Result<Self, LadderError> {
        let most = (GROUP_BLOCKS * rayon::current_num_threads()) as u64;
        let blocks = most.min(paths.div_ceil(WIDTH as u64));
        let dimension = self.problem.y0.len();
        let rows = STATES * dimension * self.runs.len() + self.problem.noises * (self.levels + 3);
        let what = format!(
            "{} paths at a time with {dimension} components (fewer of both, or threads, take less)",
            blocks * WIDTH as u64
        );
        demand(what, (rows * size_of::<Row>()) as f64 * blocks as f64)?;
        Ok(self)
    }

    /// Computes a random time along each path, see [`TimeChange`].
    #[must_use]
    pub fn with_time_change(mut self, time_change: &'a dyn TimeChange) -> Self {
        self.leave_device();
        self.time_change = Some(time_change);
        self
    }

    /// Takes the noise of the finest steps from `source` instead of drawing it: a
    /// [`NoiseSource`](crate::NoiseSource).
    #[must_use]
    pub fn with_noise(mut self, source: impl Fn(u64) -> NextNoise + Sync + 'a) -> Self {
        self.noise = Box::new(source);
        self.leave_device();
        self
    }

    /// Leaves the paths to the processor.
    fn leave_device(&mut self) {
        if let Some(ahead) = self.ahead.take() {
            ahead.device.refuse("its noise is made here, as points of Sobol are");
        }
    }

    /// Multiplies the noise of each path by a factor.
    pub fn heated(mut self, factor: impl Fn(u64) -> f64 + Sync + 'a) -> Self {
        let drawn = std::mem::replace(&mut self.noise, Box::new(|_| Box::new(|_| ())));
        self.with_noise(move |first| {
            let mut next = drawn(first);
            let factors: Row = std::array::from_fn(|p| factor(first + p as u64));
            let squares = factors.map(|factor| factor * factor);
            Box::new(move |noise| {
                next(noise);
                let StepNoise { increments, areas, space_time, .. } = noise;
                for (rows, factors) in
                    [(increments, factors), (areas, squares), (space_time, factors)]
                {
                    for row in rows.iter_mut() {
                        row.iter_mut().zip(factors).for_each(|(x, factor)| *x *= factor);
                    }
                }
            })
        })
    }

    /// Starts each run on each block at the states that `start` gives for the run and the first
    /// path.
    pub fn starting(mut self, start: impl Fn(usize, u64) -> Vec<Row> + Sync + 'a) -> Self {
        self.start = Box::new(start);
        self
    }

    /// Shows statistics also the states at time 0.
    pub fn with_start(mut self) -> Self {
        self.from_start = true;
        self
    }

    /// Describes the first `failures` failed paths in [`Measured::failures`]; eight by default.
    #[must_use]
    pub fn describing(mut self, failures: usize) -> Self {
        self.described_failures = failures;
        self
    }

    /// Calls `progress` from any thread with the number of path-steps done since its last call.
    #[must_use]
    pub fn telling(mut self, progress: impl Fn(u64) + Sync + 'a) -> Self {
        self.progress = Box::new(progress);
        self
    }

    /// The step size of a level.
    pub fn tau(&self, level: usize) -> f64 {
        self.problem.t_end * (1u64 << level) as f64 / self.finest_steps as f64
    }

    /// Number of coarsest steps: the number of times at which a statistic observes each block.
    pub fn coarse_steps(&self) -> u64 {
        self.finest_steps >> self.levels
    }

    /// Whether paths advance on the threads of the current rayon pool. In dimensions whose steps
    /// need a larger stack they advance on threads of their own.
    pub fn runs_on_pool(&self) -> bool {
        self.stack <= USUAL_STACK
    }

    /// Number of steps of one path in all runs together. Progress is counted in these steps.
    pub fn steps_per_path(&self) -> u64 {
        self.steps_done(self.finest_steps)
    }

    /// Number of steps of one path in all runs together within the first `n` finest steps.
    fn steps_done(&self, n: u64) -> u64 {
        self.runs.iter().map(|run| n >> run.level).sum()
    }

    /// Advances the paths 0 to `samples` − 1 in parallel on the current rayon pool. The results are
    /// the same bits for any number of threads.
    ///
    /// `new` creates an empty statistic.
    ///
    /// # Panics
    /// If a thread with a larger stack cannot be started, see [`runs_on_pool`](Self::runs_on_pool).
    pub fn run<T: Statistic>(&self, samples: u64, new: impl Fn() -> T + Sync) -> Measured<T> {
        self.run_until(&Stop::default(), 0, samples, new)
    }

    /// Advances `samples` paths from path number `first` on, like [`run`](Self::run). They end
    /// where `stop` asks for the end: the sums are then those of some paths.
    ///
    /// # Panics
    /// As [`run`](Self::run).
    pub fn run_until<T: Statistic>(
        &self,
        stop: &Stop,
        first: u64,
        samples: u64,
        new: impl Fn() -> T + Sync,
    ) -> Measured<T> {
        let compute = |group| {
            if stop.is_asked() {
                return None;
            }
            let (start, all) = (first + group * GROUP_PATHS, first..first + samples);
            let (statistic, tally) = self.group(start, all, &new, stop);
            Some((statistic, tally.unwrap_or_else(|cut_short| cut_short)))
        };
        let mut tree = MergeTree::new(merge);
        grow(&mut tree, 0..samples.div_ceil(GROUP_PATHS), &compute, &mut |_, _| true);
        self.measured(tree.finish(), &new)
    }

    /// Advances `samples` paths, like [`run`](Self::run), as a piece of work of a job: whole, in
    /// parts or merged. `None` if the results are not here, because this job computes a part, or
    /// parts are missing, or an error was met; [`Job::finish`] says which. The bits are those of
    /// `run`.
    ///
    /// `name` is unique in the program. It names the work in files.
    ///
    /// # Panics
    /// As [`run`](Self::run).
    pub fn run_in<T: Kept>(
        &self,
        job: &Job,
        name: &str,
        samples: u64,
        new: impl Fn() -> T + Sync,
    ) -> Option<Measured<T>> {
        self.run_in_until(job, job.stop(), name, samples, new)
    }

    /// Works like [`run_in`](Self::run_in) until `stop` asks for the end, which may be before that
    /// of the job: the sums are then those of some paths, if the job
    /// [gives](Job::giving_what_is_done) them.
    ///
    /// # Panics
    /// As [`run`](Self::run).
    pub fn run_in_until<T: Kept>(
        &self,
        job: &Job,
        stop: &Stop,
        name: &str,
        samples: u64,
        new: impl Fn() -> T + Sync,
    ) -> Option<Measured<T>> {
        let study = OnceLock::new();
        let work = Work { name, paths: samples, ladder: self, study, new: &new, stop };
        let mut tree = MergeTree::new(merge);
        tree.extend(job.collect(work)?);
        Some(self.measured(tree.finish(), &new))
    }

    /// Computes the nodes of `groups` of paths before path number `paths`; fewer if it is stopped.
    pub fn nodes<T: Statistic>(
        &self,
        stop: &Stop,
        paths: u64,
        groups: Range<u64>,
        new: &(dyn Fn() -> T + Sync),
    ) -> Nodes<T> {
        let mut tree = MergeTree::new(merge);
        self.grow(&mut tree, (paths, groups), new, stop, &mut |_, _| true);
        tree.nodes
    }

    /// Adds the sums of groups before path number `paths` to a tree. `after` sees the nodes and the
    /// next group now and then, and says whether to go on. Returns the first group that is not
    /// computed.
    pub(crate) fn grow<T: Statistic>(
        &self,
        tree: &mut MergeTree<Sum<T>>,
        (paths, groups): (u64, Range<u64>),
        new: &(dyn Fn() -> T + Sync),
        stop: &Stop,
        after: &mut After<'_, T>,
    ) -> u64 {
        let all = groups.start * GROUP_PATHS..paths.min(groups.end * GROUP_PATHS);
        let compute = |group| {
            let (statistic, tally) = self.group(group * GROUP_PATHS, all.clone(), new, stop);
            tally.ok().map(|tally| (statistic, tally))
        };
        grow(tree, groups, &compute, after)
    }

    /// Joins the nodes that are halves of one, and returns the sum of all.
    pub fn join<T: Statistic + Clone>(
        &self,
        nodes: &mut Nodes<T>,
        new: &dyn Fn() -> T,
    ) -> Measured<T> {
        let mut tree = MergeTree::new(merge);
        tree.extend(nodes.drain(..));
        nodes.extend_from_slice(&tree.nodes);
        self.measured(tree.finish(), new)
    }

    /// The statistic of the group of paths from path number `start` on, of `all` that are wanted;
    /// `Err` with the counts if `stop` cut it short.
    fn group<T: Statistic>(
        &self,
        start: u64,
        all: Range<u64>,
        new: &dyn Fn() -> T,
        stop: &Stop,
    ) -> (T, Result<Tally, Tally>) {
        let paths = GROUP_PATHS.min(all.end - start);
        let (mut statistic, progress) = (new(), &*self.progress);
        let mut observe = |view: &View<'_>| statistic.observe(view);
        let shown = self.ahead.as_ref().and_then(|ahead| {
            let (reader, paths) = (new(), (start..start + paths, all));
            let reads = |time| reader.reads(time);
            ahead.march(self, paths, &reads, &mut observe, progress, stop)
        });
        let computed = || self.march(start, paths, &mut observe, progress, stop);
        let tally = shown.unwrap_or_else(|| on_stack(self.stack, computed));
        (statistic, tally)
    }

    /// The sums over no path.
    pub(crate) fn nothing<T>(&self, new: &dyn Fn() -> T) -> Sum<T> {
        (new(), self.tally())
    }

    fn measured<T>(&self, sum: Option<Sum<T>>, new: &dyn Fn() -> T) -> Measured<T> {
        let (statistic, tally) = sum.unwrap_or_else(|| self.nothing(new));
        let failure = |&Failed { run, path, step, cause }: &Failed| {
            let Run { ref scheme, level, swapped } = self.runs[run];
            let (scheme, key, tau) = (scheme.about().id, self.key, self.tau(level));
            PathFailure { path, key, scheme, swapped, tau, step, cause }
        };
        let Tally { failed, failures, clipped, .. } = tally;
        Measured { statistic, failed, failures: failures.iter().map(failure).collect(), clipped }
    }

    /// A hash that tells this ladder and a statistic from others: of the key, the damping, and what
    /// they give in the first steps of a block, so that a long path costs no more. Names would not
    /// tell: a changed constant in a formula has the same name.
    pub(crate) fn fingerprint<T: Kept>(&self, new: &dyn Fn() -> T) -> String {
        let Self { problem, finest_steps, levels, runs, batches, key, .. } = self;
        let (fixed, times) = new().fixed(self.coarse_steps());
        // One path at a time: a sum over many would hide small differences.
        let mut statistics: Vec<T> = (0..PROBES).map(|_| new()).collect();
        let (mut states, stop) = (Vec::new(), Stop::default());
        let last = self.coarse_steps().min(PROBE_STEPS);
        let mut observe = |view: &View<'_>| {
            for state in (0..view.runs()).map(|run| view.state(run)) {
                states.extend(view.live.paths().flat_map(|p| state.iter().map(move |row| row[p])));
            }
            if view.time < last {
                return;
            }
            for (p, statistic) in statistics.iter_mut().enumerate() {
                let live = view.live.and(PathMask(1 << p));
                times.iter().for_each(|&time| statistic.observe(&View { time, live, ..*view }));
            }
            stop.now();
        };
        // It is stopped, or at its end.
        _ = on_stack(self.stack, || self.march(0, WIDTH as u64, &mut observe, &|_| (), &stop));
        // NaN has many forms, and any is as good as another.
        let one_nan = |x: f64| if x.is_nan() { f64::NAN } else { x };
        let time = |n: u32| problem.t_end * f64::from(n) / 16.0;
        let damping = problem.dampings().flat_map(|damping| {
            let at = |n| [damping.rate(time(n)), damping.integral(time(n), time(n + 1))];
            (0..16).map(move |n| at(n).map(one_nan))
        });
        let bounds = batches.iter().map(|batch| [batch.bound, batch.area_bound]);
        let schemes = runs.iter().map(|run| (run.scheme.about().id, run.level, run.swapped));
        hash(&(
            (key.seed, key.experiment, finest_steps, levels, states),
            (damping.collect::<Vec<_>>(), bounds.collect::<Vec<_>>(), schemes.collect::<Vec<_>>()),
            (fixed, statistics.iter().map(|one| hash(one.sums())).collect::<Vec<_>>()),
        ))
    }
}

impl<'a> Setup<'a> {
    /// The scheme on a ladder with a run for each level from `levels` to 0, for `paths` paths.
    ///
    /// # Errors
    /// As [`Ladder::new`]; and [`LadderError::Memory`] where the states of the paths take more
    /// memory than there is.
    pub fn ladder(
        &self,
        steps: u64,
        levels: usize,
        truncation: Truncation,
        family: (StreamKey, Purpose),
        paths: u64,
    ) -> Result<Ladder<'a>, LadderError> {
        let run = |level| Run::new(Arc::clone(&self.scheme), level);
        let runs = (0..=levels).rev().map(run).collect();
        Ladder::of(&self.problem, steps, levels, truncation, family, runs)?.fitting(paths)
    }
}

/// Merges statistics and tallies.
pub fn merge<T: Statistic>(sum: &mut Sum<T>, later: Sum<T>) {
    sum.0.merge(later.0);
    sum.1.merge(later.1);
}

/// The part of the stack of a thread of rayon, two megabytes, that steps may use.
const USUAL_STACK: usize = 1 << 20;

/// Calls `work` on this thread, or on a thread of its own if it needs a larger stack.
fn on_stack<R: Send>(stack: usize, work: impl FnOnce() -> R + Send) -> R {
    if stack <= USUAL_STACK {
        return work();
    }
    std::thread::scope(|scope| {
        let thread = std::thread::Builder::new().stack_size(stack).spawn_scoped(scope, work);
        let thread = thread.unwrap_or_else(|error| {
            panic!("cannot start a thread with a stack of {stack} bytes: {error}")
        });
        thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    })
}
