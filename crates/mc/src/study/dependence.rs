//! How observables depend on each other and on their past: covariances, joint laws,
//! autocorrelations and spectra.
//!
//! **Intervals.** The 32 places of a block of paths are 32 independent batches: sums are rows. What
//! is a smooth function of sums has its 95 % interval from the jackknife over these batches (Efron
//! and Tibshirani 1993): with θ₍ₚ₎ without batch p and g batches the mean of g·θ − (g − 1)θ₍ₚ₎ has
//! a bias of order 1/n², and their spread gives Student's interval with g − 1 degrees of freedom.
//! That of a correlation r is an interval of artanh r.
//!
//! **Autocorrelation** of v at lag s = kΔ: r(s) = c(s)/c(0), where c(s) is the mean of
//! (v(t) − m)(v(t + s) − m) over paths and over the saved times t, t + s from
//! [`from`](super::StudySettings::from) on, and m the mean of v. That is of use if v is stationary.
//! Lags go up to half of these times.
//!
//! **Spectrum**: S(ω) = (Δ/2π) Σₖ w(k) C(kΔ) cos(kωΔ)/|H(ω)|², two-sided, so that ∫S dω is the
//! variance. The window w is one up to K/3 and falls as a cos² to zero at K: smooth spectra keep
//! their level and their curvature (Politis and Romano, *J. Time Ser. Anal.* 16, 1995), with a
//! resolution of about 2π/KΔ. C is the covariance of v after a filter: a mean over all r steps h between two saved
//! times on both sides with weights that fall linearly, of which H = (sin ½ωΔ/r sin ½ωh)² is the
//! transform. It has a zero at every multiple of 2π/Δ but zero. So of what oscillates faster than
//! π/Δ, which the saved times cannot tell from slower motion (aliasing), S(ω) has the part (x/(x −
//! π))⁴ and less, x = ½ωΔ. S ends at π/2Δ, where this is 1/81, and at π/8h, where as much of a
//! spectrum that falls as 1/ω² is beyond the reach of the steps themselves.

use std::f64::consts::PI;

use real::{PathMask, Row, WIDTH, elementary};
use stats::two_sided;

use super::{Grid, Series, Summary};

/// What is asked for of the observables of these numbers.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Wanted {
    /// Their covariance, correlation and joint law.
    pub pairs: Vec<(usize, usize)>,
    /// Their autocorrelation and spectrum.
    pub lagged: Vec<usize>,
    /// Number of the time from which on lags are counted.
    pub from: usize,
    /// Those that are zero or one: their means are probabilities with binomial intervals, and they
    /// have no quantiles.
    pub probabilities: Vec<usize>,
}

/// The joint law of two observables at the final time: counts in bins.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Joint {
    /// Their names.
    pub names: [String; 2],
    /// The bins of each.
    pub grids: [Grid; 2],
    /// Counts: those of the first bin of the first observable, then of the second one, and so on.
    pub counts: Vec<u64>,
    /// Number of values outside of the bins.
    pub outside: u64,
}

/// Rows of a pair at a time: n, Σa, Σb, Σab, Σa², Σb².
const OF_PAIR: usize = 6;
/// Bins of a joint law on each side, or fewer.
const BINS: u32 = 64;

/// Where the numbers of observables have the size one.
#[derive(Clone, Copy)]
struct Unit {
    middle: f64,
    scale: f64,
}

impl Unit {
    fn of(grid: &Grid) -> Self {
        Self { middle: grid.edge(grid.bins / 2), scale: grid.scale() }
    }

    fn row(self, values: &Row) -> Row {
        values.map(|x| (x - self.middle) * self.scale)
    }
}

impl Wanted {
    /// Number of lags among so many times, lag zero included.
    fn lags(&self, times: usize) -> usize {
        times.saturating_sub(self.from) / 2 + 1
    }

    /// Number of rows of sums.
    pub(super) fn rows(&self, times: usize) -> usize {
        self.pairs.len() * times * OF_PAIR + 2 * self.lagged.len() * (2 + self.lags(times))
    }

    /// The values of the observables of which lags are wanted, in the same unit at all times.
    pub(super) fn rows_of_lagged(
        &self,
        grids: &[Grid],
        observables: usize,
        values: &[Row],
    ) -> impl ExactSizeIterator<Item = Row> {
        let last = grids.len() - observables;
        self.lagged.iter().map(move |&k| Unit::of(&grids[last + k]).row(&values[k]))
    }

