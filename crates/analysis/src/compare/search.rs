//! Step sizes, paths and times of a comparison.

use std::{hint::black_box, sync::Arc};

use mc::{DriveResolution, Ladder, LadderError, Problem, Run, View, parts::Stop};
use noise::StreamKey;
use rayon::ThreadPoolBuilder;
use schemes::Method;

use super::{
    Candidate, Candidates, Choice, CompareError, CompareSettings, Comparison, Outcome, Sampled,
    Stopped,
    errors::{ErrorPoint, Errors, Plan},
    pilot::{Known, within},
    settings::LEAST_SAMPLES,
    verdict::choose,
};
use crate::{FinalMoments, Spread, Stopwatch};

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
/// Halvings of the step sizes of schemes and of the reference, on few paths and then on all.
const AHEAD: [[u32; 2]; 2] = [[0, 2], [1, 4]];
/// Errors that are that many times the wanted one are refined by two halvings at once.
const FAR: f64 = 16.0;
/// The part of the time left that errors may take.
const ERRORS: f64 = 0.75;
/// How often times are measured.
const REPETITIONS: usize = 3;
/// Paths that are timed together, and steps that a time takes at least over all its paths.
const PATHS: u64 = 128;
const PATH_STEPS: u64 = 1 << 14;

/// A comparison under way.
pub struct Search<'a> {
    pub problem: &'a Problem<'a>,
    pub settings: &'a CompareSettings,
    pub candidates: &'a Candidates<'a>,
    /// Number of the longest steps.
    pub base: u64,
    watch: Stopwatch,
    told: &'a dyn Fn(f64, f64),
}

impl<'a> Search<'a> {
    pub fn new(
        problem: &'a Problem<'a>,
        candidates: &'a Candidates<'a>,
        settings: &'a CompareSettings,
        told: &'a dyn Fn(f64, f64),
    ) -> Result<Self, CompareError> {
        settings.check(candidates.schemes.len(), problem.t_end)?;
        let base = ((problem.t_end / LONGEST).ceil() as u64).max(LEAST_STEPS).next_power_of_two();
        Ok(Self { problem, settings, candidates, base, watch: Stopwatch::start(), told })
    }

    /// The noise of a part of the comparison: errors, pilots, times.
    pub fn key(&self, part: u64) -> StreamKey {
        let StreamKey { seed, experiment } = self.settings.key;
        StreamKey { seed, experiment: experiment.wrapping_add(part) }
    }

    fn left_s(&self) -> f64 {
        match self.settings.stop.is_asked() {
            true => 0.0,
            false => (self.settings.budget_s - self.watch.wall_s()).max(0.0),
        }
    }

