//! Step sizes, paths and times of a comparison.

use std::{cell::Cell, sync::Arc};

use mc::DynProblem;
use noise::{StepNoise, StreamKey};

use super::{
    Candidate, Choice, CompareError, Comparison, DynCandidates, DynCompareSettings,
    DynExpectations, Outcome, Repetitions, Series, Stopped, Strong, Time, Verdicts, Weak,
    WeakPoint,
    candidates::Entrant,
    grid::DynGrid,
    laws::Law,
    pilot::{Pilot, steps_beyond},
    plan::{HALVINGS, Known, Lacks, Plan, below, common, good, lacks},
    recommend::choose,
    time::times_of,
};
use crate::{
    StepSizes, Stopwatch,
    orders::{Consistency, Subject, single_steps},
};

/// The least number of coarsest steps.
const LEAST_STEPS: u64 = 4;
/// The base 2 logarithms of the most coarsest steps, and of the most steps at all.
const MOST_STEPS: u32 = 32;
const MOST: u32 = 60;
/// The longest step: truncation needs less than one.
const LONGEST: f64 = 0.5;
/// The error of the reference is to be this part of the wanted one.
const REFERENCE: f64 = 1.0 / 12.0;
/// A reference is not refined if its error is at most this part.
const ENOUGH: f64 = 1.0 / 8.0;
/// Rounds of refinement.
const ROUNDS: usize = 4;
/// The part of the budget that pilots may take.
const PILOTS: f64 = 0.2;
/// The part of the time left that a measurement may take by estimate.
const SHARE: f64 = 0.7;
/// Paths and halvings of the first measurement of weak errors.
const WEAK: (u64, u32) = (4096, 6);
/// The most paths of weak errors.
const MOST_PATHS: u64 = 1 << 22;
/// How often times are measured, on how many steps, and paths of the least.
const TIMING: (usize, u64, u64) = (3, 1 << 14, 128);

/// A comparison under way. Step sizes are numbered by the base 2 logarithm of their steps over
/// those of the longest step.
pub struct Search<'a, N> {
    problem: &'a DynProblem<'a>,
    settings: &'a DynCompareSettings<'a>,
    candidates: &'a DynCandidates<'a, N>,
    /// Number of the longest steps.
    base: u64,
    watch: Stopwatch,
    /// The finest steps, once the budget has cut something short.
    stopped: Cell<Option<u64>>,
}

impl<'a, N: StepNoise> Search<'a, N> {
    pub fn new(
        problem: &'a DynProblem<'a>,
        candidates: &'a DynCandidates<'a, N>,
        settings: &'a DynCompareSettings<'a>,
    ) -> Result<Self, CompareError> {
        settings.check(candidates.schemes.len())?;
        let least = ((problem.t_end / LONGEST).ceil() as u64).max(LEAST_STEPS);
        if least > 1 << MOST_STEPS {
            return Err(CompareError::FinalTime { t_end: problem.t_end });
        }
        let base = least.next_power_of_two();
        let (watch, stopped) = (Stopwatch::start(), Cell::new(None));
        Ok(Self { problem, settings, candidates, base, watch, stopped })
    }

    /// The noise of a part of the comparison.
    fn key(&self, part: u64) -> StreamKey {
        let StreamKey { seed, experiment } = self.settings.key;
        StreamKey { seed, experiment: experiment.wrapping_add(part) }
    }

    fn left_s(&self) -> f64 {
        self.settings.budget_s - self.watch.wall_s()
    }

