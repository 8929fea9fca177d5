//! Interpretations of the noise: Itô, Stratonovich, and what lies between.

use noise::WienerRows;
use rayon::prelude::*;
use real::WIDTH;

use super::{Referee, SolverStates, distance};

/// Number of paths on which interpretations are compared.
const FEW: usize = 256;
/// The part of a squared distance that an interpretation may leave.
const EXPLAINED: f64 = 0.25;

impl Referee<'_> {
    /// Finds another interpretation of the noise that has the limit of a solver: Euler's method on
    /// the noise of the reference, with a multiple of the Itô correction.
    pub(super) fn solves(&self, states: &SolverStates, paths: &[usize]) -> Option<&'static str> {
        let Self { setup: mc::Setup { problem, .. }, sizes } = self;
        let (d, steps) = (problem.y0.len(), sizes.reference_steps());
        let tau = problem.t_end / steps as f64;
        let finest = states.levels.last()?;
        // The squared distance from the ends of Euler's method, of the paths of a block.
        let of_block = |part: f64, paths: &[usize]| -> f64 {
            let mut wiener = WienerRows::new(sizes.key, (paths[0] / WIDTH * WIDTH) as u64);
            let mut dw = vec![[0.0; WIDTH]; problem.noises];
            let at = |states: &[f64], path: &usize| states[path * d..(path + 1) * d].to_vec();
            let mut ends: Vec<_> = paths.iter().map(|path| at(&states.start, path)).collect();
            for n in 0..steps {
                let t = n as f64 * tau;
                wiener.increments(tau.sqrt(), &mut dw);
                // Friction is in the drift.
                let rate = problem.damping.rate(t);
                for (y, path) in ends.iter_mut().zip(paths) {
                    let at = (problem.coefficients)(t, y);
                    for i in 0..d {
                        let drift = at.drift[i] + part * at.correction[i] - rate * y[i];
                        let noises = at.noises.iter().zip(&dw);
                        let noise: f64 = noises.map(|(b, dw)| b[i] * dw[path % WIDTH]).sum();
                        y[i] += drift * tau + noise;
                    }
                }
            }
            paths.iter().zip(&ends).map(|(path, end)| distance(&at(finest, path), end)).sum()
        };
        let few = &paths[..paths.partition_point(|path| *path < FEW)];
        let blocks: Vec<&[usize]> = few.chunk_by(|a, b| a / WIDTH == b / WIDTH).collect();
        let distance = |part: f64| -> f64 {
            let of_blocks = blocks.par_iter().map(|paths| of_block(part, paths));
            of_blocks.collect::<Vec<f64>>().iter().sum()
        };
        let wrong = [
            (0.0, "the equation in the sense of Itô, without the correction ½Σb′b"),
            (0.5, "an equation with half of the Itô correction ½Σb′b"),
            (2.0, "an equation with twice the Itô correction ½Σb′b"),
        ];
        let found = wrong.map(|(part, words)| (distance(part), words));
        let (least, words) = found.into_iter().min_by(|a, b| a.0.total_cmp(&b.0))?;
        (least < EXPLAINED * distance(1.0)).then_some(words)
    }
}
