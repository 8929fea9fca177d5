//! Averages with their intervals.

use std::{fmt, ops::Range};

use real::elementary::{exp2, hypot};
use serde::Serialize;
use stats::{CONFIDENCE, CentralMoments, FEW_SAMPLES, Warning, two_sided};

use super::{
    Averaged, EquilibriumSettings, LEVELS, Slope,
    chains::{Chains, Living, moments},
    growth::{unsettled, wander},
    rules::{
        ALIKE, APART, BIAS_ENOUGH, BIAS_PART, DRIFTS, EXCEEDS, FORECAST, MARGIN, MIN_FALL,
        MIN_LENGTH, NEGLIGIBLE, SHARED, WIDER,
    },
    wells::{Watched, Well},
};
use expectation::{short, written};
use study::Histogram;

/// Averages over the stationary law.
#[derive(Clone, Debug, Serialize)]
pub struct Averages {
    /// Identifier of the scheme.
    pub scheme: String,
    /// The averages, in the order of their test functions.
    #[serde(rename = "estimates")]
    pub means: Vec<StationaryMean>,
    /// Derivatives of the averages by each parameter that is asked for.
    pub gradient: Vec<(String, Vec<StationaryMean>)>,
    /// Half-width that was asked for.
    pub accuracy: f64,
    /// The step sizes 4τ, 2τ, τ; one where steps have no bias.
    pub taus: Vec<f64>,
    /// Parts of the moves that were accepted where steps have no bias, by H₀ and by noises.
    pub accepted: Option<[f64; 2]>,
    /// Heat capacity β²Var(H₀) with half of its 95 % interval where steps have no bias.
    pub heat_capacity: Option<[f64; 2]>,
    /// Reason why ⟨H₀⟩ is unknown, and so the heat capacity and derivatives by β.
    pub energy: Option<Warning>,
    /// Number of chains.
    pub chains: usize,
    /// Length of each chain in time.
    pub time: f64,
    /// Part of the time that was left out.
    pub burn_in: f64,
    /// Path-steps of all chains.
    pub spent: u64,
    /// The first chain that failed: scheme, step size and reason.
    pub failure: Option<String>,
    /// Reasons why all averages are unknown.
    pub unknown: Vec<Warning>,
    /// Whether chains failed.
    #[serde(skip)]
    pub(super) fails: bool,
    /// Number of chains with all step sizes that gives the least error for its cost.
    #[serde(skip)]
    pub(super) wanted: f64,
}

/// An average over the stationary law.
#[derive(Clone, Debug, Serialize)]
pub struct StationaryMean {
    /// Name of the function.
    #[serde(rename = "of")]
    pub name: String,
    /// The average.
    #[serde(rename = "value")]
    pub mean: f64,
    /// Half of the 95 % interval without the bias of the step.
    pub sampling: f64,
    /// Part of the half-width for the bias of the step.
    pub bias: f64,
    /// Part of the half-width for growth that is not exponential yet; zero except for exponents.
    pub unsettled: f64,
    /// Deviation of the function; zero for exponents.
    pub deviation: f64,
    /// Autocorrelation time, in units of time; `None` for exponents, and where steps have no bias:
    /// those follow no path of the system.
    pub autocorrelation_time: Option<f64>,
    /// d⟨φ⟩/dβ = −Cov(φ, H₀) with half of its 95 % interval where steps have no bias.
    pub by_beta: Option<[f64; 2]>,
    /// Number of independent samples that would be as good; `None` for exponents.
    pub effective_samples: Option<f64>,
    /// Mean at each step size, its difference from that at the finest, and the standard error of
    /// the difference, in which most of the noise cancels.
    pub levels: Vec<(f64, f64, f64)>,
    /// Reason why the average is unknown.
    pub unknown: Option<Warning>,
    /// Histogram of the values after the burn-in.
    pub histogram: Option<Histogram>,
    /// Length of a chain in autocorrelation times.
    #[serde(skip)]
    lengths: f64,
    /// Bias that was seen, and its standard error.
    #[serde(skip)]
    seen: (f64, f64),
}

impl StationaryMean {
    /// Half of the 95 % interval.
    pub fn half_width(&self) -> f64 {
        self.sampling + self.bias + self.unsettled
    }

    /// The 95 % interval.
    pub fn interval(&self) -> (f64, f64) {
        (self.mean - self.half_width(), self.mean + self.half_width())
    }