    /// Number of counts of joint laws: bins and what lies outside of them.
    pub(super) fn cells(&self) -> usize {
        self.pairs.len() * ((BINS * BINS) as usize + 1)
    }
}

/// Bins of the grid of a study that make one of a joint law.
fn joined(grid: &Grid) -> u32 {
    grid.bins.div_ceil(BINS)
}

/// The values of one block so far at saved times, as they are and filtered.
#[derive(Default)]
pub struct Past([Vec<Row>; 2]);

impl Past {
    /// Adds values at a step to the filtered ones at the saved times before and after it: with
    /// `every` steps between these, counted from the first of them.
    pub fn filter(&mut self, step: u64, every: u64, rows: impl ExactSizeIterator<Item = Row>) {
        let (number, filtered) = (rows.len(), &mut self.0[1]);
        let (first, after) = ((step / every) as usize * number, (step % every) as f64);
        filtered.resize(filtered.len().max(first + 2 * number), [0.0; WIDTH]);
        let size = every as f64;
        for (n, row) in rows.enumerate() {
            for (place, weight) in [(first, size - after), (first + number, after)] {
                let weight = weight / (size * size);
                filtered[place + n].iter_mut().zip(row).for_each(|(sum, x)| *sum += weight * x);
            }
        }
    }
}

/// Sums of dependence, and what adds to them.
pub struct Adding<'a> {
    pub wanted: &'a Wanted,
    pub grids: &'a [Grid],
    pub observables: usize,
    pub times: usize,
    pub sums: &'a mut [Row],
    pub joint: &'a mut [u64],
}

impl Adding<'_> {
    /// Adds the values of all observables on a block at a time.
    pub fn add(&mut self, time: usize, values: &[Row], live: PathMask, past: &mut Past) {
        let Self { wanted, grids, observables, times, sums, joint } = self;
        let grid = |k: usize| &grids[time * *observables + k];
        let pairs = wanted.pairs.iter().enumerate();
        for (n, &(k, l)) in pairs {
            let [a, b] = [k, l].map(|k| Unit::of(grid(k)).row(&values[k]));
            let rows = &mut sums[(time * wanted.pairs.len() + n) * OF_PAIR..][..OF_PAIR];
            let last = (time + 1 == *times).then(|| {
                [k, l].map(|k| {
                    let mut places = [0; WIDTH];
                    grid(k).place(&values[k], &mut places);
                    places.map(|place| {
                        let inside = (1..=grid(k).bins).contains(&place);
                        inside.then(|| (place - 1) / joined(grid(k)))
                    })
                })
            });
            for p in live.paths().filter(|&p| (a[p] * b[p]).is_finite()) {
                let terms = [1.0, a[p], b[p], a[p] * b[p], a[p] * a[p], b[p] * b[p]];
                rows.iter_mut().zip(terms).for_each(|(row, term)| row[p] += term);
                if let Some([i, j]) = last {
                    let cell = i[p].zip(j[p]).map_or(BINS * BINS, |(i, j)| i * BINS + j);
                    joint[n * ((BINS * BINS) as usize + 1) + cell as usize] += 1;
                }
            }
        }
        if time >= wanted.from && !wanted.lagged.is_empty() {
            past.0[0].extend(wanted.rows_of_lagged(grids, *observables, values));
            if time + 1 == *times {
                self.add_lags(std::mem::take(past), live);
            }
        }
    }

    /// Adds the products of all lags on a block: n, the mean over times, and for each lag the sum;
    /// of values as they are, and filtered but for the ends, on one side of which none are.
    fn add_lags(&mut self, Past([values, mut filtered]): Past, live: PathMask) {
        let Self { wanted, sums, times, .. } = self;
        let (number, lags) = (wanted.lagged.len(), wanted.lags(*times));
        let first = wanted.pairs.len() * *times * OF_PAIR;
        filtered.truncate(values.len().saturating_sub(number));
        filtered.drain(..number.min(filtered.len()));
        for n in 0..2 * number {
            let past = if n < number { &values } else { &filtered };
            let mut x: Vec<Row> = past.iter().skip(n % number).step_by(number).copied().collect();
            let is_whole = |p: &usize| x.iter().map(|row| row[*p]).sum::<f64>().is_finite();
            let counted: Vec<usize> = live.paths().filter(is_whole).collect();
            let others = (0..WIDTH).filter(|p| !counted.contains(p));
            others.for_each(|p| x.iter_mut().for_each(|row| row[p] = 0.0));
            let rows = &mut sums[first + n * (2 + lags)..][..2 + lags];
            counted.iter().for_each(|&p| rows[0][p] += 1.0);
            let length = x.len() as f64;
            for p in 0..WIDTH {
                rows[1][p] += x.iter().map(|row| row[p]).sum::<f64>() / length;
            }
            for k in 0..lags.min(x.len()) {
                let sum = &mut rows[2 + k];
                for (a, b) in x.iter().zip(&x[k..]) {
                    for p in 0..WIDTH {
                        sum[p] += a[p] * b[p];
                    }
                }
            }
        }
    }
}

