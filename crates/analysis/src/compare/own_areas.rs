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

use noise::{AreaMethod, BlockNoise, StreamKey, WienerPath, strong_order_one_error};
use nonlin::BlockStatus;
use real::{Row, WIDTH};
use schemes::{DynScheme, RunState, Step};

/// The method that areas are drawn with.
const METHOD: AreaMethod = AreaMethod::MrongowiusRoessler;

/// Terms behind an area of a step, for strong order one; `None` if they are too many.
pub fn terms(tau: f64, noises: usize) -> Option<usize> {
    METHOD.terms_for(strong_order_one_error(tau), tau, noises).ok()
}

/// δ(τ).
fn size(tau: f64, noises: usize) -> f64 {
    let asked = strong_order_one_error(tau);
    terms(tau, noises).map_or(asked, |terms| METHOD.rms_error(tau, terms, noises))
}

/// A scheme with areas as they are drawn at the step itself.
pub struct OwnAreas<'a, const M: usize>(pub Arc<dyn DynScheme<BlockNoise<M>> + 'a>);

impl<const M: usize> DynScheme<BlockNoise<M>> for OwnAreas<'_, M> {
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
    fn start(&self, y: &[Row]) -> Box<dyn RunState<BlockNoise<M>> + '_> {
        Box::new(Disturbed(self.0.start(y)))
    }
}

struct Disturbed<'a, const M: usize>(Box<dyn RunState<BlockNoise<M>> + 'a>);

impl<const M: usize> RunState<BlockNoise<M>> for Disturbed<'_, M> {
    fn step(&mut self, step: &Step, noise: &BlockNoise<M>, status: &mut BlockStatus) {
        let (mut drawn, size) = (noise.clone(), size(step.tau, M));
        (0..WIDTH).for_each(|p| drawn.areas.set_path(p, disturb(size, noise.areas.path(p))));
        self.0.step(step, &drawn, status);
    }
    fn rows(&self) -> &[Row] {
        self.0.rows()
    }
    fn rows_mut(&mut self) -> &mut [Row] {
        self.0.rows_mut()
    }
}

/// A stream of its own among those of the workspace.
const STREAM: u64 = 0x6f77_6e2d_6172_6561;

/// Adds errors of standard deviation `size` to the entries i < j of a skew matrix, and takes them
/// from the others.
fn disturb<const M: usize>(size: f64, areas: [[f64; M]; M]) -> [[f64; M]; M] {
    // Numbers of different paths and steps differ in some area; a product with an odd number keeps
    // all of them.
    let bits = areas.iter().flatten().fold(STREAM, |hash, area| {
        (hash ^ area.to_bits()).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(29)
    });
    let mut normals = WienerPath::<1>::new(StreamKey { seed: bits, experiment: STREAM }, 0);
    let mut disturbed = areas;
    for i in 0..M {
        for j in i + 1..M {
            disturbed[i][j] = areas[i][j] + normals.increments(size)[0];
            disturbed[j][i] = -disturbed[i][j];
        }
    }
    disturbed
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
            let areas = [[0.0, a, 0.0], [-a, 0.0, 0.0], [0.0, 0.0, 0.0]];
            let disturbed = disturb(size, areas);
            assert_eq!(disturbed, disturb(size, areas));
            assert_eq!(disturbed[1][0], -disturbed[0][1]);
            let (one, other) = ((disturbed[0][1] - a) / size, disturbed[0][2] / size);
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
