//! The noise of coarser steps of a dyadic ladder, from that of the finest.

use crate::StepNoise;

/// The noise of every coarser step of a dyadic ladder: sums of increments, Lévy areas by Chen's
/// relation ([`join`](crate::join)), and space-time areas. A step of level ℓ consists of 2^ℓ finest
/// steps.
///
/// The noise of the finest steps is pushed step by step. When a step of a level is complete, the
/// level holds its *untruncated* noise and that of its first half. Memory: twice the noise of a
/// step per level, independent of the number of steps.
#[derive(Debug)]
pub struct DyadicLadder {
    first_half: Vec<StepNoise>,
    whole: Vec<StepNoise>,
    pushed: u64,
}

impl DyadicLadder {
    /// Ladder of `levels` levels above the finest, which is level 0, for noise with the rows of
    /// `no_noise`.
    pub fn new(levels: usize, no_noise: &StepNoise) -> Self {
        let whole = vec![no_noise.clone(); levels + 1];
        Self { first_half: whole.clone(), whole, pushed: 0 }
    }

    /// Adds the next finest step. `draw` writes its noise over that of the step before. Returns the
    /// highest level whose step is now complete; all lower levels are complete as well.
    #[inline]
    pub fn push(&mut self, draw: impl FnOnce(&mut StepNoise)) -> usize {
        draw(&mut self.whole[0]);
        self.pushed += 1;
        for level in 1..self.whole.len() {
            let (below, whole) = self.whole.split_at_mut(level);
            let (lower, first_half) = (&below[level - 1], &mut self.first_half[level]);
            if self.pushed >> (level - 1) & 1 == 1 {
                first_half.copy_from(lower);
                return level - 1;
            }
            whole[0].copy_from(first_half);
            whole[0].join(lower);
        }
        self.whole.len() - 1
    }

    /// The noise of the last complete step of `level`.
    pub fn whole(&self, level: usize) -> &StepNoise {
        &self.whole[level]
    }

    /// The noise of the first half of the last complete step of `level` ≥ 1. That of the second
    /// half is [`whole`](Self::whole) of the level below.
    pub fn first_half(&self, level: usize) -> &StepNoise {
        &self.first_half[level]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Noise;

    /// Pieces of a path; its areas are sums of triangles.
    fn pieces() -> Vec<[f64; 3]> {
        let piece = |n: i32| [n * n % 7 - 3, n * 5 % 11 - 5, n * 3 % 13 - 6].map(f64::from);
        (0..32).map(piece).collect()
    }

    /// Increments and areas of both kinds over some pieces, exact in floating point:
    /// all terms are integers or halves.
    fn noise_of(pieces: &[[f64; 3]]) -> Noise<3> {
        let (mut at, mut areas) = ([0.0; 3], [[0.0; 3]; 3]);
        for piece in pieces {
            for (i, j) in (0..3).flat_map(|i| (0..3).map(move |j| (i, j))) {
                areas[i][j] += 0.5 * (at[i] * piece[j] - at[j] * piece[i]);
            }
            at = std::array::from_fn(|m| at[m] + piece[m]);
        }
        Noise { increments: at, areas, space_time: space_time(pieces) }
    }

    /// H of a path of straight pieces of length one: ∫W ds/T − ½ΔW, exact in floating point.
    fn space_time(pieces: &[[f64; 3]]) -> [f64; 3] {
        let (mut at, mut integral) = ([0.0; 3], [0.0; 3]);
        for piece in pieces {
            integral = std::array::from_fn(|m| integral[m] + at[m] + 0.5 * piece[m]);
            at = std::array::from_fn(|m| at[m] + piece[m]);
        }
        std::array::from_fn(|m| integral[m] / pieces.len() as f64 - 0.5 * at[m])
    }

    #[test]
    fn a_path_has_the_noise_that_it_was_given() {
        let mut all = StepNoise::with_areas(3).with_space_time();
        let noise = Noise { space_time: [1.0, 2.0, 3.0], ..noise_of(&pieces()[..4]) };
        all.set_path(7, &noise);
        assert_eq!(all.path::<3>(7), noise);
        assert_eq!(all.path::<3>(6), Noise::increments([0.0; 3]));
    }

    #[test]
    fn every_level_holds_the_noise_of_its_step() {
        let pieces = pieces();
        let mut ladder = DyadicLadder::new(3, &StepNoise::with_areas(3).with_space_time());
        for (n, piece) in pieces.iter().enumerate() {
            let complete = ladder.push(|finest| finest.set_path(5, &noise_of(&[*piece])));
            assert_eq!(complete, ((n + 1).trailing_zeros() as usize).min(3));
            for level in 0..=complete {
                let step = &pieces[n + 1 - (1 << level)..=n];
                let (first, second) = step.split_at(step.len() / 2);
                assert_eq!(ladder.whole(level).path::<3>(5), noise_of(step), "{n} {level}");
                if level > 0 {
                    assert_eq!(ladder.first_half(level).path::<3>(5), noise_of(first));
                    assert_eq!(ladder.whole(level - 1).path::<3>(5), noise_of(second));
                }
            }
        }
    }
}
