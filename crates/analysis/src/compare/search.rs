//! Step sizes, paths and times of a comparison.

use std::{cell::Cell, sync::Arc};

use mc::{Problem, parts::Stop};
use noise::StreamKey;
use schemes::Method;

use super::{
    Candidate, Candidates, Choice, CompareError, CompareSettings, Comparison, Expectations, Keeps,
    Outcome, Repetitions, Series, Stopped, Strong, StrongPoint, Time, Verdicts, Weak, WeakPoint,
    grid::Grid,
    laws::Law,
    pilot::{Known, within},
    recommend::choose,
    settings::LEAST_SAMPLES,
    time::path_times,
};
use crate::Stopwatch;

/// The least number of coarsest steps.
const LEAST_STEPS: u64 = 4;
/// The base 2 logarithms of the most coarsest steps, and of the most steps at all.
const MOST_STEPS: u32 = 32;
const MOST: u32 = 60;
/// The longest step: truncation needs less than one.
const LONGEST: f64 = 0.5;
/// A reference is not refined if its error is at most this part of the wanted one.
const ENOUGH: f64 = 1.0 / 8.0;
/// Halvings of the step sizes at first, of schemes and of the reference, and if these take long.
const AHEAD: [[u32; 2]; 2] = [[1, 4], [0, 2]];
/// Errors that are that many times the wanted one are refined by two halvings at once.
const FAR: f64 = 16.0;
/// The part of the time left that errors may take.
const ERRORS: f64 = 0.75;
/// Paths and halvings of the first measurement of weak errors.
const WEAK: (u64, u32) = (4096, 6);
/// The most paths of weak errors.
const MOST_PATHS: u64 = 1 << 22;
/// How often times are measured, on how many steps, and paths of the least.
const TIMING: (usize, u64, u64) = (3, 1 << 14, 128);

/// A comparison under way. Step sizes are numbered by the base 2 logarithm of their steps over
/// those of the longest step.
pub struct Search<'a> {
    problem: &'a Problem<'a>,
    settings: &'a CompareSettings<'a>,
    candidates: &'a Candidates<'a>,
    /// Number of the longest steps.
    base: u64,
    watch: Stopwatch,
    /// Whether the budget has cut something short.
    cut: Cell<bool>,
}

/// The finest step sizes of the schemes and that of the reference.
#[derive(Clone, PartialEq)]
struct Plan {
    last: Vec<u32>,
    reference: u32,
}

impl Plan {
    fn finest(&self) -> u32 {
        self.last.iter().copied().fold(self.reference, u32::max)
    }
}

/// Whether an error is resolved and its whole interval at most the wanted one.
fn below(point: &StrongPoint, wanted: f64) -> bool {
    point.resolved && point.hi.unwrap_or(point.error) <= wanted
}

