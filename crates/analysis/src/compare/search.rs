//! Step sizes, paths and times of a comparison.

use std::{cell::Cell, sync::Arc};

use mc::{Problem, parts::Stop};
use noise::StreamKey;
use schemes::Method;

use super::{
    Answer, Candidate, Candidates, Choice, CompareError, CompareSettings, Comparison, Outcome,
    Sampled, Stopped,
    errors::{ErrorPoint, Errors, Plan},
    pilot::{Known, within},
    settings::LEAST_SAMPLES,
    time::{PATH_STEPS, PATHS, path_times},
    verdict::choose,
};
use crate::{Spread, Stopwatch};

/// The least number of coarsest steps.
const LEAST_STEPS: u64 = 4;
/// The base 2 logarithms of the most coarsest steps, and of the most steps at all.
const MOST_STEPS: u32 = 32;
const MOST: u32 = 60;
/// The longest step: truncation needs less than one.
const LONGEST: f64 = 0.5;
/// A scheme gets at most 2^this times the steps of the scheme that needs fewest.
const REACH: u32 = 6;
/// A reference is not refined if its error is at most this part of the wanted one.
const ENOUGH: f64 = 1.0 / 8.0;
/// Halvings of the step sizes at first, of schemes and of the reference, and if these take long.
const AHEAD: [[u32; 2]; 2] = [[1, 4], [0, 2]];
/// Errors that are that many times the wanted one are refined by two halvings at once.
const FAR: f64 = 16.0;
/// The part of the time left that errors may take.
const ERRORS: f64 = 0.75;
/// Paths with which biases are first measured, and the most.
const WEAK_PATHS: [u64; 2] = [4096, 1 << 22];
/// How often times are measured.
const REPETITIONS: f64 = 3.0;

/// A comparison under way.
pub struct Search<'a> {
    pub problem: &'a Problem<'a>,
    pub settings: &'a CompareSettings<'a>,
    pub candidates: &'a Candidates<'a>,
    /// Number of the longest steps.
    pub base: u64,
    watch: Stopwatch,
    /// Whether the budget has cut something short.
    cut: Cell<bool>,
}

/// Errors that were measured, if any.
type Found = Option<(Sampled, Vec<Errors>)>;

impl<'a> Search<'a> {
    pub fn new(
        problem: &'a Problem<'a>,
        candidates: &'a Candidates<'a>,
        settings: &'a CompareSettings<'a>,
    ) -> Result<Self, CompareError> {
        settings.check(candidates.schemes.len())?;
        let least = ((problem.t_end / LONGEST).ceil() as u64).max(LEAST_STEPS);
        if least > 1 << MOST_STEPS {
            return Err(CompareError::FinalTime { t_end: problem.t_end });
        }
        let base = least.next_power_of_two();
        let (watch, cut) = (Stopwatch::start(), Cell::new(false));
        Ok(Self { problem, settings, candidates, base, watch, cut })
    }

    /// The noise of a part of the comparison: errors, pilots, times.
    pub fn key(&self, part: u64) -> StreamKey {
        let StreamKey { seed, experiment } = self.settings.key;
        StreamKey { seed, experiment: experiment.wrapping_add(part) }
    }

    fn left_s(&self) -> f64 {
        (self.settings.budget_s - self.watch.wall_s()).max(0.0)
    }

    /// What is asked for, and the wanted error.
    fn questions(&self) -> Vec<(String, f64)> {
        let expectations = self.settings.expectations.iter().flat_map(|wanted| {
            let name = |phi: &&dyn mc::Observe| (format!("E[{}]", phi.name()), wanted.accuracy);
            wanted.observables.iter().map(name)
        });
        std::iter::once(("y(T)".to_owned(), self.settings.error)).chain(expectations).collect()
    }

