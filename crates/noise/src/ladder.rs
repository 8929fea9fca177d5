//! Sums of fine increments over the coarser steps of a dyadic ladder.

use real::{Block, WIDTH};

/// Sums of fine increments over every coarser step of a dyadic ladder. A step of level ℓ consists
/// of 2^ℓ finest steps.
///
/// Increments of the finest steps are pushed one at a time. When a step of a level is complete, the
/// level holds the *untruncated* sum W(t + 2^ℓτ) − W(t) and the sum over the first half of the
/// step. Memory: two blocks per level, independent of the number of steps.
#[derive(Clone, Debug)]
pub struct DyadicLadder<const M: usize> {
    first_half: Vec<Block<M>>,
    sum: Vec<Block<M>>,
    pushed: u64,
}

impl<const M: usize> DyadicLadder<M> {
    /// A ladder of `levels` levels above the finest, which is level 0.
    pub fn new(levels: usize) -> Self {
        let sum = vec![Block::zero(); levels + 1];
        Self { first_half: sum.clone(), sum, pushed: 0 }
    }

    /// Adds the next finest increment. Returns the highest level whose step is now complete; all
    /// lower levels are complete as well.
    pub fn push(&mut self, dw: &Block<M>) -> usize {
        self.sum[0] = *dw;
        self.pushed += 1;
        let top = self.sum.len() - 1;
        for level in 1..=top {
            let lower = self.sum[level - 1];
            if self.pushed >> (level - 1) & 1 == 1 {
                self.first_half[level] = lower;
                return level - 1;
            }
            for m in 0..M {
                for p in 0..WIDTH {
                    self.sum[level].0[m][p] = self.first_half[level].0[m][p] + lower.0[m][p];
                }
            }
        }
        top
    }

    /// The increment over the last complete step of `level`.
    pub fn increment(&self, level: usize) -> &Block<M> {
        &self.sum[level]
    }

    /// The increment over the first half of the last complete step of `level` ≥ 1. That of the
    /// second half is [`increment`](Self::increment) of the level below.
    pub fn first_half(&self, level: usize) -> &Block<M> {
        &self.first_half[level]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_level_holds_the_sum_of_its_step() {
        let mut ladder = DyadicLadder::<1>::new(3);
        // Increment number n is n + 1. Sums are differences of triangular numbers, exact in
        // floating point.
        let triangular = |n: u64| (n * (n + 1) / 2) as f64;
        for n in 0..32u64 {
            let complete = ladder.push(&Block::splat([(n + 1) as f64]));
            assert_eq!(complete, ((n + 1).trailing_zeros() as usize).min(3));
            for level in 0..=complete {
                let step = 1 << level;
                let expected = triangular(n + 1) - triangular(n + 1 - step);
                assert_eq!(ladder.increment(level).0[0][5], expected);
                if level > 0 {
                    let first = triangular(n + 1 - step / 2) - triangular(n + 1 - step);
                    assert_eq!(ladder.first_half(level).0[0][5], first);
                }
            }
        }
    }
}
