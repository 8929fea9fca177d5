//! The way of a group of blocks up the time axis.

use noise::{AreaBlock, AreaLadder, AreaSampler, DyadicLadder, StreamKey, WienerBlock, clip};
use nonlin::BlockStatus;
use real::{Block, PathMask, WIDTH};
use schemes::Step;
use systems::{Damping, PoissonSystem};

use crate::ladder::{Ladder, Part, Run, Statistic, View};
use crate::{Cause, PathFailure};

/// Blocks that march together and share the damping of each step, which costs as much as two paths
/// of a block.
pub(crate) struct Group<'a, S, G, const D: usize, const M: usize> {
    ladder: &'a Ladder<'a, S, G, D, M>,
    blocks: Vec<Marcher<D, M>>,
}

/// One block: its noise and the state of every run.
struct Marcher<const D: usize, const M: usize> {
    first_path: u64,
    live: PathMask,
    noise: WienerBlock<M>,
    sums: DyadicLadder<M>,
    /// What the schemes are shown of them; kept here, since zeroing it anew takes as long as a
    /// tenth of a step.
    truncated: Truncated<M>,
    states: Vec<Block<D>>,
    /// For each run the paths of which an increment has been clipped.
    clipped: Vec<PathMask>,
    clock: Block<1>,
    clock_noise: WienerBlock<1>,
    areas: Option<Areas<M>>,
}

/// Lévy areas of a block: drawn on the finest steps, joined above.
struct Areas<const M: usize> {
    sampler: AreaSampler<M>,
    drawn: AreaBlock<M>,
    ladder: AreaLadder<M>,
}

impl<const M: usize> Areas<M> {
    /// A finest step of size τ with its increments has been pushed into `sums`, which has completed
    /// a level.
    fn advance(&mut self, tau: f64, dw: &Block<M>, sums: &DyadicLadder<M>, complete: usize) {
        self.sampler.areas(tau, dw, &mut self.drawn);
        self.ladder.push(&self.drawn, sums, complete);
    }
}

/// Increments and areas of a step as the schemes of a level see them.
struct Truncated<const M: usize> {
    dw: Block<M>,
    areas: AreaBlock<M>,
}

/// The clock draws from a family of streams of its own, which differs in the top bit of the
/// experiment.
const CLOCK_STREAM: u64 = 1 << 63;

/// How many finest steps of a block pass between two reports of progress.
const PROGRESS_STEPS: u64 = 4096;

/// The current step of a level and the one before.
#[derive(Clone, Copy)]
struct StepPair {
    before: Step,
    now: Step,
}

impl<'a, S: PoissonSystem<D, M>, G: Damping, const D: usize, const M: usize> Group<'a, S, G, D, M> {
    /// Blocks in a group.
    pub(crate) const BLOCKS: usize = 4;

    pub(crate) fn new(ladder: &'a Ladder<'a, S, G, D, M>, first_path: u64, paths: u64) -> Self {
        let blocks = (0..paths.div_ceil(WIDTH as u64))
            .map(|b| {
                let offset = b * WIDTH as u64;
                Marcher {
                    first_path: first_path + offset,
                    live: PathMask::first((paths - offset).min(WIDTH as u64) as usize),
                    noise: WienerBlock::new(ladder.key, first_path + offset),
                    sums: DyadicLadder::new(ladder.levels),
                    truncated: Truncated { dw: Block::zero(), areas: AreaBlock::zero() },
                    states: vec![Block::splat(ladder.problem.y0); ladder.runs.len()],
                    clipped: vec![PathMask::NONE; ladder.runs.len()],
                    clock: Block::zero(),
                    clock_noise: WienerBlock::new(
                        StreamKey {
                            experiment: ladder.key.experiment ^ CLOCK_STREAM,
                            ..ladder.key
                        },
                        first_path + offset,
                    ),
                    areas: ladder.areas.map(|(method, terms)| Areas {
                        sampler: AreaSampler::new(ladder.key, first_path + offset, method, terms),
                        drawn: AreaBlock::zero(),
                        ladder: AreaLadder::new(ladder.levels),
                    }),
                }
            })
            .collect();
        Self { ladder, blocks }
    }

