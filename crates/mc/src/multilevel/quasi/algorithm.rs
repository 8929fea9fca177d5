//! Which points are drawn on which level, and when to stop.

use std::{cell::Cell, ops::Range};

use real::elementary;
use stats::{CONFIDENCE, two_sided};

use super::{
    super::{
        algorithm::{Halt, LARGEST_EXPONENT, unresolved_damping},
        bias::BIAS_LEVELS,
        diagnosis::{Evidence, level_values},
        error::MultilevelError,
        level::{Drawn, Samples, Values, hull},
        plan::{self, Term},
        report::{Estimate, Expectation, Judged, Level, QUANTILE, Warning},
        resolution::{Motion, coupled, is_near, unresolved, unresolved_function},
        settings::{Coupling, ExpectationSettings, SoFar, whole},
        tails::{Tail, is_heavy, tails},
    },
    extrapolation::{Extrapolation, Orders, extrapolation, seen_orders},
    level::Scrambles,
};
use crate::SeenDamping;

/// The highest level of the pilot: three differences bound the bias.
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

/// The part of the variance from which on the largest and the least value of a scramble decide.
const FEW_DECIDE: f64 = 0.5;
/// The confidence for which Student's quantile is taken then.
const HIGH_CONFIDENCE: f64 = 0.99;
/// No more points of a scramble than these: twice as many have distinct numbers.
const MAX_POINTS: u64 = 1 << 31;
/// Less than this gain is none to speak of.
const FEW_GAINED: f64 = 2.0;
/// The error of scrambled points falls as N^{−3/2} at most (Owen 1997): as many more are needed.
const LEAST_GROWTH: f64 = 2.0 / 3.0;
/// More samples of the first level do not show a variance that so many have not shown.
const MOST_SAMPLES: u64 = 1 << 24;
/// The part of the accuracy that paths which failed may have: with more, nothing is reached.
const LOST: f64 = 0.25;

/// Gives all points of every scramble of a level: from a number of points drawn before up to
/// another, where the new ones take so many path-steps; `None` if they are drawn elsewhere.
type Draw<'a> =
    dyn Fn(&Samples, Range<u64>, u64) -> Result<Option<Vec<Drawn>>, MultilevelError> + 'a;

/// Draws points, and counts their cost.
pub struct Quasi<'a> {
    pub draw: &'a Draw<'a>,
    /// The identifier of the scheme.
    pub scheme: &'static str,
    pub t_end: f64,
    pub damping: SeenDamping<'a>,
    /// Names of the test functions.
    pub names: Vec<String>,
    pub accuracy: f64,
    pub settings: &'a ExpectationSettings,
    /// Independent scrambles.
    pub scrambles: u64,
    /// How the bias falls.
    pub orders: Orders,
    /// How levels above the first are coupled.
    pub coupling: Coupling,
    /// Runs of a path on each side of a difference: fine and coarse.
    pub runs: (u64, u64),
    /// Runs of a single path.
    pub single: u64,
    /// The least and the largest value of each test function so far.
    pub ranges: Vec<Option<(f64, f64)>>,
    /// Path-steps so far, those of failed attempts included.
    pub spent: &'a Cell<u64>,
    /// Whether there is noise.
    pub random: bool,
    /// Whether the computation was stopped and gives what is done.
    pub stopped: &'a dyn Fn() -> bool,
    /// What was decided, and why.
    pub decisions: Vec<String>,
}

/// The sum over the levels for one test function.
struct Sum {
    /// The first level and all differences above it.
    terms: Vec<Term>,
    extrapolation: Extrapolation,
    /// For each term the third central moment of the mean of a scramble, and the variance that its
    /// largest and its least value give to it.
    shapes: Vec<(f64, f64)>,
    /// Number of scrambles.
    scrambles: f64,
    /// How much paths that failed may add: their share of each level times the range of φ.
    lost: f64,
}

impl Sum {
    /// The weights of the terms: one, and others for the last two differences.
    fn weight(&self, term: usize) -> f64 {
        let [before, last] = self.extrapolation.weights;
        match self.terms.len() - term {
            1 => 1.0 + last,
            2 => 1.0 + before,
            _ => 1.0,
        }
    }

