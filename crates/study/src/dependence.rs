//! Dependence of observables on each other and on their past: covariances, joint laws,
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
//! variance. The window w(k) = cos²(πk/2K) leaves a resolution of about 2π/KΔ (Blackman and Tukey
//! 1958). The interval covers that of a second window, too, which is one up to K/4 and falls then.
//! It smooths nearly nothing where C has vanished at K (Politis and Romano, *J. Time Ser. Anal.*
//! 16, 1995), but has negative lobes beside lines. C is the covariance of v after a filter: a mean
//! over all r steps h between two saved times on both sides with weights that fall linearly, of
//! which H = (sin ½ωΔ/r sin ½ωh)² is the transform. It has a zero at every multiple of 2π/Δ but
//! zero. So of what oscillates faster than π/Δ, which the saved times cannot tell from slower
//! motion (aliasing), S(ω) has the part (x/(x − π))⁴ and less, x = ½ωΔ. S ends at π/2Δ, where this
//! is 1/81, and at π/8h, where as much of a spectrum that falls as 1/ω² is beyond the reach of the
//! steps themselves.

use std::f64::consts::PI;

use real::{
    PathMask, Row, WIDTH,
    elementary::{cos, ln, powi, sin, tanh},
};
use serde::{Deserialize, Serialize};
use stats::two_sided;

use super::{Grid, Kind, Series, Summary};
use mc::add_rows;

/// Wanted statistics of dependence; observables are given by their numbers.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Wanted {
    /// Pairs with a covariance, a correlation and a joint law.
    pub pairs: Vec<(usize, usize)>,
    /// Observables with an autocorrelation and a spectrum.
    pub lagged: Vec<usize>,
    /// Number of the time from which on lags are counted.
    pub from: usize,
    /// Observables that are zero or one: their means are probabilities with binomial intervals, and
    /// they have no quantiles.
    pub probabilities: Vec<usize>,
}

/// The joint law of two observables at the final time: counts in bins.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Joint {
    /// Names of both observables.
    pub names: [String; 2],
    /// Bins of each observable.
    pub grids: [Grid; 2],
    /// Counts: those of the first bin of the first observable, then of the second one, and so on.
    pub counts: Vec<u64>,
    /// Number of values outside of the bins.
    pub outside: u64,
}

/// Sums of a pair at a time: n, Σa, Σb, Σab, Σa², Σb².
pub type OfPair = [Row; 6];
/// Largest number of bins of a joint law on each side.
const BINS: u32 = 64;
/// The part of the lags over which the two windows of spectra are flat.
const FLAT: [f64; 2] = [0.0, 0.25];
/// Number of counts of a joint law: those of its bins, and one of values outside of them.
pub const CELLS: usize = (BINS * BINS) as usize + 1;

/// Number of bins of the grid of a study that make one of a joint law.
fn joined(grid: &Grid) -> u32 {
    grid.bins.div_ceil(BINS)
}

/// Wanted statistics, grids and number of observables for sums of dependence.
#[derive(Clone, Copy)]
pub struct Cells<'a> {
    pub wanted: &'a Wanted,
    /// The grids of all observables, time by time; none in a pilot.
    pub grids: &'a [Grid],
    pub observables: usize,
}

impl<'a> Cells<'a> {
    fn times(self) -> usize {
        self.grids.len() / self.observables
    }

    fn grid(self, time: usize, k: usize) -> &'a Grid {
        &self.grids[time * self.observables + k]
    }

    /// Values of an observable, shifted and scaled to the size one.
    fn scaled(self, time: usize, k: usize, values: &[Row]) -> Row {
        let grid = self.grid(time, k);
        let (middle, scale) = (grid.edge(grid.bins / 2), grid.scale());
        values[k].map(|x| (x - middle) * scale)
    }

    /// Number of times from which on lags are counted.
    fn lagged_times(self) -> usize {
        self.times().saturating_sub(self.wanted.from)
    }

    /// The values of the observables of which lags are wanted, in the same unit at all times.
    pub fn lagged(self, values: &[Row]) -> Vec<Row> {
        let last = self.times() - 1;
        self.wanted.lagged.iter().map(|&k| self.scaled(last, k, values)).collect()
    }
}

/// The values of one block so far at saved times, as they are and filtered.
#[derive(Default)]
pub struct Past {
    values: Vec<Vec<Row>>,
    filtered: Vec<Vec<Row>>,
}

