//! Which points are drawn on which level, and when to stop.

use std::{cell::Cell, ops::Range};

use real::elementary;

use super::{
    error::ExpectError,
    extrapolation::{Extrapolation, extrapolation, seen_orders},
    judge::Evidence,
    level::{Drawn, Samples, Values, hull},
    rates,
    report::{Estimate, Expectation, Judged, Level, LevelValue, Limit, Warning},
    resolution::{LARGEST_EXPONENT, unresolved},
    settings::{Orders, Settings, SoFar},
    sum::{BIAS_LEVELS, Sum, Term},
};
use crate::{DampingResolution, driver::GROUP_PATHS};

/// The highest level of the pilot.
const PILOT_LEVEL: usize = BIAS_LEVELS;
/// The part of the accuracy that may go to the bias: it falls by eight or more from a level to the
/// next.
const BIAS_SHARE: f64 = 1.0 / 3.0;
/// The bound on the bias is at most this part of the statistical half-width, so that errors are as
/// large as the interval says.
const BIAS_PART: f64 = 0.5;
/// A bound on the bias below this part of the accuracy is small enough in any case. Where φ hardly
/// varies, half of the statistical half-width may be round-off.
const BIAS_ENOUGH: f64 = 1.0 / 64.0;
/// With a larger part of the accuracy on the finest level allowed, more points are of no use.
const MOST_BIAS: f64 = 0.5;
/// No more points of a replicate than these: twice as many have distinct numbers.
const MAX_POINTS: u64 = 1 << 31;
/// Less than this gain is none to speak of.
const FEW_GAINED: f64 = 2.0;
/// The error of scrambled points falls as N^{−3/2} at most (Owen 1997): as many more are needed.
const LEAST_GROWTH: f64 = 2.0 / 3.0;
/// More samples of the first level do not show a variance that so many have not shown.
const MOST_SAMPLES: u64 = 1 << 24;
/// The part of the accuracy that paths which failed may have: with more, nothing is reached.
const LOST: f64 = 0.25;

/// Gives all points of every replicate of a level: from a number of points drawn before up to
/// another, where the new ones take so many path-steps; `None` if they are drawn elsewhere.
type Draw<'a> = dyn Fn(&Samples, Range<u64>, u64) -> Result<Option<Vec<Drawn>>, ExpectError> + 'a;

/// Why the algorithm ends before it has an expectation.
#[derive(Debug)]
pub enum Halt {
    Error(ExpectError),
    /// Samples are being drawn in parts elsewhere.
    Elsewhere,
}

impl From<ExpectError> for Halt {
    fn from(error: ExpectError) -> Self {
        Self::Error(error)
    }
}

/// The estimation of E[φ] with one scheme from one coarsest step on.
pub struct Estimator<'a> {
    pub draw: &'a Draw<'a>,
    /// The identifier of the scheme.
    pub scheme: &'static str,
    pub t_end: f64,
    pub damping: DampingResolution<'a>,
    /// Names of the test functions.
    pub names: Vec<String>,
    pub accuracy: f64,
    pub settings: Settings,
    /// How the bias falls.
    pub orders: Orders,
    /// Runs of a sample with fine and with coarse steps.
    pub runs: (u64, u64),
    /// Whether there is noise. Without, one path is all.
    pub noisy: bool,
    /// Whether points are Sobol points.
    pub sobol: bool,
    /// The least and the largest value of each test function so far.
    pub ranges: Vec<Option<(f64, f64)>>,
    /// Path-steps so far, those of failed attempts included.
    pub spent: &'a Cell<u64>,
    /// Whether the computation was stopped and gives what is done.
    pub stopped: &'a dyn Fn() -> bool,
    /// All levels so far.
    pub levels: Vec<Samples>,
    /// The level that the sum begins with.
    pub first: usize,
}

