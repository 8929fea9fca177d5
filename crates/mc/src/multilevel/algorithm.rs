//! The algorithms: which samples are drawn on which level, and when to stop.

use crate::SeenDamping;
use crate::driver::GROUP_PATHS;

use super::{
    bias::{self, BIAS_LEVELS, Bias},
    diagnosis::{Evidence, level_values},
    error::MultilevelError,
    level::{Drawn, Samples, Values, hull},
    plan::{self, BIAS_SHARE, Term},
    report::{Estimate, Expectation, Judged, Level, QUANTILE, Warning},
    resolution::{Motion, coupled, is_near, unresolved, unresolved_function},
    settings::{Coupling, Estimator, ExpectationSettings, SoFar, whole},
    tails::is_heavy,
};

/// The highest level of the pilot; the bias is judged with one more.
const PILOT_LEVEL: usize = 2;
/// A level that is added later begins with at least this part of a pilot.
const LATER_PILOT: u64 = 4;

/// What the largest difference loses from a level to the next if it falls with strong order ½.
const SHRINKS: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// The largest ∫|γ| over a step that is resolved: noise of a step that enters in its middle has the
/// variance x/sinh x of the true one, x = γτ, which has an expansion in τ where x is below one.
pub const LARGEST_EXPONENT: f64 = 1.0;

/// Gives all samples of a level, so many paths, where those of the whole round take so many
/// path-steps; `None` if they are drawn elsewhere.
type Draw<'a> = dyn Fn(&Samples, u64, u64) -> Result<Option<Drawn>, MultilevelError> + 'a;

/// Why the algorithm ends before it has an expectation.
#[derive(Debug)]
pub enum Halt {
    Error(MultilevelError),
    /// Samples are being drawn in parts elsewhere.
    Elsewhere,
}

impl<E: Into<MultilevelError>> From<E> for Halt {
    fn from(error: E) -> Self {
        Self::Error(error.into())
    }
}

/// Draws samples, and counts their cost.
pub struct Sampler<'a> {
    pub draw: &'a Draw<'a>,
    /// The identifier of the scheme.
    pub scheme: &'static str,
    pub t_end: f64,
    pub damping: SeenDamping<'a>,
    /// Names of the test functions.
    pub names: Vec<String>,
    pub accuracy: f64,
    pub settings: &'a ExpectationSettings,
    /// The least and the largest value of each test function so far.
    pub ranges: Vec<Option<(f64, f64)>>,
    /// Path-steps so far.
    pub cost: u64,
    /// Path-steps that are kept for single paths.
    pub reserve: u64,
    /// Whether the computation was stopped and gives what is done.
    pub stopped: &'a dyn Fn() -> bool,
}

/// How the steps of a level do not resolve the damping, if they do not.
pub fn unresolved_damping(damping: &SeenDamping<'_>, level: usize) -> Option<Warning> {
    let exponent = damping.lasting_exponent(level);
    let strong =
        (exponent > LARGEST_EXPONENT).then_some(Warning::StrongDamping { level, exponent });
    strong.or_else(|| damping.unresolved(level).map(|defect| Warning::Damping { level, defect }))
}