    pub fn run(self) -> Result<Comparison, CompareError> {
        let Self { problem, settings, candidates, .. } = self;
        let reference = self.known(&candidates.reference, REFERENCE * settings.error)?;
        if let Some(failure) = reference.pilot.failure {
            let scheme = candidates.reference.scheme.id();
            let steps = self.base << reference.pilot.first;
            return Err(CompareError::Reference { scheme, steps, failure });
        }
        let known = candidates.schemes.iter().map(|entrant| self.known(entrant, settings.error));
        let known: Vec<Known> = known.collect::<Result<_, _>>()?;
        let mut strong = self.strong(&known, &reference)?;
        let mut weak = match &settings.expectations {
            Some(wanted) => Some(self.weak(&known, wanted)?),
            None => None,
        };
        let times = self.times(&known, &strong, weak.as_ref())?;
        for (s, times) in times.iter().enumerate() {
            strong.series[s].add_times(times);
            for observable in weak.iter_mut().flat_map(|weak| &mut weak.observables) {
                observable.series[s].add_times(times);
            }
        }
        let laws = Law::all(problem, &candidates.casimirs);
        let casimirs: Vec<usize> = (0..laws.len()).filter(|&law| laws[law].casimir).collect();
        let verdicts = |quantity: &str, wanted, fares: &dyn Fn(usize) -> Candidate| {
            let excluded = |s: usize| {
                let Known { pilot, inconsistent } = &known[s];
                let failure = pilot.failure.clone().map(Outcome::Fails);
                failure.or(inconsistent.map(Outcome::Inconsistent))
            };
            let candidates: Vec<Candidate> = (0..known.len())
                .map(|s| match (excluded(s), fares(s)) {
                    (Some(outcome), fares) => Candidate { outcome, ..fares },
                    (None, fares) => fares,
                })
                .collect();
            let choice = match reference.inconsistent {
                Some(defect) => Choice::WrongReference(defect),
                None => choose(&candidates),
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
        let stopped = |steps| Stopped { budget_s: settings.budget_s, steps };
        let clock = if Stopwatch::MEASURES_PROCESSOR { "processor time" } else { "wall time" };
        Ok(Comparison {
            system: problem.name.clone(),
            dimension: problem.y0.len(),
            noises: problem.noises,
            t_end: problem.t_end,
            invariants: laws.iter().map(|law| law.name.clone()).collect(),
            strong,
            for_error,
            weak,
            for_expectations,
            stopped: self.stopped.get().map(stopped),
            clock: clock.to_owned(),
            wall_s: self.watch.wall_s(),
        })
    }

    /// A pilot of a scheme, and whether its single steps are right.
    fn known(&self, entrant: &Entrant<'a, N>, wanted: f64) -> Result<Known, CompareError> {
        let Self { problem, settings, base, .. } = *self;
        let pilots = (2 + self.candidates.schemes.len()) as f64;
        let share = PILOTS * settings.budget_s / pilots;
        let watch = Stopwatch::start();
        let spent = || watch.wall_s() > share;
        let key = self.key(1);
        let pilot = Pilot::new(entrant, problem, settings.truncation, key, base, wanted, &spent)?;
        let sizes = StepSizes::new(base << pilot.first, settings.truncation, key);
        let subject = Subject { problem, scheme: &entrant.scheme };
        let inconsistent = match single_steps(subject, &sizes)? {
            Consistency::Inconsistent(defect) => Some(defect),
            _ => None,
        };
        Ok(Known { pilot, inconsistent })
    }

    /// A grid with schemes up to these step sizes. A scheme whose paths fail is left out: a path
    /// that fails is in no error of any scheme.
    fn grid(&self, known: &[Known], plan: &Plan, samples: u64, key: StreamKey) -> DynGrid<'a, N> {
        let finest = plan.finest();
        let levels = known.iter().zip(&plan.last).map(|(known, &last)| match known.pilot.failure {
            None => (finest - last) as usize..(finest - known.pilot.first.min(last)) as usize + 1,
            Some(_) => 0..0,
        });
        DynGrid {
            problem: self.problem,
            schemes: self.candidates.schemes.clone(),
            levels: levels.collect(),
            reference: Arc::clone(&self.candidates.reference.scheme),
            reference_level: (finest - plan.reference) as usize,
            finest_steps: self.base << finest,
            samples,
            truncation: self.settings.truncation,
            key,
        }
    }

    /// Strong errors on either side of the wanted one.
    fn strong(&self, known: &[Known], reference: &Known) -> Result<Strong, CompareError> {
        let wanted = self.settings.error;
        let predicted = known.iter().map(|known| match known.pilot.failure {
            None if known.sound() => known.pilot.predicted(wanted) + 1,
            None => known.pilot.first + HALVINGS,
            Some(_) => 0,
        });
        let mut plan = Plan {
            last: predicted.collect(),
            reference: reference.pilot.predicted(REFERENCE * wanted).max(reference.pilot.first + 2),
        };
        let mut round = 0;
        loop {
            self.limit(known, reference, &mut plan);
            let grid = self.grid(known, &plan, self.settings.samples, self.key(0));
            let DynCandidates { casimirs, base, .. } = self.candidates;
            let strong = Strong::of(&grid, casimirs, *base, &|_| ())?;
            let mut next = plan.clone();
            let mut reference_lacks = strong.reference_error > ENOUGH * wanted;
            for (s, series) in strong.series.iter().enumerate().filter(|(s, _)| known[*s].sound()) {
                match lacks(series, wanted) {
                    Lacks::Nothing => {}
                    Lacks::Reference => reference_lacks = true,
                    Lacks::Halvings(halvings) => next.last[s] += halvings,
                }
            }
            if reference_lacks {
                let beyond = steps_beyond(strong.reference_error, REFERENCE * wanted, 1.0);
                next.reference += beyond.clamp(1, HALVINGS);
            }
            self.reach(known, &mut next);
            round += 1;
            if next == plan || round == ROUNDS || self.stopped.get().is_some() {
                return Ok(strong);
            }
            plan = next;
        }
    }

    /// Keeps the schemes within reach of the one that needs fewest steps.
    fn reach(&self, known: &[Known], plan: &mut Plan) {
        let sound = known.iter().zip(&plan.last).filter(|(known, _)| known.sound());
        let Some(fewest) = sound.map(|(_, last)| *last).min() else { return };
        let most = fewest + self.settings.reach.ilog2();
        plan.last.iter_mut().for_each(|last| *last = (*last).min(most));
    }

    /// Keeps the schemes within reach, and the plan within the time left by estimate.
    fn limit(&self, known: &[Known], reference: &Known, plan: &mut Plan) {
        let most = MOST - self.base.ilog2();
        plan.last.iter_mut().for_each(|last| *last = (*last).min(most));
        plan.reference = plan.reference.min(most);
        self.reach(known, plan);
        let samples = self.settings.samples;
        let threads = (rayon::current_num_threads() as u64).min(samples.div_ceil(128)) as f64;
        let (count, _, least) = TIMING;
        let estimate = |plan: &Plan| {
            let steps = |last: u32| (self.base as f64) * f64::from(last).exp2();
            // Twice the finest steps with all coarser ones; times without the finest.
            let of = |(known, &last): (&Known, &u32)| {
                let errors = 2.0 * samples as f64 / threads;
                (errors + (least * count as u64) as f64) * steps(last) * known.pilot.seconds
            };
            let schemes: f64 = known.iter().zip(&plan.last).map(of).sum();
            let finest = plan.finest();
            let references = 0.75 * steps(plan.reference) + steps(finest);
            schemes + references * samples as f64 / threads * reference.pilot.seconds
        };
        let (budget, mut cut) = (SHARE * self.left_s(), false);
        while estimate(plan) > budget {
            let finest = plan.finest();
            if finest <= common(known).max(reference.pilot.first) + 2 {
                break;
            }
            plan.reference = plan.reference.min(finest - 1);
            plan.last.iter_mut().for_each(|last| *last = (*last).min(finest - 1));
            cut = true;
        }
        if cut {
            self.stopped.set(Some(self.base << plan.last.iter().copied().max().unwrap_or(0)));
        }
    }

    /// Weak errors until every scheme has a step size whose bias is below the wanted accuracy, or
    /// it is out of reach.
    fn weak(&self, known: &[Known], wanted: &DynExpectations<'_>) -> Result<Weak, CompareError> {
        let (mut samples, more) = WEAK;
        let mut finest = common(known) + more;
        loop {
            let plan = Plan { last: vec![finest - 2; known.len()], reference: finest };
            let watch = Stopwatch::start();
            let grid = self.grid(known, &plan, samples, self.key(2));
            let weak = Weak::of(&grid, &wanted.observables, &|_| ())?;
            let reach = u64::from(self.settings.reach.ilog2());
            let (mut paths, mut steps) = (false, false);
            for observable in &weak.observables {
                let sound = observable.series.iter().zip(known).filter(|(_, known)| known.sound());
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
            if !paths && !steps || samples > MOST_PATHS {
                return Ok(weak);
            }
            let factor = (if paths { 4.0 } else { 1.0 }) * (if steps { 4.0 } else { 1.0 });
            if factor * watch.wall_s() > SHARE * self.left_s() {
                self.stopped.set(Some(self.base << (finest - 2)));
                return Ok(weak);
            }
        }
    }

    /// Times of the strong errors up to one that is clearly below the wanted one, and of all weak
    /// errors.
    fn times(
        &self,
        known: &[Known],
        strong: &Strong,
        weak: Option<&Weak>,
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
            steps.push(if known.sound() { each } else { Vec::new() });
        }
        let (count, path_steps, paths) = TIMING;
        // One repetition at least, and as many as the budget has room for.
        let once: f64 = steps.iter().zip(known).fold(0.0, |sum, (steps, known)| {
            let all = steps.iter().map(|steps| path_steps.max(steps * paths)).sum::<u64>();
            sum + all as f64 * known.pilot.seconds
        });
        let room = (self.left_s() / once).clamp(1.0, count as f64) as usize;
        let repetitions = Repetitions { count: room, path_steps };
        let (truncation, key) = (self.settings.truncation, self.key(3));
        let schemes = self.candidates.schemes.iter().map(|entrant| Arc::clone(&entrant.scheme));
        let (schemes, problem) = (schemes.collect::<Vec<_>>(), self.problem);
        Ok(times_of(&schemes, problem, &steps, truncation, key, repetitions, &|_| ())?)
    }
}