    pub fn run(self) -> Result<Comparison, CompareError> {
        let Self { problem, settings, candidates, .. } = self;
        let reference = self.known(&candidates.reference, 2)?;
        if let Some(Outcome::Fails(failure)) = reference.excluded {
            let scheme = candidates.reference.id();
            let steps = self.base << reference.first;
            return Err(CompareError::Reference { scheme, steps, failure });
        }
        let waiting = (1..=candidates.schemes.len()).rev();
        let known = candidates.schemes.iter().zip(waiting);
        let known = known.map(|(scheme, waiting)| self.known(scheme, waiting));
        let known: Vec<Known> = known.collect::<Result<_, _>>()?;
        let found = within(ERRORS * self.left_s(), |stop| self.errors(&known, &reference, stop))?;
        let (sampled, mut errors) = found.unwrap_or_default();
        let times = match errors.first() {
            Some(strong) => within(self.left_s(), |stop| self.times(&known, strong, stop))?,
            None => Vec::new(),
        };
        for errors in &mut errors {
            for (points, times) in errors.points.iter_mut().zip(&times) {
                points.iter_mut().zip(times).for_each(|(point, time)| point.time = Some(*time));
            }
        }
        let most = errors.iter().flat_map(|errors| errors.points.iter().flatten());
        let steps = most.map(|point| point.steps).max().unwrap_or(0);
        let damped = problem.damping.integral(0.0, problem.t_end) != 0.0;
        let mut errors = errors.into_iter();
        let mut answers = self.questions().into_iter().map(|(quantity, wanted)| {
            let nothing = Errors { of_reference: f64::INFINITY, mean: None, points: Vec::new() };
            let Errors { of_reference, mean, points } = errors.next().unwrap_or(nothing);
            let points = points.into_iter().chain(std::iter::repeat(Vec::new()));
            let schemes = candidates.schemes.iter().zip(&known).zip(points);
            let candidate = |((scheme, known), points): ((&Arc<dyn Method>, &Known), _)| {
                Candidate::new(scheme.id(), points, wanted, known.excluded.clone(), damped)
            };
            let candidates: Vec<Candidate> = schemes.map(candidate).collect();
            let choice = match reference.excluded {
                Some(Outcome::Inconsistent(defect)) => Choice::WrongReference(defect),
                _ => choose(&candidates),
            };
            Answer { quantity, wanted, reference_error: of_reference, mean, candidates, choice }
        });
        let for_error = answers.next().expect("a strong error is wanted");
        let clock = if Stopwatch::MEASURES_PROCESSOR { "processor time" } else { "wall time" };
        Ok(Comparison {
            system: problem.name.clone(),
            dimension: problem.y0.len(),
            noises: problem.noises,
            t_end: problem.t_end,
            damped,
            sampled,
            for_error,
            for_expectations: answers.collect(),
            stopped: self.cut.get().then_some(Stopped { budget_s: settings.budget_s, steps }),
            clock: clock.to_owned(),
            wall_s: self.watch.wall_s(),
        })
    }

    /// What a pilot shows of a scheme, where so many pilots share a third of the time left.
    fn known(&self, scheme: &Arc<dyn Method + 'a>, waiting: usize) -> Result<Known, CompareError> {
        within(self.left_s() / (3 * waiting) as f64, |stop| {
            let known = Known::new(scheme, self, stop)?;
            self.cut.set(self.cut.get() || !known.runs() && stop.is_asked());
            Ok(known)
        })
    }

    /// Errors on either side of the wanted ones: at T/2ᵏ, with finer steps and more paths until
    /// they are reached, or the next errors would take too long.
    fn errors(
        &self,
        known: &[Known],
        reference: &Known,
        stop: &Stop,
    ) -> Result<Found, CompareError> {
        let (mut found, room, watch) = (None, ERRORS * self.left_s(), Stopwatch::start());
        self.cut.set(self.cut.get() || !reference.runs());
        if !reference.runs() {
            return Ok(found);
        }
        let weak = self.settings.expectations.map_or(0, |_| WEAK_PATHS[0]);
        let [mut plan, small] = AHEAD.map(|[scheme, ahead]| Plan {
            sizes: known.iter().map(|k| k.first..k.first + scheme + 1).collect(),
            reference: reference.first + ahead,
            samples: self.settings.samples.max(weak),
        });
        for (sizes, _) in plan.sizes.iter_mut().zip(known).filter(|(_, known)| !known.runs()) {
            *sizes = 0..0;
        }
        if self.work(known, reference, &plan) > room {
            let ends = small.sizes.iter().map(|sizes| sizes.end);
            plan.sizes.iter_mut().zip(ends).for_each(|(sizes, end)| sizes.end = sizes.end.min(end));
            (plan.reference, plan.samples) = (small.reference, LEAST_SAMPLES);
        }
        loop {
            let before = watch.wall_s();
            let errors = self.measure(&plan, stop)?;
            if stop.is_asked() {
                break;
            }
            let (_, errors) = found.insert(errors);
            // Errors against a wrong reference are no errors.
            let next = self.refined(known, errors, &plan);
            if reference.excluded.is_some() || next == plan {
                return Ok(found);
            }
            let each = (watch.wall_s() - before) / self.work(known, reference, &plan);
            let few = Plan { samples: LEAST_SAMPLES, ..next.clone() };
            let fits = |next: &Plan| {
                watch.wall_s() + each * self.work(known, reference, next) <= room && *next != plan
            };
            match [next, few].into_iter().find(fits) {
                Some(next) => plan = next,
                None => break,
            }
        }
        self.cut.set(true);
        Ok(found)
    }

