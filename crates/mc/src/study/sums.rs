//! What a study adds up.

use real::{PathMask, WIDTH};
use serde::{Deserialize, Serialize};
use stats::CentralMoments;

use super::{counts::Counts, grid::Grid};
use crate::{Kept, Observe, Statistic, View, parts::hash};

/// The sums of a study: moments and counts of every observable at every time. Counts are the same
/// whatever the order of merging; moments are the same to rounding errors, and to the last bit if
/// the order is the same.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sums {
    /// Of the finite values, in the unit of the grid; time by time, and for each time observable by
    /// observable.
    moments: Vec<CentralMoments>,
    /// How many are equal to the smallest, and to the largest.
    ends: Vec<[u64; 2]>,
    /// Number of values that are not finite, of paths that had not failed.
    not_finite: Vec<u64>,
    counts: Counts,
}

impl Sums {
    /// No paths. `cells` is the number of times and observables, `places` that of counts for each.
    pub(super) fn new(cells: usize, places: usize) -> Self {
        Self {
            moments: vec![CentralMoments::default(); cells],
            ends: vec![[0; 2]; cells],
            not_finite: vec![0; cells],
            counts: Counts::new(cells * places),
        }
    }

    /// Adds the sums of other paths of the same study.
    fn merge(&mut self, later: &Self) {
        let mut most = 0;
        for (cell, (more, ends)) in later.moments.iter().zip(&later.ends).enumerate() {
            self.merge_cell(cell, more, *ends);
            most = most.max(self.moments[cell].count());
        }
        for (sum, more) in self.not_finite.iter_mut().zip(&later.not_finite) {
            *sum += more;
        }
        self.counts.merge(&later.counts, most);
    }

    fn merge_cell(&mut self, cell: usize, later: &CentralMoments, ends: [u64; 2]) {
        if let Some((least, largest)) = later.range() {
            let (low, high) = self.moments[cell].range().unwrap_or((least, largest));
            let sides = [(least - low, ends[0]), (high - largest, ends[1])];
            for (sum, (beyond, more)) in self.ends[cell].iter_mut().zip(sides) {
                *sum = if beyond < 0.0 { 0 } else { *sum } + if beyond > 0.0 { 0 } else { more };
            }
        }
        self.moments[cell].merge(later);
    }

    /// Adds the values of the paths `live` of a block.
    fn add(&mut self, cell: usize, values: &[f64; WIDTH], live: PathMask, grid: Option<&Grid>) {
        let scale = 1.0 / grid.map_or(1.0, Grid::unit);
        let scaled = values.map(|value| value * scale);
        let (mut block, mut finite) = (CentralMoments::of_block(&scaled, live), live);
        if !block.mean().is_finite() {
            finite = finite_values(&scaled, live);
            self.not_finite[cell] += u64::from(live.without(finite).len());
            block = CentralMoments::of_block(&scaled, finite);
        }
        let ends = block.range().map_or([0; 2], |(least, largest)| {
            // Where others are beyond, they do not count.
            let (low, high) = self.moments[cell].range().unwrap_or((least, largest));
            let count = |end: f64| match finite {
                PathMask::ALL => scaled.iter().map(|&x| u64::from(x == end)).sum(),
                _ => finite.paths().filter(|&p| scaled[p] == end).count() as u64,
            };
            [(least, least <= low), (largest, largest >= high)]
                .map(|(end, counts)| if counts { count(end) } else { 0 })
        });
        self.merge_cell(cell, &block, ends);
        let Some(grid) = grid else { return };
        let mut places = [0; WIDTH];
        grid.place(values, &mut places);
        self.counts.add(cell * grid.cells(), &places, finite, self.moments[cell].count());
    }

    /// Moments of the finite values of a cell, in the unit of its grid.
    pub(super) fn moments(&self, cell: usize) -> &CentralMoments {
        &self.moments[cell]
    }

    /// How many values of a cell are equal to the smallest, and to the largest.
    pub(super) fn ends(&self, cell: usize) -> [u64; 2] {
        self.ends[cell]
    }

    /// Number of values of a cell that are not finite.
    pub(super) fn not_finite(&self, cell: usize) -> u64 {
        self.not_finite[cell]
    }

    /// Underflow, bins and overflow of a cell.
    pub(super) fn counts(&self, cell: usize, grid: &Grid) -> Vec<u64> {
        self.counts.range(cell * grid.cells(), grid.cells())
    }
}

/// The statistic of a study on a [`Ladder`](crate::Ladder) with one run.
pub struct StudyStatistic<'a> {
    /// What was added up.
    pub(super) sums: Sums,
    observables: &'a [&'a dyn Observe],
    times: &'a [u64],
    /// The grids of all cells, or none in a pilot.
    grids: &'a [Grid],
    /// Number of the time that is expected next.
    next: usize,
}

impl<'a> StudyStatistic<'a> {
    pub(super) fn new(
        observables: &'a [&'a dyn Observe],
        times: &'a [u64],
        grids: &'a [Grid],
    ) -> Self {
        let places = grids.first().map_or(0, Grid::cells);
        Self {
            sums: Sums::new(times.len() * observables.len(), places),
            observables,
            times,
            grids,
            next: 0,
        }
    }

    /// The number of a step among the times. Steps come in order, so the next time is remembered;
    /// where they do not, it is searched for.
    fn number(&mut self, step: u64) -> Option<usize> {
        let before = self.next.checked_sub(1).map_or(0, |before| self.times[before]);
        let after = self.times.get(self.next).copied().unwrap_or(u64::MAX);
        if before < step && step < after {
            return None;
        }
        self.next = self.times.partition_point(|&time| time < step);
        (self.times.get(self.next) == Some(&step)).then_some(self.next)
    }
}

impl Statistic for StudyStatistic<'_> {
    fn observe(&mut self, view: &View<'_>) {
        let Some(time) = self.number(view.time) else { return };
        let state = view.state(0);
        let first = time * self.observables.len();
        let mut values = [0.0; WIDTH];
        for (k, observable) in self.observables.iter().enumerate() {
            observable.evaluate(state, view.live, &mut values);
            self.sums.add(first + k, &values, view.live, self.grids.get(first + k));
        }
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

    fn fixed(&self) -> String {
        hash(&(self.times, self.grids))
    }

    fn some_times(&self, _: u64) -> Vec<u64> {
        self.times.to_vec()
    }
}

/// The paths among `live` with a finite value.
fn finite_values(values: &[f64; WIDTH], live: PathMask) -> PathMask {
    let mut finite = PathMask::NONE;
    live.paths().filter(|&p| values[p].is_finite()).for_each(|p| finite.insert(p));
    finite
}