/// Values with their 95 % intervals, by the jackknife over the batches of `sums` that have paths in
/// their first row; none of what is not finite.
fn jackknife(sums: &[Row], functions: impl Fn(&[f64]) -> Vec<f64>) -> Vec<Option<[f64; 3]>> {
    let batches: Vec<usize> = (0..WIDTH).filter(|&p| sums[0][p] > 0.0).collect();
    let g = batches.len() as f64;
    let total: Vec<f64> = sums.iter().map(|row| batches.iter().map(|&p| row[p]).sum()).collect();
    let whole = functions(&total);
    let without = batches.iter().map(|&p| {
        let rest: Vec<f64> = total.iter().zip(sums).map(|(total, row)| total - row[p]).collect();
        functions(&rest)
    });
    let without: Vec<Vec<f64>> = without.collect();
    let quantile = two_sided(0.95, Some((g - 1.0).max(1.0)));
    let of = |(k, &whole): (usize, &f64)| {
        let pseudo: Vec<f64> = without.iter().map(|one| g * whole - (g - 1.0) * one[k]).collect();
        let mean = pseudo.iter().sum::<f64>() / g;
        let square = pseudo.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>();
        let half = quantile * (square / (g * (g - 1.0))).sqrt();
        (mean + half).is_finite().then_some([mean, mean - half, mean + half])
    };
    whole.iter().enumerate().map(of).collect()
}

/// A summary of a value with its interval.
fn summary(step: u64, time: f64, count: u64, value: Option<[f64; 3]>) -> Summary {
    let (mean, mean_interval) = (value.map(|[mean, ..]| mean), value.map(|[_, lo, hi]| (lo, hi)));
    Summary { step, time, count, mean, mean_interval, ..Summary::default() }
}

/// Times with their steps.
type At = (u64, f64);

/// What was found of the dependence of observables.
pub struct Found<'a> {
    pub wanted: &'a Wanted,
    pub names: &'a [String],
    pub at: Vec<At>,
    pub grids: &'a [Grid],
    pub sums: &'a [Row],
    pub joint: &'a [u64],
}