    /// What extrapolation adds to the mean at the finest step.
    fn bias(&self) -> f64 {
        let part = |(n, term): (usize, &Term)| (self.weight(n) - 1.0) * term.mean;
        self.terms.iter().enumerate().map(part).sum()
    }

    fn value(&self) -> f64 {
        self.terms.iter().enumerate().map(|(n, term)| self.weight(n) * term.mean).sum()
    }

    fn standard_error(&self) -> f64 {
        let part = |(n, term): (usize, &Term)| {
            let weight = self.weight(n);
            weight * weight * term.variance / term.count
        };
        self.terms.iter().enumerate().map(part).sum::<f64>().sqrt()
    }

    fn tail(&self) -> f64 {
        let part = |(n, term): (usize, &Term)| self.weight(n) * term.tail.size / term.count;
        self.terms.iter().enumerate().map(|one| part(one).powi(2)).sum::<f64>().sqrt()
    }

    /// How many standard errors the interval has on each side.
    ///
    /// Student's quantile x, and for means of scrambles of skewness g, as those of an unbounded φ,
    /// x(x⁴ + 2x² − 3)g²/(18R) more: so much the two-sided coverage of R skew samples lacks to
    /// first order (Hall, *The Bootstrap and Edgeworth Expansion*, 1992, §2.6). Where the largest
    /// and the least value of a scramble make much of its variance, a few large values decide, and
    /// g is not seen well either: then x is the quantile of 99 %.
    fn quantile(&self) -> f64 {
        let variance = self.scrambles * self.standard_error().powi(2);
        if variance == 0.0 {
            return two_sided(CONFIDENCE, Some(self.scrambles - 1.0));
        }
        let shapes = || self.shapes.iter().enumerate().map(|(n, shape)| (self.weight(n), shape));
        let third = shapes().map(|(w, (third, _))| w * w * w * third).sum::<f64>();
        let ends = shapes().map(|(w, (_, ends))| w * w * ends).sum::<f64>();
        let confidence = if ends > FEW_DECIDE * variance { HIGH_CONFIDENCE } else { CONFIDENCE };
        let x = two_sided(confidence, Some(self.scrambles - 1.0));
        let skewness = third * third / variance.powi(3);
        x + x * (x.powi(4) + 2.0 * x * x - 3.0) * skewness / (18.0 * self.scrambles)
    }

    /// Half of the interval without the bias.
    fn spread(&self) -> f64 {
        f64::hypot(self.quantile() * self.standard_error(), self.tail())
    }

    /// About half of the interval with twice as many points of term n, whose variance falls as that
    /// of random points at least.
    fn with_twice(&self, n: usize) -> f64 {
        let term = &self.terms[n];
        let gained = 0.5 * self.weight(n).powi(2) * term.variance / term.count;
        let spread = self.spread();
        let square = spread * spread - self.quantile().powi(2) * gained;
        square.max(0.0).sqrt() + self.bias_bound()
    }

    fn bias_bound(&self) -> f64 {
        let Extrapolation { size, standard_error, .. } = self.extrapolation;
        size + self.quantile() * standard_error + self.lost
    }

    /// About as many path-steps as the half-width `wanted` takes, if the error of a level falls
    /// with its points as N^{−1/growth}.
    fn cost(&self, wanted: f64, growth: f64) -> f64 {
        let part = |(n, term): (usize, &Term)| {
            let error = self.quantile() * (term.variance / term.count).sqrt();
            let error = self.weight(n) * f64::hypot(error, term.tail.size / term.count);
            let more = elementary::exp(growth * elementary::ln((error / wanted).max(1.0)));
            term.cost * term.count * more
        };
        self.terms.iter().enumerate().map(part).sum()
    }
}

/// All levels.
struct Levels {
    samples: Vec<Samples>,
    scrambles: Vec<Scrambles>,
}

impl Levels {
    /// All but the first are differences.
    fn differences(&self) -> &[Samples] {
        &self.samples[1..]
    }

