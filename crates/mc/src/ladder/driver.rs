//! The time loop: coupled simulation of several schemes on a dyadic hierarchy of step sizes.
//!
//! **Unknowns.** A *run* is a scheme at a level l, with steps of 2^l finest steps. All runs of a
//! ladder see the same Wiener path: the increments ΔW of the finest step are drawn (or given), a
//! step of level l takes their sum, added as a balanced binary tree ([`DyadicLadder`]), which joins
//! Lévy areas by Chen's relation. A *swapped* run is the antithetic path of Giles and Szpruch
//! (2014): it exchanges the two halves of each step of the level above, and therefore advances by
//! two steps at the end of that step.
//!
//! **Truncation.** Each run's increment is clipped to ±bound after summation (Milstein, Repin and
//! Tretyakov 2002), never before, so that all levels share one untruncated path. Runs with the same
//! level, order of halves and bounds form a *batch*, whose noise is clipped once.
//!
//! **Failures.** A path on which a step finds no solution, or whose state is NaN or infinite at the
//! end of a coarsest step, is recorded with scheme, step and reason and is no longer live, in any
//! run: statistics at that time and later exclude it, so that differences of runs stay paired.
//!
//! **Bits.** A *block* is 32 paths in vector lanes, a *group* four blocks that advance together and
//! share ∫γ of each step. Streams belong to paths, groups are merged on a fixed tree: the result
//! depends neither on threads nor on instruction sets.
//!
//! The states of a run are a trait object here, so the loop is compiled once and not for each
//! system, dimension and number of noises.

use std::sync::OnceLock;

use noise::{
    AreaSampler, DyadicLadder, Purpose, StepNoise, StreamKey, WienerRows, area_terms, clip,
    strong_order_one_error,
};
use nonlin::{BlockStatus, are_finite};
use real::{Block, PathMask, Row, WIDTH};
use schemes::{Step, Stepper};
use serde::{Deserialize, Serialize};

use super::{Ladder, TimeChange, View};
use crate::{Cause, LadderError, Run, parts::Stop};

/// Runs of one level with the same noise.
pub struct Batch {
    pub level: usize,
    /// Whether the runs exchange the two halves of each step of the level above.
    pub swapped: bool,
    /// The truncation bound of increments, and the one of areas that belongs to it.
    pub bound: f64,
    pub area_bound: f64,
    /// Whether the runs take the noise of the finest step as it was drawn, which saves copying it.
    pub as_drawn: bool,
    pub runs: Vec<usize>,
}

impl Batch {
    /// Level of the steps at whose ends the runs advance.
    pub fn due_level(&self) -> usize {
        self.level + usize::from(self.swapped)
    }
}

/// The steps of the levels of a ladder, found once and not for every group of paths; none where
/// there are too many.
pub type StepTable = Vec<Vec<OnceLock<Step>>>;

/// Largest number of steps in a table, of a few megabytes.
const MAX_STEPS: u64 = 1 << 14;

/// The table of a ladder, before any step is known.
pub fn step_table(finest_steps: u64, levels: usize) -> StepTable {
    let of_level = |level| vec![OnceLock::new(); (finest_steps >> level) as usize];
    let levels = if finest_steps > MAX_STEPS { 0..0 } else { 0..levels + 1 };
    levels.map(of_level).collect()
}

/// A failed path: which run failed when and why.
#[derive(Clone, Copy, Serialize, Deserialize)]
pub struct Failed {
    pub run: usize,
    pub path: u64,
    pub step: u64,
    pub cause: Cause,
}

/// Counts of failed paths and clipped increments.
#[derive(Clone, Default, Serialize, Deserialize)]
pub struct Tally {
    pub failed: u64,
    pub failures: Vec<Failed>,
    /// Number of clipped increments of each level.
    pub clipped: Vec<u64>,
    described: usize,
}

impl Tally {
    fn record(&mut self, failure: Failed) {
        self.failed += 1;
        if self.failures.len() < self.described {
            self.failures.push(failure);
        }
    }

    pub fn merge(&mut self, later: Self) {
        self.failed += later.failed;
        let room = self.described - self.failures.len();
        self.failures.extend(later.failures.into_iter().take(room));
        for (count, more) in self.clipped.iter_mut().zip(later.clipped) {
            *count += more;
        }
    }
}

