//! Schemes on the Sobol points of several scrambles.

use anyhow::Result;
use lab::truncation;
use mc::{Ladder, Measured, NextNoise, NoiseSource, Run, Statistic};
use noise::{BlockNoise, QuasiWiener, StepNoise, StreamKey};
use real::WIDTH;
use stats::{CONFIDENCE, CrossMoments, Moments, two_sided};
use systems::{Damping, PoissonSystem, Problem};

/// Independent scrambles, and the points of each.
#[derive(Clone, Copy)]
pub struct Scrambles {
    pub key: StreamKey,
    pub count: u64,
    pub points: u64,
}

/// The points of a scramble.
struct Points(QuasiWiener);

impl<const M: usize> NoiseSource<BlockNoise<M>> for Points {
    fn block(&self, first_path: u64) -> NextNoise<'_, BlockNoise<M>> {
        let mut increments = vec![[0.0; WIDTH]; self.0.dimensions()];
        let drawn = self.0.block(first_path, &mut increments);
        // There are far fewer points than a scramble has.
        drawn.unwrap_or_else(|error| unreachable!("{error}"));
        let mut next = 0;
        Box::new(move |noise| {
            noise.increments_mut().copy_from_slice(&increments[next..next + M]);
            next += M;
        })
    }
}

impl Scrambles {
    /// A statistic of `runs` over the points of each scramble, with the finest `steps` on [0, T]
    /// and so many levels above them. `new` makes an empty one.
    pub fn each<
        'a,
        S: PoissonSystem<D, M>,
        G: Damping,
        T: Statistic,
        const D: usize,
        const M: usize,
    >(
        self,
        problem: &'a Problem<S, G, D>,
        (steps, levels): (u64, usize),
        runs: impl Fn() -> Vec<Run<'a, S, D, M>>,
        new: impl Fn() -> T + Sync,
    ) -> Result<Vec<Measured<T>>> {
        let measure = |scramble| {
            let wiener = QuasiWiener::new(self.key, scramble, steps, M, problem.t_end())?;
            let ladder = Ladder::new(problem, steps, levels, truncation(), self.key, runs())?;
            Ok(ladder.with_noise(Points(wiener))?.run(self.points, &new, &|_| ()))
        };
        (0..self.count).map(measure).collect()
    }
}

/// For each number the mean of the means of scrambles with the half-width of its 95 % interval by
/// Student's law, and the failed paths of all scrambles.
pub fn means<T>(
    measured: &[Measured<T>],
    moments: impl Fn(&T) -> &CrossMoments,
) -> (Vec<(f64, f64)>, u64) {
    let length = measured.first().map_or(0, |one| moments(&one.statistic).length());
    let quantile = two_sided(CONFIDENCE, Some(measured.len() as f64 - 1.0));
    let mean = |index| {
        let mut means = Moments::default();
        measured.iter().for_each(|one| means.add(moments(&one.statistic).mean(index)));
        (means.mean(), quantile * means.standard_error())
    };
    ((0..length).map(mean).collect(), measured.iter().map(|one| one.failed).sum())
}