    /// Whether the bias is seen, and not small beside the sampling error.
    fn wants_shorter_steps(&self, accuracy: f64) -> bool {
        let (bias, error) = self.seen;
        bias > (BIAS_PART * self.sampling).max(BIAS_ENOUGH * accuracy).max(EXCEEDS * error)
    }

    /// Least factor by which chains must be longer for an accuracy.
    fn lacks(&self, accuracy: f64) -> f64 {
        let length = if self.unknown.is_some() { MIN_LENGTH / self.lengths } else { 1.0 };
        length.max((self.sampling / accuracy).powi(2))
    }
}

/// Relative rounding error of a mean.
const ROUND_OFF: f64 = 1e-12;

/// Both ways for the weak order p: weights of the means at 4τ, 2τ, τ for the estimate, and for the
/// bound on the bias.
fn ways(p: f64) -> [[[f64; LEVELS]; 2]; 2] {
    let power = exp2(p);
    let (last, c) = (1.0 / (power * power - 1.0), 1.0 / (power - 1.0));
    [
        [[0.0, 0.0, 1.0], [-last, 0.0, last]],
        [[0.0, -c, 1.0 + c], [c * c, -c * c * (1.0 + power), c * c * power]],
    ]
}

/// The means of chains after a burn-in.
struct Kept {
    /// Means at each step size: of all chains at the longest, of the first ones, which have all, at
    /// the others.
    means: Vec<Vec<f64>>,
    /// Mean square over all chains at the main step size.
    square: f64,
    /// Variance over the chains of their means, if batches were independent.
    of_batches: f64,
    /// The time of each chain.
    time: f64,
}

impl Kept {
    /// A sum over step sizes, with weights of the last ones, and its standard error. Chains that
    /// have the longest step alone give what the sum has of a mean, the others what it has of
    /// differences from that besides.
    fn mean(&self, weights: [f64; LEVELS]) -> (f64, f64) {
        let weights = &weights[LEVELS - self.means.len()..];
        let main = &self.means[0];
        let paired = self.means.last().map_or(0, Vec::len);
        let all = main.len() as f64;
        let sum: f64 = weights.iter().sum();
        // Of differences nothing is left.
        let share = if sum.abs() > 1e-9 { sum * paired as f64 / all } else { 0.0 };
        let first = moments((0..paired).map(|n| {
            let of: f64 = weights.iter().zip(&self.means).map(|(w, of)| w * of[n]).sum();
            of - sum * main[n] + share * main[n]
        }));
        let others = moments(main[paired..].iter().map(|x| sum * x));
        if share == 0.0 || others.count() == 0 {
            return (first.mean(), first.variance_of_mean().sqrt());
        }
        let part = others.count() as f64 / all;
        let variance = first.variance_of_mean() + part * part * others.variance_of_mean();
        (first.mean() + part * others.mean(), variance.sqrt())
    }

    /// Moments of the means at the main step size.
    fn main(&self, is_average: bool) -> CentralMoments {
        let main = if is_average { self.means.first() } else { self.means.last() };
        moments(main.into_iter().flatten().copied())
    }

    /// The number of chains with all step sizes that gives the least error for its cost.
    fn wanted(&self) -> f64 {
        let (first, last) = (&self.means[0], &self.means[LEVELS - 1]);
        let correction = moments(last.iter().zip(first).map(|(last, first)| last - first));
        let cost = self.main(true).variance() * f64::from((1 << LEVELS) - 2);
        first.len() as f64 * (correction.variance() / cost).sqrt()
    }
}