    /// The differences of test function number k, which spreads by `range`; not at all without noise.
    fn terms(&self, k: usize, range: Option<f64>) -> Vec<Term> {
        let levels = self.differences().iter().zip(&self.scrambles[1..]);
        let terms = levels.zip(tails(self.differences(), k, range.unwrap_or(0.0)));
        terms.map(|((samples, own), tail)| own.term(samples, k, false, tail)).collect()
    }
}

impl Quasi<'_> {
    pub fn expectation(mut self) -> Result<Expectation, Halt> {
        self.settings.check(self.accuracy)?;
        if self.names.is_empty() {
            return Err(MultilevelError::NoObservable.into());
        }
        let pilot = match self.random {
            true => whole(self.settings.pilot.div_ceil(self.scrambles)),
            false => 1,
        };
        let mut levels = Levels { samples: Vec::new(), scrambles: Vec::new() };
        for level in 0..=PILOT_LEVEL {
            levels.samples.push(self.level(level));
            levels.scrambles.push(Scrambles::default());
        }
        let cost = |samples: &Samples| self.scrambles * pilot * samples.cost_per_path;
        let pilot_cost =
            levels.samples.iter().map(cost).fold(self.spent.get(), u64::saturating_add);
        if pilot_cost > self.settings.max_cost {
            let max_cost = self.settings.max_cost;
            return Err(MultilevelError::PilotCost { pilot_cost, max_cost }.into());
        }
        let (accuracy, cost) = (self.accuracy, self.spent.get());
        let (half_width, expected) = (f64::INFINITY, Some(pilot_cost as f64));
        let max_cost = self.settings.max_cost;
        (self.settings.watch)(&SoFar { half_width, accuracy, cost, expected, max_cost });
        for level in 0..=PILOT_LEVEL {
            self.sample(&mut levels, level, pilot)?;
        }
        let mut first = self.first_level(&levels);
        let limit = loop {
            if !self.random {
                first = levels.samples.len() - BIAS_LEVELS;
            }
            let sums: Vec<Sum> =
                (0..self.names.len()).map(|k| self.sum(&levels, first, k)).collect();
            let last = levels.samples.len() - 1;
            let biased = |sum: &Sum| match self.random {
                true => self.is_biased(sum),
                false => self.is_wide(sum),
            };
            let finer = sums.iter().any(biased) || !self.resolves(&levels);
            self.tell(&levels, first, &sums, finer);
            if sums.iter().any(|sum| sum.lost > LOST * self.accuracy) {
                break None;
            }
            let least = self.least_cost(&sums, last, finer);
            if least > self.settings.max_cost as f64 {
                let max_cost = self.settings.max_cost as f64;
                break Some(Warning::OutOfReach { least, max_cost });
            }
            let next = if finer && last < self.settings.max_level {
                let level = self.level(last + 1);
                if !self.affordable(&level, pilot) {
                    break Some(self.cost_limit());
                }
                levels.samples.push(level);
                levels.scrambles.push(Scrambles::default());
                (last + 1, pilot)
            } else {
                let wide = sums.iter().any(|sum| self.is_wide(sum));
                let begin = &levels.samples[first];
                let heavy = (0..self.names.len()).any(|k| is_heavy(begin, k));
                let hopeless = !wide && begin.count() >= MOST_SAMPLES;
                if !self.random || !wide && !heavy || hopeless {
                    break finer.then_some(Warning::LevelLimit { level: last });
                }
                let worst = if wide { self.worst(first, &sums) } else { first };
                let points = levels.scrambles[worst].points;
                if !self.affordable(&levels.samples[worst], points) {
                    break Some(self.cost_limit());
                }
                (worst, 2 * points)
            };
            match self.sample(&mut levels, next.0, next.1) {
                Err(Halt::Elsewhere) if (self.stopped)() => {
                    levels.samples.retain(|samples| samples.paths > 0);
                    levels.scrambles.truncate(levels.samples.len());
                    break Some(Warning::Stopped);
                }
                drawn => drawn?,
            }
            // Once points are doubled, the first level stays.
            if levels.scrambles.iter().all(|own| own.points == pilot) {
                first = self.first_level(&levels);
            }
        };
        Ok(self.report(levels, first, limit))
    }

    /// Whether a finer level is wanted: the bias has more than its share, significantly.
    fn is_biased(&self, sum: &Sum) -> bool {
        let Extrapolation { size, standard_error, .. } = sum.extrapolation;
        let (least, most) = (BIAS_ENOUGH * self.accuracy, BIAS_SHARE * self.accuracy);
        let share = (BIAS_PART * sum.spread()).clamp(least, most);
        size > share + sum.quantile() * standard_error
    }

    fn is_wide(&self, sum: &Sum) -> bool {
        sum.spread() + sum.bias_bound() > self.accuracy
    }

    /// Path-steps without which the accuracy is not reached: those of points that lack, on levels
    /// that are fine enough; else those of finer levels that the damping needs.
    fn least_cost(&self, sums: &[Sum], last: usize, finer: bool) -> f64 {
        let exponent = self.damping.lasting_exponent(last) / LARGEST_EXPONENT;
        match finer {
            false => {
                sums.iter().map(|sum| sum.cost(self.accuracy, LEAST_GROWTH)).fold(0.0, f64::max)
            }
            // A pilot on a level with as many more steps, and on those below it.
            true if self.random && exponent > 1.0 => {
                let pilot = self.settings.pilot as f64 * self.level(last).cost_per_path as f64;
                2.0 * pilot * exponent
            }
            true => 0.0,
        }
    }

    /// Says how far it is. Errors are taken to fall as they did for the points that there are.
    fn tell(&self, levels: &Levels, first: usize, sums: &[Sum], finer: bool) {
        let half_widths = sums.iter().map(|sum| sum.spread() + sum.bias_bound());
        let (samples, own) = (&levels.samples[first], &levels.scrambles[first]);
        let cost = |(k, sum): (usize, &Sum)| {
            let wanted = (self.accuracy - sum.bias_bound()).max(0.5 * self.accuracy);
            let [gain, points] =
                [own.gain(samples, k).max(1.0), own.points as f64].map(elementary::ln);
            let order = 0.5 + 0.5 * gain / points;
            sum.cost(wanted, 1.0 / order.min(1.0 / LEAST_GROWTH))
        };
        let cost = sums.iter().enumerate().map(cost).fold(self.spent.get() as f64, f64::max);
        (self.settings.watch)(&SoFar {
            half_width: half_widths.fold(0.0, f64::max),
            accuracy: self.accuracy,
            cost: self.spent.get(),
            expected: (!finer).then_some(cost),
            max_cost: self.settings.max_cost,
        });
    }

    /// A level without points.
    fn level(&self, level: usize) -> Samples {
        let steps = self.settings.steps(level);
        let (coupling, cost_per_path) = match level {
            0 => (None, self.single * steps),
            _ => (Some(self.coupling), self.runs.0 * steps + self.runs.1 * (steps / 2)),
        };
        let (values, motion) = (vec![Values::default(); self.names.len()], Motion::default());
        Samples { level, coupling, cost_per_path, values, motion, paths: 0, failed: 0 }
    }

    fn cost_limit(&self) -> Warning {
        Warning::CostLimit { max_cost: self.settings.max_cost }
    }

    fn affordable(&self, level: &Samples, points: u64) -> bool {
        let cost = points.saturating_mul(self.scrambles).saturating_mul(level.cost_per_path);
        self.spent.get().saturating_add(cost) <= self.settings.max_cost && points < MAX_POINTS
    }

    /// Draws points of every scramble of a level up to so many.
    fn sample(&mut self, levels: &mut Levels, level: usize, points: u64) -> Result<(), Halt> {
        let (samples, own) = (&mut levels.samples[level], &mut levels.scrambles[level]);
        let new = self.scrambles * (points - own.points) * samples.cost_per_path;
        let Some(scrambles) = (self.draw)(samples, own.points..points, new)? else {
            return Err(Halt::Elsewhere);
        };
        let first = scrambles.iter().find_map(|scramble| scramble.first_failure);
        for scramble in &scrambles {
            let ranges = self.ranges.iter_mut().zip(&scramble.sums.values);
            ranges.for_each(|(range, values)| *range = hull(*range, values.range()));
        }
        self.spent.set(self.spent.get() + new);
        own.take(samples, scrambles, points);
        if samples.count() < 1 + u64::from(self.random) {
            let failed = samples.failed;
            return Err(MultilevelError::NoPaths { level, failed, first }.into());
        }
        let mut values = self.names.iter().zip(&samples.values);
        let finite = |values: &Values| match self.random {
            true => values.sample.variance().is_finite(),
            false => values.sample.mean().is_finite(),
        };
        match values.find(|(_, values)| !finite(values)) {
            Some((observable, _)) => {
                let observable = observable.clone();
                Err(MultilevelError::NotFinite { observable, level }.into())
            }
            None => Ok(()),
        }
    }

    /// How far test function number k may spread; `None` without noise.
    fn range(&self, k: usize) -> Option<f64> {
        let spread = self.ranges[k].map_or(0.0, |(least, largest)| largest - least);
        self.random.then_some(if spread > 0.0 { spread } else { 1.0 })
    }

    /// Test function number k, summed from level `first` on.
    fn sum(&self, levels: &Levels, first: usize, k: usize) -> Sum {
        let differences = levels.terms(k, self.range(k));
        let from = differences.len().saturating_sub(BIAS_LEVELS);
        let last = &differences[from..];
        let of_last = &levels.differences()[from..];
        let rates = (plan::alpha(of_last, last, k), plan::beta(of_last, k));
        let summed = differences.len() - first;
        let orders = if self.random { self.orders } else { seen_orders(last, self.orders) };
        let mut extrapolation = extrapolation(last, summed, orders, rates);
        let samples = &levels.samples[first];
        let fine = &samples.values[k].fine;
        let tail = |range| Tail::new(samples.count() as f64, fine.kurtosis(), range);
        let tail = self.range(k).map_or(Tail::default(), tail);
        if !self.random {
            // Rounding errors of n steps.
            let steps = self.settings.steps(levels.samples.len() - 1) as f64;
            extrapolation.size += fine.mean().abs() * f64::EPSILON * steps.sqrt();
        }
        let begin = levels.scrambles[first].term(samples, k, true, tail);
        let terms = std::iter::once(begin).chain(differences[first..].iter().copied()).collect();
        let shape = |(n, scrambles): (usize, &Scrambles)| {
            let own = scrambles.own(k, n == 0);
            (own.mean.third_moment(), own.variance_of_ends(scrambles.points))
        };
        let shapes = levels.scrambles[first..].iter().enumerate().map(shape).collect();
        let share = |samples: &Samples| samples.failed as f64 / samples.paths as f64;
        let lost = levels.samples[first..].iter().map(share).sum::<f64>();
        let lost = lost * self.range(k).unwrap_or(0.0);
        Sum { terms, extrapolation, shapes, scrambles: self.scrambles as f64, lost }
    }

    /// The level to begin with, for which an accuracy costs least: Σ√(VC) is least (Giles 2008),
    /// for all test functions together.
    fn first_level(&self, levels: &Levels) -> usize {
        let root = |first: usize, k: usize| {
            let sum = self.sum(levels, first, k);
            sum.terms.iter().map(|term| (term.variance * term.cost).sqrt()).sum::<f64>()
        };
        let mut totals = vec![0.0; levels.differences().len()];
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
    fn worst(&self, first: usize, sums: &[Sum]) -> usize {
        let gain = |n: usize, sum: &Sum| {
            let term = &sum.terms[n];
            let (weight, tail) = (sum.weight(n), term.tail.size / term.count);
            let square = QUANTILE * QUANTILE * term.variance / term.count + tail * tail;
            weight * weight * square / (term.cost * term.count)
        };
        let wide = || sums.iter().filter(|sum| self.is_wide(sum));
        let most = |n: usize| wide().map(|sum| gain(n, sum)).fold(0.0, f64::max);
        let enough = |n: usize| wide().all(|sum| sum.with_twice(n) <= self.accuracy);
        let cost =
            |n: usize| sums.first().map_or(0.0, |sum| sum.terms[n].cost * sum.terms[n].count);
        let terms = 0..sums.first().map_or(0, |sum| sum.terms.len());
        let cheapest =
            terms.clone().filter(|&n| enough(n)).min_by(|&a, &b| cost(a).total_cmp(&cost(b)));
        let best = || terms.max_by(|&a, &b| most(a).total_cmp(&most(b)));
        first + cheapest.or_else(best).unwrap_or(0)
    }

    /// Whether the last difference resolves the damping, the motion and every φ.
    fn resolves(&self, levels: &Levels) -> bool {
        let differences = levels.differences();
        let [.., last] = differences else { return false };
        unresolved_damping(&self.damping, last.level).is_none()
            && is_near(differences)
            && unresolved(differences).is_none()
            && last.values.iter().all(|values| coupled(values, self.accuracy))
            && (0..self.names.len())
                .all(|k| unresolved_function(differences, k, self.accuracy).is_none())
    }

    fn report(mut self, levels: Levels, first: usize, limit: Option<Warning>) -> Expectation {
        // Levels below the first may be far from the limit; three differences make a slope.
        let differences = levels.differences();
        let from = first.min(differences.len().saturating_sub(BIAS_LEVELS));
        let estimate = |(k, name): (usize, &String)| {
            let sum = self.sum(&levels, first, k);
            let terms = levels.terms(k, self.range(k));
            Estimate {
                name: name.clone(),
                value: sum.value(),
                standard_error: sum.standard_error(),
                quantile: sum.quantile(),
                missed: sum.tail(),
                bias: sum.bias(),
                bias_bound: sum.bias_bound(),
                alpha: plan::alpha(&differences[from..], &terms[from..], k),
                beta: plan::beta(&differences[from..], k),
                failed: levels.samples[first..].iter().map(|samples| samples.failed).sum(),
                judged: Judged::default(),
            }
        };
        let mut estimates: Vec<_> = self.names.iter().enumerate().map(estimate).collect();
        self.decide(&levels, first);
        let samples = &levels.samples;
        let level = |one: &Samples| Level {
            level: one.level,
            tau: self.t_end / self.settings.steps(one.level) as f64,
            coupling: one.coupling,
            samples: one.count(),
            failed: one.failed,
            cost_per_path: one.cost_per_path,
            values: level_values(samples, one),
        };
        let reports: Vec<_> = samples.iter().map(level).collect();
        let (accuracy, order) = (self.accuracy, self.settings.weak_order);
        let damping = samples.last().and_then(|last| unresolved_damping(&self.damping, last.level));
        let terms = samples.len() - first;
        let random = self.random;
        let evidence = Evidence { levels: samples, first, terms, accuracy, order, damping, random };
        let mut warnings = evidence.judge(&reports, &mut estimates);
        warnings.extend(limit);
        let (scheme, cost) = (self.scheme, self.spent.get());
        let (decisions, levels) = (self.decisions, reports);
        Expectation { scheme, accuracy, cost, levels, warnings, estimates, decisions }
    }

    /// Says which levels and how many points were chosen, and what Sobol points gained.
    fn decide(&mut self, levels: &Levels, first: usize) {
        let numbers = 0..self.names.len();
        let orders = numbers.clone().map(|k| self.sum(levels, first, k).extrapolation.order);
        let points: Vec<String> =
            levels.scrambles[first..].iter().map(|own| own.points.to_string()).collect();
        let order = orders.fold(f64::INFINITY, f64::min);
        let (fewest, most) =
            (self.settings.steps(first), self.settings.steps(levels.samples.len() - 1));
        self.decisions.push(format!(
            "levels of {fewest} to {most} steps, extrapolated with order {order:.2}"
        ));
        if !self.random {
            return self.decisions.push("one path: there is no noise".into());
        }
        let (scrambles, points) = (self.scrambles, points.join(", "));
        self.decisions.push(format!("{scrambles} scrambles of {points} Sobol points on them"));
        let gain = |k: usize| levels.scrambles[first].gain(&levels.samples[first], k);
        let gains = numbers.map(gain).filter(|gain| gain.is_finite());
        self.decisions.push(match gains.reduce(f64::min) {
            None => "no function varies from scramble to scramble".into(),
            Some(least) if least < FEW_GAINED => {
                "Sobol points are hardly better than random ones for some function: it jumps, or \
                 many dimensions count"
                    .into()
            }
            Some(least) => {
                format!("Sobol points have at most 1/{least:.0} of the variance of random ones")
            }
        });
    }
}
