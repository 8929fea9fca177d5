//! The noise that a solver gets.
//!
//! All of it is made of finest steps, those of the reference. Space-time areas H =
//! ∫(W − t ΔW/τ)dt/τ are independent of the Lévy areas given W.

use mc::{LadderError, NextNoise, drawn};
use noise::{DyadicLadder, Purpose, StepNoise};
use rayon::prelude::*;
use real::WIDTH;

use super::{
    super::one_step::{nodes, two_steps},
    Referee,
};

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
    fn push(&mut self, noise: &StepNoise) {
        let noises = noise.increments.len();
        for p in 0..WIDTH {
            self.increments.extend(noise.increments.iter().map(|row| row[p]));
            self.space_time.extend(noise.space_time.iter().map(|row| row[p]));
            for (i, j) in (0..noises).flat_map(|i| (0..noises).map(move |j| (i, j))) {
                let row = noise.areas.get(i.min(j) * noises + i.max(j));
                let sign = f64::from(u8::from(i < j)) - f64::from(u8::from(i > j));
                self.areas.extend(row.map(|row| sign * row[p]));
            }
        }
    }

    /// Joins blocks of 32 paths side by side in each of `steps` steps.
    fn joined<'b>(blocks: impl Iterator<Item = &'b Self> + Clone, steps: usize) -> Self {
        let of = |values: fn(&Self) -> &[f64]| {
            let mut all = Vec::new();
            for n in 0..steps {
                for values in blocks.clone().map(values) {
                    let of_step = n * values.len() / steps..(n + 1) * values.len() / steps;
                    all.extend_from_slice(&values[of_step]);
                }
            }
            all
        };
        Self {
            increments: of(|block| &block.increments),
            areas: of(|block| &block.areas),
            space_time: of(|block| &block.space_time),
        }
    }
}

impl Referee<'_> {
    /// Zero noise with all that a solver gets.
    fn none(&self) -> StepNoise {
        StepNoise::none(self.noises(), self.noises() > 1).with_space_time()
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
        let blocks = (0..paths / WIDTH).into_par_iter();
        let blocks = blocks.map(|block| self.block(source(first + (block * WIDTH) as u64)));
        let blocks: Vec<_> = blocks.collect();
        let of_level = |l: usize| {
            let steps = (sizes.coarsest_steps << l) as usize;
            LevelNoise::joined(blocks.iter().map(|block| &block[l]), steps)
        };
        Ok((0..sizes.levels).map(of_level).collect())
    }

    /// The noise of 32 paths.
    fn block(&self, mut next: NextNoise) -> Vec<LevelNoise> {
        let sizes = &self.sizes;
        let (top, finest) = (sizes.level(0), sizes.refinement as usize);
        let mut ladder = DyadicLadder::new(top, &self.none());
        let mut found = vec![LevelNoise::default(); sizes.levels];
        for _ in 0..sizes.reference_steps() {
            let complete = ladder.push(|noise| next(noise));
            for level in finest..=complete {
                found[top - level].push(ladder.whole(level));
            }
        }
        found
    }

    /// The noise of one step and of two half steps from each of [`VISITS`] states, and from these
    /// again with stronger noise, by [strength, state]; then, of one noise, that of each
    /// node of the cubature by which means are computed.
    pub fn single_noise(&self, tau: f64) -> [LevelNoise; 2] {
        let mut blocks = Vec::new();
        let mut push = |[mut one, two]: [StepNoise; 2]| {
            let [mut whole, mut halves] = [LevelNoise::default(), LevelNoise::default()];
            halves.push(&one);
            halves.push(&two);
            one.join(&two);
            whole.push(&one);
            blocks.push([whole, halves]);
        };
        let (none, key) = (self.none(), self.sizes.key);
        let firsts = || (0..VISITS as u64).step_by(WIDTH);
        for strength in STRENGTHS {
            firsts().for_each(|first| push(two_steps(&none, key, first, 0.5 * tau, strength)));
        }
        if self.noises() == 1 {
            for (noises, weights) in nodes(&none, 0.5 * tau) {
                for node in 0..weights.len() {
                    let mut all = [none.clone(), none.clone()];
                    for (all, noise) in all.iter_mut().zip(&noises) {
                        (0..WIDTH).for_each(|p| all.copy_path(p, noise, node));
                    }
                    firsts().for_each(|_| push(all.clone()));
                }
            }
        }
        [0, 1].map(|n| LevelNoise::joined(blocks.iter().map(|block| &block[n]), n + 1))
    }

    /// The weights of the nodes of [`single_noise`](Self::single_noise); none for several noises.
    pub(super) fn weights(&self) -> Vec<f64> {
        if self.noises() != 1 {
            return Vec::new();
        }
        nodes(&self.none(), 1.0).into_iter().flat_map(|(_, weights)| weights).collect()
    }
}
