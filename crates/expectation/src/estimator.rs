//! Choice of levels and points, and the stopping rule.

use std::{
    cell::Cell,
    sync::Arc,
    time::{Duration, Instant},
};

use noise::{Purpose, QuasiWiener, ScrambledSobol};
use real::{
    WIDTH,
    elementary::{exp, ln},
};
use serde::{Deserialize, Serialize};
use stats::{CONFIDENCE, Warning as Message};

use super::{
    Candidate, Expect, ExpectSettings, Orders,
    extrapolation::{Extrapolation, alpha, beta, extrapolation, seen_orders},
    judge::Evidence,
    level::{PathValues, Samples, Values, hull, tail},
    report::{Estimate, Expectation, Judged, Level, Warning, WarningKind},
    resolution::{Motion, PARTS, unresolved},
    rules::{
        BIAS_ENOUGH, BIAS_PART, BIAS_SHARE, FEWER, LARGEST_EXPONENT, LARGEST_TURN, LOST, MAX_BIAS,
        MAX_LOST, MAX_SAMPLES, MIN_GROWTH, NEGLIGIBLE, OF_RANDOM_POINTS, ROUNDED, SINGLE,
        UNCOUPLED,
    },
    sum::{BIAS_LEVELS, Sum, Term},
};
use mc::{
    DampingResolution, DriveResolution, GROUP_PATHS, Ladder, LadderError, NextNoise, Node, Nodes,
    Observe, Run, RunError, Setup, in_parallel, value_at,
};

/// The highest level of the pilot.
const PILOT_LEVEL: usize = BIAS_LEVELS;
/// Largest number of points of a replicate; twice that number have distinct numbers.
const MAX_POINTS: u64 = 1 << 31;
/// Number of independent replicates of the points of a level.
const REPLICATES: u64 = 32;
/// Time of a round of groups of all replicates below which the next round is larger.
const BETWEEN: Duration = Duration::from_millis(500);

/// Binary logarithm of the largest number of steps without noise: 2²² steps take seconds.
const MAX_HALVINGS: usize = 22;
/// Largest dimension of Sobol points: in more they gain nothing over random ones, and take memory.
const MAX_DIMENSIONS: u64 = 1 << 16;

/// Source of the increments of the points of all scrambles. A path has the number of its replicate
/// times [`ScrambledSobol::POINTS`], plus that of its point. With space-time areas the increments a
/// and b of two halves of a step make ΔW = a + b and H = (a − b)/√12.
fn points(scrambles: Vec<QuasiWiener>, noises: usize) -> impl Fn(u64) -> NextNoise {
    let size = (1.0f64 / 12.0).sqrt();
    move |first_path| {
        let wiener = &scrambles[(first_path / ScrambledSobol::POINTS) as usize];
        let mut increments = vec![[0.0; WIDTH]; wiener.dimensions()];
        wiener.block(first_path % ScrambledSobol::POINTS, &mut increments);
        let mut next = 0;
        Box::new(move |noise| {
            noise.increments.copy_from_slice(&increments[next..next + noises]);
            next += noises;
            if !noise.space_time.is_empty() {
                let rows = noise.increments.as_flattened_mut().iter_mut();
                let second = increments[next..next + noises].as_flattened();
                for ((dw, b), h) in rows.zip(second).zip(noise.space_time.as_flattened_mut()) {
                    (*dw, *h) = (*dw + b, size * (*dw - b));
                }
                next += noises;
            }
        })
    }
}

/// The samples of an attempt, in a checkpoint.
#[derive(Serialize, Deserialize)]
pub struct Kept<'a> {
    /// Number of the attempt.
    pub attempt: usize,
    /// Path-steps of the complete rounds of all attempts so far.
    spent: u64,
    /// The level that the sum begins with.
    first: usize,
    /// Number of points of complete rounds, and nodes of each replicate, for each level.
    levels: Vec<(u64, Vec<Nodes<PathValues<'a>>>)>,
}