impl Estimator<'_> {
    pub fn expectation(mut self) -> Result<Expectation, Halt> {
        let pilot = if self.noisy { GROUP_PATHS } else { 1 };
        self.levels = (0..=PILOT_LEVEL).map(|level| self.level(level)).collect();
        let costs = self.levels.iter().map(|samples| self.cost(samples, pilot));
        let pilot_cost = costs.fold(self.spent.get(), u64::saturating_add);
        let max_cost = self.settings.max_cost;
        if pilot_cost > max_cost {
            return Err(ExpectError::PilotCost { pilot_cost, max_cost }.into());
        }
        self.tell(f64::INFINITY, Some(pilot_cost as f64));
        for level in 0..=PILOT_LEVEL {
            self.sample(level, pilot)?;
        }
        self.first = self.first_level();
        let limit = loop {
            if !self.noisy {
                self.first = self.levels.len() - BIAS_LEVELS;
            }
            let sums: Vec<Sum> = (0..self.names.len()).map(|k| self.sum(k)).collect();
            let last = self.levels.len() - 1;
            let biased =
                |sum: &Sum| if self.noisy { self.is_biased(sum) } else { self.is_wide(sum) };
            let unresolved = !self.unresolved().is_empty();
            let finer = unresolved || sums.iter().any(biased);
            let half_width = sums.iter().map(Sum::half_width).fold(0.0, f64::max);
            self.tell(half_width, (!finer).then(|| self.expected_cost(&sums)));
            if sums.iter().any(|sum| sum.lost > LOST * self.accuracy) {
                break None;
            }
            let least = self.least_cost(&sums, finer);
            if least > max_cost as f64 {
                break Some(Limit::OutOfReach { least, max_cost: max_cost as f64 });
            }
            let (level, points) = if finer && last < self.settings.max_level {
                self.levels.push(self.level(last + 1));
                (last + 1, pilot)
            } else {
                let begin = &self.levels[self.first];
                let wide = sums.iter().any(|sum| self.is_wide(sum));
                let heavy = begin.values.iter().any(Values::is_heavy);
                let enough = !wide && (!heavy || begin.count() >= MOST_SAMPLES);
                let most = MOST_BIAS * self.accuracy;
                let stuck = unresolved || sums.iter().any(|sum| sum.extrapolation.size > most);
                if !self.noisy || enough || finer && stuck {
                    break finer.then_some(Limit::Level { level: last });
                }
                let level = if wide { self.worst(&sums) } else { self.first };
                (level, 2 * self.levels[level].points)
            };
            let samples = &self.levels[level];
            let cost = self.cost(samples, points - samples.points);
            let drawn = match self.spent.get().saturating_add(cost) > max_cost
                || samples.points >= MAX_POINTS
            {
                true => Err(Limit::Cost { max_cost }),
                false => match self.sample(level, points) {
                    Err(Halt::Elsewhere) if (self.stopped)() => Err(Limit::Stopped),
                    drawn => Ok(drawn?),
                },
            };
            if let Err(limit) = drawn {
                self.levels.retain(|samples| samples.paths > 0);
                break Some(limit);
            }
            // Once points are doubled, the first level stays.
            if self.levels.iter().all(|samples| samples.points == pilot) {
                self.first = self.first_level();
            }
        };
        Ok(self.report(limit))
    }

    /// Whether a finer level is wanted: the bias has more than its share, significantly.
    fn is_biased(&self, sum: &Sum) -> bool {
        let Extrapolation { size, standard_error, .. } = sum.extrapolation;
        let (least, most) = (BIAS_ENOUGH * self.accuracy, BIAS_SHARE * self.accuracy);
        let share = (BIAS_PART * sum.spread()).clamp(least, most);
        size > share + sum.quantile() * standard_error
    }

    fn is_wide(&self, sum: &Sum) -> bool {
        sum.half_width() > self.accuracy
    }

    /// What the steps of the last level do not resolve.
    fn unresolved(&self) -> Vec<Warning> {
        unresolved(&self.levels[1..], &self.damping, &self.names, self.accuracy)
    }

    /// Path-steps without which the accuracy is not reached: those of points that lack, on levels
    /// that are fine enough; else those of finer levels that the damping needs.
    fn least_cost(&self, sums: &[Sum], finer: bool) -> f64 {
        let last = &self.levels[self.levels.len() - 1];
        let exponent = self.damping.lasting_exponent(last.level) / LARGEST_EXPONENT;
        match finer {
            false => {
                sums.iter().map(|sum| sum.cost(self.accuracy, LEAST_GROWTH)).fold(0.0, f64::max)
            }
            // A pilot on a level with as many more steps, and on those below it.
            true if self.noisy && exponent > 1.0 => {
                2.0 * self.cost(last, GROUP_PATHS) as f64 * exponent
            }
            true => 0.0,
        }
    }

    /// Path-steps that the accuracy takes in all, if errors fall as they did for the points that
    /// there are.
    fn expected_cost(&self, sums: &[Sum]) -> f64 {
        let begin = &self.levels[self.first];
        let cost = |(k, sum): (usize, &Sum)| {
            let wanted = (self.accuracy - sum.bias_bound()).max(0.5 * self.accuracy);
            let [gain, points] = [begin.gain(k).max(1.0), begin.points as f64].map(elementary::ln);
            let order = 0.5 + 0.5 * gain / points;
            sum.cost(wanted, 1.0 / order.min(1.0 / LEAST_GROWTH))
        };
        sums.iter().enumerate().map(cost).fold(self.spent.get() as f64, f64::max)
    }

    /// Says how far it is.
    fn tell(&self, half_width: f64, expected: Option<f64>) {
        let Settings { max_cost, watch, .. } = self.settings;
        let (accuracy, cost) = (self.accuracy, self.spent.get());
        watch(&SoFar { half_width, accuracy, cost, expected, max_cost });
    }

    /// A level without points.
    fn level(&self, level: usize) -> Samples {
        let (steps, (fine, coarse)) = (self.settings.steps(level), self.runs);
        // A single path has as many runs as a coarse one.
        let cost_per_path =
            if level == 0 { coarse * steps } else { fine * steps + coarse * (steps / 2) };
        let values = vec![Values::default(); self.names.len()];
        Samples { level, cost_per_path, values, ..Samples::default() }
    }

    /// Path-steps of so many points of every replicate.
    fn cost(&self, samples: &Samples, points: u64) -> u64 {
        self.settings.replicates.saturating_mul(points).saturating_mul(samples.cost_per_path)
    }

    /// Draws points of every replicate of a level up to so many.
    fn sample(&mut self, level: usize, points: u64) -> Result<(), Halt> {
        let new = self.cost(&self.levels[level], points - self.levels[level].points);
        let samples = &mut self.levels[level];
        let Some(replicates) = (self.draw)(samples, samples.points..points, new)? else {
            return Err(Halt::Elsewhere);
        };
        let first = replicates.iter().find_map(|replicate| replicate.first_failure);
        for replicate in &replicates {
            let ranges = self.ranges.iter_mut().zip(&replicate.sums.values);
            ranges.for_each(|(range, values)| *range = hull(*range, values.range()));
        }
        self.spent.set(self.spent.get() + new);
        samples.take(replicates, points);
        if samples.count() < 1 + u64::from(self.noisy) {
            return Err(ExpectError::NoPaths { level, failed: samples.failed, first }.into());
        }
        let finite = |values: &Values| match self.noisy {
            true => values.sample.variance().is_finite(),
            false => values.sample.mean().is_finite(),
        };
        match self.names.iter().zip(&samples.values).find(|(_, values)| !finite(values)) {
            Some((observable, _)) => {
                let observable = observable.clone();
                Err(ExpectError::NotFinite { observable, level }.into())
            }
            None => Ok(()),
        }
    }

    /// How far test function number k may spread: as on all levels so far, or by one if it is the
    /// same on all; not at all without noise.
    fn range(&self, k: usize) -> f64 {
        let spread = self.ranges[k].map_or(0.0, |(least, largest)| largest - least);
        match self.noisy {
            true if spread > 0.0 => spread,
            noisy => f64::from(u8::from(noisy)),
        }
    }

    /// Test function number k, summed from the first level on.
    fn sum(&self, k: usize) -> Sum {
        self.sum_from(self.first, k)
    }

    fn sum_from(&self, first: usize, k: usize) -> Sum {
        let (samples, range) = (&self.levels[first], self.range(k));
        let differences = Term::differences(&self.levels[1..], k, range);
        let from = differences.len().saturating_sub(BIAS_LEVELS);
        let (last, of_last) = (&differences[from..], &self.levels[1 + from..]);
        let seen = (rates::alpha(of_last, last, k), rates::beta(of_last, k));
        let orders = if self.noisy { self.orders } else { seen_orders(last, self.orders) };
        let mut extrapolation = extrapolation(last, orders, seen);
        if !self.noisy {
            // Rounding errors of n steps.
            let steps = self.settings.steps(self.levels.len() - 1) as f64;
            let size = samples.values[k].fine.mean().abs();
            extrapolation.size += size * f64::EPSILON * steps.sqrt();
        }
        let mut terms = vec![Term::first(samples, k, range)];
        terms.extend_from_slice(&differences[first..]);
        let share = |samples: &Samples| samples.failed as f64 / samples.paths as f64;
        let lost = self.levels[first..].iter().map(share).sum::<f64>() * range;
        Sum { terms, extrapolation, replicates: self.settings.replicates as f64, lost }
    }

    /// The level to begin with, for which an accuracy costs least: Σ√(VC) is least (Giles 2008),
    /// for all test functions together. Two differences are above it, which extrapolation needs.
    fn first_level(&self) -> usize {
        let root = |first: usize, k: usize| {
            let terms = self.sum_from(first, k).terms;
            terms.iter().map(|term| (term.variance * term.cost).sqrt()).sum::<f64>()
        };
        let mut totals = vec![0.0; self.levels.len() - 2];
        for k in 0..self.names.len() {
            let roots: Vec<f64> = (0..totals.len()).map(|first| root(first, k)).collect();
            let least = roots.iter().copied().fold(f64::INFINITY, f64::min);
            if least > 0.0 {
                totals.iter_mut().zip(&roots).for_each(|(total, root)| *total += root / least);
            }
        }
        (0..totals.len()).min_by(|&a, &b| totals[a].total_cmp(&totals[b])).unwrap_or(0)
    }

    /// The level whose points are doubled: the cheapest one that is enough for every function, if
    /// one is, else the one on which a path-step gains most for the function that gains most (Giles
    /// and Waterhouse 2009).
    fn worst(&self, sums: &[Sum]) -> usize {
        let wide = || sums.iter().filter(|sum| self.is_wide(sum));
        let most = |n: usize| wide().map(|sum| sum.gain(n)).fold(0.0, f64::max);
        let enough = |n: usize| wide().all(|sum| sum.with_twice(n) <= self.accuracy);
        let cost = |n: usize| sums[0].terms[n].cost;
        let terms = 0..self.levels.len() - self.first;
        let cheapest =
            terms.clone().filter(|&n| enough(n)).min_by(|&a, &b| cost(a).total_cmp(&cost(b)));
        let best = || terms.max_by(|&a, &b| most(a).total_cmp(&most(b)));
        self.first + cheapest.or_else(best).unwrap_or(0)
    }

    fn report(self, limit: Option<Limit>) -> Expectation {
        let Self { ref levels, first, noisy, accuracy, scheme, .. } = self;
        // Levels below the first may be far from the limit; three differences make a slope.
        let differences = &levels[1..];
        let from = first.min(differences.len().saturating_sub(BIAS_LEVELS));
        let estimate = |(k, name): (usize, &String)| {
            let sum = self.sum(k);
            let terms = Term::differences(differences, k, self.range(k));
            Estimate {
                name: name.clone(),
                value: sum.value(),
                standard_error: sum.standard_error(),
                quantile: sum.quantile(),
                missed: sum.missed(),
                bias: sum.bias(),
                bias_bound: sum.bias_bound(),
                alpha: rates::alpha(&differences[from..], &terms[from..], k),
                beta: rates::beta(&differences[from..], k),
                failed: levels[first..].iter().map(|samples| samples.failed).sum(),
                judged: Judged::default(),
            }
        };
        let mut estimates: Vec<_> = self.names.iter().enumerate().map(estimate).collect();
        let (order, unresolved) = (self.orders.weak, self.unresolved());
        let evidence = Evidence { levels, first, order, noisy, unresolved };
        let mut warnings = evidence.judge(&mut estimates);
        warnings.extend(limit.map(Warning::Limit));
        let level = |samples: &Samples| {
            let samples_of = samples.values.iter().map(|values| &values.sample);
            Level {
                level: samples.level,
                tau: self.t_end / self.settings.steps(samples.level) as f64,
                samples: samples.count(),
                failed: samples.failed,
                cost_per_path: samples.cost_per_path,
                values: samples_of
                    .map(|of| LevelValue { mean: of.mean(), variance: of.variance() })
                    .collect(),
            }
        };
        let (decisions, cost) = (self.decisions(), self.spent.get());
        let levels = levels.iter().map(level).collect();
        Expectation { scheme, accuracy, cost, levels, warnings, estimates, decisions }
    }

    /// Says which levels and how many points were chosen, and what Sobol points gained.
    fn decisions(&self) -> Vec<String> {
        let numbers = 0..self.names.len();
        let used = &self.levels[self.first..];
        let orders = numbers.clone().map(|k| self.sum(k).extrapolation.order);
        let order = orders.fold(f64::INFINITY, f64::min);
        let steps = |samples: &Samples| self.settings.steps(samples.level);
        let (fewest, most) = (steps(&used[0]), steps(&used[used.len() - 1]));
        let levels =
            format!("levels of {fewest} to {most} steps, extrapolated with order {order:.2}");
        if !self.noisy {
            return vec![levels, "one path: there is no noise".into()];
        }
        let points: Vec<String> = used.iter().map(|samples| samples.points.to_string()).collect();
        let (replicates, points) = (self.settings.replicates, points.join(", "));
        if !self.sobol {
            return vec![levels, format!("{replicates} times {points} random points on them")];
        }
        let gains = numbers.map(|k| used[0].gain(k)).filter(|gain| gain.is_finite());
        let gained = match gains.reduce(f64::min) {
            None => "no function varies from scramble to scramble".into(),
            Some(least) if least < FEW_GAINED => {
                "Sobol points are hardly better than random ones for some function: it jumps, or \
                 many dimensions count"
                    .into()
            }
            Some(least) => {
                format!("Sobol points have at most 1/{least:.0} of the variance of random ones")
            }
        };
        vec![levels, format!("{replicates} scrambles of {points} Sobol points on them"), gained]
    }
}
