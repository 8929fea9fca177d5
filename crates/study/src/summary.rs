//! The law of one observable at one time.

use std::fmt;

use serde::{Deserialize, Serialize};
use stats::{Tail, proportion};

use super::{Grid, sums::Sums};

/// Relative difference below which values are equal except for rounding errors.
const ROUNDING: f64 = 1e-12;
/// Multiple of the values of a neighbour, plus [`MORE`], above which a bin holds an atom or a peak.
const TIMES: u64 = 4;
const MORE: u64 = 16;

/// Statistics of one observable at one time, over the paths that have not failed by then and on
/// which it is finite.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// Number of steps done; 0 for the initial value, which is exact.
    pub step: u64,
    /// The time t.
    pub time: f64,
    /// Number of values.
    pub count: u64,
    /// Number of values that are not finite and count nowhere else.
    pub not_finite: u64,
    /// The mean; `None` without values, and where the [tail](stats::Tail) at the last time says
    /// that there may be none.
    pub mean: Option<f64>,
    /// The 95 % interval of the mean by
    /// [`CentralMoments::mean_interval`](stats::CentralMoments::mean_interval).
    pub mean_interval: Option<(f64, f64)>,
    /// Reason why the mean has no interval, or why that is hardly known.
    pub interval_note: Option<IntervalNote>,
    /// The sample variance; `None` with fewer than two values, if it is not a number of 64 bits, or
    /// if the law may have none.
    pub variance: Option<f64>,
    /// The 95 % interval of the variance by
    /// [`CentralMoments::variance_interval`](stats::CentralMoments::variance_interval).
    pub variance_interval: Option<(f64, f64)>,
    /// The standard deviation.
    pub deviation: Option<f64>,
    /// The smallest value.
    pub least: Option<f64>,
    /// The largest value.
    pub largest: Option<f64>,
    /// The quantiles, in the order of their levels.
    pub quantiles: Vec<Quantile>,
    /// The histogram; `None` for the initial value.
    pub histogram: Option<Histogram>,
}

/// The 95 % interval of a statistic; `None` where it is not known.
pub type IntervalOf = fn(&Summary) -> Option<(f64, f64)>;

/// A number that tables and files have of a [`Summary`].
pub struct SummaryStatistic {
    /// Name in files.
    pub key: &'static str,
    /// Title of its column in the table at the end; `None` if it is in files alone.
    pub title: Option<&'static str>,
    /// The number; `None` where it is not known.
    pub of: fn(&Summary) -> Option<f64>,
    /// The 95 % interval, for statistics that have one.
    pub interval: Option<IntervalOf>,
}

/// All statistics beside quantiles and counts.
pub const STATISTICS: &[SummaryStatistic] = &[
    SummaryStatistic {
        key: "mean",
        title: Some("mean"),
        of: |point| point.mean,
        interval: Some(|point| point.mean_interval),
    },
    SummaryStatistic {
        key: "variance",
        title: None,
        of: |point| point.variance,
        interval: Some(|point| point.variance_interval),
    },
    SummaryStatistic {
        key: "deviation",
        title: Some("deviation"),
        of: |point| point.deviation,
        interval: None,
    },
    SummaryStatistic { key: "least", title: None, of: |point| point.least, interval: None },
    SummaryStatistic { key: "largest", title: None, of: |point| point.largest, interval: None },
];

/// Reason why a mean has no interval, or why that is hardly known; in files its words.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(into = "String", from = "String")]
pub enum IntervalNote {
    /// Too few values carry the mean.
    TooFew,
    /// All values are equal except for rounding errors; others are on less than one path in this
    /// number, with 95 % confidence: n equal values leave room for one path in n/3.
    Equal(u64),
    /// The [tail](stats::Tail) is heavy, with its words.
    Heavy(String),
}

const TOO_FEW: &str = "too few values carry the mean";
const EQUAL: &str = "all equal; others < 1 path in ";

impl fmt::Display for IntervalNote {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooFew => f.write_str(TOO_FEW),
            Self::Equal(paths) => write!(f, "{EQUAL}{paths}"),
            Self::Heavy(tail) => f.write_str(tail),
        }
    }
}

impl From<IntervalNote> for String {
    fn from(note: IntervalNote) -> Self {
        note.to_string()
    }
}

impl From<String> for IntervalNote {
    fn from(words: String) -> Self {
        let paths = words.strip_prefix(EQUAL).and_then(|paths| paths.parse().ok());
        match paths {
            Some(paths) => Self::Equal(paths),
            None if words == TOO_FEW => Self::TooFew,
            None => Self::Heavy(words),
        }
    }
}