/// The estimation of E[φ] with one scheme from one coarsest step on.
pub struct Estimator<'a> {
    candidate: &'a Candidate<'a>,
    expect: &'a Expect<'a>,
    observables: &'a [&'a dyn Observe],
    accuracy: f64,
    /// Path-steps of all attempts so far, to which the limit applies.
    spent: &'a Cell<u64>,
    orders: Orders,
    attempt: usize,
    coarsest_steps: u64,
    max_level: usize,
    replicates: u64,
    damping: DampingResolution<'a>,
    drive: DriveResolution<'a>,
    /// Whether there is noise or a random initial value. If not, one path is enough.
    noisy: bool,
    /// Whether points are Sobol points.
    sobol: bool,
    /// All levels so far, with their samples.
    levels: Vec<Samples>,
    /// Ladder of each level, and the nodes of its replicates so far. The last may be of a level
    /// that was begun before it was stopped.
    ladders: Vec<(Ladder<'a>, Vec<Nodes<PathValues<'a>>>)>,
    /// The level that the sum begins with: the last one for single paths.
    first: usize,
}

impl<'a> Estimator<'a> {
    pub fn new(
        candidate: &'a Candidate<'a>,
        expect: &'a Expect<'a>,
        observables: &'a [&'a dyn Observe],
        accuracy: f64,
        spent: &'a Cell<u64>,
        orders: Orders,
        (attempt, coarsest_steps): (usize, u64),
    ) -> Self {
        let Setup { problem, scheme } = &candidate.setup;
        let settings = &expect.settings;
        let noisy = !problem.silent || problem.initial.is_some();
        let reads_areas = scheme.about().reads_areas;
        let halvings = MAX_HALVINGS.saturating_sub(coarsest_steps.ilog2() as usize);
        Self {
            candidate,
            expect,
            observables,
            accuracy,
            spent,
            orders,
            attempt,
            coarsest_steps,
            max_level: if noisy { settings.max_level } else { halvings.max(3) },
            replicates: if noisy { REPLICATES } else { 1 },
            damping: DampingResolution::new(&candidate.setup, coarsest_steps),
            drive: DriveResolution::new(problem),
            noisy,
            sobol: !problem.silent && !settings.random_points && !reads_areas,
            levels: Vec::new(),
            ladders: Vec::new(),
            first: 0,
        }
    }

    /// Computes the expectation, from the samples in `kept` if there are some; and whether smaller
    /// coarsest steps help, where failed paths are in the way.
    pub fn expectation(
        mut self,
        kept: Option<Kept<'a>>,
    ) -> Result<(Expectation, Option<bool>), RunError> {
        let Self { expect: Expect { settings, .. }, accuracy, spent, .. } = self;
        let (pilot, max_cost) = (if self.noisy { GROUP_PATHS } else { 1 }, settings.max_cost);
        if let Some(kept) = kept {
            self.restore(kept)?;
        }
        self.begin(pilot)?;
        let out_of_reach = |why: String, remedy: &str| {
            let what = Message::new("the accuracy is out of reach");
            Some((WarningKind::OutOfReach, what.with_reason(why).with_remedy(remedy)))
        };
        let mut helps = None;
        let limit = loop {
            if !self.noisy {
                self.first = self.levels.len() - BIAS_LEVELS;
            }
            let numbers = self.numbers();
            let sums: Vec<Sum> = numbers.iter().map(|&k| self.sum_from(self.first, k)).collect();
            if sums.is_empty() {
                break None;
            }
            self.tell(&sums);
            let last = self.levels.len() - 1;
            let wide = |sum: &Sum| sum.half_width() > accuracy;
            let unresolved = !self.unresolved().is_empty();
            let finer = unresolved
                || sums.iter().any(|sum| if self.noisy { self.is_biased(sum) } else { wide(sum) });
            let lost = sums.iter().map(|sum| sum.lost).fold(0.0, f64::max);
            if lost > LOST * accuracy {
                let [before, share] = [0, PILOT_LEVEL].map(|level| self.levels[level].lost());
                if share <= FEWER * before {
                    helps = Some(true);
                    break None;
                }
                if lost > MAX_LOST * accuracy {
                    helps = Some(false);
                    let why = format!(
                        "a share of {before:.1e} of the paths fails, and {share:.1e} with steps an \
                         eighth as long, which may change the result by {lost:.1e}"
                    );
                    let remedy =
                        "write the equation in variables without a singular point, as √x for x";
                    break out_of_reach(why, remedy);
                }
            }
            let rounding = sums.iter().map(|sum| sum.rounding).fold(0.0, f64::max);
            // Values on steps that do not resolve the motion may be large.
            if rounding > accuracy && !unresolved {
                let why = format!("rounding errors may be {rounding:.1e}");
                break out_of_reach(why, "");
            }
            let least = self.least_cost(&sums, finer);
            if least > max_cost as f64 {
                let allowed = max_cost as f64;
                let why =
                    format!("it takes {least:.0e} path-steps or more, {allowed:.0e} are allowed");
                break out_of_reach(why, "");
            }
            let (level, points) = if finer && last < self.max_level {
                self.add_level()?;
                self.first += usize::from(self.first == last);
                (last + 1, pilot)
            } else {
                let begin = &self.levels[self.first];
                let wide = sums.iter().any(wide);
                let is_heavy = |&k: &usize| begin.values[k].is_heavy() && !self.is_still(k);
                let heavy = numbers.iter().any(is_heavy);
                let enough = !wide && (!heavy || begin.count() >= MAX_SAMPLES);
                let most = MAX_BIAS * accuracy;
                let stuck = unresolved || sums.iter().any(|sum| sum.extrapolation.size > most);
                if !self.noisy || enough || finer && stuck {
                    let text = format!("the bias is too large on the finest level allowed, {last}");
                    break (unresolved || wide).then(|| (WarningKind::Level, Message::new(text)));
                }
                let level = if wide { self.worst(&sums) } else { self.first };
                (level, 2 * self.levels[level].points)
            };
            let samples = &self.levels[level];
            let cost = spent.get().saturating_add(self.cost(samples, points - samples.points));
            let (kind, what) = if cost > max_cost || samples.points >= MAX_POINTS {
                let what = "the accuracy was not reached with the";
                (WarningKind::Cost, format!("{what} {max_cost} path-steps allowed"))
            } else if self.sample(level, points)? {
                // Once points are doubled, the first level stays.
                if self.levels.iter().all(|samples| samples.points == pilot) {
                    self.first = self.first_level();
                }
                continue;
            } else {
                let what = if sums.iter().any(wide) { "accuracy" } else { "least bias" };
                (WarningKind::Stopped, format!("stopped before the {what} was reached"))
            };
            self.levels.retain(|samples| samples.paths > 0);
            self.first = self.first.min(self.levels.len() - 1);
            break Some((kind, Message::new(what)));
        };
        Ok((self.report(limit), helps))
    }

    /// Samples the first levels, except those that were restored.
    fn begin(&mut self, pilot: u64) -> Result<(), RunError> {
        let (kept, max_cost) = (self.levels.len(), self.expect.settings.max_cost);
        if kept > PILOT_LEVEL {
            return Ok(());
        }
        (kept..=PILOT_LEVEL).try_for_each(|_| self.add_level())?;
        let pilot_cost = self.levels[kept..]
            .iter()
            .map(|samples| self.cost(samples, pilot))
            .fold(self.spent.get(), u64::saturating_add);
        if pilot_cost > max_cost {
            return Err(RunError::PilotCost { pilot_cost, max_cost });
        }
        for level in kept..=PILOT_LEVEL {
            if !self.sample(level, pilot)? {
                return Err(RunError::Stopped);
            }
        }
        self.first = self.first_level();
        Ok(())
    }

    /// Restores the samples of a checkpoint. The sum of the complete rounds of a replicate is one
    /// node.
    fn restore(&mut self, kept: Kept<'a>) -> Result<(), RunError> {
        for (level, (points, replicates)) in kept.levels.into_iter().enumerate() {
            self.add_level()?;
            let empty = self.empty(level);
            let (ladder, nodes) = &mut self.ladders[level];
            let join = |(nodes, mut whole): (&mut Nodes<_>, Nodes<PathValues<'a>>)| {
                whole.iter_mut().for_each(|node| node.sum.0.observables = empty.observables);
                let later = whole.split_off(1.min(whole.len()));
                let sum = ladder.join(&mut whole, &|| empty.clone());
                *nodes = [whole, later].concat();
                sum
            };
            let complete = nodes.iter_mut().zip(replicates).map(join).collect();
            self.levels[level].take(complete, points);
        }
        self.levels.retain(|samples| samples.points > 0);
        self.spent.set(kept.spent);
        self.first = kept.first;
        Ok(())
    }

    /// Writes the checkpoint if it is due, or at the end. [`Checkpoint::failure`] says if that
    /// fails.
    fn keep(&self) {
        let &Self { expect: Expect { settings, checkpoint, .. }, spent, .. } = self;
        let Some(checkpoint) = checkpoint.filter(|to| settings.stop.is_asked() || to.is_due())
        else {
            return;
        };
        let complete = self.levels.iter().filter(|samples| samples.points > 0).count();
        // As a [`Kept`].
        let first = self.first.min(complete.saturating_sub(1));
        let points = self.levels.iter().map(|samples| samples.points);
        let levels: Vec<_> = points.zip(self.ladders.iter().map(|(_, nodes)| nodes)).collect();
        _ = checkpoint.write(&(self.attempt, spent.get(), first, levels));
    }

    /// Values of a level without samples.
    fn empty(&self, level: usize) -> PathValues<'a> {
        let observables = self.observables;
        let rows = self.candidate.setup.start();
        let starts: Vec<f64> = observables.iter().map(|phi| value_at(*phi, &rows)).collect();
        PathValues {
            observables,
            last_time: self.ladders[level].0.coarse_steps(),
            coupled: level > 0,
            values: vec![Values::default(); observables.len()],
            motion: [(); PARTS].map(|()| Motion::new(&self.candidate.setup.problem.y0)),
            functions: Motion::new(&starts),
        }
    }

    /// Reports the largest half-width, and the part of the work that is done.
    fn tell(&self, sums: &[Sum]) {
        let half_width = sums.iter().map(Sum::half_width).fold(0.0, f64::max);
        // Errors fall as N^{−1/2} for random points, and as N^{−2/3} or faster for Sobol points.
        let growth = if self.sobol { 1.5 } else { 2.0 };
        let lacks = ln((half_width / self.accuracy).max(1.0));
        (self.expect.told)(half_width, exp(-growth * lacks));
    }

    /// Whether a finer level is wanted: the bias has more than its share, significantly.
    fn is_biased(&self, sum: &Sum) -> bool {
        let Extrapolation { size, standard_error, .. } = sum.extrapolation;
        let [least, most] = [BIAS_ENOUGH, BIAS_SHARE].map(|part| part * self.accuracy);
        let share = (BIAS_PART * sum.spread()).clamp(least, most);
        size > share + sum.quantile() * standard_error
    }

    /// Warnings of what the steps of the last level do not resolve.
    fn unresolved(&self) -> Vec<Warning> {
        let names: Vec<&str> = self.observables.iter().map(|phi| phi.name()).collect();
        let last = self.levels.len() - 1;
        let (drive, turn) = (self.drive.unresolved(self.steps(last)), self.turn(last));
        let wanted = (self.accuracy, self.is_single(self.first));
        unresolved(&self.levels[1..], (&self.damping, drive, turn), &names, wanted)
    }

    /// The angle by which the fastest motion turns in a step of a level.
    fn turn(&self, level: usize) -> f64 {
        let t_end = self.candidate.setup.problem.t_end;
        self.expect.settings.fastest * t_end / self.steps(level) as f64
    }

    /// Least number of path-steps that the accuracy takes: those of missing points, on levels that
    /// are fine enough; else those of finer levels that damping and fast motion need.
    fn least_cost(&self, sums: &[Sum], finer: bool) -> f64 {
        let last = &self.levels[self.levels.len() - 1];
        if !finer {
            let costs = sums.iter().map(|sum| sum.cost(self.accuracy, MIN_GROWTH));
            return costs.fold(0.0, f64::max);
        }
        let exponent = self.damping.lasting_exponent(last.level) / LARGEST_EXPONENT;
        let more = exponent.max(self.turn(last.level) / LARGEST_TURN);
        // A pilot on a level with as many more steps, and on those below it.
        let lasts = self.noisy && more > 1.0;
        if lasts { 2.0 * self.cost(last, GROUP_PATHS) as f64 * more } else { 0.0 }
    }

    /// The numbers of the test functions for which more samples are of use: those with a variance,
    /// or all until steps resolve the motion.
    fn numbers(&self) -> Vec<usize> {
        let unresolved = !self.unresolved().is_empty() && self.levels.len() <= self.max_level;
        (0..self.observables.len())
            .filter(|&k| unresolved || tail(&self.levels, k).has_variance())
            .collect()
    }

    /// Whether the sum is of single paths if it begins with this level.
    fn is_single(&self, first: usize) -> bool {
        first + 1 == self.levels.len()
    }

    /// Steps of the fine path of a level.
    fn steps(&self, level: usize) -> u64 {
        self.coarsest_steps << level
    }

    /// Adds a level without points.
    fn add_level(&mut self) -> Result<(), RunError> {
        let (level, Setup { problem, scheme }) = (self.levels.len(), &self.candidate.setup);
        let Expect { settings, counted, parameters, scores, .. } = self.expect;
        let &ExpectSettings { key, truncation, .. } = settings;
        let (steps, family) = (self.steps(level), Purpose::Level(level as u64));
        let (levels, runs) = (usize::from(level > 0), self.candidate.runs(level > 0));
        let ladder = Ladder::of(problem, steps, levels, truncation, (key, family), runs)?;
        let mut ladder = ladder.fitting(GROUP_PATHS * self.replicates)?.telling(counted);
        // Two normals for each step and noise with space-time areas.
        let reads_two = scheme.about().reads_space_time;
        let pieces = if reads_two { steps.saturating_mul(2) } else { steps };
        if self.sobol && pieces.saturating_mul(problem.noises as u64) <= MAX_DIMENSIONS {
            let key = key.beside(family);
            let wiener = QuasiWiener::new(key, 0, pieces, problem.noises, problem.t_end);
            let wiener = wiener.map_err(LadderError::from)?;
            ladder = ladder.with_noise(points(
                (0..self.replicates).map(|number| wiener.of_scramble(number)).collect(),
                problem.noises,
            ));
        }
        // Of the paths side by side.
        let nearby = if scores.is_none() { parameters.len() } else { 0 };
        let cost_per_path = (1 + nearby as u64) * ladder.steps_per_path();
        self.levels.push(Samples { level, cost_per_path, ..Samples::default() });
        if self.ladders.len() == level {
            self.ladders.push((ladder, vec![Vec::new(); self.replicates as usize]));
        }
        Ok(())
    }

    /// Path-steps of `points` points of every replicate.
    fn cost(&self, samples: &Samples, points: u64) -> u64 {
        self.replicates.saturating_mul(points).saturating_mul(samples.cost_per_path)
    }

    /// Draws points of every replicate of a level up to `points`; false if it is stopped.
    fn sample(&mut self, level: usize, points: u64) -> Result<bool, RunError> {
        let new_cost = self.cost(&self.levels[level], points - self.levels[level].points);
        let &mut Self { expect: Expect { settings, .. }, observables, spent, .. } = self;
        let new = self.empty(level);
        let empty = || new.clone();
        let groups = points.div_ceil(GROUP_PATHS);
        let (mut done, mut some, mut begun) = (0, 1, Instant::now());
        while done < groups {
            done = groups.min(done + some);
            let (ladder, nodes) = &mut self.ladders[level];
            // All replicates are begun: none depends on another. They go on from where they
            // stopped.
            let more = in_parallel(0..self.replicates, &|replicate| {
                let first = replicate * ScrambledSobol::POINTS;
                let begin = first / GROUP_PATHS;
                let next = nodes[replicate as usize].last().map_or(begin, Node::end);
                let groups = next..(begin + done).max(next);
                ladder.nodes(&settings.stop, first + points, groups, &empty)
            });
            // Complete rounds stay nodes of their own.
            nodes.iter_mut().zip(more).for_each(|(nodes, more)| nodes.extend(more));
            self.keep();
            if settings.stop.is_asked() {
                return Ok(false);
            }
            if begun.elapsed() < BETWEEN {
                some *= 4;
            }
            begun = Instant::now();
        }
        let (ladder, nodes) = &mut self.ladders[level];
        let replicates: Vec<_> = nodes.iter_mut().map(|of| ladder.join(of, &empty)).collect();
        let samples = &mut self.levels[level];
        let first = replicates.iter().find_map(|replicate| replicate.failures.first().copied());
        spent.set(spent.get() + new_cost);
        samples.take(replicates, points);
        if samples.count() < 1 + u64::from(self.noisy) {
            return Err(RunError::NoPaths { level, failed: samples.failed, first });
        }
        for (phi, Values { sample, .. }) in observables.iter().zip(&samples.values) {
            let number = if self.noisy { sample.variance() } else { sample.mean() };
            if !number.is_finite() {
                return Err(RunError::NotFinite { observable: phi.name().to_owned(), level });
            }
        }
        Ok(true)
    }

    /// Whether test function number k is smooth and the same on all paths of each level, but for
    /// rounding errors: noise does not move it.
    pub fn is_still(&self, k: usize) -> bool {
        let same = |level: &Samples| {
            let one = |of: &Values| {
                let rounding = ROUNDED * of.fine.mean().abs();
                of.is_blind() || of.spread() <= rounding.min(NEGLIGIBLE * self.accuracy)
            };
            level.values.get(k).is_none_or(one)
        };
        self.observables[k].is_smooth() == Some(true) && self.levels.iter().all(same)
    }

    /// Bound of the rounding errors of the steps of a level: 8√n by chance, and more where solvers
    /// stop on one side.
    fn rounding(&self, level: usize, values: &Values) -> f64 {
        let steps = self.steps(level) as f64;
        32.0 * steps.sqrt() * f64::EPSILON * values.fine.mean().abs()
    }

    /// Range of test function number k: that on all levels so far, or one if it is the same on all;
    /// zero if nothing moves it.
    fn range(&self, k: usize) -> f64 {
        let ranges = self.levels.iter().filter_map(|level| level.values.get(k)?.range());
        match hull(ranges) {
            _ if !self.noisy || self.is_still(k) => 0.0,
            Some((least, largest)) if largest > least => largest - least,
            _ => 1.0,
        }
    }

    /// Sum of test function number k from a level on.
    fn sum_from(&self, first: usize, k: usize) -> Sum {
        let (samples, range) = (&self.levels[first], self.range(k));
        let differences = Term::differences(&self.levels[1..], k, range);
        let from = differences.len().saturating_sub(BIAS_LEVELS);
        let (last, of_last) = (&differences[from..], &self.levels[1 + from..]);
        // Single paths are extrapolated from below: all differences must show the order.
        let single = self.is_single(first);
        let (levels, terms) =
            if single { (&self.levels[1..], &*differences) } else { (of_last, last) };
        let seen = (alpha(levels, terms, k), beta(of_last, k));
        let orders = if self.noisy { self.orders } else { seen_orders(last, self.orders) };
        let mut extrapolation = match self.observables[k].is_smooth() {
            Some(false) if !self.noisy => Extrapolation::of_no_order(last),
            _ => extrapolation(last, orders, seen, single),
        };
        let rounding = self.rounding(self.levels.len() - 1, &samples.values[k]);
        extrapolation.size += rounding;
        let below = if single { &last[..2] } else { &[] };
        let terms = [below, &[Term::first(samples, k, range)], &differences[first..]].concat();
        let lost = self.levels[first..].iter().map(Samples::lost).sum::<f64>() * range;
        let confidence = if self.sobol { CONFIDENCE } else { OF_RANDOM_POINTS };
        let (replicates, beside) = (self.replicates as f64, 0.0);
        let mut sum =
            Sum { terms, extrapolation, single, replicates, confidence, lost, rounding, beside };
        let value = |sum: &Sum| sum.over(|weight, term| weight * term.mean);
        let steps = self.steps(self.levels.len() - 1) as f64;
        let (place, own) = ((k, self.observables.len()), value(&sum));
        let other = |k: usize| value(&self.sum_from(first, k));
        sum.beside = self.expect.beside(place, (steps, self.accuracy), own, other);
        sum
    }

    /// The level to begin with, for which an accuracy costs least: Σ√(VC) is least (Giles 2008),
    /// for all test functions together. Two differences are above it, which extrapolation needs; or
    /// the last one, if single paths need less by far.
    fn first_level(&self) -> usize {
        let root = |first: usize, k: usize| -> f64 {
            let sum = self.sum_from(first, k);
            sum.terms.iter().map(|term| (term.variance * term.cost).sqrt()).sum()
        };
        let (numbers, last) = (self.numbers(), self.levels.len() - 1);
        let mut totals = vec![0.0; last - 1];
        for &k in &numbers {
            let roots: Vec<f64> = (0..totals.len()).map(|first| root(first, k)).collect();
            let least = roots.iter().copied().fold(f64::INFINITY, f64::min);
            if least > 0.0 {
                totals.iter_mut().zip(&roots).for_each(|(total, root)| *total += root / least);
            }
        }
        let best = (0..totals.len()).min_by(|&a, &b| totals[a].total_cmp(&totals[b])).unwrap_or(0);
        let most = |first: usize| {
            numbers.iter().map(|&k| self.sum_from(first, k).root()).fold(0.0, f64::max)
        };
        let apart = numbers.iter().all(|&k| {
            let Values { sample, fine, .. } = &self.levels[last].values[k];
            sample.variance() >= UNCOUPLED * fine.variance()
        });
        if self.noisy && apart && most(last) < SINGLE * most(best) { last } else { best }
    }

    /// The level whose points are doubled: the cheapest one that is enough for every function, if
    /// one is, else the one on which a path-step gains most for the function that gains most (Giles
    /// and Waterhouse 2009).
    fn worst(&self, sums: &[Sum]) -> usize {
        let accuracy = self.accuracy;
        let wide = || sums.iter().filter(|sum| sum.half_width() > accuracy);
        let most = |n: usize| wide().map(|sum| sum.gain(n)).fold(0.0, f64::max);
        let enough = |n: usize| wide().all(|sum| sum.with_twice(n) <= accuracy);
        let cost = |n: usize| sums[0].terms[n].cost;
        let terms = || 0..sums[0].terms.len();
        let cheapest = terms().filter(|&n| enough(n)).min_by(|&a, &b| cost(a).total_cmp(&cost(b)));
        let best = || terms().max_by(|&a, &b| most(a).total_cmp(&most(b)));
        self.levels.len() - terms().end + cheapest.or_else(best).unwrap_or(0)
    }

    fn report(self, limit: Option<(WarningKind, Message)>) -> Expectation {
        let Self { ref levels, first, candidate, .. } = self;
        // Levels below the first may be far from the limit; three differences make a slope.
        let differences = &levels[1..];
        let from = first.min(differences.len().saturating_sub(BIAS_LEVELS));
        let estimate = |(k, phi): (usize, &&dyn Observe)| {
            let sum = self.sum_from(first, k);
            let terms = Term::differences(differences, k, self.range(k));
            let tail = tail(levels, k);
            Estimate {
                name: phi.name().to_owned(),
                value: if tail.has_mean() {
                    sum.over(|weight, term| weight * term.mean)
                } else {
                    f64::NAN
                },
                standard_error: sum.standard_error(),
                quantile: sum.quantile(),
                missed: if tail.has_variance() { sum.missed() } else { f64::INFINITY },
                bias: sum.bias(),
                bias_bound: sum.bias_bound(),
                alpha: alpha(&differences[from..], &terms[from..], k),
                beta: beta(&differences[from..], k),
                failed: levels[first..].iter().map(|samples| samples.failed).sum(),
                judged: Judged::default(),
            }
        };
        let mut estimates: Vec<_> = self.observables.iter().enumerate().map(estimate).collect();
        let evidence = Evidence {
            levels,
            first,
            order: self.orders.weak,
            noisy: self.noisy,
            still: (0..estimates.len()).map(|k| self.is_still(k)).collect(),
            unresolved: self.unresolved(),
        };
        let mut warnings = evidence.judge(&mut estimates);
        warnings.extend(limit.map(|(kind, text)| Warning::of_all(kind, text)));
        let level = |samples: &Samples| Level {
            level: samples.level,
            tau: candidate.setup.problem.t_end / self.steps(samples.level) as f64,
            samples: samples.count(),
            failed: samples.failed,
            cost_per_path: samples.cost_per_path,
            variances: samples.values.iter().map(|values| values.sample.variance()).collect(),
        };
        Expectation {
            gradient: Vec::new(),
            scheme: candidate.setup.scheme.about().id,
            accuracy: self.accuracy,
            single_steps: self.is_single(first).then(|| self.steps(first)),
            cost: self.spent.get(),
            levels: levels.iter().map(level).collect(),
            warnings,
            estimates,
        }
    }
}

impl Candidate<'_> {
    /// The runs of a sample: fine, coarse, and a second fine and a second coarse one. For several
    /// noises without areas the second fine path takes the increments of every coarse step in the
    /// other order (Giles and Szpruch 2014): then the variance falls like τ² instead of τ.
    fn runs(&self, coupled: bool) -> Vec<Run<'_>> {
        let (scheme, mirror) = (&self.setup.scheme, self.mirror.as_ref());
        let without_areas = self.setup.problem.noises > 1 && !scheme.about().reads_areas;
        let twin = mirror.or(without_areas.then_some(scheme)).filter(|_| coupled);
        let at = |level: usize| move |scheme| Run::new(Arc::clone(scheme), level);
        let coarse = usize::from(coupled);
        let mut runs = vec![at(0)(scheme)];
        runs.extend(coupled.then(|| at(1)(scheme)));
        runs.extend(twin.map(|twin| Run::swapped(Arc::clone(twin), 0)));
        runs.extend(mirror.map(at(coarse)));
        runs
    }
}