    pub fn run(self) -> Result<Comparison, CompareError> {
        let Self { problem, settings, candidates, .. } = self;
        // So many pilots share a third of the time left.
        let known = |scheme: &Arc<dyn Method + 'a>, waiting: usize| {
            let seconds = self.left_s() / (3 * waiting) as f64;
            within(seconds, &settings.stop, |stop| Known::new(scheme, &self, stop))
        };
        let reference = known(&candidates.reference, 2)?;
        if let Some(Outcome::Fails(failure)) = reference.excluded {
            let scheme = candidates.reference.id();
            let steps = self.base << reference.first;
            return Err(CompareError::Reference { scheme, steps, failure });
        }
        let all = candidates.schemes.iter().zip((1..=candidates.schemes.len()).rev());
        let all: Vec<Known> =
            all.map(|(scheme, waiting)| known(scheme, waiting)).collect::<Result<_, _>>()?;
        let (found, cut) = within(ERRORS * self.left_s(), &settings.stop, |stop| {
            self.errors(&all, &reference, stop)
        })?;
        let Errors { sampled, of_reference, mut points } = found.unwrap_or_else(|| Errors {
            sampled: Sampled::default(),
            of_reference: f64::INFINITY,
            points: vec![Vec::new(); all.len()],
        });
        within(self.left_s(), &settings.stop, |stop| self.time(&mut points, stop))?;
        let cut = cut || all.iter().any(|known| known.excluded == Some(Outcome::NotMeasured));
        let steps = points.iter().flatten().map(|point| point.steps).max().unwrap_or(0);
        let damped = problem.dampings().any(|damping| damping.integral(0.0, problem.t_end) != 0.0);
        let schemes = candidates.schemes.iter().zip(all).zip(points);
        let candidate = |((scheme, known), points): ((&Arc<dyn Method>, Known), _)| {
            let asked = self.asked(&**scheme);
            Candidate::new(scheme.id(), points, asked, known.excluded, damped)
        };
        let candidates: Vec<Candidate> = schemes.map(candidate).collect();
        let choice = match reference.excluded {
            Some(Outcome::Inconsistent(defect)) => Choice::WrongReference(defect),
            _ => match DriveResolution::new(problem).unresolved(sampled.steps) {
                Some(t) => Choice::NotResolved(t),
                None => choose(&candidates),
            },
        };
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
            stopped: cut.then_some(Stopped { budget_s: settings.budget_s, steps }),
            wall_s: self.watch.wall_s(),
        })
    }

    /// Errors at T/2ᵏ, first on few paths, then with finer and finer steps until the wanted one is
    /// reached or the time is over; and whether it was over.
    fn errors(
        &self,
        known: &[Known],
        reference: &Known,
        stop: &Stop,
    ) -> Result<(Option<Errors>, bool), CompareError> {
        let mut found = None;
        let plan = |[scheme, ahead]: [u32; 2], samples| Plan {
            sizes: known.iter().map(|known| known.sizes(scheme)).collect(),
            reference: reference.first + ahead,
            samples,
        };
        let (mut next, all) =
            (plan(AHEAD[0], LEAST_SAMPLES), plan(AHEAD[1], self.settings.samples));
        while reference.runs() {
            let (plan, watch) = (next, Stopwatch::start());
            let errors = self.measure(&plan, stop)?;
            if stop.is_asked() {
                break;
            }
            let errors = found.insert(errors);
            let ends = errors.points.iter().flatten().map(|point| point.hi);
            (self.told)(ends.fold(f64::INFINITY, f64::min), self.left_s());
            next = match plan.samples < all.samples || plan.reference < all.reference {
                true => all.clone(),
                false => self.refined(known, errors, &plan),
            };
            // Errors against a wrong reference are no errors.
            if reference.excluded.is_some() || next == plan {
                return Ok((found, false));
            }
            // The next ones take twice as long at least.
            if 2.0 * watch.wall_s() > self.left_s() {
                break;
            }
        }
        Ok((found, true))
    }

    /// The error that is asked of a scheme.
    fn asked(&self, scheme: &dyn Method) -> f64 {
        if scheme.reads_areas() { 0.5 * self.settings.error } else { self.settings.error }
    }

    /// Finer step sizes for schemes whose errors are above those asked, and for the reference.
    fn refined(&self, known: &[Known], errors: &Errors, plan: &Plan) -> Plan {
        let (mut next, wanted) = (plan.clone(), self.settings.error);
        let by = |error: f64| if error.is_finite() && error > FAR * wanted { 2 } else { 1 };
        let mut finer = errors.of_reference > ENOUGH * wanted;
        let sound: Vec<usize> = (0..known.len()).filter(|&s| known[s].excluded.is_none()).collect();
        for &s in &sound {
            // The whole interval is at most the wanted error.
            let asked = self.asked(&*self.candidates.schemes[s]);
            let reached = |point: &ErrorPoint| point.resolved && point.hi <= asked;
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

    /// Times paths on one thread, coarse steps first, each in turn, so that a disturbance hits all
    /// of them. Where there is no time, a step costs what one of the finest timed ones does.
    fn time(&self, points: &mut [Vec<ErrorPoint>], stop: &Stop) -> Result<(), LadderError> {
        let (problem, truncation) = (self.problem, self.settings.truncation);
        let mut ladders = Vec::new();
        for (scheme, points) in self.candidates.schemes.iter().zip(points.iter_mut()) {
            for point in points {
                let runs = vec![Run::new(Arc::clone(scheme), 0)];
                let ladder = Ladder::new(problem, point.steps, 0, truncation, self.key(2), runs)?;
                ladders.push((ladder, point));
            }
        }
        ladders.sort_by_key(|(_, point)| point.steps);
        let mut measured = vec![Vec::new(); ladders.len()];
        let nothing = |_: &View<'_>, _: &mut [_]| ();
        // The clock of the thread is read on the thread that works.
        let one = ThreadPoolBuilder::new().num_threads(1).build();
        let one = one.unwrap_or_else(|error| panic!("cannot start a thread: {error}"));
        one.install(|| {
            for _ in 0..REPETITIONS {
                for ((ladder, point), seconds) in ladders.iter().zip(&mut measured) {
                    let paths = PATH_STEPS.div_ceil(PATHS * point.steps).max(1) * PATHS;
                    let new = || FinalMoments::new(ladder.coarse_steps(), 0, &nothing);
                    let watch = Stopwatch::start();
                    black_box(ladder.run_until(stop, 0, paths, new));
                    if stop.is_asked() {
                        return;
                    }
                    let used =
                        if ladder.runs_on_pool() { watch.thread_s() } else { watch.wall_s() };
                    seconds.push(used / paths as f64);
                }
            }
        });
        for ((_, point), seconds) in ladders.into_iter().zip(measured) {
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