/// The quantile of one level.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Quantile {
    /// The level, between 0 and 1.
    pub level: f64,
    /// The estimate, interpolated inside of its bin; the smallest or the largest value where its
    /// rank is among the values equal to that, and the smallest where all are equal except for
    /// rounding errors. `None` outside of the grid and in a crowded bin.
    pub value: Option<f64>,
    /// Lower end of the 95 % interval; `None` if there are too few values to know one.
    ///
    /// The interval reaches from the lower edge of the bin of the order statistic X₍ₗ₎ to the upper
    /// edge of that of X₍ᵤ₎, with l and u of [`stats::quantile_ranks`]. So it contains the
    /// uncertainty of ranks, for any law, and the width of the bins. In the underflow and the
    /// overflow the ends are the smallest and the largest value.
    pub lo: Option<f64>,
    /// Upper end of the interval.
    pub hi: Option<f64>,
    /// Place of the quantile.
    pub place: Place,
}

/// The place of a quantile on the grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Place {
    /// Inside of a bin.
    Inside,
    /// Inside of a bin that has many more values than its neighbours, as where many are equal: the
    /// quantile is known to lie between `lo` and `hi` only.
    Crowded,
    /// Below the grid: the quantile is known to lie between `lo` and `hi` only.
    BelowGrid,
    /// Above the grid: the quantile is known to lie between `lo` and `hi` only.
    AboveGrid,
    /// No place: there are no values.
    NoValues,
}

impl Place {
    /// Reason why the quantile has no value; empty if it has one, or if there are no values at all.
    pub fn note(self) -> &'static str {
        match self {
            Self::Inside | Self::NoValues => "",
            Self::BelowGrid => "below the grid",
            Self::AboveGrid => "above the grid",
            Self::Crowded => {
                "a quantile lies in a bin with many more values than its neighbours: more bins \
                 would resolve it"
            }
        }
    }
}

/// A histogram: the number of values in each bin.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Histogram {
    /// The bins.
    pub grid: Grid,
    /// Number of values below the bins.
    pub below: u64,
    /// Number of values in each bin.
    pub counts: Vec<u64>,
    /// Number of values above the bins.
    pub above: u64,
}

impl Histogram {
    /// A histogram without values.
    pub fn empty(grid: Grid) -> Self {
        Self { grid, below: 0, counts: vec![0; grid.bins as usize], above: 0 }
    }

    /// Adds counts in the places of the [grid](Grid::place).
    pub fn add(&mut self, places: &[u64]) {
        if let [below, counts @ .., above] = places {
            self.counts.iter_mut().zip(counts).for_each(|(sum, count)| *sum += count);
            self.below += below;
            self.above += above;
        }
    }
    /// The edges of a bin. Those of the underflow begin at the least value, those of the overflow
    /// end at the largest; and no value lies beyond these.
    fn ends(&self, place: usize, (least, largest): (f64, f64)) -> (f64, f64) {
        let (place, last) = (place as u32, self.grid.bins + 1);
        let lo = if place == 0 { least } else { self.grid.edge(place - 1) };
        let hi = if place == last { largest } else { self.grid.edge(place) };
        (lo.max(least), hi.min(largest))
    }

