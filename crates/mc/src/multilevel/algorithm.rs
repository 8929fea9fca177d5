//! The algorithms: which samples are drawn on which level, and when to stop.

use real::WIDTH;

use super::{
    diagnosis::{better_coarsest_steps, level_values, warnings},
    error::MultilevelError,
    level::{Round, Samples, Values},
    plan::{self, BIAS_SHARE, Bias},
    report::{Estimate, Expectation, Level, QUANTILE, Warning},
    settings::{Coupling, Estimator, ExpectationSettings, MAX_ROUNDS},
};

/// The highest level of the pilot: two differences show how they decay.
const PILOT_LEVEL: usize = 2;
/// A level that is added later begins with at least this part of a pilot.
const LATER_PILOT: u64 = 4;

/// Paths of a block.
const BLOCK: u64 = WIDTH as u64;

/// Draws samples of a level.
type Draw<'a> = dyn Fn(&Samples, u64) -> Result<Round> + 'a;

type Result<T> = std::result::Result<T, MultilevelError>;

/// Draws samples, and counts their cost.
pub struct Sampler<'a> {
    pub draw: &'a Draw<'a>,
    pub t_end: f64,
    /// Names of the test functions.
    pub names: Vec<&'static str>,
    pub accuracy: f64,
    pub settings: &'a ExpectationSettings,
    /// Path-steps so far.
    pub cost: u64,
    /// Path-steps that are kept for single paths.
    pub reserve: u64,
}

