//! Sums of a study: moments, and counts of values in bins.

use std::{collections::BTreeMap, ops::Range};

use real::{PathMask, Row, WIDTH};
use serde::{Deserialize, Serialize};
use stats::CentralMoments;

use super::{
    Wanted,
    dependence::{Cells, Dependence, Past},
    grid::Grid,
};
use mc::{Kept, Observe, Statistic, View, parts::hash};

/// The sums of a study: moments and counts of every observable at every time. Counts are the same
/// whatever the order of merging; moments are the same to rounding errors, and to the last bit if
/// the order is the same.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sums {
    /// Moments of the finite values, in the unit of the grid; time by time, and for each time
    /// observable by observable.
    pub moments: Vec<CentralMoments>,
    /// Number of values that are not finite, of paths that had not failed.
    pub not_finite: Vec<u64>,
    counts: Counts,
    pub dependence: Dependence,
    /// The finite values of each observable at the last time on the first paths, in the unit of the
    /// grid: they show the tail of its law.
    pub first: Vec<Vec<f64>>,
}

/// Number of paths whose values are stored: with more the estimate of a tail is hardly better.
pub const FIRST_PATHS: u64 = 8192;

impl Sums {
    /// Sums over no paths, of observables at `times` times.
    fn new(times: usize, of: Cells<'_>) -> Self {
        let cells = times * of.observables;
        Self {
            first: Vec::new(),
            moments: vec![CentralMoments::default(); cells],
            not_finite: vec![0; cells],
            counts: Counts::new(of.grids.iter().map(Grid::cells).sum()),
            dependence: Dependence::new(of),
        }
    }

    /// Adds the sums of other paths of the same study.
    fn merge(&mut self, later: &Self) {
        let mut most = 0;
        for (sum, more) in self.moments.iter_mut().zip(&later.moments) {
            sum.merge(more);
            most = most.max(sum.count());
        }
        for (sum, more) in self.not_finite.iter_mut().zip(&later.not_finite) {
            *sum += more;
        }
        self.counts.merge(&later.counts, most);
        self.dependence.merge(&later.dependence);
        self.first.resize(self.first.len().max(later.first.len()), Vec::new());
        self.first.iter_mut().zip(&later.first).for_each(|(sum, more)| sum.extend(more));
    }

    /// Adds the values of the paths `live` of a block.
    fn add(&mut self, cell: usize, values: &[f64; WIDTH], live: PathMask, grid: Option<&Grid>) {
        let sum = &mut self.moments[cell];
        let finite = sum.add_block(values, grid.map_or(1.0, Grid::scale), live);
        self.not_finite[cell] += u64::from(live.without(finite).len());
        let Some(grid) = grid else { return };
        let mut places = [0; WIDTH];
        grid.place(values, &mut places);
        self.counts.add(cell * grid.cells(), &places, finite);
    }

    /// Counts of a cell: underflow, bins and overflow.
    pub fn counts(&self, cell: usize, grid: &Grid) -> Vec<u64> {
        self.counts.range(cell * grid.cells(), grid.cells())
    }
}

/// The statistic of a study on a [`Ladder`](mc::Ladder) with one run.
pub struct StudyStatistic<'a> {
    /// Sums so far.
    pub sums: Sums,
    observables: &'a [&'a dyn Observe],
    times: &'a [u64],
    of: Cells<'a>,
    /// The values of all observables, and those of each block so far.
    values: Vec<Row>,
    past: BTreeMap<u64, Past>,
    /// Times before the next one of `times`, from and to: blocks of a group go side by side.
    between: Range<u64>,
}

impl<'a> StudyStatistic<'a> {
    pub fn new(
        observables: &'a [&'a dyn Observe],
        times: &'a [u64],
        grids: &'a [Grid],
        wanted: &'a Wanted,
    ) -> Self {
        let of = Cells { wanted, grids, observables: observables.len() };
        Self {
            sums: Sums::new(times.len(), of),
            observables,
            times,
            of,
            values: vec![[0.0; WIDTH]; observables.len()],
            past: BTreeMap::new(),
            between: 0..0,
        }
    }

    /// The place of a time among those of the study.
    #[inline]
    fn place(&mut self, time: u64) -> Option<usize> {
        if self.between.contains(&time) {
            return None;
        }
        match self.times.binary_search(&time) {
            Ok(place) => Some(place),
            Err(next) => {
                self.between = time..self.times.get(next).copied().unwrap_or(u64::MAX);
                None
            }
        }
    }

    /// Filters the observables that have a spectrum, at every step.
    #[inline]
    fn filter(&mut self, view: &View<'_>) {
        let Wanted { from, lagged, .. } = self.of.wanted;
        if lagged.is_empty() || self.of.grids.is_empty() {
            return;
        }
        let &[first, second, ..] = self.times.get(*from..).unwrap_or_default() else { return };
        if view.time < first {
            return;
        }
        for &k in lagged {
            self.observables[k].evaluate(view.state(0), view.live, &mut self.values[k]);
        }
        self.past.entry(view.first_path).or_default().filter(
            view.time - first,
            second - first,
            &self.of.lagged(&self.values),
        );
    }
}

