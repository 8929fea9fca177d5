//! Processor time of a path: increments drawn and clipped, areas drawn and clipped where the scheme
//! reads them, steps.
//!
//! What is timed is how the block kernels are meant to be used: four blocks of 32 paths that share
//! the damping of a step, on one thread. Every repetition times every scheme at every number of
//! steps once, so that a disturbance hits all of them.

use std::hint::black_box;

use noise::{AreaBlock, AreaSampler, StreamKey, Truncation, WienerBlock, clip};
use nonlin::BlockStatus;
use real::{Block, WIDTH};
use schemes::{Scheme, Step};
use systems::{Damping, PoissonSystem, Problem};

use crate::clock::thread_time;
use crate::own_areas::{METHOD, terms};
use crate::results::Time;

/// Blocks that march together, as in a ladder.
pub(crate) const BLOCKS: usize = 4;
/// Paths of them.
const PATHS: u64 = (BLOCKS * WIDTH) as u64;

/// What all times of a case share.
pub(crate) struct Course<'a, S, G, const D: usize> {
    pub problem: &'a Problem<S, G, D>,
    pub truncation: Truncation,
    pub key: StreamKey,
}

impl<S, G: Damping, const D: usize> Course<'_, S, G, D> {
    /// The final states of paths `first_path` .. `first_path` + 128 in `steps` steps.
    pub(crate) fn march<const M: usize>(
        &self,
        scheme: &dyn Scheme<S, D, M>,
        steps: u64,
        first_path: u64,
    ) -> [Block<D>; BLOCKS]
    where
        S: PoissonSystem<D, M>,
    {
        let tau = self.problem.t_end / steps as f64;
        let bounds = self
            .truncation
            .bound(tau)
            .and_then(|bound| Ok((bound, self.truncation.area_bound(tau)?)));
        let (bound, area_bound) =
            bounds.unwrap_or_else(|error| unreachable!("the steps are below one: {error}"));
        let needs_areas = scheme.needs_areas();
        let terms = if needs_areas { terms(tau, M) } else { 0 };
        let first = |b: usize| first_path + (b * WIDTH) as u64;
        let mut noises: [WienerBlock<M>; BLOCKS] =
            std::array::from_fn(|b| WienerBlock::new(self.key, first(b)));
        let mut samplers: Vec<AreaSampler<M>> = if needs_areas {
            (0..BLOCKS).map(|b| AreaSampler::new(self.key, first(b), METHOD, terms)).collect()
        } else {
            Vec::new()
        };
        let mut states = [Block::splat(self.problem.y0); BLOCKS];
        let (mut dw, mut clipped) = (Block::zero(), Block::zero());
        let (mut drawn, mut areas) = (AreaBlock::zero(), AreaBlock::zero());
        let mut status = BlockStatus::explicit();
        for n in 0..steps {
            let step = Step::new(&self.problem.damping, n, tau).unwrap_or_else(|error| {
                unreachable!("a validated problem has positive steps: {error}")
            });
            for (b, state) in states.iter_mut().enumerate() {
                noises[b].increments(tau.sqrt(), &mut dw);
                if let Some(sampler) = samplers.get_mut(b) {
                    sampler.areas(tau, &dw, &mut drawn);
                    areas = drawn.clipped(area_bound).0;
                }
                clip(&dw, bound, &mut clipped);
                scheme.step_block_with_areas(
                    &self.problem.system,
                    &step,
                    &clipped,
                    &areas,
                    state,
                    &mut status,
                );
            }
        }
        states
    }

    /// The time of a path for every scheme, by scheme and number of steps.
    pub(crate) fn times<const M: usize>(
        &self,
        schemes: &[&dyn Scheme<S, D, M>],
        steps: &[u64],
        repetitions: usize,
        path_steps: u64,
        progress: &dyn Fn(u64),
    ) -> Vec<Vec<Time>>
    where
        S: PoissonSystem<D, M>,
    {
        let marches = |steps: u64| path_steps.div_ceil(PATHS * steps).max(1);
        let mut seconds = vec![vec![Vec::with_capacity(repetitions); steps.len()]; schemes.len()];
        for _ in 0..repetitions {
            for (scheme, of_scheme) in schemes.iter().zip(&mut seconds) {
                for (&steps, of_steps) in steps.iter().zip(of_scheme) {
                    let start = thread_time();
                    for march in 0..marches(steps) {
                        black_box(self.march(*scheme, steps, march * PATHS));
                    }
                    let paths = marches(steps) * PATHS;
                    of_steps.push((thread_time() - start).as_secs_f64() / paths as f64);
                    progress(paths * steps);
                }
            }
        }
        let summary = |(mut seconds, &steps): (Vec<f64>, &u64)| {
            seconds.sort_by(f64::total_cmp);
            let count = seconds.len();
            Time {
                min_s: seconds[0],
                median_s: 0.5 * (seconds[(count - 1) / 2] + seconds[count / 2]),
                max_s: seconds[count - 1],
                repetitions: count,
                paths: marches(steps) * PATHS,
            }
        };
        seconds
            .into_iter()
            .map(|of_scheme| of_scheme.into_iter().zip(steps).map(summary).collect())
            .collect()
    }

    /// Path-steps that [`times`](Self::times) does.
    pub(crate) fn work(schemes: usize, steps: &[u64], repetitions: usize, path_steps: u64) -> u64 {
        let of_steps = |&steps: &u64| path_steps.div_ceil(PATHS * steps).max(1) * PATHS * steps;
        steps.iter().map(of_steps).sum::<u64>() * (schemes * repetitions) as u64
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lab::Compiled;
    use mc::trajectory;
    use schemes::{Sexp, SexpLevy};
    use systems::{Cosine, RigidBody};

    #[test]
    fn what_is_timed_are_the_paths_of_the_other_crates() -> Result<(), Box<dyn std::error::Error>> {
        let body = RigidBody::three_noises([2.0, 1.0, 2.0 / 3.0], [1.0, 2.0, 3.0])?;
        let problem = Problem::new(body, Cosine::new(0.5, 2.0)?, [0.45, 0.0, 0.89], 1.0)?;
        let (truncation, key) = (Truncation::new(4)?, StreamKey { seed: 3, experiment: 1 });
        let course = Course { problem: &problem, truncation, key };
        let levy = RigidBody::sexp_levy(SexpLevy::new(&problem.system, problem.y0));
        let schemes = [RigidBody::sexp(Sexp::default()), levy, RigidBody::heun()];
        let schemes: Vec<&dyn Scheme<_, 3, 3>> = schemes.iter().map(AsRef::as_ref).collect();
        for &scheme in &schemes {
            let ends = course.march(scheme, 32, 128);
            for path in [0usize, 31, 32, 127] {
                let alone = trajectory(&problem, scheme, 32, truncation, key, 128 + path as u64)?;
                assert_eq!(
                    alone.states[32],
                    ends[path / WIDTH].path(path % WIDTH),
                    "{} {path}",
                    scheme.id()
                );
            }
        }
        let times = course.times(&schemes, &[8, 16], 3, 1, &|_| ());
        for time in times.iter().flatten() {
            assert!(
                0.0 <= time.min_s && time.min_s <= time.median_s && time.median_s <= time.max_s,
                "{time:?}"
            );
            assert_eq!((time.repetitions, time.paths), (3, PATHS));
        }
        Ok(())
    }
}
