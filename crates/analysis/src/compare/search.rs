//! Step sizes, paths and times of a comparison.

use std::{hint::black_box, ops::Range, sync::Arc, time::Instant};

use mc::{DriveResolution, LadderError, Problem, RunError, Setup, parts::Stop};
use noise::{Purpose, StreamKey};
use rayon::ThreadPoolBuilder;
use schemes::Method;

use super::{
    Candidate, Candidates, Choice, CompareSettings, Comparison, Outcome, Stopped,
    candidates::MIN_SAMPLES,
    errors::{ErrorPoint, Errors, Sampled},
    verdict::choose,
};
use crate::{FinalMoments, Limit, Spread, StepSizes, Stopwatch, orders::single_steps};
use inspect::facts::is_damped;

/// The least number of coarsest steps.
const MIN_STEPS: u64 = 4;
/// The base 2 logarithm of the most steps.
const MOST: u32 = 60;
/// The longest step: truncation needs less than one.
const LONGEST: f64 = 0.5;
/// Base 2 logarithm of the ratio of the steps of the finest pilot to those of the coarsest.
const FINEST: u32 = 8;
/// The reference begins with 2^this times the steps of the schemes, and is not refined any more if
/// its error is at most this part of the wanted one.
const AHEAD: u32 = 3;
const ENOUGH: f64 = 1.0 / 8.0;
/// Halvings of the step size after the first scheme has the wanted error.
const REACH: u32 = 6;
/// The parts of the time left that pilots and errors may take.
const PILOTS: f64 = 1.0 / 3.0;
const ERRORS: f64 = 0.75;
/// Number of measurements of each time.
const REPETITIONS: usize = 3;
/// Number of paths that are timed together, and least number of steps over all paths of a time.
const PATHS: u64 = 128;
const PATH_STEPS: u64 = 1 << 14;

/// State of a running comparison. Step sizes are numbered by the base 2 logarithm of their number
/// of steps over that of the longest step.
pub struct Search<'a> {
    pub problem: &'a Problem<'a>,
    pub settings: &'a CompareSettings,
    pub candidates: &'a Candidates<'a>,
    /// Number of steps of a path with the longest steps.
    pub base: u64,
    pub start: Instant,
    pub told: &'a dyn Fn(f64, f64),
}

/// Number of steps of a path up to `t_end` with the longest steps.
pub fn longest_steps(t_end: f64) -> u64 {
    ((t_end / LONGEST).ceil() as u64).max(MIN_STEPS).next_power_of_two()
}

/// The coarsest step size of a scheme at which no path fails, or why it has no errors.
type Coarsest = Result<u32, Outcome>;

impl<'a> Search<'a> {
    /// The noise of a part of the comparison: errors, pilots, times.
    pub fn key(&self, part: u64) -> StreamKey {
        let StreamKey { seed, experiment } = self.settings.key;
        StreamKey { seed, experiment: experiment.wrapping_add(part) }
    }

