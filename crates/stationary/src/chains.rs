//! Chains that go on from batch to batch, and sums along them.

use std::ops::{Range, RangeInclusive};

use real::{
    PathMask, Row, WIDTH,
    elementary::{exp, ln},
};
use serde::{Deserialize, Serialize};
use stats::CentralMoments;

use super::{
    Averaged, EquilibriumSettings,
    metropolis::MORE,
    rules::{BY_NOISE, REACH, REJECTED},
    wells::Watched,
};
use mc::{PathFailure, Statistic, View, add_rows};
use study::{Grid, Histogram};

/// Number of batches of time when they are full.
pub const BATCHES: usize = 32;
/// Least number of batches, and their distance, at which averages are formed before they are full.
const DUE: usize = 18;
const OFTEN: usize = 2;
/// Steps of the longest size from one value in a histogram to the next.
const SELDOM: u64 = 4;
/// Number of batches of the same length before the first, in which chains are spread.
pub const SPREADING: u64 = BATCHES as u64;
/// Least and largest number of steps in the first batches of chains that choose them.
const MIN_STEPS: f64 = 8.0;
const MAX_STEPS: f64 = 1e12;
/// Changes of the step that are small, and the most batches until they are.
const SETTLED: RangeInclusive<f64> = 0.8..=1.25;
const MAX_SPREADING: u64 = 3 * SPREADING;
/// Number of bins of a histogram.
pub const BINS: u32 = 256;

/// A block of 32 chains.
#[derive(Clone, Serialize, Deserialize)]
struct Block {
    first: u64,
    /// Mask, as bits, of the chains that have not failed.
    live: u32,
    /// The states at each step size.
    states: Vec<Vec<Row>>,
}

/// Rows with a number for each chain: the means over a batch of each average at each step size,
/// zero where a chain has the longest only, and of its square at the longest; for each step size
/// and each weight w of a derivative (where steps have no bias, H₀ is the first) of w, of w², and
/// of φw − ∂φ for each average; and the values of watched functions at its end.
pub type Batch = Vec<Vec<f64>>;

/// The batches of the chains that have not failed.
pub struct Living<'a> {
    pub batches: &'a [Batch],
    /// Numbers of the chains.
    pub chains: Vec<usize>,
    /// Number of the first ones, which have all step sizes.
    pub paired: usize,
}

impl Living<'_> {
    /// Sum of a row over batches, for each chain.
    pub fn sums(&self, row: usize, batches: Range<usize>) -> impl Iterator<Item = f64> {
        let batches = &self.batches[batches];
        self.chains.iter().map(move |&n| batches.iter().map(|batch| batch[row][n]).sum())
    }

    /// Mean of a row over batches, for each chain.
    pub fn means(&self, row: usize, batches: Range<usize>) -> impl Iterator<Item = f64> {
        let length = batches.len() as f64;
        self.sums(row, batches).map(move |sum| sum / length)
    }
}

pub fn moments(values: impl Iterator<Item = f64>) -> CentralMoments {
    let mut moments = CentralMoments::default();
    values.for_each(|x| moments.add(x));
    moments
}

/// All chains, with their batches and histograms.
#[derive(Default, Serialize, Deserialize)]
pub struct Chains {
    /// The coarsest step size.
    pub tau: f64,
    /// Number of times that the steps were doubled.
    pub halvings: u32,
    /// Steps of the coarsest size in a batch.
    pub batch_steps: u64,
    /// Number of batches done, of any length.
    pub number: u64,
    /// Path-steps so far, and before steps were halved.
    pub spent: u64,
    pub spent_before: u64,
    /// Whether batches were joined, so that their first half is old and they may be the last ones.
    pub doubled: bool,
    blocks: Vec<Block>,
    /// Batches since steps were halved last, after those of spreading.
    pub batches: Vec<Batch>,
    /// Histograms of the averages, over the last batches.
    pub histograms: Vec<Histogram>,
    /// Number of chains that had failed when steps were halved.
    pub failed_before: usize,
    /// The first failure.
    pub failure: Option<String>,
    averages: usize,
    /// Number of weights of derivatives.
    weights: usize,
    /// Number of step sizes, and of the chains that have all of them; others have the longest.
    pub levels: usize,
    pub paired: usize,
    /// Whether this number was chosen since steps were halved.
    pub is_settled: bool,
    /// Number of batches in which chains are spread and choose their step.
    pub spread: u64,
    /// Parts of the moves that were accepted since batches count, by H₀ and by noises.
    pub accepted: [f64; 2],
}