impl Statistic for StudyStatistic<'_> {
    fn observe(&mut self, view: &View<'_>) {
        self.filter(view);
        let Some(time) = self.place(view.time) else { return };
        let state = view.state(0);
        let first = time * self.observables.len();
        let keeps = view.first_path < FIRST_PATHS && time + 1 == self.times.len();
        if keeps {
            self.sums.first.resize(self.observables.len(), Vec::new());
        }
        for (k, (observable, values)) in self.observables.iter().zip(&mut self.values).enumerate() {
            observable.evaluate(state, view.live, values);
            let grid = self.of.grids.get(first + k);
            self.sums.add(first + k, values, view.live, grid);
            if let Some(grid) = grid.filter(|_| keeps) {
                self.sums.first[k].extend(
                    view.live.paths().map(|p| values[p] * grid.scale()).filter(|x| x.is_finite()),
                );
            }
        }
        if !self.of.grids.is_empty() {
            let past = self.past.entry(view.first_path).or_default();
            self.sums.dependence.add(self.of, time, &self.values, view.live, past);
        }
    }

    fn reads(&self, time: u64) -> bool {
        !self.of.wanted.lagged.is_empty() || self.times.binary_search(&time).is_ok()
    }

    fn merge(&mut self, later: Self) {
        self.sums.merge(&later.sums);
    }
}

impl Kept for StudyStatistic<'_> {
    type Sums = Sums;

    fn sums(&self) -> &Sums {
        &self.sums
    }

    fn sums_mut(&mut self) -> &mut Sums {
        &mut self.sums
    }

    fn fixed(&self, _: u64) -> (String, Vec<u64>) {
        let Cells { wanted: Wanted { pairs, lagged, from, .. }, grids, .. } = self.of;
        (hash(&(self.times, grids, pairs, lagged, from)), self.times.to_vec())
    }
}

/// The counts of all cells, one after the other. Counts are integers, so they are the same in
/// whatever order paths are added and merged.
///
/// They have two bytes until one may need more, which is never in a group of paths: what a group
/// sums up fits into the cache.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(into = "Vec<u64>", from = "Vec<u64>")]
pub struct Counts {
    /// Counts while none can exceed 65535; empty otherwise.
    narrow: Vec<u16>,
    /// Counts once one may exceed 65535; empty before.
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
        if paths == PathMask::ALL {
            places.iter().for_each(|&place| counts[place as usize] += 1);
        } else {
            paths.paths().for_each(|p| counts[places[p] as usize] += 1);
        }
    }

    /// Adds all counts of `later`. No count exceeds `most` afterwards.
    pub fn merge(&mut self, later: &Self, most: u64) {
        let may_exceed = most > u64::from(u16::MAX) || !later.wide.is_empty();
        if may_exceed && self.wide.is_empty() {
            self.wide = self.iter().collect();
            self.narrow.clear();
        }
        // One of the two is empty.
        self.narrow.iter_mut().zip(&later.narrow).for_each(|(sum, more)| *sum += more);
        self.wide.iter_mut().zip(later.iter()).for_each(|(sum, more)| *sum += more);
    }

    fn iter(&self) -> impl Iterator<Item = u64> {
        self.narrow.iter().map(|&count| u64::from(count)).chain(self.wide.iter().copied())
    }

    /// The `length` counts from `start` on.
    pub fn range(&self, start: usize, length: usize) -> Vec<u64> {
        let cells = start..start + length;
        if !self.wide.is_empty() {
            return self.wide[cells].to_vec();
        }
        self.narrow[cells].iter().map(|&count| u64::from(count)).collect()
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