impl Past {
    /// Adds values at a step to the filtered ones at the saved times before and after it: with
    /// `every` steps between these, counted from the first of them.
    pub fn filter(&mut self, step: u64, every: u64, rows: &[Row]) {
        let (first, after, size) = ((step / every) as usize, (step % every) as f64, every as f64);
        let length = self.filtered.len().max(first + 2);
        self.filtered.resize(length, vec![[0.0; WIDTH]; rows.len()]);
        for (place, weight) in [(first, size - after), (first + 1, after)] {
            let weight = weight / (size * size);
            self.filtered[place]
                .iter_mut()
                .flatten()
                .zip(rows.iter().flatten())
                .for_each(|(sum, x)| *sum += weight * x);
        }
    }
}

/// Sums of dependence; rows are in 32 batches.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Dependence {
    /// Sums of each pair at each time.
    pairs: Vec<Vec<OfPair>>,
    /// Sums of each observable, of its values and of the filtered ones, except at the ends, on one
    /// side of which no values are: n, the mean over times, and for each lag the sum of products.
    lagged: Vec<[Vec<Row>; 2]>,
    /// The joint law of each pair.
    joint: Vec<Vec<u64>>,
}

impl Dependence {
    pub fn new(of: Cells<'_>) -> Self {
        let Wanted { pairs, lagged, .. } = of.wanted;
        let zero = [0.0; WIDTH];
        // Lag zero included.
        let lags = of.lagged_times() / 2 + 1;
        Self {
            pairs: vec![vec![[zero; 6]; pairs.len()]; of.times()],
            lagged: vec![[(); 2].map(|()| vec![zero; 2 + lags]); lagged.len()],
            joint: vec![vec![0; CELLS]; pairs.len()],
        }
    }

    pub fn merge(&mut self, later: &Self) {
        self.pairs
            .iter_mut()
            .flatten()
            .zip(later.pairs.iter().flatten())
            .for_each(|(sums, more)| add_rows(sums, more));
        self.lagged
            .iter_mut()
            .flatten()
            .zip(later.lagged.iter().flatten())
            .for_each(|(sums, more)| add_rows(sums, more));
        self.joint
            .iter_mut()
            .flatten()
            .zip(later.joint.iter().flatten())
            .for_each(|(sum, more)| *sum += more);
    }

    /// Adds the values of all observables on a block at a time.
    pub fn add(
        &mut self,
        of: Cells<'_>,
        time: usize,
        values: &[Row],
        live: PathMask,
        past: &mut Past,
    ) {
        let (wanted, is_last) = (of.wanted, time + 1 == of.times());
        let pairs = wanted.pairs.iter().zip(&mut self.pairs[time]).zip(&mut self.joint);
        for ((&(k, l), sums), joint) in pairs {
            let [a, b] = [k, l].map(|k| of.scaled(time, k, values));
            let last = is_last.then(|| {
                [k, l].map(|k| {
                    let (grid, mut places) = (of.grid(time, k), [0; WIDTH]);
                    grid.place(&values[k], &mut places);
                    let inside = |place| (1..=grid.bins).contains(&place);
                    places.map(|place| inside(place).then(|| (place - 1) / joined(grid)))
                })
            });
            for p in live.paths().filter(|&p| (a[p] * b[p]).is_finite()) {
                let terms = [1.0, a[p], b[p], a[p] * b[p], a[p] * a[p], b[p] * b[p]];
                sums.iter_mut().zip(terms).for_each(|(row, term)| row[p] += term);
                if let Some([i, j]) = last {
                    let cell = i[p].zip(j[p]).map(|(i, j)| (i * BINS + j) as usize);
                    joint[cell.unwrap_or(CELLS - 1)] += 1;
                }
            }
        }
        if time >= wanted.from && !wanted.lagged.is_empty() {
            past.values.push(of.lagged(values));
            if is_last {
                self.add_lags(std::mem::take(past), live);
            }
        }
    }