impl Chains {
    pub fn new(
        settings: &EquilibriumSettings,
        of: Averaged<'_>,
        (levels, paired): (usize, usize),
        t_end: f64,
    ) -> Self {
        let (batches, spread) = (BATCHES as u64, SPREADING);
        // An even number in each batch, for schemes that alternate.
        let steps = settings.steps.div_ceil(1 << (levels - 1)).next_multiple_of(2 * batches);
        let (batch_steps, averages, tau) = (steps / batches, of.count(), t_end / steps as f64);
        let weights = of.slopes().len() + usize::from(levels == 1);
        Self { tau, batch_steps, averages, weights, levels, paired, spread, ..Self::default() }
    }

    /// Number of rows of averages, squares and products.
    pub fn rows(&self) -> usize {
        self.products(self.levels, 0)
    }

    /// The first row of a weight at a step size, counted from the longest.
    pub fn products(&self, run: usize, weight: usize) -> usize {
        (self.levels + 1) * self.averages + (run * self.weights + weight) * (self.averages + 2)
    }

    /// Path-steps of `chains` chains in a step of the longest size.
    pub fn each(&self, chains: u64) -> u64 {
        let paired = (self.paired as u64).min(chains);
        paired * ((1 << self.levels) - 1) + (chains - paired)
    }

    /// Notes how many moves were accepted, and chooses the step size for the `time` of a batch
    /// while chains are spread: a rejection by H₀ is of order τ³, one by noises of order √τ,
    /// and where a chain stands still the step is too long for where it is.
    pub fn adapt(&mut self, dimension: usize, time: f64) {
        let (mut sums, mut moving, mut stands) = ([0.0; 2], 0, false);
        for block in &self.blocks {
            let rows = &block.states[0][dimension..];
            // Nothing moves those whose energy is no number.
            for p in (0..WIDTH).filter(|&p| rows[MORE - 1][p].is_finite()) {
                moving += 1;
                stands |= rows[1][p] == 0.0;
                (0..2).for_each(|k| sums[k] += rows[1 + k][p]);
            }
        }
        let (chains, is_spread) = (self.chains(), self.number < self.spread);
        if self.number == self.spread {
            self.spent_before = self.spent;
        }
        let steps = if self.number <= self.spread {
            self.batch_steps
        } else {
            (self.spent - self.spent_before) / chains
        };
        let all = (steps * moving.max(1)) as f64;
        self.accepted = sums.map(|sum| sum / all);
        if is_spread && moving > 0 {
            let by_energy = exp(ln(REJECTED / (1.0 - self.accepted[0]).max(1e-9)) / 3.0);
            let by_noise = match self.accepted[1] {
                0.0 => f64::INFINITY,
                accepted => (BY_NOISE / (1.0 - accepted).max(1e-9)).powi(2),
            };
            let factor = if stands { 0.5 } else { by_energy.min(by_noise).clamp(0.5, 2.0) };
            self.tau = (self.tau * factor).min(2.0 * time);
            if !SETTLED.contains(&factor) && self.number + 1 == self.spread {
                self.spread = (self.spread + 1).min(MAX_SPREADING);
            }
            self.batch_steps = (time / self.tau).ceil().clamp(MIN_STEPS, MAX_STEPS) as u64;
        }
    }

    fn chains(&self) -> u64 {
        (self.blocks.len() * WIDTH) as u64
    }

    /// Whether averages can be formed: when batches are full, and between.
    pub fn is_due(&self) -> bool {
        self.is_full() || self.has_averages() && self.batches.len().is_multiple_of(OFTEN)
    }

    /// Whether chains that go on have averages.
    pub fn has_averages(&self) -> bool {
        self.is_full() || self.doubled && self.batches.len() >= DUE
    }

    /// Whether batches are full.
    pub fn is_full(&self) -> bool {
        self.batches.len() == BATCHES
    }

    fn block(&self, path: u64) -> Option<&Block> {
        self.blocks.get((path / WIDTH as u64) as usize)
    }

    /// The states of a block of chains at a step size; none before the first batch. Before batches
    /// count, the first `dimension` rows: tangent vectors are anew then.
    pub fn states(&self, run: usize, path: u64, dimension: usize) -> Option<&[Row]> {
        let states = &self.block(path)?.states[run];
        Some(if self.batches.is_empty() { &states[..dimension] } else { states })
    }

