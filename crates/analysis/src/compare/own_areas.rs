//! Lévy areas as they are when drawn at the step itself.
//!
//! On a ladder the areas of a step are joined from those of the finest steps and are practically
//! exact. A user of the scheme has no finer steps: areas are drawn at τ with a root-mean-square
//! error δ(τ) in each entry, which counts in the strong error of what is timed. The drawn area and
//! the exact one can be coupled in theory only, so the error is put back here: a centred normal of
//! standard deviation δ(τ), the proven bound, is added to every entry. It is drawn from a stream
//! keyed by the bits of the path's areas, so that the scheme still keeps no state and a path is the
//! same in any block. The actual error is about half the bound, so the error measured is an upper
//! estimate.

use std::sync::Arc;

use noise::{StepNoise, StreamKey, WienerPath, area_error, area_terms, strong_order_one_error};
use nonlin::BlockStatus;
use real::{Row, WIDTH};
use schemes::{Method, Step, Stepper};

/// δ(τ), with the terms of the series that strong order one asks for, unless they are too many.
fn size(tau: f64, noises: usize) -> f64 {
    let asked = strong_order_one_error(tau);
    let terms = area_terms(asked, tau, noises);
    terms.map_or(asked, |terms| area_error(tau, terms, noises))
}

/// The scheme as users have it: with Lévy areas as it would draw them, if it reads areas.
pub fn as_drawn<'a>(scheme: &Arc<dyn Method + 'a>) -> Arc<dyn Method + 'a> {
    match scheme.reads_areas() {
        true => Arc::new(OwnAreas(Arc::clone(scheme))),
        false => Arc::clone(scheme),
    }
}

/// A scheme with areas as they are drawn at the step itself.
struct OwnAreas<'a>(Arc<dyn Method + 'a>);

impl Method for OwnAreas<'_> {
    fn id(&self) -> &'static str {
        self.0.id()
    }
    fn reads_areas(&self) -> bool {
        self.0.reads_areas()
    }
    fn clips_increments(&self) -> bool {
        self.0.clips_increments()
    }
    fn stack(&self) -> usize {
        self.0.stack()
    }
    fn start(&self, y: &[Row]) -> Box<dyn Stepper + '_> {
        Box::new(Disturbed { stepper: self.0.start(y), noise: StepNoise::zero(0) })
    }
}

struct Disturbed<'a> {
    stepper: Box<dyn Stepper + 'a>,
    /// The noise of the last step, disturbed.
    noise: StepNoise,
}

impl Stepper for Disturbed<'_> {
    fn step(&mut self, step: &Step, noise: &StepNoise, status: &mut BlockStatus) {
        let noises = noise.increments.len();
        if self.noise.increments.len() != noises {
            self.noise = StepNoise::with_areas(noises);
        }
        let (size, mut areas) = (size(step.tau, noises), vec![0.0; noises * noises]);
        self.noise.increments.copy_from_slice(&noise.increments);
        for p in 0..WIDTH {
            for (i, j) in (0..noises).flat_map(|i| (0..noises).map(move |j| (i, j))) {
                let [one, other] = [i * noises + j, j * noises + i];
                areas[one] = noise.areas[one][p] - noise.areas[other][p];
            }
            disturb(size, noises, &mut areas);
            for (i, j) in (0..noises).flat_map(|i| (i + 1..noises).map(move |j| (i, j))) {
                self.noise.areas[i * noises + j][p] = areas[i * noises + j];
            }
        }
        self.stepper.step(step, &self.noise, status);
    }
    fn state(&self) -> &[Row] {
        self.stepper.state()
    }
    fn state_mut(&mut self) -> &mut [Row] {
        self.stepper.state_mut()
    }
}

/// A stream of its own among those of the workspace.
const STREAM: u64 = 0x6f77_6e2d_6172_6561;

/// Adds errors of standard deviation `size` to the entries i < j of a skew matrix, row by row, and
/// takes them from the others.
fn disturb(size: f64, noises: usize, areas: &mut [f64]) {
    // Numbers of different paths and steps differ in some area; a product with an odd number keeps
    // all of them.
    let bits = areas.iter().fold(STREAM, |hash, area| {
        (hash ^ area.to_bits()).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(29)
    });
    let mut normals = WienerPath::<1>::new(StreamKey { seed: bits, experiment: STREAM }, 0);
    for i in 0..noises {
        for j in i + 1..noises {
            let disturbed = areas[i * noises + j] + normals.increments(size)[0];
            (areas[i * noises + j], areas[j * noises + i]) = (disturbed, -disturbed);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_error_has_the_size_of_the_bound_and_depends_on_the_areas_alone() {
        let tau = 1.0 / 64.0;
        let size = size(tau, 3);
        let (mut sum, mut squares, mut cross) = (0.0, 0.0, 0.0);
        let count = 20_000;
        for n in 0..count {
            let a = 0.1 * tau * f64::from(n);
            let disturbed = || {
                let mut areas = [0.0, a, 0.0, -a, 0.0, 0.0, 0.0, 0.0, 0.0];
                disturb(size, 3, &mut areas);
                areas
            };
            assert_eq!(disturbed(), disturbed());
            let disturbed = disturbed();
            assert_eq!(disturbed[3], -disturbed[1]);
            let (one, other) = ((disturbed[1] - a) / size, disturbed[2] / size);
            sum += one;
            squares += one * one;
            cross += one * other;
        }
        // Five standard deviations of means over 20 000 normals: 0.035, of squares 0.05.
        let count = f64::from(count);
        assert!((sum / count).abs() < 0.036 && (cross / count).abs() < 0.036);
        assert!((squares / count - 1.0).abs() < 0.05);
        assert!(size <= strong_order_one_error(tau));
    }
}