/// Whether an expectation of this accuracy is not much dearer for the bias of the point.
fn good(point: &WeakPoint, accuracy: f64) -> bool {
    point.hi <= std::f64::consts::FRAC_1_SQRT_2 * accuracy
}

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

    /// The noise of a part of the comparison.
    fn key(&self, part: u64) -> StreamKey {
        let StreamKey { seed, experiment } = self.settings.key;
        StreamKey { seed, experiment: experiment.wrapping_add(part) }
    }

    fn left_s(&self) -> f64 {
        (self.settings.budget_s - self.watch.wall_s()).max(0.0)
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
        let mut strong =
            within(ERRORS * self.left_s(), |stop| self.strong(&known, &reference, stop))?;
        let mut weak = match &settings.expectations {
            Some(wanted) => within(ERRORS * self.left_s(), |stop| self.weak(&known, wanted, stop))?,
            None => None,
        };
        let times = within(self.left_s(), |stop| self.times(&known, &strong, weak.as_ref(), stop))?;
        for (s, times) in times.iter().enumerate() {
            strong.series[s].add_times(times);
            for observable in weak.iter_mut().flat_map(|weak| &mut weak.observables) {
                observable.series[s].add_times(times);
            }
        }
        let laws = Law::all(problem, &candidates.casimirs);
        let casimirs: Vec<usize> = (0..laws.len()).filter(|&law| laws[law].casimir).collect();
        let damped = problem.damping.integral(0.0, problem.t_end) != 0.0;
        let verdicts = |quantity: &str, wanted, fares: &dyn Fn(usize) -> Candidate| {
            let candidates = known.iter().enumerate().map(|(s, known)| {
                let fares = fares(s);
                let keeps = Keeps::of(&fares, damped);
                let outcome = known.excluded.clone().unwrap_or(fares.outcome);
                Candidate { outcome, keeps, ..fares }
            });
            let candidates: Vec<Candidate> = candidates.collect();
            let choice = match reference.excluded {
                Some(Outcome::Inconsistent(defect)) => Choice::WrongReference(defect),
                _ => choose(&candidates),
            };
            Verdicts { quantity: quantity.to_owned(), wanted, candidates, choice }
        };
        let for_error = verdicts("y(T)", settings.error, &|s| {
            Candidate::strong(&strong.series[s], settings.error, &casimirs)
        });
        let accuracy = settings.expectations.as_ref().map_or(0.0, |wanted| wanted.accuracy);
        let observables = weak.iter().flat_map(|weak| &weak.observables);
        let for_expectations = observables.map(|observable| {
            verdicts(&format!("E[{}]", observable.name), accuracy, &|s| {
                let defect = for_error.candidates[s].defect;
                Candidate::weak(&observable.series[s], accuracy, defect)
            })
        });
        let for_expectations = for_expectations.collect();
        let points = strong.series.iter().flat_map(|series| &series.points);
        let steps = points.map(|point| point.steps).max().unwrap_or(0);
        let stopped = Stopped { budget_s: settings.budget_s, steps };
        let clock = if Stopwatch::MEASURES_PROCESSOR { "processor time" } else { "wall time" };
        Ok(Comparison {
            system: problem.name.clone(),
            dimension: problem.y0.len(),
            noises: problem.noises,
            t_end: problem.t_end,
            damped,
            invariants: laws.iter().map(|law| law.name.clone()).collect(),
            strong,
            for_error,
            weak,
            for_expectations,
            stopped: self.cut.get().then_some(stopped),
            clock: clock.to_owned(),
            wall_s: self.watch.wall_s(),
        })
    }

    /// What a pilot shows of a scheme, where so many pilots share a third of the time left.
    fn known(&self, scheme: &Arc<dyn Method + 'a>, waiting: usize) -> Result<Known, CompareError> {
        let Self { problem, settings, base, .. } = *self;
        within(self.left_s() / (3 * waiting) as f64, |stop| {
            let known = Known::new(scheme, problem, settings.truncation, self.key(1), base, stop)?;
            self.cut.set(self.cut.get() || !known.runs() && stop.is_asked());
            Ok(known)
        })
    }

    /// A grid with schemes up to these step sizes. A scheme whose paths fail is left out: a path
    /// that fails is in no error of any scheme.
    fn grid(
        &self,
        known: &[Known],
        plan: &Plan,
        samples: u64,
        key: StreamKey,
        stop: &Stop,
    ) -> Grid<'a> {
        let finest = plan.finest();
        let levels = known.iter().zip(&plan.last).map(|(known, &last)| match known.runs() {
            true => (finest - last) as usize..(finest - known.first.min(last)) as usize + 1,
            false => 0..0,
        });
        Grid {
            problem: self.problem,
            schemes: self.candidates.schemes.clone(),
            levels: levels.collect(),
            reference: Arc::clone(&self.candidates.reference),
            reference_level: (finest - plan.reference) as usize,
            finest_steps: self.base << finest,
            samples,
            truncation: self.settings.truncation,
            key,
            stop: stop.clone(),
        }
    }

    /// Strong errors on either side of the wanted one: at T/2ᵏ, with k by one or two larger until
    /// it is reached, or the next errors would take too long. A few paths come first.
    fn strong(
        &self,
        known: &[Known],
        reference: &Known,
        stop: &Stop,
    ) -> Result<Strong, CompareError> {
        let Candidates { casimirs, base, schemes, .. } = self.candidates;
        let mut found = Strong::nothing(&schemes.iter().map(|s| s.id()).collect::<Vec<_>>());
        let (mut samples, room) = (LEAST_SAMPLES, ERRORS * self.left_s());
        let plans = AHEAD.map(|[scheme, ahead]| Plan {
            last: known.iter().map(|k| if k.runs() { k.first + scheme } else { 0 }).collect(),
            reference: reference.first + ahead,
        });
        let fits = self.work(known, reference, &plans[0], samples) < 0.5 * room;
        let [mut plan, small] = plans;
        if !fits {
            plan = small;
        }
        let watch = Stopwatch::start();
        loop {
            let before = watch.wall_s();
            if !reference.runs() {
                break;
            }
            let grid = self.grid(known, &plan, samples, self.key(0), stop);
            let strong = Strong::measure(&grid, casimirs, *base, &|_| ())?;
            if stop.is_asked() {
                break;
            }
            found = strong;
            if reference.excluded.is_some() {
                // Errors against it are no errors.
                return Ok(found);
            }
            let next = self.refined(known, &found, &plan);
            let all = self.settings.samples;
            if next == plan && samples == all {
                return Ok(found);
            }
            let each = (watch.wall_s() - before) / self.work(known, reference, &plan, samples);
            let fits = |&samples: &u64| {
                let next = each * self.work(known, reference, &next, samples);
                watch.wall_s() + next <= room
            };
            match [all, samples].into_iter().find(fits) {
                Some(paths) if next != plan || paths != samples => samples = paths,
                _ => break,
            }
            plan = next;
        }
        self.cut.set(true);
        Ok(found)
    }

    /// Finer step sizes for schemes whose errors are above the wanted one, and for the reference.
    fn refined(&self, known: &[Known], strong: &Strong, plan: &Plan) -> Plan {
        let (wanted, mut next) = (self.settings.error, plan.clone());
        let by = |error: f64| if error.is_finite() && error > FAR * wanted { 2 } else { 1 };
        let mut finer = strong.reference_error > ENOUGH * wanted;
        let sound = |s: &usize| known[*s].excluded.is_none();
        for s in (0..known.len()).filter(sound) {
            let points = &strong.series[s].points;
            match points.last() {
                _ if points.iter().any(|point| below(point, wanted)) => {}
                Some(last) if last.resolved => next.last[s] += by(last.error),
                _ => finer = true,
            }
        }
        if finer {
            next.reference += by(strong.reference_error);
        }
        let fewest = (0..known.len()).filter(sound).map(|s| next.last[s]).min().unwrap_or(0);
        let most = MOST - self.base.ilog2();
        let within = (fewest + self.settings.reach.ilog2()).min(most);
        // A first step size may be out of reach.
        next.last.iter_mut().zip(&plan.last).for_each(|(next, last)| {
            *next = (*next).min(within).max(*last);
        });
        next.reference = next.reference.min(most);
        next
    }

    /// Seconds of a plan on so many paths, by what steps of the pilots took.
    fn work(&self, known: &[Known], reference: &Known, plan: &Plan, samples: u64) -> f64 {
        let groups = samples.div_ceil(128).div_ceil(rayon::current_num_threads() as u64);
        let steps = |last: u32| (self.base as f64) * f64::from(last).exp2();
        let of = |(known, &last): (&Known, &u32)| match known.runs() {
            true => 2.0 * steps(last) * known.seconds,
            false => 0.0,
        };
        let schemes: f64 = known.iter().zip(&plan.last).map(of).sum();
        let reference = 2.0 * steps(plan.reference) * reference.seconds;
        (samples.min(128) * groups) as f64 * (schemes + reference)
    }

    /// Weak errors until every scheme has a step size whose bias is below the wanted accuracy, or
    /// it is out of reach.
    fn weak(
        &self,
        known: &[Known],
        wanted: &Expectations<'_>,
        stop: &Stop,
    ) -> Result<Option<Weak>, CompareError> {
        let (mut samples, more) = WEAK;
        let running = known.iter().filter(|known| known.runs());
        let mut finest = running.map(|known| known.first).max().unwrap_or(0) + more;
        let (mut found, room, begin) = (None, ERRORS * self.left_s(), Stopwatch::start());
        loop {
            let plan = Plan { last: vec![finest - 2; known.len()], reference: finest };
            let watch = Stopwatch::start();
            let grid = self.grid(known, &plan, samples, self.key(2), stop);
            let weak = Weak::measure(&grid, wanted.observables, &|_| ())?;
            if stop.is_asked() {
                self.cut.set(true);
                return Ok(found);
            }
            let reach = u64::from(self.settings.reach.ilog2());
            let (mut paths, mut steps) = (false, false);
            for observable in &weak.observables {
                let sound = observable
                    .series
                    .iter()
                    .zip(known)
                    .filter(|(_, known)| known.excluded.is_none());
                let series: Vec<_> = sound.map(|(series, _)| series).collect();
                let enough = |series: &&Series<WeakPoint>| {
                    let point = series.points.iter().find(|point| good(point, wanted.accuracy));
                    point.map(|point| u64::from((point.steps / self.base).ilog2()))
                };
                let fewest = series.iter().filter_map(enough).min().unwrap_or(u64::from(finest));
                for series in series.iter().filter(|series| enough(series).is_none()) {
                    let Some(point) = series.points.last() else { continue };
                    if point.bias.abs() <= 0.5 * wanted.accuracy {
                        paths = true;
                    } else if u64::from(finest) < fewest + reach {
                        steps = true;
                    }
                }
            }
            samples *= if paths { 4 } else { 1 };
            finest += if steps { 2 } else { 0 };
            found = Some(weak);
            if !paths && !steps || samples > MOST_PATHS {
                return Ok(found);
            }
            let factor = (if paths { 4.0 } else { 1.0 }) * (if steps { 4.0 } else { 1.0 });
            if begin.wall_s() + factor * watch.wall_s() > room {
                self.cut.set(true);
                return Ok(found);
            }
        }
    }

    /// Times of the strong errors up to one that is clearly below the wanted one, and of all weak
    /// errors. Where there is no time, a step costs what one of the finest timed ones does, or of
    /// the pilot.
    fn times(
        &self,
        known: &[Known],
        strong: &Strong,
        weak: Option<&Weak>,
        stop: &Stop,
    ) -> Result<Vec<Vec<(u64, Time)>>, CompareError> {
        let wanted = self.settings.error;
        let mut steps: Vec<Vec<u64>> = Vec::with_capacity(known.len());
        for (s, known) in known.iter().enumerate() {
            let points = &strong.series[s].points;
            let enough = points.iter().position(|point| below(point, wanted));
            let timed = points.iter().take(enough.map_or(points.len(), |n| n + 1));
            let mut each: Vec<u64> = timed.map(|point| point.steps).collect();
            let weak = weak.and_then(|weak| weak.observables.first());
            each.extend(weak.iter().flat_map(|w| &w.series[s].points).map(|point| point.steps));
            each.sort_unstable();
            each.dedup();
            steps.push(if known.excluded.is_none() { each } else { Vec::new() });
        }
        let (count, path_steps, paths) = TIMING;
        // One repetition at least, and as many as the budget has room for.
        let once: f64 = steps.iter().zip(known).fold(0.0, |sum, (steps, known)| {
            let all = steps.iter().map(|steps| path_steps.max(steps * paths)).sum::<u64>();
            sum + all as f64 * known.seconds
        });
        let room = (self.left_s() / once).clamp(1.0, count as f64) as usize;
        let repetitions = Repetitions { count: room, path_steps };
        let (truncation, key) = (self.settings.truncation, self.key(3));
        let (schemes, problem) = (&self.candidates.schemes, self.problem);
        let nobody = &|_| ();
        let mut times =
            path_times(schemes, problem, &steps, truncation, key, (repetitions, stop), nobody)?;
        self.cut.set(self.cut.get() || stop.is_asked());
        for ((times, steps), known) in times.iter_mut().zip(&steps).zip(known) {
            let step_s = times.last().map_or(known.seconds, |(n, time)| time.min_s / *n as f64);
            for &steps in &steps[times.len()..] {
                let s = step_s * steps as f64;
                let (min_s, median_s, max_s) = (s, s, s);
                let (repetitions, paths, failed) = (0, 0, 0);
                times.push((steps, Time { min_s, median_s, max_s, repetitions, paths, failed }));
            }
        }
        Ok(times)
    }
}