    pub fn living(&self) -> Living<'_> {
        let chains: Vec<usize> = self.live().collect();
        let paired = chains.iter().filter(|&&n| n < self.paired).count();
        Living { batches: &self.batches, chains, paired }
    }

    /// The numbers of the chains that have not failed.
    fn live(&self) -> impl Iterator<Item = usize> {
        self.blocks
            .iter()
            .flat_map(|block| PathMask(block.live).paths().map(|p| block.first as usize + p))
    }

    /// Number of chains that have failed.
    pub fn failed(&self) -> usize {
        self.chains() as usize - self.live().count()
    }

    /// Whether states are beyond 1e50.
    pub fn are_large(&self) -> bool {
        let mut states =
            self.blocks.iter().flat_map(|block| block.states.iter().flatten().flatten());
        states.any(|y| y.abs() > 1e50)
    }

    /// Takes the sums of a batch. Chains that failed go on from `start`, and count for nothing
    /// except while they are spread.
    pub fn take(
        &mut self,
        mut batch: Vec<Sums>,
        failures: Vec<PathFailure>,
        start: &dyn Fn(u64) -> Vec<Row>,
        watched: Watched<'_>,
    ) {
        let spreading = self.number < self.spread;
        batch.sort_by_key(|sums| sums.block.first);
        let chains = batch.len() * WIDTH;
        self.spent += self.batch_steps * self.each(chains as u64);
        self.number += 1;
        let exactly = || Vec::with_capacity(chains);
        let mut values: Batch = (0..self.rows()).map(|_| exactly()).collect();
        let scale = 1.0 / self.batch_steps as f64;
        for sums in &batch {
            values
                .iter_mut()
                .zip(&sums.sums)
                .for_each(|(all, row)| all.extend(row.map(|x| scale * x)));
            for (found, counts) in self.histograms.iter_mut().zip(&sums.counts) {
                found.add(counts);
            }
        }
        let before = std::mem::take(&mut self.blocks);
        self.blocks = batch.into_iter().map(|sums| sums.block).collect();
        self.revive(start);
        if spreading {
            self.blocks.iter_mut().for_each(|block| block.live = PathMask::ALL.0);
            return;
        }
        for (block, before) in self.blocks.iter_mut().zip(before) {
            block.live &= before.live;
        }
        self.failure = self.failure.take().or(failures.first().map(|first| {
            let PathFailure { scheme, tau, cause, .. } = first;
            format!("{scheme} with steps {tau:.2e}: {cause}")
        }));
        let first = values.len();
        for block in &self.blocks {
            let seen = watched.values(&block.states[0]);
            values.resize_with(first + seen.len(), exactly);
            values[first..].iter_mut().zip(seen).for_each(|(all, row)| all.extend(row));
        }
        self.batches.push(values);
    }

    /// Joins the batches in pairs, so that the next batches, up to the full number, double the
    /// time.
    pub fn double(&mut self, of: Averaged<'_>) {
        if let Averaged::Of(..) = of {
            self.histograms = (0..self.averages).map(|k| self.histogram(k)).collect();
        }
        let mean = |pair: &[Batch]| -> Batch {
            pair[0]
                .iter()
                .zip(&pair[1])
                .map(|(a, b)| a.iter().zip(b).map(|(a, b)| 0.5 * (a + b)).collect())
                .collect()
        };
        self.batches = self.batches.chunks(2).map(mean).collect();
        self.batch_steps *= 2;
        self.doubled = true;
    }

    /// Lets chains that failed begin at `start`.
    fn revive(&mut self, start: &dyn Fn(u64) -> Vec<Row>) {
        for block in self.blocks.iter_mut().filter(|block| block.live != PathMask::ALL.0) {
            let first = start(block.first);
            for state in &mut block.states {
                for p in PathMask(!block.live).paths() {
                    state.iter_mut().zip(&first).for_each(|(y, first)| y[p] = first[p]);
                }
            }
        }
    }

    /// Begins anew with steps of half the size, where the chains are.
    pub fn halve(&mut self) {
        self.failure = None;
        self.failed_before = self.failed();
        self.tau *= 0.5;
        self.batch_steps *= 2;
        self.halvings += 1;
        self.clear();
        for block in &mut self.blocks {
            if block.states.len() > 1 {
                block.states.remove(0);
                block.states.extend(block.states.last().cloned());
            }
            block.live = PathMask::ALL.0;
        }
        self.is_settled = false;
    }

    /// Leaves out what was summed.
    fn clear(&mut self) {
        self.spent_before = self.spent;
        self.batches.clear();
        self.histograms.iter_mut().for_each(|found| *found = Histogram::empty(found.grid));
    }

    /// Begins anew with this number of chains that have all step sizes, where the chains are.
    pub fn pair(&mut self, paired: usize) {
        (self.paired, self.is_settled) = (paired, true);
        self.clear();
        for block in &mut self.blocks {
            let levels = if (block.first as usize) < paired { self.levels } else { 1 };
            let longest = block.states[0].clone();
            block.states.resize(levels, longest);
        }
    }

    /// An empty histogram about the mean of an average in the second half of the time.
    fn histogram(&self, k: usize) -> Histogram {
        let of = |row: usize| {
            let (sum, count) = self.batches[BATCHES / 2..]
                .iter()
                .flat_map(|batch| self.live().map(move |n| batch[row][n]))
                .fold((0.0, 0), |(sum, count), x| (sum + x, count + 1));
            sum / f64::from(count.max(1))
        };
        let mean = of(k);
        let deviation = (of(self.levels * self.averages + k) - mean * mean).max(0.0).sqrt();
        let range = (mean - REACH * deviation, mean + REACH * deviation);
        Histogram::empty(Grid::covering(Some(range), BINS))
    }
}

