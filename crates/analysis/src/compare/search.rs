//! Step sizes, paths and times of a comparison.

use std::{cell::Cell, sync::Arc};

use mc::{Problem, parts::Stop};
use noise::StreamKey;
use schemes::Method;

use super::{
    Candidate, Candidates, Choice, CompareError, CompareSettings, Comparison, Outcome, Sampled,
    Stopped,
    errors::{ErrorPoint, Errors, Plan},
    pilot::{Known, within},
    settings::LEAST_SAMPLES,
    time::{PATH_STEPS, PATHS, path_times},
    verdict::choose,
};
use crate::{Spread, Stopwatch};

/// The least number of coarsest steps.
const LEAST_STEPS: u64 = 4;
/// The base 2 logarithm of the most steps.
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
/// How often times are measured.
const REPETITIONS: f64 = 3.0;

/// A comparison under way.
pub struct Search<'a> {
    pub problem: &'a Problem<'a>,
    pub settings: &'a CompareSettings,
    pub candidates: &'a Candidates<'a>,
    /// Number of the longest steps.
    pub base: u64,
    watch: Stopwatch,
    /// Whether the budget has cut something short.
    cut: Cell<bool>,
}

impl<'a> Search<'a> {
    pub fn new(
        problem: &'a Problem<'a>,
        candidates: &'a Candidates<'a>,
        settings: &'a CompareSettings,
    ) -> Result<Self, CompareError> {
        settings.check(candidates.schemes.len(), problem.t_end)?;
        let base = ((problem.t_end / LONGEST).ceil() as u64).max(LEAST_STEPS).next_power_of_two();
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

    /// Notes that the budget cuts something short, if so.
    fn cut_if(&self, cut: bool) {
        self.cut.set(self.cut.get() || cut);
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
        let Errors { sampled, of_reference, mut points } = found.unwrap_or_else(|| Errors {
            sampled: Sampled::default(),
            of_reference: f64::INFINITY,
            points: vec![Vec::new(); known.len()],
        });
        within(self.left_s(), |stop| self.time(&known, &mut points, stop))?;
        let steps = points.iter().flatten().map(|point| point.steps).max().unwrap_or(0);
        let damped = problem.damping.integral(0.0, problem.t_end) != 0.0;
        let schemes = candidates.schemes.iter().zip(known).zip(points);
        let candidate = |((scheme, known), points): ((&Arc<dyn Method>, Known), _)| {
            Candidate::new(scheme.id(), points, settings.error, known.excluded, damped)
        };
        let candidates: Vec<Candidate> = schemes.map(candidate).collect();
        let choice = match reference.excluded {
            Some(Outcome::Inconsistent(defect)) => Choice::WrongReference(defect),
            _ => choose(&candidates),
        };
        let clock = if Stopwatch::MEASURES_PROCESSOR { "processor time" } else { "wall time" };
        Ok(Comparison {
            system: problem.name.clone(),
            dimension: problem.y0.len(),
            noises: problem.noises,
            t_end: problem.t_end,
            damped,
            wanted: settings.error,
            sampled,
            reference_error: of_reference,
            candidates,
            choice,
            stopped: self.cut.get().then_some(Stopped { budget_s: settings.budget_s, steps }),
            clock: clock.to_owned(),
            wall_s: self.watch.wall_s(),
        })
    }

    /// What a pilot shows of a scheme, where so many pilots share a third of the time left.
    fn known(&self, scheme: &Arc<dyn Method + 'a>, waiting: usize) -> Result<Known, CompareError> {
        within(self.left_s() / (3 * waiting) as f64, |stop| {
            let known = Known::new(scheme, self, stop)?;
            self.cut_if(!known.runs() && stop.is_asked());
            Ok(known)
        })
    }

    /// Errors on either side of the wanted one: at T/2ᵏ, with finer steps until it is reached, or
    /// the next errors would take too long.
    fn errors(
        &self,
        known: &[Known],
        reference: &Known,
        stop: &Stop,
    ) -> Result<Option<Errors>, CompareError> {
        let (mut found, room, watch) = (None, ERRORS * self.left_s(), Stopwatch::start());
        let plan = |[scheme, ahead]: [u32; 2], samples| Plan {
            sizes: known.iter().map(|known| known.sizes(scheme)).collect(),
            reference: reference.first + ahead,
            samples,
        };
        let mut next = plan(AHEAD[0], self.settings.samples);
        if self.work(known, reference, &next) > room {
            next = plan(AHEAD[1], LEAST_SAMPLES);
        }
        while reference.runs() {
            let (plan, before) = (next, watch.wall_s());
            let errors = self.measure(&plan, stop)?;
            if stop.is_asked() {
                break;
            }
            next = self.refined(known, found.insert(errors), &plan);
            // Errors against a wrong reference are no errors.
            if reference.excluded.is_some() || next == plan {
                return Ok(found);
            }
            let each = (watch.wall_s() - before) / self.work(known, reference, &plan);
            if watch.wall_s() + each * self.work(known, reference, &next) > room {
                break;
            }
        }
        self.cut_if(true);
        Ok(found)
    }

    /// Finer step sizes for schemes whose errors are above the wanted one, and for the reference.
    fn refined(&self, known: &[Known], errors: &Errors, plan: &Plan) -> Plan {
        let (mut next, wanted) = (plan.clone(), self.settings.error);
        let by = |error: f64| if error.is_finite() && error > FAR * wanted { 2 } else { 1 };
        let mut finer = errors.of_reference > ENOUGH * wanted;
        let sound: Vec<usize> = (0..known.len()).filter(|&s| known[s].excluded.is_none()).collect();
        for &s in &sound {
            // The whole interval is at most the wanted error.
            let reached = |point: &ErrorPoint| point.resolved && point.hi <= wanted;
            match errors.points[s].last() {
                Some(last) if !errors.points[s].iter().any(reached) => match last.resolved {
                    true => next.sizes[s].end += by(last.error),
                    false => finer = true,
                },
                _ => {}
            }
        }
        if finer {
            next.reference += by(errors.of_reference);
        }
        let fewest = sound.iter().map(|&s| next.sizes[s].end).min().unwrap_or(0);
        let most = MOST - self.base.ilog2();
        // A first step size may be out of reach.
        for (next, plan) in next.sizes.iter_mut().zip(&plan.sizes) {
            next.end = next.end.min((fewest + REACH).min(most)).max(plan.end);
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

    /// Times paths. Where there is no time, a step costs what one of the finest timed ones does, or
    /// of the pilot.
    fn time(
        &self,
        known: &[Known],
        points: &mut [Vec<ErrorPoint>],
        stop: &Stop,
    ) -> Result<(), CompareError> {
        let of_scheme = |(points, known): (&Vec<ErrorPoint>, &Known)| {
            let timed = points.iter().filter(|_| known.excluded.is_none());
            timed.map(|point| point.steps).collect::<Vec<u64>>()
        };
        let steps: Vec<_> = points.iter().zip(known).map(of_scheme).collect();
        // One repetition at least, and as many as the budget has room for.
        let of_scheme = |(steps, known): (&Vec<u64>, &Known)| {
            let steps = steps.iter().map(|steps| PATH_STEPS.max(steps * PATHS));
            steps.sum::<u64>() as f64 * known.seconds
        };
        let once: f64 = steps.iter().zip(known).map(of_scheme).sum();
        let repetitions = (self.left_s() / once).clamp(1.0, REPETITIONS) as usize;
        let noise = (self.settings.truncation, self.key(2));
        let (schemes, problem) = (&self.candidates.schemes, self.problem);
        let times = path_times(schemes, problem, &steps, noise, repetitions, stop)?;
        self.cut_if(stop.is_asked());
        for (((points, times), steps), known) in points.iter_mut().zip(times).zip(steps).zip(known)
        {
            let mut step_s = known.seconds;
            for (k, (point, &steps)) in points.iter_mut().zip(&steps).enumerate() {
                let s = step_s * steps as f64;
                let time = times.get(k).copied();
                let time = time.unwrap_or(Spread { best: s, median: s, worst: s });
                (point.time, step_s) = (Some(time), time.best / steps as f64);
            }
        }
        Ok(())
    }
}