impl Sampler<'_> {
    pub fn expectation(self) -> Result<Expectation> {
        self.settings.check(self.accuracy)?;
        if self.names.is_empty() {
            return Err(MultilevelError::NoObservable);
        }
        match self.settings.estimator {
            Estimator::Multilevel => self.multilevel(),
            Estimator::SinglePaths => self.single_paths(),
        }
    }

    fn multilevel(mut self) -> Result<Expectation> {
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
            let complete = if too_wide(&levels, &half_widths) {
                let wanted = plan::samples(&plan::costs_and_variances(&levels), &half_widths);
                self.sample_up_to(&mut levels, &wanted)?
            } else if biases.iter().all(|bias| bias.bound <= budget) {
                break None;
            } else if at_end {
                let wanted = self.bias_samples(&levels[1..], 0.5 * budget);
                if !resolvable || enough(&levels[1..], &wanted) {
                    break Some(Warning::LevelLimit { level: last });
                }
                self.sample_up_to(&mut levels[1..], &wanted)?
            } else {
                let mut next = plan::costs_and_variances(&levels);
                next.push(plan::next_level(&levels));
                let paths = plan::samples(&next, &half_widths)[last + 1];
                self.add_level(&mut levels, paths.max(self.settings.pilot / LATER_PILOT))?
            };
            if !complete {
                break Some(self.cost_limit());
            }
        };
        let mut expectation = self.report(&levels, levels.len());
        let better = better_coarsest_steps(&levels, self.settings);
        expectation.warnings.extend(better.map(|steps| Warning::CoarsestSteps { steps }));
        expectation.warnings.extend(limit);
        Ok(expectation)
    }

    fn single_paths(mut self) -> Result<Expectation> {
        // Without a reserve for the first single paths there would be no estimate at the limit.
        self.reserve = self.settings.pilot.saturating_mul(self.settings.steps(PILOT_LEVEL));
        let mut differences: Vec<_> =
            (1..=PILOT_LEVEL).map(|level| self.difference(level)).collect();
        self.pilot(&mut differences)?;
        let mut limit = self.resolve_bias(&mut differences)?;
        self.reserve = 0;
        // If a bound exceeds its share, the accuracy is not reached in any case, and the rest is
        // not worth more samples.
        let half_widths = self.half_widths(&self.biases(&differences), BIAS_SHARE * self.accuracy);
        let mut single = vec![self.level(differences.len(), None)];
        let mut complete = self.sample_up_to(&mut single, &[self.settings.pilot])?;
        while complete && too_wide(&single, &half_widths) {
            let wanted = plan::samples(&plan::costs_and_variances(&single), &half_widths);
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

    /// A level without samples.
    fn level(&self, level: usize, coupling: Option<Coupling>) -> Samples {
        let steps = self.settings.steps(level);
        let cost_per_path = match coupling {
            None => steps,
            Some(Coupling::Plain) => steps + steps / 2,
            Some(Coupling::Antithetic) => 2 * steps + steps / 2,
        };
        let values = vec![Values::default(); self.names.len()];
        Samples { level, coupling, cost_per_path, values, paths: 0, failed: 0, rounds: 0 }
    }

    fn difference(&self, level: usize) -> Samples {
        self.level(level, Some(self.settings.coupling))
    }

    fn cost_limit(&self) -> Warning {
        Warning::CostLimit { max_cost: self.settings.max_cost }
    }

    fn biases(&self, differences: &[Samples]) -> Vec<Bias> {
        let observables = 0..self.names.len();
        observables.map(|k| plan::bias(differences, k, self.settings.weak_order)).collect()
    }

    /// What the bounds on the bias, up to their budget, leave for 1.96 standard errors.
    fn half_widths(&self, biases: &[Bias], budget: f64) -> Vec<f64> {
        biases.iter().map(|bias| self.accuracy - bias.bound.min(budget)).collect()
    }

    fn pilot(&mut self, levels: &mut [Samples]) -> Result<()> {
        let ExpectationSettings { pilot, max_cost, .. } = *self.settings;
        let cost = levels.iter().map(|level| level.cost_per_path).sum::<u64>();
        let pilot_cost = cost.saturating_mul(pilot).saturating_add(self.reserve);
        if pilot_cost > max_cost {
            return Err(MultilevelError::PilotCost { pilot_cost, max_cost });
        }
        levels.iter_mut().try_for_each(|level| self.sample(level, pilot))
    }

    /// Samples differences, and adds levels, until the bias on the last is bounded by its share of
    /// the accuracy. Returns the limit that was reached, if any.
    fn resolve_bias(&mut self, differences: &mut Vec<Samples>) -> Result<Option<Warning>> {
        let budget = BIAS_SHARE * self.accuracy;
        loop {
            let biases = self.biases(differences);
            if biases.iter().all(|bias| bias.bound <= budget) {
                return Ok(None);
            }
            // More samples if the bias may be small, else a finer level.
            let wanted = self.bias_samples(differences, 0.5 * budget);
            let last = differences.len();
            let small = biases.iter().all(|bias| bias.size <= budget);
            let complete = if small && !enough(differences, &wanted) {
                self.sample_up_to(differences, &wanted)?
            } else if last == self.settings.max_level {
                return Ok(Some(Warning::LevelLimit { level: last }));
            } else {
                let pilot = self.settings.pilot;
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
            plan::raise_for_bias(&mut wanted, differences, k, self.settings.weak_order, margin);
        }
        wanted
    }

    /// Adds a level with `paths` samples, or as many as the cost limit allows; whether all were
    /// drawn. Adds none if not even the least pilot is allowed.
    fn add_level(&mut self, levels: &mut Vec<Samples>, paths: u64) -> Result<bool> {
        let level = self.difference(levels.last().map_or(0, |last| last.level) + 1);
        let least_pilot = self.settings.pilot / LATER_PILOT;
        if least_pilot.saturating_mul(level.cost_per_path) > self.budget() {
            return Ok(false);
        }
        levels.push(level);
        let last = levels.len() - 1;
        self.sample_up_to(&mut levels[last..], &[paths])
    }

    /// Path-steps that may be spent now.
    fn budget(&self) -> u64 {
        self.settings.max_cost.saturating_sub(self.cost).saturating_sub(self.reserve)
    }

    /// Draws the samples wanted of each level, or in proportion as many as the cost limit allows;
    /// whether all were drawn.
    fn sample_up_to(&mut self, levels: &mut [Samples], wanted: &[u64]) -> Result<bool> {
        let more: Vec<u64> =
            levels.iter().zip(wanted).map(|(level, &wanted)| additional(level, wanted)).collect();
        let costs = levels.iter().zip(&more);
        let cost: u128 =
            costs.map(|(level, &n)| u128::from(level.cost_per_path) * u128::from(n)).sum();
        let budget = u128::from(self.budget());
        if levels.iter().any(|level| level.rounds >= MAX_ROUNDS) {
            return Ok(false);
        }
        for (level, mut paths) in levels.iter_mut().zip(more) {
            if cost > budget {
                // Whole blocks, rounded down.
                paths = (u128::from(paths) * budget / cost) as u64 / BLOCK * BLOCK;
            }
            if paths > 0 {
                self.sample(level, paths)?;
            }
        }
        Ok(cost <= budget)
    }

    fn sample(&mut self, level: &mut Samples, paths: u64) -> Result<()> {
        let round = (self.draw)(level, paths)?;
        level.values.iter_mut().zip(&round.values).for_each(|(values, more)| values.merge(more));
        level.paths += paths;
        level.failed += round.failed;
        level.rounds += 1;
        self.cost += paths * level.cost_per_path;
        let Samples { level: number, failed, .. } = *level;
        if level.count() < 2 {
            let first = round.first_failure;
            return Err(MultilevelError::NoPaths { level: number, failed, first });
        }
        let mut values = self.names.iter().zip(&level.values);
        match values.find(|(_, values)| !values.sample.variance().is_finite()) {
            Some((observable, _)) => Err(MultilevelError::NotFinite { observable, level: number }),
            None => Ok(()),
        }
    }

    /// The sum over the first `terms` levels, with the warnings that are not about limits. All
    /// levels but the first are differences.
    fn report(&self, levels: &[Samples], terms: usize) -> Expectation {
        let order = self.settings.weak_order;
        let (terms, differences) = (&levels[..terms], &levels[1..]);
        let estimate = |(k, &name): (usize, &&'static str)| {
            let bias = plan::bias(differences, k, order);
            Estimate {
                name,
                value: terms.iter().map(|samples| samples.values[k].sample.mean()).sum(),
                standard_error: plan::variance_of_sum(terms, k).sqrt(),
                bias: bias.value,
                bias_bound: bias.bound,
                alpha: plan::alpha(differences, k),
                beta: plan::beta(differences, k),
            }
        };
        let estimates: Vec<_> = self.names.iter().enumerate().map(estimate).collect();
        let level = |samples: &Samples| Level {
            level: samples.level,
            tau: self.t_end / self.settings.steps(samples.level) as f64,
            coupling: samples.coupling,
            samples: samples.count(),
            failed: samples.failed,
            cost_per_path: samples.cost_per_path,
            values: level_values(levels, samples),
        };
        let levels: Vec<_> = levels.iter().map(level).collect();
        let warnings = warnings(&levels, &estimates, order);
        Expectation { accuracy: self.accuracy, cost: self.cost, levels, warnings, estimates }
    }
}

/// Whether 1.96 standard errors of a sum over the levels exceed the half-width.
fn too_wide(levels: &[Samples], half_widths: &[f64]) -> bool {
    let wide =
        |(k, width): (usize, &f64)| QUANTILE * plan::variance_of_sum(levels, k).sqrt() > *width;
    half_widths.iter().enumerate().any(wide)
}

/// Whether every level has the samples wanted.
fn enough(levels: &[Samples], wanted: &[u64]) -> bool {
    levels.iter().zip(wanted).all(|(level, &wanted)| level.count() >= wanted)
}

/// How many paths to add: whole blocks, and none or at least a 32nd of those there are, so that the
/// rounds are few.
fn additional(level: &Samples, wanted: u64) -> u64 {
    let missing = wanted.saturating_sub(level.count());
    if missing == 0 {
        return 0;
    }
    missing.max(level.count() / 32).div_ceil(BLOCK).saturating_mul(BLOCK)
}
