//! What runs on the ladder, and the loop over all paths.

use noise::{AreaMethod, StreamKey, Truncation, strong_order_one_error};
use real::{Block, PathMask, WIDTH};
use schemes::{Scheme, StepError};
use systems::{Damping, PoissonSystem, Problem};

use crate::march::Group;
use crate::parallel::in_parallel;
use crate::tree::MergeTree;
use crate::{LadderError, PathFailure};

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
    /// The state of each run.
    pub states: &'a [Block<D>],
    /// For each run the paths of which an increment has been clipped so far.
    pub clipped: &'a [PathMask],
    /// What the [`Clock`] of the ladder has reached; zero without one.
    pub clock: &'a Block<1>,
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

/// A number that is carried along each path, driven by the untruncated finest increments: for
/// example the random time at which the exact solution of a one-noise system is a deterministic
/// flow.
pub trait Clock<const M: usize>: Send + Sync {
    /// Finest step number n (from 0) with its increments; `normals` are standard normals of their
    /// own stream, for what the increments do not determine.
    fn advance(&self, n: u64, dw: &Block<M>, normals: &Block<1>, clock: &mut Block<1>);
}

/// Schemes on a dyadic ladder of steps, driven by one noise. Checked at construction.
pub struct Ladder<'a, S, G, const D: usize, const M: usize> {
    pub(crate) problem: &'a Problem<S, G, D>,
    pub(crate) finest_steps: u64,
    pub(crate) levels: usize,
    /// Largest truncated increment and area on each level.
    pub(crate) bounds: Vec<Bounds>,
    /// How Lévy areas of the finest steps are drawn, if a scheme reads them.
    pub(crate) areas: Option<(AreaMethod, usize)>,
    pub(crate) key: StreamKey,
    pub(crate) runs: Vec<Run<'a, S, D, M>>,
    pub(crate) clock: Option<&'a dyn Clock<M>>,
}

/// The largest truncated increment and area on a level.
#[derive(Clone, Copy)]
pub(crate) struct Bounds {
    pub(crate) increment: f64,
    pub(crate) area: f64,
}

/// What a ladder measured.
#[derive(Clone, Debug)]
pub struct Outcome<T> {
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

impl<'a, S, G, const D: usize, const M: usize> Ladder<'a, S, G, D, M>
where
    S: PoissonSystem<D, M>,
    G: Damping,
{
    /// `finest_steps` steps on [0, T] at level 0, and `levels` levels above.
    ///
    /// Where a scheme reads Lévy areas they are drawn on the finest steps after Mrongowius and
    /// Rößler, with an error of no more than τ^{3/2} as strong order one asks, and joined to
    /// coarser steps by Chen's relation. With their tail the areas have the right covariance given
    /// the increments for any number of terms, so that areas drawn at a step and areas joined from
    /// finer steps agree in it.
    ///
    /// # Errors
    /// [`LadderError`] when the steps are no positive multiple of the coarsest step, when a run is
    /// on a level that does not exist (a swapped run needs a level above its own), when the
    /// truncation is not defined at one of the step sizes in use, or when T is so small that the
    /// finest step underflows.
    pub fn new(
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
        let mut bounds = vec![Bounds { increment: f64::INFINITY, area: f64::INFINITY }; levels + 1];
        for run in &runs {
            if run.level + usize::from(run.swapped) > levels {
                return Err(LadderError::Level { level: run.level, swapped: run.swapped, levels });
            }
            let tau = problem.t_end * (1u64 << run.level) as f64 / finest_steps as f64;
            bounds[run.level] =
                Bounds { increment: truncation.bound(tau)?, area: truncation.area_bound(tau)? };
        }
        let areas = if runs.iter().any(|run| run.scheme.needs_areas()) {
            let method = AreaMethod::MrongowiusRoessler;
            Some((method, method.terms_for(strong_order_one_error(finest), finest, M)?))
        } else {
            None
        };
        Ok(Self { problem, finest_steps, levels, bounds, areas, key, runs, clock: None })
    }

    /// Carries a number along each path, see [`Clock`].
    #[must_use]
    pub fn with_clock(mut self, clock: &'a dyn Clock<M>) -> Self {
        self.clock = Some(clock);
        self
    }

    /// Step size of a level.
    #[must_use]
    pub fn tau(&self, level: usize) -> f64 {
        self.problem.t_end * (1u64 << level) as f64 / self.finest_steps as f64
    }

    /// Number of coarsest steps: how often a statistic sees each block.
    #[must_use]
    pub fn coarse_steps(&self) -> u64 {
        self.finest_steps >> self.levels
    }

    /// Steps that one path takes in all runs together: the unit in which `progress` counts.
    #[must_use]
    pub fn steps_per_path(&self) -> u64 {
        self.runs.iter().map(|run| self.finest_steps >> run.level).sum()
    }

    /// Advances `samples` paths in parallel on the current rayon pool.
    ///
    /// `progress` is told now and then how many more path-steps are done, from any thread.
    pub fn run<T: Statistic<D>>(
        &self,
        samples: u64,
        new: impl Fn() -> T + Sync,
        progress: &(dyn Fn(u64) + Sync),
    ) -> Outcome<T> {
        let group_paths = (Group::<S, G, D, M>::BLOCKS * WIDTH) as u64;
        let groups = samples.div_ceil(group_paths);
        let wave = (rayon::current_num_threads() * GROUPS_PER_THREAD) as u64;
        let mut tree = MergeTree::new(Part::merge);
        tree.push(Part {
            statistic: new(),
            failed: 0,
            failures: Vec::new(),
            clipped: vec![0; self.levels + 1],
        });
        for first in (0..groups).step_by(wave as usize) {
            let parts: Vec<Part<T>> = in_parallel(first..groups.min(first + wave), &|g| {
                let first_path = g * group_paths;
                Group::new(self, first_path, group_paths.min(samples - first_path))
                    .march(new(), progress)
            });
            for part in parts {
                tree.push(part);
            }
        }
        let Part { statistic, failed, failures, clipped } =
            tree.finish().unwrap_or_else(|| unreachable!("an empty part was pushed first"));
        Outcome { statistic, failed, failures, clipped }
    }
}

/// What one group of blocks contributes.
pub(crate) struct Part<T> {
    pub(crate) statistic: T,
    pub(crate) failed: u64,
    pub(crate) failures: Vec<PathFailure>,
    pub(crate) clipped: Vec<u64>,
}

impl<T> Part<T> {
    pub(crate) fn record(&mut self, failure: PathFailure) {
        self.failed += 1;
        if self.failures.len() < DESCRIBED_FAILURES {
            self.failures.push(failure);
        }
    }

    fn merge<const D: usize>(&mut self, later: Self)
    where
        T: Statistic<D>,
    {
        self.statistic.merge(later.statistic);
        self.failed += later.failed;
        let room = DESCRIBED_FAILURES - self.failures.len();
        self.failures.extend(later.failures.into_iter().take(room));
        for (count, more) in self.clipped.iter_mut().zip(later.clipped) {
            *count += more;
        }
    }
}
