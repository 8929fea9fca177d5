//! Counts of values in bins.

use real::{PathMask, WIDTH};
use serde::{Deserialize, Serialize};

/// The counts of all cells, one after the other. Counts are integers, so they are the same in
/// whatever order paths are added and merged.
///
/// They have two bytes until one may need more: what a group of paths sums up fits into the cache.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(into = "Vec<u64>", from = "Vec<u64>")]
pub enum Counts {
    /// While no count can exceed 65535.
    Narrow(Vec<u16>),
    /// Otherwise.
    Wide(Vec<u64>),
}

impl Counts {
    pub fn new(length: usize) -> Self {
        Self::Narrow(vec![0; length])
    }

    /// Adds one to the count number `first` + `places[p]` of each path p. `most` is what none of
    /// these counts exceeds afterwards.
    pub fn add(&mut self, first: usize, places: &[u32; WIDTH], paths: PathMask, most: u64) {
        self.reserve(most);
        match self {
            Self::Narrow(counts) => count(&mut counts[first..], places, paths, |count| *count += 1),
            Self::Wide(counts) => count(&mut counts[first..], places, paths, |count| *count += 1),
        }
    }

    /// Adds all counts of `later`. `most` is what no count exceeds afterwards.
    pub fn merge(&mut self, later: &Self, most: u64) {
        self.reserve(if matches!(later, Self::Wide(_)) { u64::MAX } else { most });
        match (self, later) {
            (Self::Narrow(sums), Self::Narrow(more)) => {
                sums.iter_mut().zip(more).for_each(|(sum, more)| *sum += more);
            }
            (Self::Wide(sums), Self::Narrow(more)) => {
                sums.iter_mut().zip(more).for_each(|(sum, &more)| *sum += u64::from(more));
            }
            (Self::Wide(sums), Self::Wide(more)) => {
                sums.iter_mut().zip(more).for_each(|(sum, more)| *sum += more);
            }
            (Self::Narrow(_), Self::Wide(_)) => unreachable!("widened above"),
        }
    }

    fn reserve(&mut self, most: u64) {
        if most > u64::from(u16::MAX) && matches!(self, Self::Narrow(_)) {
            *self = self.widened();
        }
    }

    fn widened(&self) -> Self {
        Self::Wide(self.range(0, self.len()))
    }

    pub fn len(&self) -> usize {
        match self {
            Self::Narrow(counts) => counts.len(),
            Self::Wide(counts) => counts.len(),
        }
    }

    /// The counts from `start` on.
    pub fn range(&self, start: usize, length: usize) -> Vec<u64> {
        match self {
            Self::Narrow(counts) => {
                counts[start..start + length].iter().map(|&count| u64::from(count)).collect()
            }
            Self::Wide(counts) => counts[start..start + length].to_vec(),
        }
    }
}

#[inline(always)]
fn count<T>(counts: &mut [T], places: &[u32; WIDTH], paths: PathMask, add: impl Fn(&mut T)) {
    if paths == PathMask::ALL {
        places.iter().for_each(|&place| add(&mut counts[place as usize]));
    } else {
        paths.paths().for_each(|p| add(&mut counts[places[p] as usize]));
    }
}

impl From<Counts> for Vec<u64> {
    fn from(counts: Counts) -> Self {
        counts.range(0, counts.len())
    }
}

impl From<Vec<u64>> for Counts {
    fn from(counts: Vec<u64>) -> Self {
        Self::Wide(counts)
    }
}

impl PartialEq for Counts {
    fn eq(&self, other: &Self) -> bool {
        self.range(0, self.len()) == other.range(0, other.len())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_are_widened_before_they_overflow() {
        let full = || Counts::from(vec![65_535, 0]);
        let (places, one) = ([0; WIDTH], PathMask(1 << 7));
        let mut counts = Counts::new(2);
        for most in 1..=65_535 {
            counts.add(0, &places, one, most);
        }
        assert!(matches!(counts, Counts::Narrow(_)) && counts == full());
        counts.add(0, &places, PathMask::ALL, 65_567);
        assert_eq!(counts, Counts::from(vec![65_567, 0]));

        let mut narrow = Counts::new(2);
        narrow.add(1, &places, one, 1);
        for (first, second) in [(&narrow, &counts), (&counts, &narrow)] {
            let mut sum = first.clone();
            sum.merge(second, 65_567);
            assert_eq!(sum, Counts::from(vec![65_567, 1]));
        }
        let mut twice = narrow.clone();
        twice.merge(&narrow, 2);
        assert!(matches!(twice, Counts::Narrow(_)) && twice.range(0, 2) == [0, 2]);
    }
}