    pub(crate) fn march<T: Statistic<D>>(
        mut self,
        statistic: T,
        progress: &(dyn Fn(u64) + Sync),
    ) -> Part<T> {
        let ladder = self.ladder;
        let levels = ladder.levels;
        let mut part =
            Part { statistic, failed: 0, failures: Vec::new(), clipped: vec![0; levels + 1] };
        let runs: Vec<RunsOfLevel<'_, S, D, M>> =
            (0..=levels).map(|level| RunsOfLevel::new(ladder, level)).collect();
        let sqrt_tau = ladder.tau(0).sqrt();
        let mut steps: Vec<StepPair> =
            (0..=levels).map(|level| first_step(ladder, level)).collect();
        let paths: u64 = self.blocks.iter().map(|block| u64::from(block.live.len())).sum();
        let (mut reported, total) = (0, ladder.steps_per_path());
        for n in 1..=ladder.finest_steps {
            for (level, pair) in steps.iter_mut().enumerate() {
                if n % (1 << level) != 0 {
                    break;
                }
                if !runs[level].is_empty() {
                    let now = checked_step(ladder, level, (n >> level) - 1);
                    *pair = StepPair { before: pair.now, now };
                }
            }
            for block in &mut self.blocks {
                block.advance(ladder, &runs, &steps, sqrt_tau, n, &mut part);
            }
            if n % PROGRESS_STEPS == 0 || n == ladder.finest_steps {
                // In proportion, so that the reports of a path add up to its steps exactly.
                let done =
                    (u128::from(total) * u128::from(n) / u128::from(ladder.finest_steps)) as u64;
                progress((done - reported) * paths);
                reported = done;
            }
        }
        part
    }
}

/// The runs that advance when a step of the level ends, by their number.
struct RunsOfLevel<'a, S, const D: usize, const M: usize> {
    plain: Vec<(usize, &'a Run<'a, S, D, M>)>,
    /// Runs of this level that wait for the end of a step of the level above.
    swapped: Vec<(usize, &'a Run<'a, S, D, M>)>,
}

impl<'a, S: PoissonSystem<D, M>, const D: usize, const M: usize> RunsOfLevel<'a, S, D, M> {
    fn new<G>(ladder: &'a Ladder<'a, S, G, D, M>, level: usize) -> Self {
        let of_level = |swapped| {
            ladder
                .runs
                .iter()
                .enumerate()
                .filter(move |(_, run)| run.level == level && run.swapped == swapped)
                .collect()
        };
        Self { plain: of_level(false), swapped: of_level(true) }
    }

    fn is_empty(&self) -> bool {
        self.plain.is_empty() && self.swapped.is_empty()
    }
}

/// Step sizes are positive because the final time is, and it was checked.
fn checked_step<S: PoissonSystem<D, M>, G: Damping, const D: usize, const M: usize>(
    ladder: &Ladder<'_, S, G, D, M>,
    level: usize,
    n: u64,
) -> Step {
    Step::new(&ladder.problem.damping, n, ladder.tau(level))
        .unwrap_or_else(|error| unreachable!("a validated problem has positive steps: {error}"))
}

fn first_step<S: PoissonSystem<D, M>, G: Damping, const D: usize, const M: usize>(
    ladder: &Ladder<'_, S, G, D, M>,
    level: usize,
) -> StepPair {
    let step = checked_step(ladder, level, 0);
    StepPair { before: step, now: step }
}

/// The number of a step, from its time.
fn step_number(step: &Step) -> u64 {
    (step.t / step.tau).round() as u64
}

/// The paths on which two blocks differ.
#[cold]
fn differing<const M: usize>(a: &Block<M>, b: &Block<M>) -> PathMask {
    let mut paths = PathMask::NONE;
    for p in (0..WIDTH).filter(|&p| a.path(p) != b.path(p)) {
        paths.insert(p);
    }
    paths
}

/// How many entries of the given paths differ.
#[cold]
fn count_on<const M: usize>(paths: PathMask, a: &Block<M>, b: &Block<M>) -> u64 {
    let differ = |p: usize| (0..M).filter(|&m| a.0[m][p] != b.0[m][p]).count() as u64;
    paths.paths().map(differ).sum()
}