    /// The quantile of values in `range`, with the numbers of values that are equal to its two
    /// ends.
    fn quantile(
        &self,
        (level, (l, u)): Ranks,
        range: Option<(f64, f64)>,
        ends: [u64; 2],
    ) -> Quantile {
        let Some(range) = range else {
            return Quantile { level, value: None, lo: None, hi: None, place: Place::NoValues };
        };
        let cells = [&[self.below], &*self.counts, &[self.above]].concat();
        let n: u64 = cells.iter().sum();
        // The place of the value of a rank, and the number of values below the place.
        let find = |rank: f64| {
            let mut up_to = 0;
            let reaches = |&count: &u64| {
                up_to += count;
                count > 0 && up_to as f64 >= rank
            };
            let place = cells.iter().position(reaches).unwrap_or(cells.len() - 1);
            (place, up_to - cells[place])
        };
        let rank = level * n as f64;
        // Values equal to the ends are known, and count no more in their bins. One is no atom.
        let [low, high] = ends.map(|n| if n > 1 { n } else { 0 });
        let [first, last] = [1, n].map(|rank| find(rank as f64).0);
        let others = |place: usize| {
            let known = [(first, low), (last, high)].map(|(at, n)| if at == place { n } else { 0 });
            cells[place].saturating_sub(known[0] + known[1])
        };
        let (place, before) = find(rank);
        let (before, count) = (before.max(low), others(place));
        let ends = |rank: u64| match rank {
            _ if rank <= low => (range.0, range.0),
            _ if rank > n - high => (range.1, range.1),
            _ => self.ends(find(rank as f64).0, range),
        };
        let (value, place) = if rank <= low as f64 {
            (Some(range.0), Place::Inside)
        } else if rank > (n - high) as f64 {
            (Some(range.1), Place::Inside)
        } else if place == 0 {
            (None, Place::BelowGrid)
        } else if place + 1 == cells.len() {
            (None, Place::AboveGrid)
        } else if count > MORE + TIMES * others(place - 1).max(others(place + 1)) {
            (None, Place::Crowded)
        } else {
            let share = (rank - before as f64) / count as f64;
            let value = self.grid.edge(place as u32 - 1) + share * self.grid.width;
            (Some(value.clamp(range.0, range.1)), Place::Inside)
        };
        let lo = (l > 0).then(|| ends(l).0);
        let hi = (u <= n).then(|| ends(u).1);
        Quantile { level, value, lo, hi, place }
    }
}

impl Summary {
    /// The summary of `count` paths that all have the same value.
    pub(super) fn exact(value: Option<f64>, count: u64, levels: &[f64]) -> Self {
        let (count, not_finite, place) = match value {
            Some(_) => (count, 0, Place::Inside),
            None => (0, count, Place::NoValues),
        };
        let quantile = |&level| Quantile { level, value, lo: value, hi: value, place };
        let zero = value.map(|_| 0.0);
        Self {
            count,
            not_finite,
            mean: value,
            mean_interval: value.zip(value),
            variance: zero,
            variance_interval: zero.zip(zero),
            deviation: zero,
            least: value,
            largest: value,
            quantiles: levels.iter().map(quantile).collect(),
            ..Self::default()
        }
    }

    /// The quantile of a level, if it was asked for.
    pub fn quantile(&self, level: f64) -> Option<&Quantile> {
        self.quantiles.iter().find(|quantile| quantile.level == level)
    }

    /// The summary of the values of a cell, at the end of step `step` at `time`.
    pub(super) fn new(
        (step, time): (u64, f64),
        sums: &Sums,
        cell: usize,
        histogram: Histogram,
        (ranks, tail): (&[Ranks], Tail),
    ) -> Self {
        let finite = |x: f64| x.is_finite().then_some(x);
        let (moments, unit) = (&sums.moments[cell], histogram.grid.unit());
        let scaled = |(lo, hi): (f64, f64)| (lo * unit, hi * unit);
        let (count, range) = (moments.count(), moments.range().map(scaled));
        let (least, largest) = range.unzip();
        let (spread, size) = range.map_or((0.0, 0.0), |(least, largest)| {
            (largest - least, least.abs().max(largest.abs()))
        });
        let equal = spread <= ROUNDING * size;
        let variance = moments.variance();
        let tail = if moments.may_be_heavy() { tail } else { Tail::default() };
        // A spread whose square is zero is not known.
        let known = |x: &f64| count > 1 && (*x > 0.0 || spread == 0.0) && tail.has_variance();
        let varies = |_: &(f64, f64)| !equal && tail.has_variance();
        let mean_interval = moments.mean_interval().filter(varies).map(scaled);
        let note = || match tail.is_heavy() {
            true => IntervalNote::Heavy(tail.to_string()),
            false if equal && count > 2 => IntervalNote::Equal(count / 3),
            false => IntervalNote::TooFew,
        };
        let quantile = |&(level, (l, u)): &Ranks| {
            if !equal || count == 0 {
                return histogram.quantile((level, (l, u)), range, moments.at_ends());
            }
            // All of them, but for rounding errors.
            let (lo, hi) = (least.filter(|_| l > 0), largest.filter(|_| u <= count));
            Quantile { level, value: least, lo, hi, place: Place::Inside }
        };
        Self {
            step,
            time,
            count,
            not_finite: sums.not_finite[cell],
            mean: finite(moments.mean() * unit).filter(|_| count > 0 && tail.has_mean()),
            interval_note: (count > 0 && (mean_interval.is_none() || tail.is_heavy())).then(note),
            mean_interval,
            variance: finite(variance * unit * unit).filter(known),
            variance_interval: moments.variance_interval().filter(varies).map(scaled).map(scaled),
            deviation: finite(variance.sqrt() * unit).filter(known),
            least,
            largest,
            quantiles: ranks.iter().map(quantile).collect(),
            histogram: Some(histogram),
        }
    }