    fn setup(&self, scheme: &Arc<dyn Method + 'a>) -> Setup<'a> {
        Setup { problem: self.problem.clone(), scheme: Arc::clone(scheme) }
    }

    /// Seconds that are left of the budget.
    fn left(&self) -> f64 {
        self.settings.budget_s - self.start.elapsed().as_secs_f64()
    }

    /// Stop signal for work that takes more than this part of the time left.
    fn within(&self, part: f64) -> Stop {
        self.settings.stop.within(part * self.left())
    }

    pub fn run(self) -> Result<Comparison, RunError> {
        let Self { problem, settings, candidates, .. } = self;
        let stop = self.within(PILOTS);
        let reference = self.coarsest(&candidates.reference, &stop)?;
        let all = candidates.schemes.iter().map(|scheme| self.coarsest(scheme, &stop));
        let coarsest = all.collect::<Result<Vec<Coarsest>, _>>()?;
        if let Err(Outcome::Fails(failure)) = reference {
            let (scheme, steps) = (candidates.reference.about().id, self.base << FINEST);
            return Err(RunError::Setting(format!(
                "{scheme} fails on pilot paths with {steps} steps, too: {failure}; take a shorter \
                 final time, or another reference"
            )));
        }
        let (found, cut) = self.errors(&coarsest, &reference, &self.within(ERRORS))?;
        let Errors { sampled, of_reference, mut points } = found;
        self.time(&mut points, &self.within(1.0))?;
        let cut = cut || coarsest.contains(&Err(Outcome::NotMeasured));
        let steps = points.iter().flatten().map(|point| point.steps).max().unwrap_or(0);
        let damped = is_damped(problem);
        let choice = match reference {
            Err(Outcome::Inconsistent(defect)) => Some(Choice::WrongReference(defect)),
            _ => DriveResolution::new(problem).unresolved(sampled.steps).map(Choice::NotResolved),
        };
        let schemes = candidates.schemes.iter().zip(coarsest).zip(points);
        let schemes = schemes.map(|((scheme, coarsest), points)| {
            Candidate::new(scheme.about().id, points, self.asked(&**scheme), coarsest.err(), damped)
        });
        let candidates: Vec<Candidate> = schemes.collect();
        Ok(Comparison {
            system: problem.name.clone(),
            dimension: problem.y0.len(),
            noises: problem.noises,
            t_end: problem.t_end,
            damped,
            wanted: settings.error,
            sampled,
            reference_error: of_reference,
            choice: choice.unwrap_or_else(|| choose(&candidates)),
            candidates,
            stopped: cut.then_some(Stopped { budget_s: settings.budget_s, steps }),
            wall_s: self.start.elapsed().as_secs_f64(),
        })
    }

    /// Runs a scheme with finer and finer steps until no path fails, and checks single steps.
    fn coarsest(
        &self,
        scheme: &Arc<dyn Method + 'a>,
        stop: &Stop,
    ) -> Result<Coarsest, LadderError> {
        let setup = self.setup(scheme);
        let mut why = Outcome::NotMeasured;
        for size in 0..=FINEST {
            let sizes = StepSizes::new(self.base << size, self.settings.truncation, self.key(1));
            let sizes = StepSizes { levels: 1, stop: stop.clone(), ..sizes };
            let found = single_steps(&setup, &sizes)?;
            match found {
                _ if stop.is_asked() => return Ok(Err(Outcome::NotMeasured)),
                Ok(Limit::Inconsistent { defect }) => {
                    return Ok(Err(Outcome::Inconsistent(defect)));
                }
                Ok(_) => return Ok(Ok(size)),
                Err(failure) => why = Outcome::Fails(failure),
            }
        }
        Ok(Err(why))
    }

    /// The error that is asked of a scheme.
    fn asked(&self, scheme: &dyn Method) -> f64 {
        if scheme.about().reads_areas { 0.5 * self.settings.error } else { self.settings.error }
    }

    /// Measures errors at T/2ᵏ with finer and finer steps, on few paths first, until the wanted
    /// error is reached or the time is over; returns whether it was over.
    fn errors(
        &self,
        coarsest: &[Coarsest],
        reference: &Coarsest,
        stop: &Stop,
    ) -> Result<(Errors, bool), LadderError> {
        let schemes = &self.candidates.schemes;
        let mut found = Errors {
            sampled: Sampled {
                reference: self.candidates.reference.about().id.into(),
                ..Sampled::default()
            },
            of_reference: f64::INFINITY,
            points: vec![Vec::new(); schemes.len()],
        };
        let first = match reference {
            Ok(size) => *size,
            Err(why) => return Ok((found, *why == Outcome::NotMeasured)),
        };
        // A scheme whose paths fail has no sizes: a path that fails is in no error of any scheme.
        let mut sizes: Vec<Range<u32>> =
            coarsest.iter().map(|size| size.as_ref().map_or(0..0, |&size| size..size)).collect();
        let mut ahead: Vec<usize> = (0..schemes.len()).filter(|&s| coarsest[s].is_ok()).collect();
        let (all, least) = (ahead.len(), coarsest.iter().flatten().min().copied());
        let mut finest = least.map_or(first, |least| least.max(first)) + 1;
        let (mut reference, mut samples) = (finest + AHEAD, MIN_SAMPLES);
        let mut last = MOST - AHEAD - self.base.ilog2();
        loop {
            let start = Instant::now();
            ahead.iter().for_each(|&s| sizes[s].end = sizes[s].start.max(finest + 1));
            let errors = self.measure(&sizes, reference, samples, stop)?;
            if stop.is_asked() {
                return Ok((found, true));
            }
            found = errors;
            let ends = found.points.iter().flatten().map(|point| point.hi);
            (self.told)(ends.fold(f64::INFINITY, f64::min), self.left().max(0.0));
            if samples == self.settings.samples {
                ahead.retain(|&s| {
                    // The whole interval is at most the error that is asked.
                    let asked = self.asked(&*schemes[s]);
                    !found.points[s].iter().any(|point| point.resolved && point.hi <= asked)
                });
                if ahead.len() < all {
                    last = last.min(finest + REACH);
                }
                if ahead.is_empty() || finest >= last {
                    return Ok((found, false));
                }
                finest += 1;
                reference += u32::from(found.of_reference > ENOUGH * self.settings.error);
            }
            samples = self.settings.samples;
            // The next ones take twice as long at least.
            if 2.0 * start.elapsed().as_secs_f64() > self.left() {
                return Ok((found, true));
            }
        }
    }

    /// Times paths on one thread, coarse steps first, each in turn, so that a disturbance hits all
    /// of them. Where there is no time, a step costs what one of the finest timed ones does.
    fn time(&self, points: &mut [Vec<ErrorPoint>], stop: &Stop) -> Result<(), LadderError> {
        let (truncation, family) = (self.settings.truncation, (self.key(2), Purpose::Paths));
        let mut all = Vec::new();
        for (scheme, points) in self.candidates.schemes.iter().zip(points.iter_mut()) {
            for point in points {
                let ladder =
                    self.setup(scheme).ladder(point.steps, 0, truncation, family, PATHS)?;
                all.push((ladder, point, Vec::new()));
            }
        }
        all.sort_by_key(|(_, point, _)| point.steps);
        let one = ThreadPoolBuilder::new().num_threads(1).build();
        let one = one.unwrap_or_else(|error| panic!("cannot start a thread: {error}"));
        for _ in 0..REPETITIONS {
            for (ladder, point, seconds) in &mut all {
                let (ladder, steps) = (&*ladder, PATHS * point.steps);
                let paths = PATH_STEPS.div_ceil(steps).max(1) * PATHS;
                // The clock of the thread is read on the thread that works.
                let used = one.install(|| {
                    let watch = Stopwatch::start();
                    black_box(ladder.run_until(stop, 0, paths, Vec::<FinalMoments<'_>>::new));
                    if ladder.runs_on_pool() { watch.thread_s() } else { watch.wall_s() }
                });
                if !stop.is_asked() {
                    seconds.push(used / paths as f64);
                }
            }
        }
        for (_, point, seconds) in all {
            point.time = (!seconds.is_empty()).then(|| Spread::of(seconds));
        }
        for points in points {
            let mut step: Option<Spread> = None;
            for point in points {
                let steps = point.steps as f64;
                point.time = point.time.or(step.map(|step| step.scaled(steps)));
                step = point.time.map(|time| time.scaled(1.0 / steps));
            }
        }
        Ok(())
    }
}
