//! The noise that a solver gets.
//!
//! All of it is made of finest steps, those of the reference. Space-time areas H =
//! ∫(W − t ΔW/τ)dt/τ are drawn there, N(0, τ/12), independent of the Lévy areas given W, and joined
//! exactly: H = ½(H₁ + H₂) + ¼(ΔW₁ − ΔW₂).

use mc::{LadderError, NextNoise, drawn};
use noise::{DyadicLadder, Purpose, StepNoise, WienerRows};
use rayon::prelude::*;
use real::{Row, WIDTH};

use super::{super::one_step::two_steps, Referee};

/// Factors of the noise of single steps; stronger noise would overflow solvers that do not expect
/// it.
pub(super) const STRENGTHS: [f64; 3] = [1.0, 16.0, 256.0];
/// Number of states from which single steps start.
pub const VISITS: usize = 64;

/// The noise of a step size, each array by [step, path, noise].
#[derive(Clone, Debug, Default)]
pub struct LevelNoise {
    /// Increments ΔW.
    pub increments: Vec<f64>,
    /// Lévy areas ½∫(W_i dW_j − W_j dW_i), [step, path, i, j]; empty for one noise.
    pub areas: Vec<f64>,
    /// Space-time areas H.
    pub space_time: Vec<f64>,
}

impl LevelNoise {
    /// Adds a step of 32 paths.
    fn push(&mut self, noise: &StepNoise, space_time: &[Row]) {
        let noises = noise.increments.len();
        for p in 0..WIDTH {
            self.increments.extend(noise.increments.iter().map(|row| row[p]));
            self.space_time.extend(space_time.iter().map(|row| row[p]));
            for (i, j) in (0..noises).flat_map(|i| (0..noises).map(move |j| (i, j))) {
                let row = noise.areas.get(i.min(j) * noises + i.max(j));
                let sign = f64::from(u8::from(i < j)) - f64::from(u8::from(i > j));
                self.areas.extend(row.map(|row| sign * row[p]));
            }
        }
    }

    /// Joins blocks of 32 paths side by side in each of `steps` steps.
    fn joined<'b>(blocks: impl Iterator<Item = &'b Self> + Clone, steps: usize) -> Self {
        let of = |values: fn(&Self) -> &[f64]| -> Vec<f64> {
            let step = |n: usize| {
                blocks.clone().flat_map(move |block| {
                    let all = values(block);
                    &all[n * all.len() / steps..(n + 1) * all.len() / steps]
                })
            };
            (0..steps).flat_map(step).copied().collect()
        };
        Self {
            increments: of(|block| &block.increments),
            areas: of(|block| &block.areas),
            space_time: of(|block| &block.space_time),
        }
    }
}

/// The space-time area of two steps on this noise.
fn joined_space_time([a, b]: [&[Row]; 2], [one, two]: [&StepNoise; 2]) -> Vec<Row> {
    let of = |m: usize, p: usize| {
        0.5 * (a[m][p] + b[m][p]) + 0.25 * (one.increments[m][p] - two.increments[m][p])
    };
    (0..a.len()).map(|m| std::array::from_fn(|p| of(m, p))).collect()
}

impl Referee<'_> {
    /// Space-time areas of the 32 paths from path number `first` on.
    fn space_time(&self, first: u64) -> WienerRows {
        WienerRows::new(self.sizes.key.beside(Purpose::SpaceTimeAreas), first)
    }

    /// Noise of `paths` paths from path number `first` on, both multiples of 32, at every step size
    /// of the solver, coarsest first.
    ///
    /// # Errors
    /// [`LadderError`] if areas would take too many terms.
    pub fn noise(&self, first: u64, paths: usize) -> Result<Vec<LevelNoise>, LadderError> {
        let sizes = &self.sizes;
        let tau = self.setup.problem.t_end / sizes.reference_steps() as f64;
        let areas = (self.noises() > 1).then_some(self.noises());
        let source = drawn(sizes.key.paths_of(Purpose::Paths)?, tau, areas)?;
        let blocks = (0..paths / WIDTH).into_par_iter().map(|block| {
            let first = first + (block * WIDTH) as u64;
            self.block(first, tau, source(first))
        });
        let blocks: Vec<_> = blocks.collect();
        let of_level = |l: usize| {
            let steps = (sizes.coarsest_steps << l) as usize;
            LevelNoise::joined(blocks.iter().map(|block| &block[l]), steps)
        };
        Ok((0..sizes.levels).map(of_level).collect())
    }

    /// The noise of 32 paths.
    fn block(&self, first: u64, tau: f64, mut next: NextNoise) -> Vec<LevelNoise> {
        let (sizes, mut others) = (&self.sizes, self.space_time(first));
        let (top, finest) = (sizes.level(0), sizes.refinement as usize);
        let mut ladder = DyadicLadder::new(top, &StepNoise::none(self.noises(), self.noises() > 1));
        let zero = vec![[0.0; WIDTH]; self.noises()];
        // Of the whole step of each level, and of its first half.
        let (mut whole, mut half) = (vec![zero.clone(); top + 1], vec![zero; top + 2]);
        let mut found = vec![LevelNoise::default(); sizes.levels];
        for _ in 0..sizes.reference_steps() {
            let complete = ladder.push(|noise| next(noise));
            others.increments((tau / 12.0).sqrt(), &mut whole[0]);
            for level in 1..=complete {
                let noise = [ladder.first_half(level), ladder.whole(level - 1)];
                whole[level] = joined_space_time([&half[level], &whole[level - 1]], noise);
            }
            half[complete + 1].clone_from(&whole[complete]);
            for level in finest..=complete {
                found[top - level].push(ladder.whole(level), &whole[level]);
            }
        }
        found
    }

    /// The noise of one step and of two half steps from each of [`VISITS`] states, and from these
    /// again with stronger noise, by [strength, state].
    pub fn single_noise(&self, tau: f64) -> [LevelNoise; 2] {
        let (noises, key) = (self.noises(), self.sizes.key);
        let block = |strength: f64, first: u64| {
            let [mut one, two] = two_steps(noises, noises > 1, key, first, 0.5 * tau, strength);
            let mut others = self.space_time(first);
            let [a, b] = [(); 2].map(|()| {
                let mut areas = vec![[0.0; WIDTH]; noises];
                others.increments((tau / 24.0).sqrt() * strength, &mut areas);
                areas
            });
            let [mut whole, mut halves] = [(); 2].map(|()| LevelNoise::default());
            halves.push(&one, &a);
            halves.push(&two, &b);
            let space_time = joined_space_time([&a, &b], [&one, &two]);
            one.join(&two);
            whole.push(&one, &space_time);
            [whole, halves]
        };
        let firsts = || (0..VISITS as u64).step_by(WIDTH);
        let of = |strength: f64| firsts().map(move |first| block(strength, first));
        let blocks: Vec<[LevelNoise; 2]> = STRENGTHS.into_iter().flat_map(of).collect();
        [0, 1].map(|n| LevelNoise::joined(blocks.iter().map(|block| &block[n]), n + 1))
    }
}