impl<const D: usize, const M: usize> Marcher<D, M> {
    /// Finest step number n, counted from 1, and every coarser step that ends with it.
    fn advance<S: PoissonSystem<D, M>, G: Damping, T: Statistic<D>>(
        &mut self,
        ladder: &Ladder<'_, S, G, D, M>,
        runs: &[RunsOfLevel<'_, S, D, M>],
        steps: &[StepPair],
        sqrt_tau: f64,
        n: u64,
        part: &mut Part<T>,
    ) {
        let mut dw = Block::zero();
        self.noise.increments(sqrt_tau, &mut dw);
        if let Some(clock) = ladder.clock {
            let mut normals = Block::zero();
            self.clock_noise.increments(1.0, &mut normals);
            clock.advance(n - 1, &dw, &normals, &mut self.clock);
        }
        let complete = self.sums.push(&dw);
        if let Some(areas) = &mut self.areas {
            areas.advance(ladder.tau(0), &dw, &self.sums, complete);
        }
        for level in 0..=complete {
            if !runs[level].plain.is_empty() {
                let increment = self.sums.increment(level);
                let count = clip(increment, ladder.bounds[level].increment, &mut self.truncated.dw);
                let paths = if count > 0 {
                    differing(increment, &self.truncated.dw)
                } else {
                    PathMask::NONE
                };
                if count > 0 {
                    part.clipped[level] += count_on(self.live, increment, &self.truncated.dw);
                }
                if let Some(areas) = &self.areas {
                    self.truncated.areas =
                        areas.ladder.areas(level).clipped(ladder.bounds[level].area).0;
                }
                for &(number, run) in &runs[level].plain {
                    self.clipped[number] = self.clipped[number].or(paths);
                    self.step(ladder, number, run, &steps[level].now, part);
                }
            }
            if level > 0 && !runs[level - 1].swapped.is_empty() {
                // Second half first, then the first half, each clipped as of the level below.
                let StepPair { before, now } = steps[level - 1];
                let bounds = ladder.bounds[level - 1];
                for second in [true, false] {
                    let (half, step) = if second {
                        (self.sums.increment(level - 1), before)
                    } else {
                        (self.sums.first_half(level), now)
                    };
                    let count = clip(half, bounds.increment, &mut self.truncated.dw);
                    let paths = if count > 0 {
                        differing(half, &self.truncated.dw)
                    } else {
                        PathMask::NONE
                    };
                    if let Some(Areas { ladder: areas, .. }) = &self.areas {
                        let half =
                            if second { areas.areas(level - 1) } else { areas.first_half(level) };
                        self.truncated.areas = half.clipped(bounds.area).0;
                    }
                    for &(number, run) in &runs[level - 1].swapped {
                        self.clipped[number] = self.clipped[number].or(paths);
                        self.step(ladder, number, run, &step, part);
                    }
                }
            }
        }
        if complete == ladder.levels {
            self.drop_non_finite(ladder, n, part);
            let Self { states, clipped, clock, live, .. } = self;
            part.statistic.observe(&View {
                time: n >> ladder.levels,
                states,
                clipped,
                clock,
                live: *live,
            });
        }
    }

    fn step<S: PoissonSystem<D, M>, G: Damping, T>(
        &mut self,
        ladder: &Ladder<'_, S, G, D, M>,
        number: usize,
        run: &Run<'_, S, D, M>,
        step: &Step,
        part: &mut Part<T>,
    ) {
        let (system, state, noise) =
            (&ladder.problem.system, &mut self.states[number], &self.truncated);
        let mut status = BlockStatus::explicit();
        run.scheme.step_block_with_areas(system, step, &noise.dw, &noise.areas, state, &mut status);
        let failed = status.failed.and(self.live);
        if !failed.is_empty() {
            for p in failed.paths() {
                let cause = Cause::of_residual(status.residual(p));
                part.record(self.failure(ladder, run, p, step_number(step), cause));
            }
            self.live = self.live.without(failed);
        }
    }

    #[cold]
    fn failure<S: PoissonSystem<D, M>, G: Damping>(
        &self,
        ladder: &Ladder<'_, S, G, D, M>,
        run: &Run<'_, S, D, M>,
        p: usize,
        step: u64,
        cause: Cause,
    ) -> PathFailure {
        PathFailure {
            path: self.first_path + p as u64,
            key: ladder.key,
            scheme: run.scheme.id(),
            swapped: run.swapped,
            tau: ladder.tau(run.level),
            step,
            cause,
        }
    }

    /// The schemes of this workspace fail where their state is not finite; for anybody else's this
    /// looks, once in each coarse step.
    fn drop_non_finite<S: PoissonSystem<D, M>, G: Damping, T>(
        &mut self,
        ladder: &Ladder<'_, S, G, D, M>,
        n: u64,
        part: &mut Part<T>,
    ) {
        for (state, run) in self.states.iter().zip(&ladder.runs) {
            let mut status = BlockStatus::explicit();
            status.fail_where_not_finite(state);
            let failed = status.failed.and(self.live);
            for p in failed.paths() {
                part.record(self.failure(
                    ladder,
                    run,
                    p,
                    (n >> run.level).saturating_sub(1),
                    Cause::NotFinite,
                ));
            }
            self.live = self.live.without(failed);
        }
    }
}