    fn add_lags(&mut self, Past { values, mut filtered }: Past, live: PathMask) {
        filtered.truncate(values.len() - 1);
        filtered.drain(..1.min(filtered.len()));
        for (n, sums) in self.lagged.iter_mut().enumerate() {
            for (past, rows) in [&values, &filtered].into_iter().zip(sums) {
                let mut x: Vec<Row> = past.iter().map(|all| all[n]).collect();
                let counted: Vec<usize> = live
                    .paths()
                    .filter(|p| x.iter().map(|row| row[*p]).sum::<f64>().is_finite())
                    .collect();
                (0..WIDTH)
                    .filter(|p| !counted.contains(p))
                    .for_each(|p| x.iter_mut().for_each(|row| row[p] = 0.0));
                counted.iter().for_each(|&p| rows[0][p] += 1.0);
                let length = x.len() as f64;
                for p in 0..WIDTH {
                    rows[1][p] += x.iter().map(|row| row[p]).sum::<f64>() / length;
                }
                for (k, sum) in rows[2..].iter_mut().enumerate().take(x.len()) {
                    for (a, b) in x.iter().zip(&x[k..]) {
                        for p in 0..WIDTH {
                            sum[p] += a[p] * b[p];
                        }
                    }
                }
            }
        }
    }
}

/// Values with their 95 % intervals, by the jackknife over the batches of `sums` that have paths in
/// their first row; `None` for a value that is not finite.
fn jackknife(sums: &[Row], functions: impl Fn(&[f64]) -> Vec<f64>) -> Vec<Option<[f64; 3]>> {
    let batches: Vec<usize> = (0..WIDTH).filter(|&p| sums[0][p] > 0.0).collect();
    let g = batches.len() as f64;
    let total: Vec<f64> = sums.iter().map(|row| batches.iter().map(|&p| row[p]).sum()).collect();
    let whole = functions(&total);
    let rest = |p: usize| total.iter().zip(sums).map(|(all, row)| all - row[p]).collect::<Vec<_>>();
    let without: Vec<_> = batches.iter().map(|&p| functions(&rest(p))).collect();
    let quantile = two_sided(0.95, Some((g - 1.0).max(1.0)));
    (0..whole.len())
        .map(|k| {
            let pseudo = without.iter().map(|one| g * whole[k] - (g - 1.0) * one[k]);
            let mean = pseudo.clone().sum::<f64>() / g;
            let square = pseudo.map(|x| (x - mean) * (x - mean)).sum::<f64>();
            let half = quantile * (square / (g * (g - 1.0))).sqrt();
            (mean + half).is_finite().then_some([mean, mean - half, mean + half])
        })
        .collect()
}

/// A summary of a value with its interval.
fn summary(step: u64, time: f64, count: u64, value: Option<[f64; 3]>) -> Summary {
    let (mean, mean_interval) = (value.map(|[mean, ..]| mean), value.map(|[_, lo, hi]| (lo, hi)));
    Summary { step, time, count, mean, mean_interval, ..Summary::default() }
}

/// Sums of dependence, with the names and the times that results need.
pub struct Found<'a> {
    pub of: Cells<'a>,
    pub names: &'a [String],
    /// Steps and their times.
    pub at: Vec<(u64, f64)>,
    pub sums: &'a Dependence,
}