impl Sampler<'_> {
    pub fn expectation(self) -> Result<Expectation, Halt> {
        self.settings.check(self.accuracy)?;
        if self.names.is_empty() {
            return Err(MultilevelError::NoObservable.into());
        }
        match self.settings.estimator {
            Estimator::Multilevel => self.multilevel(),
            Estimator::SinglePaths => self.single_paths(),
        }
    }

    fn multilevel(mut self) -> Result<Expectation, Halt> {
        let mut levels = vec![self.level(0, None)];
        levels.extend((1..=PILOT_LEVEL).map(|level| self.difference(level)));
        self.pilot(&mut levels)?;
        let limit = loop {
            let biases = self.biases(&levels[1..]);
            let last = levels.len() - 1;
            // On the finest level allowed, a bias that more samples may show to be small gets half.
            let at_end = last == self.settings.max_level;
            let resolvable = biases.iter().all(|bias| bias.size <= BIAS_SHARE * self.accuracy);
            let budget = if at_end && resolvable { 0.5 } else { BIAS_SHARE } * self.accuracy;
            let half_widths = self.half_widths(&biases, budget);
            let bounded = biases.iter().all(|bias| bias.bound <= budget);
            self.tell(&levels, &biases, &half_widths);
            let complete = if !at_end && !is_near(&levels[1..]) {
                self.add_level(&mut levels, 0)?
            } else if self.too_wide(&levels, &half_widths) {
                let wanted = self.samples(&levels, &half_widths);
                self.sample_up_to(&mut levels, &wanted)?
            } else if bounded && (at_end || self.resolves(&levels[1..])) {
                match self.blind_samples(&levels) {
                    None => break None,
                    Some(wanted) => self.sample_up_to(&mut levels, &wanted)?,
                }
            } else if at_end {
                let wanted = self.bias_samples(&levels[1..], 0.5 * budget);
                if !resolvable || enough(&levels[1..], &wanted) {
                    break Some(Warning::LevelLimit { level: last });
                }
                self.sample_up_to(&mut levels[1..], &wanted)?
            } else if let Some(wanted) = self.missed_bias(&levels[1..], &biases, budget) {
                self.sample_up_to(&mut levels[1..], &wanted)?
            } else {
                let paths = self.next_samples(&levels, &half_widths);
                self.add_level(&mut levels, paths)?
            };
            if !complete {
                break Some(self.cost_limit());
            }
        };
        let mut expectation = self.report(&levels, levels.len());
        expectation.warnings.extend(limit);
        Ok(expectation)
    }

    fn single_paths(mut self) -> Result<Expectation, Halt> {
        // Without a reserve for the first single paths there would be no estimate at the limit.
        self.reserve = self.settings.whole_pilot().saturating_mul(self.settings.steps(PILOT_LEVEL));
        let mut differences: Vec<_> =
            (1..=PILOT_LEVEL).map(|level| self.difference(level)).collect();
        self.pilot(&mut differences)?;
        let mut limit = self.resolve_bias(&mut differences)?;
        self.reserve = 0;
        // If a bound exceeds its share, the accuracy is not reached in any case, and the rest is
        // not worth more samples.
        let half_widths = self.half_widths(&self.biases(&differences), BIAS_SHARE * self.accuracy);
        let mut single = vec![self.level(differences.len(), None)];
        let mut complete = self.sample_up_to(&mut single, &[self.settings.whole_pilot()])?;
        if single[0].paths == 0 {
            return Err(Halt::Elsewhere);
        }
        while complete && self.too_wide(&single, &half_widths) {
            let wanted = self.samples(&single, &half_widths);
            complete = self.sample_up_to(&mut single, &wanted)?;
        }
        if !complete {
            limit = Some(self.cost_limit());
        }
        single.append(&mut differences);
        let mut expectation = self.report(&single, 1);
        expectation.warnings.extend(limit);
        Ok(expectation)
    }

    /// Says how far it is.
    fn tell(&self, levels: &[Samples], biases: &[Bias], half_widths: &[f64]) {
        let half_width = |(k, bias): (usize, &Bias)| {
            let terms = self.terms(levels, k);
            let (variance, tail) = (plan::variance_of_sum(&terms), plan::tail_of_sum(&terms));
            plan::half_width(variance, tail) + bias.bound
        };
        let half_width = biases.iter().enumerate().map(half_width).fold(0.0, f64::max);
        let wanted = self.samples(levels, half_widths);
        let cost = |(level, n): (&Samples, &u64)| {
            level.count().max(*n) as f64 * level.cost_per_path as f64
        };
        (self.settings.watch)(&SoFar {
            half_width,
            accuracy: self.accuracy,
            cost: self.cost,
            expected: Some(levels.iter().zip(&wanted).map(cost).sum()),
            max_cost: self.settings.max_cost,
        });
    }

    /// A level without samples.
    fn level(&self, level: usize, coupling: Option<Coupling>) -> Samples {
        let steps = self.settings.steps(level);
        let cost_per_path = match coupling {
            None => steps,
            Some(Coupling::Plain) => steps + steps / 2,
            Some(Coupling::Antithetic) => 2 * steps + steps / 2,
        };
        let values = vec![Values::default(); self.names.len()];
        let motion = Motion::default();
        Samples { level, coupling, cost_per_path, values, motion, paths: 0, failed: 0 }
    }

    fn difference(&self, level: usize) -> Samples {
        self.level(level, Some(self.settings.coupling))
    }

    /// Why not all samples that were wanted were drawn.
    fn cost_limit(&self) -> Warning {
        match (self.stopped)() {
            true => Warning::Stopped,
            false => Warning::CostLimit { max_cost: self.settings.max_cost },
        }
    }

    /// Test function number k on these levels. It may spread as it does on all levels that were
    /// sampled so far, or by one if it is the same on all.
    fn terms(&self, levels: &[Samples], k: usize) -> Vec<Term> {
        let spread = self.ranges[k].map_or(0.0, |(least, largest)| largest - least);
        plan::terms(levels, k, if spread > 0.0 { spread } else { 1.0 })
    }

    /// The order by which the bias of test function number k is extrapolated.
    fn order(&self, differences: &[Samples], terms: &[Term], k: usize) -> f64 {
        bias::order(self.settings.weak_order, plan::alpha(differences, terms, k))
    }

    fn bias(&self, differences: &[Samples], k: usize) -> Bias {
        let terms = self.terms(differences, k);
        bias::bias(&terms, self.order(differences, &terms, k))
    }

    fn biases(&self, differences: &[Samples]) -> Vec<Bias> {
        (0..self.names.len()).map(|k| self.bias(differences, k)).collect()
    }

    /// What the bounds on the bias, up to their budget, leave for standard errors and missed
    /// events.
    fn half_widths(&self, biases: &[Bias], budget: f64) -> Vec<f64> {
        biases.iter().map(|bias| self.accuracy - bias.bound.min(budget)).collect()
    }

    /// Whether the half-width of a sum over the levels exceeds the one wanted, or is not known for
    /// heavy tails.
    fn too_wide(&self, levels: &[Samples], half_widths: &[f64]) -> bool {
        let wide = |(k, width): (usize, &f64)| {
            let terms = self.terms(levels, k);
            let found = plan::half_width(plan::variance_of_sum(&terms), plan::tail_of_sum(&terms));
            found > *width || is_heavy(&levels[0], k)
        };
        half_widths.iter().enumerate().any(wide)
    }

    /// Samples of each level with which every sum reaches its half-width.
    fn samples(&self, levels: &[Samples], half_widths: &[f64]) -> Vec<u64> {
        let mut wanted = vec![0; levels.len()];
        for (k, &half_width) in half_widths.iter().enumerate() {
            let terms = self.terms(levels, k);
            plan::raise(&mut wanted, &terms, half_width);
            if is_heavy(&levels[0], k) {
                let enough = terms[0].tail.enough as u64;
                wanted[0] = wanted[0].max(2 * levels[0].count()).max(enough);
            }
        }
        wanted
    }

    /// Samples expected of the next level.
    fn next_samples(&self, levels: &[Samples], half_widths: &[f64]) -> u64 {
        let mut wanted = vec![0; levels.len() + 1];
        for (k, &half_width) in half_widths.iter().enumerate() {
            let mut terms = self.terms(levels, k);
            terms.push(plan::next_level(&terms));
            plan::raise(&mut wanted, &terms, half_width);
        }
        wanted[levels.len()]
    }

    /// Twice as many samples of the levels that decide the bias and on which some φ is the same on
    /// every path while it varies on others: it has rare events that a few more paths will meet.
    fn blind_samples(&self, levels: &[Samples]) -> Option<Vec<u64>> {
        let blind = |samples: &Samples, k: usize| samples.values[k].is_blind();
        let rare = |k: &usize| levels.iter().any(|samples| !blind(samples, *k));
        let rare: Vec<usize> = (0..self.names.len()).filter(rare).collect();
        let first = levels.len() - BIAS_LEVELS;
        let wanted = levels.iter().enumerate().map(|(l, samples)| {
            let unseen = l >= first && rare.iter().any(|&k| blind(samples, k));
            if unseen { 2 * samples.count() } else { 0 }
        });
        let wanted: Vec<u64> = wanted.collect();
        wanted.iter().any(|&n| n > 0).then_some(wanted)
    }

    /// Whether the last difference resolves the damping, the motion and every φ.
    fn resolves(&self, differences: &[Samples]) -> bool {
        let [.., last] = differences else { return false };
        unresolved_damping(&self.damping, last.level).is_none()
            && unresolved(differences).is_none()
            && last.values.iter().all(|values| coupled(values, self.accuracy))
            && (0..self.names.len())
                .all(|k| unresolved_function(differences, k, self.accuracy).is_none())
    }

    /// Samples of the differences that show a small bias where events that are as large on the last
    /// level as below may have been missed: a finer level would not make them smaller.
    fn missed_bias(
        &self,
        differences: &[Samples],
        biases: &[Bias],
        budget: f64,
    ) -> Option<Vec<u64>> {
        let [.., below, last] = differences else { return None };
        let of = |samples: &Samples, k: usize| samples.values[k].sample.largest_deviation();
        let lasting = |k: usize| of(last, k) == 0.0 || of(last, k) > SHRINKS * of(below, k);
        let first = differences.len() - BIAS_LEVELS;
        let tailed = |k: usize| plan::tail_of_sum(&self.terms(differences, k)[first..]) > 0.0;
        let open = |k: usize| biases[k].bound > budget && lasting(k) && tailed(k);
        let small = biases.iter().all(|bias| bias.size <= 0.5 * budget);
        let wanted = self.bias_samples(differences, 0.5 * budget);
        let more = small && (0..self.names.len()).any(open) && !enough(differences, &wanted);
        more.then_some(wanted)
    }

    fn pilot(&mut self, levels: &mut [Samples]) -> Result<(), Halt> {
        let (pilot, max_cost) = (self.settings.whole_pilot(), self.settings.max_cost);
        let cost = levels.iter().map(|level| level.cost_per_path).sum::<u64>();
        let pilot_cost = cost.saturating_mul(pilot).saturating_add(self.reserve);
        if pilot_cost > max_cost {
            return Err(MultilevelError::PilotCost { pilot_cost, max_cost }.into());
        }
        self.sample(levels, &vec![pilot; levels.len()])
    }

    /// Samples differences, and adds levels, until the bias on the last is bounded by its share of
    /// the accuracy. Returns the limit that was reached, if any.
    fn resolve_bias(&mut self, differences: &mut Vec<Samples>) -> Result<Option<Warning>, Halt> {
        let budget = BIAS_SHARE * self.accuracy;
        loop {
            let biases = self.biases(differences);
            let last = differences.len();
            let resolved = is_near(differences) && self.resolves(differences);
            if resolved && biases.iter().all(|bias| bias.bound <= budget) {
                return Ok(None);
            }
            // More samples if the bias may be small, else a finer level.
            let wanted = self.bias_samples(differences, 0.5 * budget);
            let small = resolved && biases.iter().all(|bias| bias.size <= budget);
            let complete = if small && !enough(differences, &wanted) {
                self.sample_up_to(differences, &wanted)?
            } else if last == self.settings.max_level {
                return Ok(Some(Warning::LevelLimit { level: last }));
            } else {
                let pilot = self.settings.whole_pilot();
                self.reserve = pilot * self.settings.steps(last + 1);
                self.add_level(differences, pilot)?
            };
            if !complete {
                return Ok(Some(self.cost_limit()));
            }
        }
    }

    /// Samples of each difference with which the statistical margin of every bias is at most
    /// `margin`.
    fn bias_samples(&self, differences: &[Samples], margin: f64) -> Vec<u64> {
        let mut wanted = vec![0; differences.len()];
        for k in 0..self.names.len() {
            let terms = self.terms(differences, k);
            bias::raise(&mut wanted, &terms, self.order(differences, &terms, k), margin);
        }
        wanted
    }

    /// Adds a level with `paths` samples, at least the least pilot, or as many as the cost limit
    /// allows; whether all were drawn. Adds none if not even the least pilot is allowed.
    fn add_level(&mut self, levels: &mut Vec<Samples>, paths: u64) -> Result<bool, Halt> {
        let level = self.difference(levels.last().map_or(0, |last| last.level) + 1);
        let least_pilot = whole(self.settings.pilot / LATER_PILOT);
        if least_pilot.saturating_mul(level.cost_per_path) > self.budget() {
            return Ok(false);
        }
        levels.push(level);
        let last = levels.len() - 1;
        let complete = self.sample_up_to(&mut levels[last..], &[paths.max(least_pilot)])?;
        if levels[last].paths == 0 {
            levels.pop();
        }
        Ok(complete)
    }

    /// Path-steps that may be spent now.
    fn budget(&self) -> u64 {
        self.settings.max_cost.saturating_sub(self.cost).saturating_sub(self.reserve)
    }

    /// Draws the samples wanted of each level, or in proportion as many as the cost limit allows;
    /// whether all were drawn.
    fn sample_up_to(&mut self, levels: &mut [Samples], wanted: &[u64]) -> Result<bool, Halt> {
        let more: Vec<u64> =
            levels.iter().zip(wanted).map(|(level, &wanted)| additional(level, wanted)).collect();
        let costs = levels.iter().zip(&more);
        let cost: u128 =
            costs.map(|(level, &n)| u128::from(level.cost_per_path) * u128::from(n)).sum();
        let budget = u128::from(self.budget());
        let within = |paths: u64| match cost > budget {
            // Whole groups, rounded down.
            true => (u128::from(paths) * budget / cost) as u64 / GROUP_PATHS * GROUP_PATHS,
            false => paths,
        };
        match self.sample(levels, &more.into_iter().map(within).collect::<Vec<_>>()) {
            Err(Halt::Elsewhere) if (self.stopped)() => Ok(false),
            drawn => drawn.map(|()| cost <= budget),
        }
    }

    /// Draws more paths of each level.
    fn sample(&mut self, levels: &mut [Samples], more: &[u64]) -> Result<(), Halt> {
        let cost = |(level, paths): (&Samples, &u64)| level.cost_per_path.saturating_mul(*paths);
        let round = levels.iter().zip(more).map(cost).fold(0, u64::saturating_add);
        let mut elsewhere = false;
        for (level, &paths) in levels.iter_mut().zip(more).filter(|(_, paths)| **paths > 0) {
            // All levels are begun: none depends on another.
            match (self.draw)(level, level.paths + paths, round)? {
                Some(drawn) => self.take(level, paths, drawn)?,
                None => elsewhere = true,
            }
        }
        if elsewhere { Err(Halt::Elsewhere) } else { Ok(()) }
    }

    /// Takes all samples of a level, of which the last `paths` paths are new.
    fn take(
        &mut self,
        level: &mut Samples,
        paths: u64,
        drawn: Drawn,
    ) -> Result<(), MultilevelError> {
        let Drawn { sums, failed, first_failure: first } = drawn;
        let ranges = self.ranges.iter_mut().zip(&sums.values);
        ranges.for_each(|(range, values)| *range = hull(*range, values.range()));
        (level.values, level.motion) = (sums.values, sums.motion);
        (level.paths, level.failed) = (level.paths + paths, failed);
        self.cost += paths * level.cost_per_path;
        if level.count() < 2 {
            return Err(MultilevelError::NoPaths { level: level.level, failed, first });
        }
        let mut values = self.names.iter().zip(&level.values);
        match values.find(|(_, values)| !values.sample.variance().is_finite()) {
            Some((observable, _)) => {
                let observable = observable.clone();
                Err(MultilevelError::NotFinite { observable, level: level.level })
            }
            None => Ok(()),
        }
    }

    /// The sum over the first `terms` levels, with the warnings that are not about limits. All
    /// levels but the first are differences.
    fn report(&self, levels: &[Samples], terms: usize) -> Expectation {
        let (summed, differences) = (&levels[..terms], &levels[1..]);
        let estimate = |(k, name): (usize, &String)| {
            let bias = self.bias(differences, k);
            let sum = self.terms(summed, k);
            Estimate {
                name: name.clone(),
                value: sum.iter().map(|term| term.mean).sum(),
                standard_error: plan::variance_of_sum(&sum).sqrt(),
                quantile: QUANTILE,
                missed: plan::tail_of_sum(&sum),
                bias: bias.value,
                bias_bound: bias.bound,
                alpha: plan::alpha(differences, &self.terms(differences, k), k),
                beta: plan::beta(differences, k),
                failed: summed.iter().map(|samples| samples.failed).sum(),
                judged: Judged::default(),
            }
        };
        let mut estimates: Vec<_> = self.names.iter().enumerate().map(estimate).collect();
        let level = |samples: &Samples| Level {
            level: samples.level,
            tau: self.t_end / self.settings.steps(samples.level) as f64,
            coupling: samples.coupling,
            samples: samples.count(),
            failed: samples.failed,
            cost_per_path: samples.cost_per_path,
            values: level_values(levels, samples),
        };
        let reports: Vec<_> = levels.iter().map(level).collect();
        let (accuracy, order) = (self.accuracy, self.settings.weak_order);
        let damping = levels.last().and_then(|last| unresolved_damping(&self.damping, last.level));
        let random = true;
        let evidence = Evidence { levels, first: 0, terms, accuracy, order, damping, random };
        let warnings = evidence.judge(&reports, &mut estimates);
        let decisions = Vec::new();
        let (scheme, cost, levels) = (self.scheme, self.cost, reports);
        Expectation { scheme, accuracy, cost, levels, warnings, estimates, decisions }
    }
}

/// Whether every level has the samples wanted.
fn enough(levels: &[Samples], wanted: &[u64]) -> bool {
    levels.iter().zip(wanted).all(|(level, &wanted)| level.count() >= wanted)
}

/// How many paths to add: whole groups, and none or at least a 32nd of those there are, so that the
/// rounds are few.
fn additional(level: &Samples, wanted: u64) -> u64 {
    let missing = wanted.saturating_sub(level.count());
    if missing == 0 {
        return 0;
    }
    whole(missing.max(level.count() / 32))
}