    /// Takes the binomial interval of values that are zero or one, and drops the histogram.
    pub(super) fn of_probability(self) -> Self {
        let mean_interval =
            self.mean.map(|mean| proportion((mean * self.count as f64).round() as u64, self.count));
        let variance_interval = None;
        Self { mean_interval, variance_interval, interval_note: None, histogram: None, ..self }
    }
}

/// The level of a quantile, and the ranks that enclose it.
pub type Ranks = (f64, (u64, u64));

#[cfg(test)]
mod tests {
    use stats::quantile_ranks;

    use super::*;

    /// Bins of width 1 on [0, 4], and values between −2 and 9.
    fn histogram(counts: [u64; 6]) -> Histogram {
        let mut histogram = Histogram::empty(Grid { lo: 0.0, width: 1.0, bins: 4 });
        histogram.add(&counts);
        histogram
    }

    fn quantile(histogram: &Histogram, level: f64, range: Option<(f64, f64)>) -> Quantile {
        let count = histogram.below + histogram.counts.iter().sum::<u64>() + histogram.above;
        histogram.quantile((level, quantile_ranks(count, level)), range, [1; 2])
    }

    const RANGE: Option<(f64, f64)> = Some((-2.0, 9.0));

    #[test]
    fn a_quantile_is_interpolated_in_its_bin() {
        let near = histogram([0, 1000, 2000, 500, 500, 0]);
        let quantile = |level: f64| quantile(&near, level, Some((0.25, 3.75)));
        assert_eq!(quantile(0.125).value, Some(0.5));
        assert_eq!(quantile(0.5).value, Some(1.5));
        assert_eq!(quantile(0.9375).value, Some(3.5));
        // In the first and the last bin no value lies beyond the least and the largest.
        assert_eq!((quantile(0.01).value, quantile(0.01).lo), (Some(0.25), Some(0.25)));
        assert_eq!((quantile(0.999).value, quantile(0.999).hi), (Some(3.75), Some(3.75)));
        // At the border of two bins, and of an empty one, the interval has both.
        let histogram = histogram([0, 1000, 2000, 0, 1000, 0]);
        let quantile = |level: f64| super::tests::quantile(&histogram, level, Some((0.25, 3.75)));
        assert_eq!((quantile(0.25).lo, quantile(0.25).hi), (Some(0.25), Some(2.0)));
        assert_eq!((quantile(0.75).lo, quantile(0.75).hi), (Some(1.0), Some(3.75)));
        // A bin between empty ones may hold an atom anywhere.
        let alone = quantile(0.9);
        let bounds = (alone.value, alone.lo, alone.hi, alone.place);
        assert_eq!(bounds, (None, Some(3.0), Some(3.75), Place::Crowded));
    }

    #[test]
    fn a_quantile_outside_of_the_grid_is_not_made_up() {
        let histogram = histogram([500, 300, 0, 0, 0, 200]);
        let below = quantile(&histogram, 0.25, RANGE);
        let bounds = (below.value, below.lo, below.hi, below.place);
        assert_eq!(bounds, (None, Some(-2.0), Some(0.0), Place::BelowGrid));
        let above = quantile(&histogram, 0.9, RANGE);
        let bounds = (above.value, above.lo, above.hi, above.place);
        assert_eq!(bounds, (None, Some(4.0), Some(9.0), Place::AboveGrid));
        // The uncertainty of the rank reaches into the underflow.
        let near = quantile(&histogram, 0.51, RANGE);
        assert_eq!((near.lo, near.hi, near.place), (Some(-2.0), Some(1.0), Place::Inside));
    }

    #[test]
    fn few_values_bound_no_extreme_quantile() {
        let few = histogram([0, 10, 10, 10, 10, 0]);
        let low = quantile(&few, 0.05, RANGE);
        assert_eq!((low.value, low.lo), (Some(0.2), None));
        assert!(low.hi.is_some());
        assert_eq!(quantile(&few, 0.95, RANGE).hi, None);
        let none = quantile(&histogram([0; 6]), 0.5, None);
        assert_eq!((none.value, none.lo, none.hi, none.place), (None, None, None, Place::NoValues));
    }
}