impl Found<'_> {
    /// Covariance and correlation of each pair in time. A fixed initial value of `start` paths
    /// comes first, with covariance zero and no correlation.
    pub fn pairs(&self, start: Option<u64>) -> Vec<Series> {
        let of = |(n, &(k, l)): (usize, &(usize, usize))| {
            let points = self.at.iter().enumerate().map(|(time, &(step, t))| {
                let sums = &self.sums.pairs[time][n];
                let [a, b] = [k, l].map(|k| self.of.grid(time, k).scale());
                let found = jackknife(sums, |s| {
                    let product = |sum: f64, x: f64, y: f64| (sum - x * y / s[0]) / (s[0] - 1.0);
                    let covariance = product(s[3], s[1], s[2]);
                    let variances = product(s[4], s[1], s[1]) * product(s[5], s[2], s[2]);
                    let (r, unit) = (covariance / variances.sqrt(), 1.0 / (a * b));
                    vec![covariance * unit, 0.5 * ln((1.0 + r) / (1.0 - r))]
                });
                let count = sums[0].iter().sum::<f64>() as u64;
                let correlation = found[1].map(|ends| ends.map(tanh));
                [found[0], correlation].map(|value| summary(step, t, count, value))
            });
            let zero = [Some([0.0; 3]), None];
            let first = start.map(|paths| zero.map(|value| summary(0, 0.0, paths, value)));
            let (covariances, correlations) =
                first.into_iter().chain(points).map(|[one, other]| (one, other)).unzip();
            let series = |what: &str, kind, points| {
                let observable = format!("{what}({}, {})", self.names[k], self.names[l]);
                Series { observable, kind, points }
            };
            [
                series("cov", Kind::Covariance, covariances),
                series("corr", Kind::Correlation, correlations),
            ]
        };
        self.of.wanted.pairs.iter().enumerate().flat_map(of).collect()
    }

    /// Autocorrelations against the lag, and spectra against the frequency.
    pub fn lagged(&self) -> Vec<Series> {
        let [.., before, last] = self.at[..] else { return Vec::new() };
        let number = self.of.lagged_times();
        let (delta, half) = (last.1 - before.1, (number / 2).max(1));
        let of = |(&k, [sums, filtered]): (&usize, &[Vec<Row>; 2])| {
            let unit = self.of.grid(self.at.len() - 1, k).scale();
            let covariances = |s: &[f64], number: usize| -> Vec<f64> {
                let mean = s[1] / s[0];
                let of_lag = |(k, sum)| sum / (s[0] * (number as f64 - f64::from(k))) - mean * mean;
                (0u32..).zip(&s[2..]).map(of_lag).collect()
            };
            let autocorrelation = jackknife(sums, |s| {
                let c = covariances(s, number);
                c.iter().map(|x| x / c[0]).collect()
            });
            let every = (last.0 - before.0) as f64;
            let frequencies = 0..=(half / 2).min((half as f64 * every / 8.0) as usize);
            let angle = |n: usize| PI * n as f64 / half as f64;
            let cosines: Vec<f64> = (0..2 * half).map(|n| cos(angle(n))).collect();
            let window = |k: usize| {
                let both = if k == 0 { 1.0 } else { 2.0 };
                FLAT.map(|flat| {
                    let falls = (angle(k) - PI * flat).max(0.0) / (1.0 - flat);
                    both * (0.5 + 0.5 * cos(falls))
                })
            };
            let windows: Vec<_> = (0..half).map(window).collect();
            let both = jackknife(filtered, |s| {
                let c = covariances(s, number.saturating_sub(2));
                frequencies
                    .clone()
                    .flat_map(|j| {
                        let x = 0.5 * angle(j);
                        let root = if j == 0 { 1.0 } else { sin(x) / (every * sin(x / every)) };
                        let scale = delta / (2.0 * PI * powi(root, 4) * unit * unit);
                        let terms = (0..).zip(c.iter().zip(&windows));
                        terms.fold([0.0; 2], |sum, (k, (c, window))| {
                            let term = scale * c * cosines[j * k % (2 * half)];
                            [0, 1].map(|n| sum[n] + window[n] * term)
                        })
                    })
                    .collect()
            });
            let spectrum = both
                .chunks_exact(2)
                .map(|of| {
                    let ([mean, lo, hi], [_, least, most]) = (of[0]?, of[1]?);
                    Some([mean, lo.min(least), hi.max(most)])
                })
                .collect();
            let count = sums[0].iter().sum::<f64>() as u64;
            let series = |what: &str, kind, axis: f64, values: Vec<_>| {
                let point = |(k, x)| summary(k, axis * k as f64, count, x);
                let points = (0..).zip(values).map(point).collect();
                Series { observable: format!("{what}({})", self.names[k]), kind, points }
            };
            let frequency = PI / (delta * half as f64);
            [
                series("autocorrelation", Kind::Autocorrelation, delta, autocorrelation),
                series("spectrum", Kind::Spectrum, frequency, spectrum),
            ]
        };
        self.of.wanted.lagged.iter().zip(&self.sums.lagged).flat_map(of).collect()
    }

    /// The joint laws at the final time.
    pub fn joint(&self) -> Vec<Joint> {
        let of = |(&(k, l), counts): (&(usize, usize), &Vec<u64>)| {
            let grids = [k, l].map(|k| {
                let grid @ &Grid { lo, width, bins } = self.of.grid(self.at.len() - 1, k);
                let joined = joined(grid);
                Grid { lo, width: width * f64::from(joined), bins: bins.div_ceil(joined) }
            });
            let [x, y] = grids.map(|grid| grid.bins as usize);
            let cells = (0..x).flat_map(|i| &counts[i * BINS as usize..][..y]);
            Joint {
                names: [k, l].map(|k| self.names[k].clone()),
                grids,
                counts: cells.copied().collect(),
                outside: counts[CELLS - 1],
            }
        };
        self.of.wanted.pairs.iter().zip(&self.sums.joint).map(of).collect()
    }
}