    /// Finer step sizes for schemes whose errors are above the wanted ones, and for the reference;
    /// more paths where these hide that a bias is small.
    fn refined(&self, known: &[Known], errors: &[Errors], plan: &Plan) -> Plan {
        let mut next = plan.clone();
        let by = |error: f64| if error.is_finite() && error > FAR { 2 } else { 1 };
        let sound = |s: &usize| known[*s].excluded.is_none();
        for (errors, (_, wanted)) in errors.iter().zip(self.questions()) {
            let mut finer = errors.of_reference > ENOUGH * wanted;
            for s in (0..known.len()).filter(sound) {
                let points = &errors.points[s];
                let Some(last) = points.last() else { continue };
                let end = plan.sizes[s].end;
                if points.iter().any(|point| below(point, wanted)) {
                } else if !last.resolved {
                    finer = true;
                } else if last.deviation.is_some() && last.error.abs() <= 0.5 * wanted {
                    next.samples = (4 * plan.samples).min(WEAK_PATHS[1]);
                } else {
                    next.sizes[s].end = next.sizes[s].end.max(end + by(last.error.abs() / wanted));
                }
            }
            if finer {
                let finer = plan.reference + by(errors.of_reference / wanted);
                next.reference = next.reference.max(finer);
            }
        }
        let ends = (0..known.len()).filter(sound).map(|s| next.sizes[s].end);
        let most = MOST - self.base.ilog2();
        let within = (ends.min().unwrap_or(0) + REACH).min(most);
        // A first step size may be out of reach.
        for (next, plan) in next.sizes.iter_mut().zip(&plan.sizes) {
            next.end = next.end.min(within).max(plan.end);
        }
        next.reference = next.reference.min(most);
        next
    }

    /// Seconds of a plan on one thread, by what steps of the pilots took.
    fn work(&self, known: &[Known], reference: &Known, plan: &Plan) -> f64 {
        let steps = |end: u32| 2.0 * self.base as f64 * f64::from(end).exp2();
        let schemes = known.iter().zip(&plan.sizes).filter(|(_, sizes)| !sizes.is_empty());
        let schemes = schemes.map(|(known, sizes)| steps(sizes.end - 1) * known.seconds);
        plan.samples as f64 * (schemes.sum::<f64>() + steps(plan.reference) * reference.seconds)
    }

    /// The times of all points of the schemes that are not excluded. Where there is no time, a step
    /// costs what one of the finest timed ones does, or of the pilot.
    fn times(
        &self,
        known: &[Known],
        errors: &Errors,
        stop: &Stop,
    ) -> Result<Vec<Vec<Spread>>, CompareError> {
        let of_points = |points: &[ErrorPoint]| points.iter().map(|point| point.steps).collect();
        let steps = errors.points.iter().zip(known).map(|(points, known)| match known.excluded {
            None => of_points(points),
            Some(_) => Vec::new(),
        });
        let steps: Vec<Vec<u64>> = steps.collect();
        // One repetition at least, and as many as the budget has room for.
        let once: f64 = steps.iter().zip(known).fold(0.0, |sum, (steps, known)| {
            let all = steps.iter().map(|steps| PATH_STEPS.max(steps * PATHS)).sum::<u64>();
            sum + all as f64 * known.seconds
        });
        let repetitions = (self.left_s() / once).clamp(1.0, REPETITIONS) as usize;
        let noise = (self.settings.truncation, self.key(2));
        let (schemes, problem) = (&self.candidates.schemes, self.problem);
        let times = path_times(schemes, problem, &steps, noise, repetitions, stop)?;
        self.cut.set(self.cut.get() || stop.is_asked());
        let all = times.into_iter().zip(steps).zip(known).map(|((times, steps), known)| {
            let step_s = times.last().map_or(known.seconds, |(n, time)| time.best / *n as f64);
            let untimed = steps[times.len()..].iter().map(|&steps| {
                let s = step_s * steps as f64;
                Spread { best: s, median: s, worst: s }
            });
            times.iter().map(|(_, time)| *time).chain(untimed).collect()
        });
        Ok(all.collect())
    }
}

/// Whether an error is resolved and its whole interval at most the wanted one; or whether an
/// expectation is not much dearer for the bias.
fn below(point: &ErrorPoint, wanted: f64) -> bool {
    let part = point.deviation.map_or(1.0, |_| std::f64::consts::FRAC_1_SQRT_2);
    point.resolved && point.hi <= part * wanted
}