impl Found<'_> {
    /// Covariance and correlation of each pair in time; before it none at a fixed initial value.
    pub fn pairs(&self, start: Option<u64>) -> Vec<Series> {
        let number = self.wanted.pairs.len();
        let of = |(n, &(k, l)): (usize, &(usize, usize))| {
            let point = |(time, &(step, t)): (usize, &At)| {
                let sums = &self.sums[(time * number + n) * OF_PAIR..][..OF_PAIR];
                let [a, b] =
                    [k, l].map(|k| Unit::of(&self.grids[time * self.names.len() + k]).scale);
                let found = jackknife(sums, |s| {
                    let product = |sum: f64, x: f64, y: f64| (sum - x * y / s[0]) / (s[0] - 1.0);
                    let covariance = product(s[3], s[1], s[2]);
                    let variances = product(s[4], s[1], s[1]) * product(s[5], s[2], s[2]);
                    let (r, unit) = (covariance / variances.sqrt(), 1.0 / (a * b));
                    vec![covariance * unit, 0.5 * elementary::ln((1.0 + r) / (1.0 - r))]
                });
                let count = sums[0].iter().sum::<f64>() as u64;
                let correlation = found[1].map(|ends| ends.map(elementary::tanh));
                [found[0], correlation].map(|value| summary(step, t, count, value))
            };
            let points: Vec<_> = self.at.iter().enumerate().map(point).collect();
            let names = format!("({}, {})", self.names[k], self.names[l]);
            [("cov", 0), ("corr", 1)].map(|(what, column)| Series {
                observable: format!("{what}{names}"),
                points: start
                    .map(|paths| summary(0, 0.0, paths, (column == 0).then_some([0.0; 3])))
                    .into_iter()
                    .chain(points.iter().map(|point| point[column].clone()))
                    .collect(),
            })
        };
        self.wanted.pairs.iter().enumerate().flat_map(of).collect()
    }

    /// Autocorrelations against the lag, and spectra against the frequency.
    pub fn lagged(&self) -> Vec<Series> {
        let (times, names) = (self.at.len(), self.names);
        let (lags, number) = (self.wanted.lags(times), times.saturating_sub(self.wanted.from));
        let (Some(last), Some(before)) = (self.at.last(), self.at.get(times.wrapping_sub(2)))
        else {
            return Vec::new();
        };
        let (delta, half) = (last.1 - before.1, (lags - 1).max(1));
        let first = self.wanted.pairs.len() * times * OF_PAIR;
        let all = self.sums[first..].chunks_exact(2 + lags);
        let filtered = all.clone().skip(self.wanted.lagged.len());
        let of = |(&k, (sums, filtered)): (&usize, (&[Row], &[Row]))| {
            let unit = Unit::of(&self.grids[(times - 1) * names.len() + k]).scale;
            let covariances = |s: &[f64], number: usize| -> Vec<f64> {
                let mean = s[1] / s[0];
                let number = |k: usize| number as f64 - k as f64;
                let of_lag = |(k, sum): (usize, &f64)| sum / (s[0] * number(k)) - mean * mean;
                s[2..].iter().enumerate().map(of_lag).collect()
            };
            let autocorrelation = jackknife(sums, |s| {
                let c = covariances(s, number);
                c.iter().map(|x| x / c[0]).collect()
            });
            let every = (last.0 - before.0) as f64;
            let frequencies = 0..=(half / 2).min((half as f64 * every / 8.0) as usize);
            let spectrum = jackknife(filtered, |s| {
                let c = covariances(s, number.saturating_sub(2));
                let spectrum = |j: usize| {
                    let term = |(k, c): (usize, &f64)| {
                        let cos = |n: usize| elementary::cos(PI * n as f64 / half as f64);
                        let falls = (3 * k).saturating_sub(half) as f64 / (2 * half) as f64;
                        let window = 0.5 * (1.0 + elementary::cos(PI * falls));
                        let both = if k == 0 { 1.0 } else { 2.0 };
                        both * window * c * cos(j * k % (2 * half))
                    };
                    let x = PI * j as f64 / (2 * half) as f64;
                    let root = match j {
                        0 => 1.0,
                        _ => elementary::sin(x) / (every * elementary::sin(x / every)),
                    };
                    let sum = c.iter().take(half).enumerate().map(term).sum::<f64>();
                    delta / (2.0 * PI) * sum / (elementary::powi(root, 4) * unit * unit)
                };
                frequencies.clone().map(spectrum).collect()
            });
            let count = sums[0].iter().sum::<f64>() as u64;
            let series = |what: &str, axis: f64, values: Vec<Option<[f64; 3]>>| Series {
                observable: format!("{what}({})", names[k]),
                points: (0..)
                    .zip(values)
                    .map(|(k, x)| summary(k, axis * k as f64, count, x))
                    .collect(),
            };
            let frequency = PI / (delta * half as f64);
            [
                series("autocorrelation", delta, autocorrelation),
                series("spectrum", frequency, spectrum),
            ]
        };
        self.wanted.lagged.iter().zip(all.zip(filtered)).flat_map(of).collect()
    }

    /// The joint laws at the final time.
    pub fn joint(&self) -> Vec<Joint> {
        let last = self.at.len().saturating_sub(1) * self.names.len();
        let all = self.joint.chunks((BINS * BINS) as usize + 1);
        let of = |(&(k, l), counts): (&(usize, usize), &[u64])| {
            let grids = [k, l].map(|k| {
                let Grid { lo, width, bins } = self.grids[last + k];
                let joined = joined(&self.grids[last + k]);
                Grid { lo, width: width * f64::from(joined), bins: bins.div_ceil(joined) }
            });
            let [x, y] = grids.map(|grid| grid.bins as usize);
            let cells = (0..x).flat_map(|i| &counts[i * BINS as usize..][..y]);
            Joint {
                names: [k, l].map(|k| self.names[k].clone()),
                grids,
                counts: cells.copied().collect(),
                outside: counts[(BINS * BINS) as usize],
            }
        };
        self.wanted.pairs.iter().zip(all).map(of).collect()
    }
}
