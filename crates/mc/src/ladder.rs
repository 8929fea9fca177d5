//! Schemes on a dyadic ladder of steps.

use noise::{StreamKey, Truncation};
use real::{Block, PathMask};
use schemes::{Scheme, StepError};
use systems::{Damping, PoissonSystem, Problem};

use crate::driver::{Batch, BoundScheme, Bounds, Driver, DriverRun, GROUP_PATHS, Tally};
use crate::noise_source::Drawn;
use crate::parallel::in_parallel;
use crate::tree::MergeTree;
use crate::{LadderError, NoiseSource, PathFailure};

/// A scheme on a level: steps of 2^level finest steps.
pub struct Run<'a, S, const D: usize, const M: usize> {
    /// The scheme.
    pub scheme: &'a dyn Scheme<S, D, M>,
    /// The level; 0 is the finest.
    pub level: usize,
    /// Whether the two increments of every step of the level above are exchanged: the antithetic
    /// twin (Giles and Szpruch 2014), which has the same law and the same coarse path.
    pub swapped: bool,
}

impl<'a, S, const D: usize, const M: usize> Run<'a, S, D, M> {
    /// The scheme on the increments as they come.
    #[must_use]
    pub fn new(scheme: &'a dyn Scheme<S, D, M>, level: usize) -> Self {
        Self { scheme, level, swapped: false }
    }

    /// The scheme on exchanged increments.
    #[must_use]
    pub fn swapped(scheme: &'a dyn Scheme<S, D, M>, level: usize) -> Self {
        Self { scheme, level, swapped: true }
    }
}

/// A block as a [`Statistic`] sees it at the end of a coarsest step, where all levels meet.
#[derive(Clone, Copy, Debug)]
pub struct View<'a, const D: usize> {
    /// Number of the coarse time; 1 is the end of the first coarse step.
    pub time: u64,
    /// Number of the block's first path.
    pub first_path: u64,
    /// The state of each run.
    pub states: &'a [Block<D>],
    /// How the last step of each run was solved.
    pub statuses: &'a [nonlin::BlockStatus],
    /// For each run the paths of which an increment has been clipped so far.
    pub clipped: &'a [PathMask],
    /// What the [`TimeChange`] of the ladder has reached; zero without one.
    pub random_time: &'a Block<1>,
    /// The paths that count.
    pub live: PathMask,
}

/// What is kept of the paths.
pub trait Statistic<const D: usize>: Send {
    /// Folds in one block.
    fn observe(&mut self, view: &View<'_, D>);
    /// Adds what `later` has seen.
    fn merge(&mut self, later: Self);
}

/// A random time that is carried along each path, driven by the untruncated finest increments: the
/// exact solution of a one-noise system is the deterministic flow at such a time.
pub trait TimeChange<const M: usize>: Send + Sync {
    /// Advances the random time of a block over finest step number n (from 0) with its increments.
    /// `normals` are standard normals of their own stream, for what the increments do not
    /// determine.
    fn advance(&self, n: u64, dw: &Block<M>, normals: &Block<1>, random_time: &mut Block<1>);
}

/// Schemes on a dyadic ladder of steps, driven by one noise. Checked at construction.
pub struct Ladder<'a, const D: usize, const M: usize> {
    driver: Driver<'a, D, M>,
    /// Bytes of stack that a group needs.
    stack: usize,
}

/// What a ladder measured.
#[derive(Clone, Debug)]
pub struct Measured<T> {
    /// What was kept of the paths.
    pub statistic: T,
    /// How many paths were left out.
    pub failed: u64,
    /// The first few of them.
    pub failures: Vec<PathFailure>,
    /// How many increments were clipped on each level, on the paths that count; of levels with
    /// plain runs only.
    pub clipped: Vec<u64>,
}

/// Failures that are described one by one; the rest are counted.
const DESCRIBED_FAILURES: usize = 8;
/// Groups in flight for each thread: enough that no thread waits long for the last one of a wave.
const GROUPS_PER_THREAD: usize = 8;