/// The sums of 32 chains over a batch.
pub struct Sums {
    block: Block,
    /// Sums of each average at each step size, and of its square at the longest.
    sums: Vec<Row>,
    counts: Vec<Vec<u64>>,
}

/// Statistic that gathers the sums of chains over a batch.
pub struct Gather<'a> {
    pub of: Averaged<'a>,
    /// Number of step sizes of these chains.
    pub levels: usize,
    /// The chains before the batch.
    pub chains: &'a Chains,
    pub blocks: Vec<Sums>,
    /// Values of weights of derivatives.
    pub weights: Vec<Row>,
}

real::kernel! {
    /// Adds a·b.
    fn add_product(sum: &'a mut Row, a: &'a Row, b: &'a Row) {
        for ((sum, a), b) in sum.iter_mut().zip(a).zip(b) {
            *sum += a * b;
        }
    }
}

impl Statistic for Gather<'_> {
    fn observe(&mut self, view: &View<'_>) {
        let &mut Self { of, levels, chains, ref mut blocks, ref mut weights } = self;
        let (count, first, squares) = (of.count(), view.first_path, chains.levels);
        let known = blocks.iter().rposition(|sums| sums.block.first == first);
        let at = known.unwrap_or_else(|| {
            blocks.push(Sums {
                block: Block { first, live: view.live.0, states: Vec::new() },
                sums: vec![[0.0; WIDTH]; chains.rows()],
                counts: chains.histograms.iter().map(|of| vec![0; of.grid.cells()]).collect(),
            });
            blocks.len() - 1
        });
        let Sums { block, sums, counts } = &mut blocks[at];
        let is_last = view.time == chains.batch_steps;
        if is_last {
            block.live = view.live.0;
            block.states = (0..levels).map(|run| view.state(run).to_vec()).collect();
        }
        match of {
            Averaged::Of(observables, slopes) => {
                for run in 0..levels {
                    let mut y = view.state(run);
                    weights.clear();
                    if squares == 1 {
                        weights.extend(y.last());
                        // Without the rows of a sampler.
                        y = &y[..y.len() - MORE];
                    }
                    weights.extend(slopes.iter().map(|slope| slope.weight.values(y, view.live)));
                    for (w, weight) in weights.iter().enumerate() {
                        let products = chains.products(run, w);
                        add_rows(&mut sums[products..], &[*weight]);
                        add_product(&mut sums[products + 1], weight, weight);
                    }
                    for (k, phi) in observables.iter().enumerate() {
                        let values = phi.values(y, view.live);
                        add_rows(&mut sums[run * count + k..], &[values]);
                        for (w, weight) in weights.iter().enumerate() {
                            let product = &mut sums[chains.products(run, w) + 2 + k];
                            add_product(product, &values, weight);
                            // The first weight may be H₀.
                            let slope = (w + slopes.len()).checked_sub(weights.len());
                            let of = slope.and_then(|slope| slopes[slope].of.get(k));
                            if let Some(change) = of.map(|of| of.values(y, view.live)) {
                                product.iter_mut().zip(change).for_each(|(sum, x)| *sum -= x);
                            }
                        }
                        if run > 0 {
                            continue;
                        }
                        add_product(&mut sums[squares * count + k], &values, &values);
                        let known = chains
                            .histograms
                            .get(k)
                            .zip(chains.block(first))
                            .filter(|_| view.time.is_multiple_of(SELDOM));
                        if let Some((Histogram { grid, .. }, before)) = known {
                            let mut places = [0; WIDTH];
                            grid.place(&values, &mut places);
                            view.live
                                .and(PathMask(before.live))
                                .paths()
                                .for_each(|p| counts[k][places[p] as usize] += 1);
                        }
                    }
                }
            }
            Averaged::Growth(_) if is_last => {
                for run in 0..levels {
                    let state = view.state(run);
                    let grown = &state[state.len() - count..];
                    sums[run * count..][..count].copy_from_slice(grown);
                }
            }
            Averaged::Growth(_) => {}
        }
    }

    fn merge(&mut self, later: Self) {
        self.blocks.extend(later.blocks);
    }
}