/// Number of blocks that advance together and share the damping of each step, which costs as much
/// as two paths of a block.
pub const GROUP_BLOCKS: usize = 4;
/// Number of paths of a group, which is computed in one piece.
pub const GROUP_PATHS: u64 = (GROUP_BLOCKS * WIDTH) as u64;

/// Number of finest steps between two reports of progress.
const PROGRESS_STEPS: u64 = 4096;

impl Ladder<'_> {
    /// Counts of nothing.
    pub fn tally(&self) -> Tally {
        let (clipped, described) = (vec![0; self.levels + 1], self.described_failures);
        Tally { clipped, described, ..Tally::default() }
    }

    /// Step number `n` of a level.
    pub fn step(&self, level: usize, n: u64) -> Step {
        // `Ladder::of` checks that the finest step is positive and finite.
        let new = || {
            Step::new(self.problem.damping, n, self.tau(level))
                .unwrap_or_else(|error| unreachable!("the steps of a ladder are valid: {error}"))
        };
        match self.steps.get(level) {
            Some(steps) => *steps[n as usize].get_or_init(new),
            None => new(),
        }
    }

    /// Advances `paths` paths from `first_path` on to the final time. Calls `observe` for each
    /// block at the end of every coarsest step. `Err` with the counts so far if `stop` asks for the
    /// end before.
    pub fn march(
        &self,
        first_path: u64,
        paths: u64,
        observe: &mut dyn FnMut(&View<'_>),
        progress: &(dyn Fn(u64) + Sync),
        stop: &Stop,
    ) -> Result<Tally, Tally> {
        let mut tally = self.tally();
        let mut blocks: Vec<Marcher<'_>> = (0..paths)
            .step_by(WIDTH)
            .map(|offset| Marcher::new(self, first_path + offset, (paths - offset) as usize))
            .collect();
        if self.from_start {
            blocks.iter().for_each(|block| block.show(0, observe));
        }
        let mut steps: Vec<Step> = (0..=self.levels).map(|level| self.step(level, 0)).collect();
        let mut reported = 0;
        for n in 1..=self.finest_steps {
            if stop.is_asked() {
                return Err(tally);
            }
            for level in (0..=self.levels).take_while(|level| n.is_multiple_of(1 << level)) {
                steps[level] = self.step(level, (n >> level) - 1);
            }
            for block in &mut blocks {
                block.advance(&steps, n, &mut tally, observe);
            }
            if n % PROGRESS_STEPS == 0 || n == self.finest_steps {
                let done = self.steps_done(n);
                progress((done - reported) * paths);
                reported = done;
            }
        }
        Ok(tally)
    }
}

/// The noise of one block and the states of every run.
struct Marcher<'a> {
    ladder: &'a Ladder<'a>,
    first_path: u64,
    live: PathMask,
    next_noise: NextNoise,
    levels: DyadicLadder,
    /// The truncated noise of the current step. It is reused, since zeroing it in every step takes
    /// as long as a tenth of a step.
    truncated: StepNoise,
    states: Vec<Box<dyn Stepper + 'a>>,
    statuses: Vec<BlockStatus>,
    /// Paths with a clipped increment so far, for each run.
    clipped: Vec<PathMask>,
    random_time: Block<1>,
    /// The time change with its normals, if there is one.
    time_change: Option<(&'a dyn TimeChange, WienerRows)>,
    /// Whether no live path moves any more: neither noise nor steps are needed.
    rests: bool,
}

impl<'a> Marcher<'a> {
    fn new(ladder: &'a Ladder<'a>, first_path: u64, paths: usize) -> Self {
        let runs = ladder.runs.len();
        let key = ladder.key.beside(Purpose::TimeChange);
        let start = |(number, run): (usize, &'a Run<'_>)| {
            run.scheme.start(&(ladder.start)(number, first_path))
        };
        let mut new = Self {
            ladder,
            first_path,
            live: PathMask::first(paths),
            next_noise: (ladder.noise)(first_path),
            levels: DyadicLadder::new(ladder.levels, &ladder.no_noise),
            truncated: ladder.no_noise.clone(),
            states: ladder.runs.iter().enumerate().map(start).collect(),
            statuses: vec![BlockStatus::explicit(); runs],
            clipped: vec![PathMask::NONE; runs],
            random_time: Block::zero(),
            time_change: ladder
                .time_change
                .map(|change| (change, WienerRows::new(key, first_path))),
            rests: false,
        };
        new.all_rest();
        new
    }