impl<'a, const D: usize, const M: usize> Ladder<'a, D, M> {
    /// `finest_steps` steps on [0, T] at level 0, and `levels` levels above.
    ///
    /// Where a scheme reads Lévy areas they are drawn on the finest steps after Mrongowius and
    /// Rößler, with an error of no more than τ^{3/2} as strong order 1 asks, and joined to coarser
    /// steps by Chen's relation. With their tail the areas have the right covariance given the
    /// increments for any number of terms, so that areas drawn at a step and areas joined from
    /// finer steps agree in it.
    ///
    /// # Errors
    /// [`LadderError`] when the steps are no positive multiple of the coarsest step, when a run is
    /// on a level that does not exist (a swapped run needs a level above its own), when the
    /// truncation is not defined at one of the step sizes in use, or when T is so small that the
    /// finest step underflows.
    pub fn new<S: PoissonSystem<D, M>, G: Damping>(
        problem: &'a Problem<S, G, D>,
        finest_steps: u64,
        levels: usize,
        truncation: Truncation,
        key: StreamKey,
        runs: Vec<Run<'a, S, D, M>>,
    ) -> Result<Self, LadderError> {
        let coarsest = 1u64.checked_shl(levels as u32).unwrap_or(u64::MAX);
        if finest_steps == 0 || !finest_steps.is_multiple_of(coarsest) {
            return Err(LadderError::Steps { steps: finest_steps, multiple_of: coarsest });
        }
        // A final time next to the smallest number has no finer steps.
        let finest = problem.t_end / finest_steps as f64;
        if finest <= 0.0 {
            return Err(LadderError::Step(StepError::Size { tau: finest }));
        }
        let mut driver = Driver {
            damping: &problem.damping,
            y0: problem.y0,
            t_end: problem.t_end,
            finest_steps,
            levels,
            key,
            noise: Box::new(Drawn::new::<M>(
                key,
                finest,
                runs.iter().any(|run| run.scheme.reads_areas()),
            )?),
            joins_areas: runs.iter().any(|run| run.scheme.reads_areas()),
            runs: Vec::with_capacity(runs.len()),
            batches: Vec::new(),
            time_change: None,
            described_failures: DESCRIBED_FAILURES,
        };
        for run in runs {
            if run.level + usize::from(run.swapped) > levels {
                let Run { level, swapped, .. } = run;
                return Err(LadderError::Level { level, swapped, levels });
            }
            let bounds = if run.scheme.clips_increments() {
                let tau = driver.tau(run.level);
                Bounds { increment: truncation.bound(tau)?, area: truncation.area_bound(tau)? }
            } else {
                Bounds { increment: f64::INFINITY, area: f64::INFINITY }
            };
            Batch::add(&mut driver.batches, run.level, run.swapped, bounds, driver.runs.len());
            driver.runs.push(DriverRun {
                id: run.scheme.id(),
                level: run.level,
                swapped: run.swapped,
                scheme: Box::new(BoundScheme { system: &problem.system, scheme: run.scheme }),
            });
        }
        // The order in which runs are due, which decides whose failure is described.
        driver.batches.sort_by_key(|batch| (batch.due(), batch.swapped));
        Ok(Self { driver, stack: stack_for(D) })
    }

    /// Carries a random time along each path, see [`TimeChange`].
    #[must_use]
    pub fn with_time_change(mut self, time_change: &'a dyn TimeChange<M>) -> Self {
        self.driver.time_change = Some(time_change);
        self
    }

    /// Takes the noise of the finest steps from elsewhere instead of drawing it.
    #[must_use]
    pub fn with_noise(mut self, source: impl NoiseSource<M> + 'a) -> Self {
        self.driver.noise = Box::new(source);
        self
    }

    /// Describes so many of the paths that fail; the first eight unless told otherwise.
    #[must_use]
    pub fn describing(mut self, failures: usize) -> Self {
        self.driver.described_failures = failures;
        self
    }

    /// Step size of a level.
    #[must_use]
    pub fn tau(&self, level: usize) -> f64 {
        self.driver.tau(level)
    }

    /// Number of coarsest steps: how often a statistic sees each block.
    #[must_use]
    pub fn coarse_steps(&self) -> u64 {
        self.driver.finest_steps >> self.driver.levels
    }

    /// Whether paths are advanced on the threads of the current rayon pool; in dimensions whose steps
    /// need a larger stack they are advanced on threads of their own.
    #[must_use]
    pub fn runs_on_pool(&self) -> bool {
        self.stack <= USUAL_STACK
    }

    /// Steps that one path takes in all runs together: the unit in which `progress` counts.
    #[must_use]
    pub fn steps_per_path(&self) -> u64 {
        self.driver.steps_per_path()
    }

    /// Advances the paths 0 to `samples` − 1 in parallel on the current rayon pool.
    ///
    /// `progress` is told now and then how many more path-steps are done, from any thread.
    pub fn run<T: Statistic<D>>(
        &self,
        samples: u64,
        new: impl Fn() -> T + Sync,
        progress: &(dyn Fn(u64) + Sync),
    ) -> Measured<T> {
        self.run_from(0, samples, new, progress)
    }

    /// Advances `samples` paths from path number `first` on.
    pub fn run_from<T: Statistic<D>>(
        &self,
        first: u64,
        samples: u64,
        new: impl Fn() -> T + Sync,
        progress: &(dyn Fn(u64) + Sync),
    ) -> Measured<T> {
        let groups = samples.div_ceil(GROUP_PATHS);
        let wave = (rayon::current_num_threads() * GROUPS_PER_THREAD) as u64;
        let mut tree = MergeTree::new(|sum: &mut (T, Tally), later: (T, Tally)| {
            sum.0.merge(later.0);
            sum.1.merge(later.1);
        });
        tree.push((new(), self.driver.tally()));
        for begin in (0..groups).step_by(wave as usize) {
            let parts = in_parallel(begin..groups.min(begin + wave), &|group| {
                let offset = group * GROUP_PATHS;
                let paths = GROUP_PATHS.min(samples - offset);
                let mut statistic = new();
                let mut observe = |view: &View<'_, D>| statistic.observe(view);
                let tally = on_stack(self.stack, || {
                    self.driver.march(first + offset, paths, &mut observe, progress)
                });
                (statistic, tally)
            });
            parts.into_iter().for_each(|part| tree.push(part));
        }
        let (statistic, Tally { failed, failures, clipped, .. }) =
            tree.finish().unwrap_or_else(|| unreachable!("an empty part was pushed first"));
        Measured { statistic, failed, failures, clipped }
    }
}

/// Stacks of rayon's threads have two megabytes, of which this much may be used here.
const USUAL_STACK: usize = 1 << 20;

/// Bytes of stack for a step in D dimensions. Newton's method and the continuation behind it keep
/// some matrices and their copies: a dozen where the program is optimised, and up to 160 were found
/// where it is not. Memory that is not touched is only reserved.
fn stack_for(dimension: usize) -> usize {
    (1 << 19) + 256 * 8 * dimension * dimension
}

/// Does the work on this thread, or on one of its own where it needs a larger stack.
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
