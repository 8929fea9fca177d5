//! Counts of values in bins.

use real::{PathMask, WIDTH};
use serde::{Deserialize, Serialize};

/// The counts of all cells, one after the other. Counts are integers, so they are the same in
/// whatever order paths are added and merged.
///
/// They have two bytes until one may need more, which is never in a group of paths: what a group
/// sums up fits into the cache.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(into = "Vec<u64>", from = "Vec<u64>")]
pub struct Counts {
    /// While no count can exceed 65535; empty otherwise.
    narrow: Vec<u16>,
    /// Otherwise.
    wide: Vec<u64>,
}

impl Counts {
    pub fn new(length: usize) -> Self {
        Self { narrow: vec![0; length], wide: Vec::new() }
    }

    /// Adds one to the count number `first` + `places[p]` of each path p of a group, whose counts
    /// are narrow.
    pub fn add(&mut self, first: usize, places: &[u32; WIDTH], paths: PathMask) {
        let counts = &mut self.narrow[first..];
        match paths == PathMask::ALL {
            true => places.iter().for_each(|&place| counts[place as usize] += 1),
            false => paths.paths().for_each(|p| counts[places[p] as usize] += 1),
        }
    }

    /// Adds all counts of `later`. `most` is what no count exceeds afterwards.
    pub fn merge(&mut self, later: &Self, most: u64) {
        self.reserve(if later.wide.is_empty() { most } else { u64::MAX });
        // One of the two is empty.
        self.narrow.iter_mut().zip(&later.narrow).for_each(|(sum, more)| *sum += more);
        self.wide.iter_mut().zip(later.iter()).for_each(|(sum, more)| *sum += more);
    }

    fn reserve(&mut self, most: u64) {
        if most > u64::from(u16::MAX) && self.wide.is_empty() {
            self.wide = self.iter().collect();
            self.narrow.clear();
        }
    }

    fn iter(&self) -> impl Iterator<Item = u64> {
        self.narrow.iter().map(|&count| u64::from(count)).chain(self.wide.iter().copied())
    }

    /// The counts from `start` on.
    pub fn range(&self, start: usize, length: usize) -> Vec<u64> {
        let cells = start..start + length;
        match self.wide.is_empty() {
            true => self.narrow[cells].iter().map(|&count| u64::from(count)).collect(),
            false => self.wide[cells].to_vec(),
        }
    }
}

impl From<Counts> for Vec<u64> {
    fn from(counts: Counts) -> Self {
        counts.iter().collect()
    }
}

impl From<Vec<u64>> for Counts {
    fn from(wide: Vec<u64>) -> Self {
        Self { narrow: Vec::new(), wide }
    }
}

impl PartialEq for Counts {
    fn eq(&self, other: &Self) -> bool {
        self.iter().eq(other.iter())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_are_widened_before_they_overflow() {
        let places = [0; WIDTH];
        let (mut counts, mut one) = (Counts::new(2), Counts::new(2));
        one.add(0, &places, PathMask(1 << 7));
        for most in 1..=65_535 {
            counts.merge(&one, most);
        }
        assert!(counts.wide.is_empty() && counts == Counts::from(vec![65_535, 0]));
        let mut block = Counts::new(2);
        block.add(0, &places, PathMask::ALL);
        counts.merge(&block, 65_567);
        assert_eq!(counts, Counts::from(vec![65_567, 0]));

        let mut narrow = Counts::new(2);
        narrow.add(1, &places, PathMask(1));
        for (first, second) in [(&narrow, &counts), (&counts, &narrow)] {
            let mut sum = first.clone();
            sum.merge(second, 65_567);
            assert_eq!(sum, Counts::from(vec![65_567, 1]));
        }
        let mut twice = narrow.clone();
        twice.merge(&narrow, 2);
        assert!(twice.wide.is_empty() && twice.range(0, 2) == [0, 2]);
    }
}