impl Averages {
    pub(super) fn new(
        chains: &Chains,
        settings: &EquilibriumSettings,
        (of, scheme, beta): (Averaged<'_>, &str, Option<f64>),
        accuracy: f64,
        watched: Watched<'_>,
    ) -> Self {
        let (living, count, tau) = (chains.living(), of.count(), chains.tau);
        let (batches, live) = (living.batches.len(), living.chains.len());
        let is_average = matches!(of, Averaged::Of(..));
        let (unit, least) =
            if is_average { (1.0, 0.0) } else { (1.0 / tau, NEGLIGIBLE * accuracy) };
        let levels = chains.levels;
        // Averages are judged at the longest step, which all chains have.
        let main = if is_average { 0 } else { (levels - 1) * count };
        let row = |k: usize| main + k;
        // The sum of exponents is known to settle.
        let settling = if is_average { count } else { (count - 1).max(1) };
        let burn_in = (0..count)
            .try_fold(0, |most: usize, k| Some(most.max(burn_in(&living, row(k), least / unit)?)));
        let first = burn_in.unwrap_or(batches / 2);
        let late = (batches - first) as f64;
        let time = tau * (chains.batch_steps * batches as u64) as f64;
        let means = |run: usize, row: usize| {
            let chains = if run == 0 { live } else { living.paired };
            living.sums(row, first..batches).map(move |sum| sum * unit / late).take(chains)
        };
        let kept = |k: usize| Kept {
            means: (0..levels).map(|run| means(run, run * count + k).collect()).collect(),
            square: means(0, levels * count + k).sum::<f64>() / live as f64,
            of_batches: (first..batches).map(|b| spread(&living, row(k), b)).sum::<f64>()
                * unit
                * unit
                / (late * late),
            time: time * late / batches as f64,
        };
        // −Cov(φ, w) + ⟨∂φ⟩ for a weight w: of the rows of φ, w and φw − ∂φ at each step size.
        let slope = |name: String, rows: &dyn Fn(usize) -> [usize; 3]| {
            let of_run = |run: usize| -> Vec<f64> {
                let rows = rows(run).map(|row| means(run, row).collect::<Vec<_>>());
                let [f, w] = [0, 1].map(|k| moments(rows[k].iter().copied()).mean());
                (0..rows[0].len())
                    .map(|n| f * (rows[1][n] - w) + w * rows[0][n] - rows[2][n])
                    .collect()
            };
            let means = (0..levels).map(of_run).collect();
            let kept = Kept { means, square: 0.0, of_batches: 0.0, time };
            StationaryMean {
                effective_samples: None,
                autocorrelation_time: None,
                ..mean(&kept, settings.weak_order, name, true)
            }
        };
        let by = |weight: usize, k: usize, name: String| {
            let products = |run| chains.products(run, weight);
            slope(name, &|run| [run * count + k, products(run), products(run) + 2 + k])
        };
        let ends = |mean: StationaryMean| [mean.mean, mean.half_width()];
        let wells = |of| watched.wells(&living, of, first);
        let stays = |mean: &mut StationaryMean, Well { of, crossings }: Well| {
            mean.lengths = mean.lengths.min(crossings);
            let what = Warning::new("the chains stay in wells on which it depends");
            mean.unknown.get_or_insert(what.with_reason(format!("{of} does not forget")));
        };
        // Why covariances with a weight are unknown: its own average is.
        let unknown = |weight: usize| {
            let row = chains.products(0, weight);
            let kept = Kept {
                means: vec![means(0, row).collect()],
                square: means(0, row + 1).sum::<f64>() / live as f64,
                of_batches: 0.0,
                time,
            };
            let mut mean = mean(&kept, settings.weak_order, String::new(), true);
            let well = wells((1, true, row, chains.rows())).remove(0);
            well.into_iter().for_each(|well| stays(&mut mean, well));
            mean.unknown
        };
        let energy = beta.and_then(|_| unknown(0));
        let mut wanted = 0.0f64;
        let mean = |((k, name), well): ((usize, String), Option<Well>)| {
            let kept = kept(k);
            if is_average && levels == LEVELS {
                wanted = kept.wanted().max(wanted);
            }
            let mut mean = mean(&kept, settings.weak_order, name, is_average);
            mean.histogram = chains.histograms.get(k).cloned();
            mean.by_beta = beta.map(|_| ends(by(0, k, String::new())));
            let wander = unit * wander(&living, row(k), first);
            if !is_average || wander > SHARED * mean.sampling {
                mean.sampling = hypot(mean.sampling, wander);
            }
            let (lo, hi) = mean.interval();
            let reach = (!is_average && k < settling)
                .then(|| unsettled(&living, row(k), first, (lo / unit, hi / unit)))
                .flatten()
                .filter(|(lo, hi)| 0.5 * (hi - lo) * unit > mean.half_width() + least);
            if let Some((lo, hi)) = reach {
                mean.unsettled = 0.5 * (hi - lo) * unit - mean.half_width();
                mean.mean = 0.5 * (lo + hi) * unit;
            } else if let Some(well) = well {
                stays(&mut mean, well);
            }
            if mean.unknown.is_some() || energy.is_some() {
                mean.by_beta = None;
            }
            mean
        };
        let wells = wells((count, is_average, main, chains.rows()));
        let means: Vec<StationaryMean> =
            of.names().into_iter().enumerate().zip(wells).map(mean).collect();
        let drifts =
            burn_in.is_none() && means.iter().take(settling).any(|mean| mean.unsettled == 0.0);
        let drifts = drifts.then(|| {
            Warning::new("the chains still drift after half of their time")
                .with_reason("no stationary law is reached, or there is none")
        });
        let is_short = !is_average && watched.dimension > 1 && time * accuracy < APART;
        let mixed = is_short.then(|| {
            let length = format!("chains should have a length of {}", short(APART / accuracy));
            Warning::new("directions whose exponents differ by the accuracy are not apart yet")
                .with_reason(length)
        });
        let all = settings.blocks_of_chains();
        let failed = all - live as u64;
        let fails = failed > 0;
        let large = if chains.are_large() {
            "states are beyond 1e50: steps are too long, or they grow without bound, and exponents \
             of a linear system are those at y = 0"
        } else {
            ""
        };
        let failed = fails
            .then(|| Warning::new(format!("{failed} of {all} chains failed")).with_reason(large));
        let exact = usize::from(beta.is_some());
        let gradient = of.slopes().iter().enumerate().map(|(w, Slope { parameter, .. })| {
            let unknown = unknown(exact + w);
            let of_mean = |(k, of): (usize, &StationaryMean)| {
                let mut slope = by(exact + w, k, format!("∂{}/∂{parameter}", of.name));
                slope.unknown = slope.unknown.or(of.unknown.clone()).or(unknown.clone());
                slope
            };
            (parameter.clone(), means.iter().enumerate().map(of_mean).collect())
        });
        Self {
            scheme: scheme.into(),
            gradient: gradient.collect(),
            accuracy,
            taus: (0..levels).map(|k| tau / f64::from(1 << k)).collect(),
            accepted: beta.map(|_| chains.accepted),
            heat_capacity: beta.filter(|_| energy.is_none()).map(|beta| {
                let products = chains.products(0, 0);
                let [value, half_width] =
                    ends(slope(String::new(), &|_| [products, products, products + 1]));
                [-beta * beta * value, beta * beta * half_width]
            }),
            energy,
            chains: live,
            time,
            burn_in: time * first as f64 / batches as f64,
            spent: chains.spent,
            failure: chains.failure.clone(),
            unknown: drifts.into_iter().chain(failed).chain(mixed).collect(),
            fails,
            wanted,
            means,
        }
    }

    /// The averages and their derivatives.
    fn all(&self) -> impl Iterator<Item = &StationaryMean> {
        self.means.iter().chain(self.gradient.iter().flat_map(|(_, slopes)| slopes))
    }

    /// The largest half-width.
    pub fn half_width(&self) -> f64 {
        self.all().map(StationaryMean::half_width).fold(0.0, stats::worse)
    }

    /// Whether more than `most` path-steps are needed, by a forecast from the `since` path-steps
    /// that were done with the current steps.
    pub(super) fn is_out_of_reach(&self, since: u64, most: u64) -> bool {
        let lacks = self.all().map(|mean| mean.lacks(self.accuracy)).fold(1.0, f64::max);
        let [since, most] = [since, most].map(|n| n as f64);
        since > FORECAST * most && since * lacks > MARGIN * most
    }

    /// Whether the bias is large, or chains fail.
    pub(super) fn wants_shorter_steps(&self) -> bool {
        self.fails || self.all().any(|mean| mean.wants_shorter_steps(self.accuracy))
    }

    /// Whether every interval has the accuracy, and nothing is unknown.
    pub fn reached(&self) -> bool {
        let known = self.all().all(|mean| mean.unknown.is_none());
        known && self.unknown.is_empty() && self.half_width() <= self.accuracy
    }
}

/// The variance over the chains of a row of a batch.
fn spread(living: &Living<'_>, row: usize, batch: usize) -> f64 {
    moments(living.sums(row, batch..batch + 1)).variance()
}

/// Number of batches to leave out for the average in this row of batches, of which `least` is not a
/// change; `None` if more than half.
fn burn_in(living: &Living<'_>, row: usize, least: f64) -> Option<usize> {
    let (all, half) = (living.batches.len(), living.batches.len() / 2);
    let last = living.sums(row, all - 1..all).map(f64::abs).fold(0.0, f64::max);
    // The deviation of late batches that all chains share, such as a phase.
    let shared = |b: usize| moments(living.sums(row, b..b + 1)).mean();
    let swing = moments((half..all).map(shared)).variance().sqrt();
    // Whether the means of two ranges of batches differ.
    let differ = |a: Range<usize>, b: Range<usize>, swing: f64| {
        let (a, b) = (living.means(row, a), living.means(row, b));
        let moments = moments(a.zip(b).map(|(a, b)| a - b));
        let error = moments.variance_of_mean().sqrt();
        moments.mean().abs() > DRIFTS * error.max(swing) + least.max(ROUND_OFF * last)
    };
    let spread = |b: usize| spread(living, row, b);
    let usual = (half..all).map(spread).sum::<f64>() / half as f64;
    let is_early = |b: usize| differ(b..b + 1, half..all, swing) || spread(b) > WIDER * usual;
    let first = (0..half).rev().find(|&b| is_early(b)).map_or(1, |b| 2 * (b + 1));
    let middle = (first + all) / 2;
    // Of a bounded motion the ends of both ranges are left.
    let swing = 4.0 * swing / (all - first) as f64;
    (first <= half && !differ(first..middle, middle..all, swing)).then_some(first)
}

/// An average, or an exponent, from the means of its chains.
fn mean(kept: &Kept, order: f64, name: String, is_average: bool) -> StationaryMean {
    let count = kept.means[0].len() as f64;
    let paired = kept.means.last().map_or(0, Vec::len) as f64;
    let quantile = two_sided(CONFIDENCE, Some(paired - 1.0));
    // Differences have one sign, and fall by 2^p or nearly so.
    let (coarse, fine) = (kept.mean([1.0, -1.0, 0.0]), kept.mean([0.0, 1.0, -1.0]));
    let seen = |(mean, error): (f64, f64)| mean.abs() > EXCEEDS * error;
    let turns = coarse.0 * fine.0 < 0.0;
    let (sign, least) = (if turns { -1.0 } else { 1.0 }, MIN_FALL * exp2(order));
    let (excess, error) = kept.mean([-sign, sign + least, -least]);
    let slow = excess * fine.0.signum() > EXCEEDS * error;
    let ways = if slow || turns && seen(coarse) && seen(fine) {
        [[[0.0, 0.0, 1.0], [-sign, sign - 1.0, 1.0]]; 2]
    } else {
        ways(order)
    };
    let [plain, extrapolated] = ways.map(|[weights, bias]| {
        let with =
            |sign: f64| kept.mean(std::array::from_fn(|run| weights[run] + sign * bias[run])).1;
        let ((mean, error), seen) = (kept.mean(weights), kept.mean(bias));
        let sampling = quantile * error + ROUND_OFF * mean.abs();
        let whole = seen.0.abs() + quantile * with(1.0).max(with(-1.0));
        (mean, sampling, (whole - sampling).max(0.0), (seen.0.abs(), seen.1))
    });
    let is_shorter = extrapolated.1 + extrapolated.2 < plain.1 + plain.2;
    let (mean, sampling, mut bias, mut seen) = if is_shorter { extrapolated } else { plain };
    let main = kept.main(is_average);
    let is_exact = kept.means.len() == 1;
    if is_exact {
        (bias, seen) = (0.0, (0.0, 0.0));
    }
    let variance = kept.square - main.mean() * main.mean();
    let deviation = if variance > 1e-14 * kept.square { variance.sqrt() } else { 0.0 };
    let of_mean = main.variance();
    let ratio = if deviation == 0.0 { 0.0 } else { of_mean / (deviation * deviation) };
    // Of exponents, batches are as good as independent.
    let lengths = match is_average {
        true => 2.0 / ratio,
        false if of_mean.sqrt() <= ROUND_OFF * mean.abs() => f64::INFINITY,
        false => MIN_LENGTH * ALIKE * kept.of_batches / of_mean,
    };
    let unknown = if !mean.is_finite() {
        Some(Warning::new("it is not finite"))
    } else if lengths < MIN_LENGTH && is_average {
        let what = format!("the chains are {lengths:.1} autocorrelation times long, or disagree");
        Some(Warning::new(what).with_reason(format!("{MIN_LENGTH} are wanted")))
    } else if lengths < MIN_LENGTH {
        Some(Warning::new("the chains are too short, or disagree"))
    } else {
        let few = main.effective_samples() < FEW_SAMPLES.min(count / 6.0);
        few.then(|| Warning::new("a few chains decide"))
    };
    let level = |run: usize| {
        let own = std::array::from_fn(|k| if k == run { 1.0 } else { 0.0 });
        let (difference, error) = kept.mean([own[0], own[1], own[2] - 1.0]);
        (kept.mean(own).0, difference, error)
    };
    StationaryMean {
        name,
        mean,
        sampling,
        bias,
        unsettled: 0.0,
        deviation,
        autocorrelation_time: (is_average && !is_exact).then_some(0.5 * kept.time * ratio),
        effective_samples: is_average.then_some(count / ratio),
        by_beta: None,
        levels: (LEVELS - kept.means.len()..LEVELS).map(level).collect(),
        unknown,
        histogram: None,
        lengths,
        seen,
    }
}

/// Each average with its interval and the parts of it, what it cost, and what is unknown.
impl fmt::Display for Averages {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let longest = self.all().map(|mean| mean.name.chars().count()).max().unwrap_or(0);
        for mean in self.all() {
            let StationaryMean { name, sampling, bias, unsettled, autocorrelation_time, .. } = mean;
            let half_width = mean.half_width();
            let value = written(mean.mean, half_width);
            write!(f, "{name:longest$} = {value} ± {half_width:.1e}")?;
            if self.accepted.is_none() {
                write!(f, " (sampling {sampling:.1e}, step {bias:.1e}")?;
                if *unsettled > 0.0 {
                    write!(f, ", growth {unsettled:.1e}")?;
                }
                write!(f, ")")?;
            }
            if let Some([slope, half_width]) = mean.by_beta {
                write!(f, ", d/dβ {} ± {half_width:.1e}", written(slope, half_width))?;
            }
            if let Some(time) = autocorrelation_time.filter(|time| *time > 0.0) {
                write!(f, ", autocorrelation time {}", short(time))?;
            }
            if let Some(samples) =
                mean.effective_samples.filter(|samples| mean.deviation > 0.0 && samples.is_finite())
            {
                write!(f, ", {samples:.1e} effective samples")?;
            }
            writeln!(f)?;
            if *unsettled > 0.0 {
                let (lo, hi) = mean.interval();
                let (sign, end) = if mean.mean > 0.0 { ("≤", hi) } else { ("≥", lo) };
                let end = written(end, half_width);
                let is_power = lo <= 0.0 && 0.0 <= hi;
                let why = if is_power {
                    "growth may be that of a power of t, so far"
                } else {
                    "growth changes with time"
                };
                writeln!(f, "  {name} {sign} {end}: {why}")?;
            }
            if let Some(why) = &mean.unknown {
                writeln!(f, "  cannot tell: {why}")?;
            }
        }
        let Self { scheme, taus, chains, accuracy, accepted, .. } = self;
        let [time, burn_in] = [self.time, self.burn_in].map(short);
        let taus = taus.iter().map(|tau| format!("{tau:.2e}")).collect::<Vec<_>>().join(", ");
        writeln!(
            f,
            "{scheme} with steps {taus}; {chains} chains of length {time}, burn-in {burn_in}; \
             {:.2e} path-steps",
            self.spent as f64
        )?;
        if let Some([value, half_width]) = self.heat_capacity {
            let value = written(value, half_width);
            writeln!(f, "heat capacity Var(H0)/kT² = {value} ± {half_width:.1e}")?;
        }
        if let Some(why) = &self.energy {
            writeln!(f, "heat capacity: cannot tell: {why}")?;
        }
        if let Some([by_energy, by_noise]) = accepted {
            let percent = |part: &f64| format!("{:.1} %", 100.0 * part);
            write!(f, "exact: Metropolis; accepted {}", percent(by_energy))?;
            if *by_noise > 0.0 {
                write!(f, ", of moves by noises {}", percent(by_noise))?;
            }
            writeln!(f)?;
        }
        for why in &self.unknown {
            writeln!(f, "cannot tell: {why}")?;
        }
        if self.half_width() > *accuracy {
            writeln!(f, "±{accuracy:e} is not reached")?;
        }
        self.failure.as_ref().map_or(Ok(()), |failure| writeln!(f, "the first failure: {failure}"))
    }
}