    /// Shows the states after `time` coarsest steps to `observe`.
    fn show(&self, time: u64, observe: &mut dyn FnMut(&View<'_>)) {
        observe(&View {
            time,
            first_path: self.first_path,
            states: &self.states,
            clipped: &self.clipped,
            random_time: &self.random_time.0[0],
            live: self.live,
        });
    }

    /// Takes finest step number `n`, counted from 1, and every coarser step that ends at the same
    /// time. Where no live path moves, the quantities that they collect go on.
    fn advance(
        &mut self,
        steps: &[Step],
        n: u64,
        tally: &mut Tally,
        observe: &mut dyn FnMut(&View<'_>),
    ) {
        let ladder = self.ladder;
        let complete =
            if self.rests { ladder.levels.min(n.trailing_zeros() as usize) } else { self.draw(n) };
        let lives = !self.live.is_empty();
        let due = |batch: &&Batch| lives && batch.due_level() <= complete;
        for batch in ladder.batches.iter().filter(due) {
            let now = &steps[batch.level];
            if batch.swapped {
                // The second half of the step of the level above comes first.
                let before = ladder.step(batch.level, now.number() - 1);
                self.step(batch, &before, false, tally);
            }
            self.step(batch, now, batch.swapped, tally);
        }
        if complete == ladder.levels {
            if lives {
                self.drop_non_finite(steps, tally);
            }
            self.show(n >> ladder.levels, observe);
            let all_rest = self.all_rest();
            self.rests = self.live.is_empty() || ladder.time_change.is_none() && all_rest;
        }
    }

    /// Tells every run which paths go on, and asks whether none of them moves any more.
    fn all_rest(&mut self) -> bool {
        self.states.iter_mut().fold(true, |all, run| run.rests(self.live) & all)
    }

    /// Draws the noise of finest step number n. Returns the highest level whose step is complete.
    fn draw(&mut self, n: u64) -> usize {
        let complete = self.levels.push(&mut self.next_noise);
        if let Some((change, noise)) = &mut self.time_change {
            let mut normals = [[0.0; WIDTH]];
            noise.increments(1.0, &mut normals);
            let (dw, [time]) = (&self.levels.whole(0).increments[..], &mut self.random_time.0);
            change.advance(n - 1, dw, &normals[0], time);
        }
        complete
    }

    /// Truncates the noise of the last step of the level of the batch, or of the step before.
    #[inline]
    fn truncate(&mut self, batch: &Batch, one_before: bool, tally: &mut Tally) {
        let level = batch.level;
        let StepNoise { increments, areas, space_time, .. } =
            if one_before { self.levels.first_half(level + 1) } else { self.levels.whole(level) };
        self.truncated.clipped.clear();
        if clip(increments, batch.bound, &mut self.truncated.increments) > 0 {
            let StepNoise { increments: inside, clipped, .. } = &mut self.truncated;
            let (paths, count) = differing(increments, inside, self.live, clipped);
            for &run in &batch.runs {
                self.clipped[run] = self.clipped[run].or(paths);
            }
            if !batch.swapped {
                tally.clipped[level] += count;
            }
        }
        if !areas.is_empty() {
            clip(areas, batch.area_bound, &mut self.truncated.areas);
        }
        if !space_time.is_empty() {
            self.truncated.space_time.copy_from_slice(space_time);
        }
    }

    /// Takes one step of the runs of a batch, with the truncated noise of the last step of its
    /// level or of the step before, or with that of the finest step as it was drawn.
    #[inline]
    fn step(&mut self, batch: &Batch, step: &Step, one_before: bool, tally: &mut Tally) {
        let as_drawn = self.rests || batch.as_drawn;
        if !as_drawn {
            self.truncate(batch, one_before, tally);
        }
        for &number in &batch.runs {
            let noise = if as_drawn { self.levels.whole(0) } else { &self.truncated };
            self.states[number].step(step, noise, &mut self.statuses[number]);
            if !self.statuses[number].failed.and(self.live).is_empty() {
                self.drop_failed(number, step, self.statuses[number], tally);
            }
        }
    }

    /// Records the paths on which a step of a run failed, and drops them from the live ones.
    #[cold]
    fn drop_failed(&mut self, run: usize, step: &Step, status: BlockStatus, tally: &mut Tally) {
        let (step, failed) = (step.number(), status.failed.and(self.live));
        for p in failed.paths() {
            let cause = Cause::of_residual(status.residual(p));
            tally.record(Failed { run, path: self.first_path + p as u64, step, cause });
        }
        self.live = self.live.without(failed);
    }

    /// Marks paths with a state that is not finite as failed, for schemes that do not do so
    /// themselves. Called once in each coarsest step.
    fn drop_non_finite(&mut self, steps: &[Step], tally: &mut Tally) {
        for (number, run) in self.ladder.runs.iter().enumerate() {
            let state = self.states[number].state();
            if !all_finite(state) {
                let mut status = BlockStatus::explicit();
                status.fail_where_not_finite(state);
                self.drop_failed(number, &steps[run.level], status, tally);
            }
        }
    }
}

real::kernel! {
    /// Whether all numbers are finite: asked once in each coarsest step.
    pub fn all_finite(rows: &'a [Row]) -> bool {
        are_finite(rows)
    }
}

/// The paths on which two blocks differ, and the number of differing entries on the `live` paths;
/// `mixed` gets the bits of these entries of `a`.
#[cold]
fn differing(a: &[Row], b: &[Row], live: PathMask, mixed: &mut Vec<u64>) -> (PathMask, u64) {
    let (mut paths, mut count) = (PathMask::NONE, 0);
    for p in 0..WIDTH {
        let entries = a.iter().zip(b).map(|(a, b)| (a[p].to_bits(), b[p].to_bits()));
        let entries = entries.filter(|(a, b)| a != b);
        mixed.push(entries.clone().fold(0, |mixed: u64, (a, _)| mixed.rotate_left(21) ^ a));
        let differ = entries.count();
        if differ > 0 {
            paths.insert(p);
        }
        if live.contains(p) {
            count += differ as u64;
        }
    }
    (paths, count)
}

/// Writes the noise of the next finest step τ of a block: increments, row m of variance τ on each
/// of 32 paths, and areas if there are rows for them, which are zero otherwise. Paths with
/// numbers that are not finite fail.
pub type NextNoise = Box<dyn FnMut(&mut StepNoise) + Send>;

/// Function from the number of the first path of a block to the untruncated noise of its 32 paths.
pub type NoiseSource<'a> = Box<dyn Fn(u64) -> NextNoise + Sync + 'a>;

/// The noise of a [`Ladder`](crate::Ladder) on finest steps τ: increments drawn from the streams of
/// a key; with `area_noises` noises also their Lévy areas, whose error is at most τ^{3/2}, as
/// strong order 1 requires. Space-time areas are drawn where there are rows for them, of a stream
/// of their own.
///
/// # Errors
/// [`LadderError`] if areas would take too many terms.
pub fn drawn(
    key: StreamKey,
    tau: f64,
    area_noises: Option<usize>,
) -> Result<NoiseSource<'static>, LadderError> {
    let areas = match area_noises {
        Some(noises) => Some((noises, area_terms(strong_order_one_error(tau), tau, noises)?)),
        None => None,
    };
    let root = tau.sqrt();
    Ok(Box::new(move |first_path| {
        let mut increments = WienerRows::new(key, first_path);
        let mut space_time = None;
        let mut areas =
            areas.map(|(noises, terms)| AreaSampler::new(key, first_path, noises, terms));
        Box::new(move |noise| {
            increments.increments(root, &mut noise.increments);
            if !noise.space_time.is_empty() {
                let key = key.beside(Purpose::SpaceTimeAreas);
                space_time
                    .get_or_insert_with(|| WienerRows::new(key, first_path))
                    .increments((tau / 12.0).sqrt(), &mut noise.space_time);
            }
            if let Some(areas) = &mut areas {
                areas.areas(tau, &noise.increments, &mut noise.areas);
            }
        })
    }))
}
