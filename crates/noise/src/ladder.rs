//! Sums of fine increments over the coarser steps of a dyadic ladder.

use real::{Row, Rows};

use crate::step::zero_rows;

/// Sums of fine increments over every coarser step of a dyadic ladder. A step of level ℓ consists
/// of 2^ℓ finest steps.
///
/// Increments of the finest steps are pushed one at a time. When a step of a level is complete, the
/// level holds the *untruncated* sum W(t + 2^ℓτ) − W(t) and the sum over the first half of the
/// step. Memory: two blocks per level, independent of the number of steps.
#[derive(Debug)]
pub struct DyadicLadder {
    noises: usize,
    levels: usize,
    /// The rows of level 0, of level 1, and so on.
    first_half: Rows,
    sum: Rows,
    pushed: u64,
}

impl DyadicLadder {
    /// A ladder of `levels` levels above the finest, which is level 0, for so many noises.
    ///
    /// # Panics
    /// If there is no memory for it.
    pub fn new(noises: usize, levels: usize) -> Self {
        let zero = || zero_rows(noises.saturating_mul(levels + 1));
        Self { noises, levels, first_half: zero(), sum: zero(), pushed: 0 }
    }

    /// Adds the next finest increment, one row for each noise. Returns the highest level whose step
    /// is now complete; all lower levels are complete as well.
    #[inline]
    pub fn push(&mut self, dw: &[Row]) -> usize {
        let noises = self.noises;
        self.sum[..noises].copy_from_slice(dw);
        self.pushed += 1;
        for level in 1..=self.levels {
            let first_half = &mut self.first_half[level * noises..][..noises];
            let (lower, sum) = self.sum[(level - 1) * noises..][..2 * noises].split_at_mut(noises);
            if self.pushed >> (level - 1) & 1 == 1 {
                first_half.copy_from_slice(lower);
                return level - 1;
            }
            let halves = first_half.as_flattened().iter().zip(lower.as_flattened());
            let sums = sum.as_flattened_mut().iter_mut().zip(halves);
            sums.for_each(|(sum, (first, second))| *sum = first + second);
        }
        self.levels
    }

    /// The increment over the last complete step of `level`, one row for each noise.
    pub fn increment(&self, level: usize) -> &[Row] {
        &self.sum[level * self.noises..][..self.noises]
    }

    /// The increment over the first half of the last complete step of `level` ≥ 1. That of the
    /// second half is [`increment`](Self::increment) of the level below.
    pub fn first_half(&self, level: usize) -> &[Row] {
        &self.first_half[level * self.noises..][..self.noises]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use real::WIDTH;

    #[test]
    fn every_level_holds_the_sum_of_its_step() {
        let mut ladder = DyadicLadder::new(1, 3);
        // Increment number n is n + 1. Sums are differences of triangular numbers, exact in
        // floating point.
        let triangular = |n: u64| (n * (n + 1) / 2) as f64;
        for n in 0..32u64 {
            let complete = ladder.push(&[[(n + 1) as f64; WIDTH]]);
            assert_eq!(complete, ((n + 1).trailing_zeros() as usize).min(3));
            for level in 0..=complete {
                let step = 1 << level;
                let expected = triangular(n + 1) - triangular(n + 1 - step);
                assert_eq!(ladder.increment(level)[0][5], expected);
                if level > 0 {
                    let first = triangular(n + 1 - step / 2) - triangular(n + 1 - step);
                    assert_eq!(ladder.first_half(level)[0][5], first);
                }
            }
        }
    }
}
