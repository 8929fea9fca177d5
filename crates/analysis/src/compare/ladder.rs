//! The ladder of step counts: errors of all schemes on the same noise, and their times.

use std::{hint::black_box, ops::Range, sync::Arc, time::Instant};

use mc::{
    ConformalLaw, DriveResolution, Ladder, LadderError, Problem, Run, RunError, Setup, View,
    parts::Stop,
};
use noise::{Purpose, StreamKey};
use rayon::{ThreadPool, ThreadPoolBuilder};
use real::{
    Row, WIDTH,
    elementary::{exp2, log2},
};
use schemes::{BuiltIn, Method};
use stats::{CrossMoments, root_mean_square_interval};

use super::{
    Candidate, Candidates, Choice, CompareSettings, Comparison, ErrorPoint, Outcome, Sampled,
    Stopped, candidates::MIN_SAMPLES, verdict::choose,
};
use crate::{
    FinalMoments, Limit, Spread, StepSizes, Stopwatch,
    orders::{kept, single_steps, squared_distance, state},
    worse,
};
use inspect::facts::{Form, is_damped};

/// Least number of coarsest steps.
const MIN_STEPS: u64 = 4;
/// Longest step: truncation needs less than one.
const LONGEST: f64 = 0.5;
/// Base 2 logarithm of the largest number of steps.
const MAX_LOG_STEPS: u32 = 60;
/// Last rung of the pilots.
const LAST_PILOT: u32 = 8;
/// Rungs from the first one of the schemes to that of the reference, which climbs until its error
/// is at most this part of the wanted one.
const AHEAD: u32 = 3;
const ENOUGH: f64 = 1.0 / 8.0;
/// Part of the wanted error below which differences of the reference need not fall: often they are
/// rounding errors.
const SETTLED: f64 = 1e-3;
/// Relative standard error below which squares are the same on all paths, but for rounding.
const SAME: f64 = 1e-7;
/// Rungs of the reference: its error is estimated from the last two differences.
const REFERENCES: usize = 3;
/// Largest part of an error that the error of the reference may be.
const RESOLVED: f64 = 0.25;
/// Rungs that follow the first at which a scheme has the wanted error.
const REACH: u32 = 6;
/// Number of measurements of each time, and seconds that one takes at least.
const REPETITIONS: usize = 3;
const MIN_TIME_S: f64 = 1e-3;

/// Comparison in progress. On rung k a path has 2ᵏ times the least number of steps.
struct Climb<'a> {
    problem: &'a Problem<'a>,
    settings: &'a CompareSettings,
    candidates: &'a Candidates<'a>,
    told: &'a dyn Fn(f64, f64),
    /// Number of steps of a path on rung 0.
    base: u64,
    start: Instant,
    /// The thread of all times.
    thread: ThreadPool,
}

/// Scheme on the ladder.
struct Climber<'a> {
    scheme: Arc<dyn Method + 'a>,
    /// Error that is asked of it.
    asked: f64,
    /// Rungs with errors, from the first one on which no path fails.
    rungs: Range<u32>,
    /// Reason why it has no errors.
    excluded: Option<Outcome>,
    /// Times and errors on its rungs.
    times: Vec<Spread>,
    points: Vec<ErrorPoint>,
}

impl Climber<'_> {
    /// Whether finer steps are needed: no error is at most that asked with its whole interval, or a
    /// part of it where the reference does not resolve the error.
    fn climbs(&self) -> bool {
        let part = |resolved| if resolved { 1.0 } else { ENOUGH };
        let reached = |point: &ErrorPoint| point.hi <= part(point.resolved) * self.asked;
        self.excluded.is_none() && !self.points.iter().any(reached)
    }
}

/// Compares schemes on a problem and recommends one; see the [module](super).
///
/// `told` reports the progress now and then: the least error of a scheme so far, by the upper end
/// of its interval, and the seconds that are left at most.
///
/// # Errors
/// [`RunError`] if there is no scheme, if a setting is out of range, if the reference fails, or
/// if a step size is refused.
///
/// # Panics
/// When no thread can be started.
pub fn compare(
    problem: &Problem<'_>,
    candidates: &Candidates<'_>,
    settings: &CompareSettings,
    told: &dyn Fn(f64, f64),
) -> Result<Comparison, RunError> {
    settings.check(candidates.schemes.len(), problem.t_end)?;
    let base = ((problem.t_end / LONGEST).ceil() as u64).max(MIN_STEPS).next_power_of_two();
    let thread = ThreadPoolBuilder::new().num_threads(1).build();
    let thread = thread.unwrap_or_else(|error| panic!("cannot start a thread: {error}"));
    let start = Instant::now();
    Climb { problem, settings, candidates, told, base, start, thread }.run()
}

impl<'a> Climb<'a> {
    /// The noise of a part of the comparison: errors, pilots, times.
    fn key(&self, part: u64) -> StreamKey {
        let StreamKey { seed, experiment } = self.settings.key;
        StreamKey { seed, experiment: experiment.wrapping_add(part) }
    }

    fn setup(&self, scheme: &Arc<dyn Method + 'a>) -> Setup<'a> {
        Setup { problem: self.problem.clone(), scheme: Arc::clone(scheme) }
    }

    fn run(self) -> Result<Comparison, RunError> {
        let Self { problem, settings, candidates, base, .. } = self;
        let stop = settings.stop.within(settings.budget_s);
        let reference = self.pilot(&candidates.reference, &stop)?;
        if let Some(Outcome::Fails(failure)) = reference.excluded {
            let (scheme, steps) = (candidates.reference.about().id, base << LAST_PILOT);
            return Err(RunError::Setting(format!(
                "{scheme} fails on pilot paths with {steps} steps, too: {failure}; take a shorter \
                 final time, or another reference"
            )));
        }
        let all = candidates.schemes.iter().map(|scheme| self.pilot(scheme, &stop));
        let mut all = all.collect::<Result<Vec<Climber<'_>>, _>>()?;
        let id = candidates.reference.about().id.to_owned();
        let mut found = (Sampled { reference: id, ..Sampled::default() }, f64::INFINITY);
        let cut = match reference.excluded {
            None => self.climb(&mut all, reference.rungs.start, &mut found, &stop)?,
            Some(_) => stop.is_asked(),
        };
        let (sampled, reference_error) = found;
        let steps = all.iter().flat_map(|one| &one.points).map(|point| point.steps).max();
        let damped = is_damped(problem);
        let excluded = match reference.excluded {
            Some(Outcome::Inconsistent(defect)) => Some(Choice::WrongReference(defect)),
            _ => DriveResolution::new(problem).unresolved(sampled.steps).map(Choice::NotResolved),
        };
        // An explicit reference is for equations without B and H, whose damping is always exact.
        let explicit = BuiltIn::named(&sampled.reference).is_some_and(|of| of.is_explicit(false));
        let candidates = all.into_iter().map(|one| {
            let id = one.scheme.about().id;
            let mut judged = Candidate::new(id, one.points, one.asked, one.excluded, damped);
            judged.keeps.conformal &= !explicit;
            judged
        });
        let candidates: Vec<Candidate> = candidates.collect();
        Ok(Comparison {
            system: problem.name.clone(),
            dimension: problem.y0.len(),
            noises: problem.noises,
            t_end: problem.t_end,
            damped,
            wanted: settings.error,
            sampled,
            reference_error,
            choice: excluded.unwrap_or_else(|| choose(&candidates)),
            candidates,
            stopped: cut
                .then_some(Stopped { budget_s: settings.budget_s, steps: steps.unwrap_or(0) }),
            wall_s: self.start.elapsed().as_secs_f64(),
        })
    }

    /// Climbs until no path of a scheme fails, and checks single steps there.
    fn pilot(
        &self,
        scheme: &Arc<dyn Method + 'a>,
        stop: &Stop,
    ) -> Result<Climber<'a>, LadderError> {
        let (setup, mut first, mut excluded) = (self.setup(scheme), 0, None);
        for rung in 0..=LAST_PILOT {
            let sizes = StepSizes::new(self.base << rung, self.settings.truncation, self.key(1));
            let sizes = StepSizes { levels: 1, stop: stop.clone(), ..sizes };
            (first, excluded) = match single_steps(&setup, &sizes)? {
                _ if stop.is_asked() => (0, Some(Outcome::NotMeasured)),
                Ok(Limit::Inconsistent { defect }) => (0, Some(Outcome::Inconsistent(defect))),
                Ok(_) => (rung, None),
                Err(failure) => (0, Some(Outcome::Fails(failure))),
            };
            if !matches!(excluded, Some(Outcome::Fails(_))) {
                break;
            }
        }
        Ok(Climber {
            // Of areas that are better than those of a run half of the error is asked.
            asked: if scheme.about().reads_areas { 0.5 } else { 1.0 } * self.settings.error,
            scheme: Arc::clone(scheme),
            rungs: first..first,
            excluded,
            times: Vec::new(),
            points: Vec::new(),
        })
    }

    /// Measures times and errors on more and more rungs until no scheme climbs, or the time is
    /// over; returns whether it was over.
    fn climb(
        &self,
        all: &mut [Climber<'a>],
        first: u32,
        found: &mut (Sampled, f64),
        stop: &Stop,
    ) -> Result<bool, LadderError> {
        let lowest = all.iter().filter(|one| one.climbs()).map(|one| one.rungs.start).min();
        let mut rung = lowest.map_or(first, |lowest| lowest.max(first)) + 1;
        let (mut reference, mut last) = (rung + AHEAD, MAX_LOG_STEPS - AHEAD - self.base.ilog2());
        let climbing = |all: &[Climber<'_>]| all.iter().filter(|one| one.climbs()).count();
        let (number, mut samples) = (climbing(all), MIN_SAMPLES);
        loop {
            for one in all.iter_mut().filter(|one| one.climbs()) {
                one.rungs.end = one.rungs.start.max(rung + 1);
            }
            let (points, sampled, of_reference) = self.measure(all, (reference, samples), stop)?;
            if stop.is_asked() {
                return Ok(true);
            }
            *found = (sampled, of_reference);
            for (one, points) in all.iter_mut().zip(points) {
                one.points = points;
                self.time(one, stop)?;
            }
            let ends = all.iter().flat_map(|one| &one.points).map(|point| point.hi);
            let left = self.settings.budget_s - self.start.elapsed().as_secs_f64();
            (self.told)(ends.fold(f64::INFINITY, f64::min), left.max(0.0));
            if samples < self.settings.samples {
                samples = self.settings.samples;
                continue;
            }
            if climbing(all) < number {
                last = last.min(rung + REACH);
            }
            if climbing(all) == 0 || rung >= last {
                return Ok(false);
            }
            rung += 1;
            reference += u32::from(of_reference > ENOUGH * self.settings.error);
        }
    }

    /// Measures distances to the reference on the same noise, on all rungs of each scheme; and the
    /// error of the reference, from its own differences.
    fn measure(
        &self,
        all: &[Climber<'a>],
        (reference, samples): (u32, u64),
        stop: &Stop,
    ) -> Result<(Vec<Vec<ErrorPoint>>, Sampled, f64), LadderError> {
        let Self { problem, candidates, settings, base, .. } = *self;
        let top = all.iter().map(|one| one.rungs.end.saturating_sub(1)).fold(reference, u32::max);
        let run = |scheme: &Arc<dyn Method + 'a>, rung: u32| {
            Run::new(Arc::clone(scheme), (top - rung) as usize)
        };
        let references = (0..REFERENCES as u32).map(|k| run(&candidates.reference, reference - k));
        let mut runs: Vec<Run<'_>> = references.collect();
        for one in all {
            runs.extend(one.rungs.clone().map(|rung| run(&one.scheme, rung)));
        }
        let length = 2 * runs.len() - REFERENCES;
        let levels = runs.iter().map(|run| run.level).max().unwrap_or(0);
        let casimirs = defects(problem, &candidates.casimirs);
        let values = |view: &View<'_>, values: &mut [Row]| squares(view, &casimirs, values);
        let (steps, truncation) = (base << top, settings.truncation);
        let ladder = Ladder::new(problem, steps, levels, truncation, self.key(0), runs)?;
        let ladder = ladder.fitting(samples)?;
        let new = || FinalMoments::new(ladder.coarse_steps(), length, &values);
        let rungs: Vec<_> = all.iter().map(|one| &one.rungs).collect();
        let (job, name) = (settings.job.as_deref(), format!("{rungs:?}, reference {reference}"));
        let measured = kept(&ladder, (job, stop), &name, samples, new);
        let moments = measured.statistic.moments;

        let rms = |index: usize| moments.mean(index).sqrt();
        let of_reference = left(rms(1), root_mean_square(&moments, 0), settings.error);
        let mut squares = (REFERENCES..).step_by(2);
        let point = |(rung, square): (u32, usize)| {
            let [lo, error, hi] = root_mean_square(&moments, square);
            ErrorPoint {
                steps: base << rung,
                error,
                lo: (lo - of_reference).max(0.0),
                hi: hi + of_reference,
                resolved: of_reference <= RESOLVED * error,
                defect: (!casimirs.is_empty()).then(|| rms(square + 1)),
                time: None,
            }
        };
        let points = all.iter().map(|one| one.rungs.clone().zip(&mut squares).map(point).collect());
        let points = points.collect();
        let sampled = Sampled {
            samples,
            failed: measured.failed,
            failures: measured.failures.iter().map(ToString::to_string).collect(),
            reference: candidates.reference.about().id.to_owned(),
            steps: base << reference,
            last_difference: rms(0),
            spread: rms(2),
        };
        Ok((points, sampled, of_reference))
    }

    /// Times paths of a scheme on one thread, on rungs that were not timed yet. Where there is no
    /// time, a step costs what it does on the last rung that was timed.
    fn time(&self, one: &mut Climber<'a>, stop: &Stop) -> Result<(), LadderError> {
        let (truncation, family) = (self.settings.truncation, (self.key(2), Purpose::Paths));
        let setup = self.setup(&one.scheme);
        for point in &one.points[one.times.len()..] {
            let mut paths = WIDTH as u64;
            let ladder = setup.ladder(point.steps, 0, truncation, family, paths)?;
            // The clock of the thread is read on the thread that works.
            let seconds = |paths: u64| {
                self.thread.install(|| {
                    let watch = Stopwatch::start();
                    black_box(ladder.run_until(stop, 0, paths, Vec::<FinalMoments<'_>>::new));
                    if ladder.runs_on_pool() { watch.thread_s() } else { watch.wall_s() }
                })
            };
            let mut first = seconds(paths);
            while first < MIN_TIME_S && !stop.is_asked() {
                paths *= 4;
                first = seconds(paths);
            }
            let mut times = vec![first];
            times.extend((1..REPETITIONS).map(|_| seconds(paths)));
            if stop.is_asked() {
                break;
            }
            one.times.push(Spread::of(times.iter().map(|all| all / paths as f64).collect()));
        }
        let mut step: Option<Spread> = None;
        let mut times = one.times.iter().copied();
        for point in &mut one.points {
            let steps = point.steps as f64;
            point.time = times.next().or(step.map(|step| step.scaled(steps)));
            step = point.time.map(|time| time.scaled(1.0 / steps));
        }
        Ok(())
    }
}

/// Function of the state.
type Value<'a> = Box<dyn Fn(&[f64]) -> f64 + Sync + 'a>;

/// Relative defects (C(y) − c)/c of a final state, one for each Casimir C of degree p that the
/// problem names or that was found, with c = e^{−p∫γ}C(y₀); relative to e^{−p∫γ} where c is zero.
fn defects<'a>(problem: &'a Problem<'a>, found: &'a [Form]) -> Vec<Value<'a>> {
    let integrals = problem.dampings().map(|damping| damping.integral(0.0, problem.t_end));
    let integrals: Vec<f64> = integrals.collect();
    let mut laws = problem.laws.clone();
    // With friction those that still hold are among the laws of the problem.
    if problem.friction.is_empty() {
        laws.extend(found.iter().map(|form| form.law(String::new())));
    }
    let defect = |law: ConformalLaw<'a>| -> Value<'a> {
        let decay = law.decay(&integrals);
        let at_end = decay * (law.value)(&problem.y0);
        let scale = if at_end == 0.0 { decay } else { at_end };
        Box::new(move |y| ((law.value)(y) - at_end) / scale)
    };
    laws.into_iter().filter(|law| law.casimir).map(defect).collect()
}

/// Writes the squared differences of the reference from itself with half and a quarter of the
/// steps, and of neighbouring paths; then the squared error and the largest squared defect of every
/// point.
fn squares(view: &View<'_>, casimirs: &[Value<'_>], values: &mut [Row]) {
    let distance = |a: usize, b: usize| squared_distance(view.state(a), view.state(b), view.live);
    (values[0], values[1]) = (distance(0, 1), distance(1, 2));
    let mut other = view.live.paths().last().unwrap_or(0);
    for p in view.live.paths() {
        values[2][p] = view.state(0).iter().map(|row| (row[p] - row[other]).powi(2)).sum();
        other = p;
    }
    for (run, pair) in (REFERENCES..).zip(values[REFERENCES..].chunks_exact_mut(2)) {
        pair[0] = distance(run, 0);
        for p in view.live.paths().filter(|_| !casimirs.is_empty()) {
            let y = state(view.state(run), p);
            let squares = casimirs.iter().map(|defect| defect(&y).powi(2));
            pair[1][p] = squares.fold(0.0, |most, square| worse(square, most));
        }
    }
}

/// The root of a mean square between the ends of its bootstrap-t interval of 95 %, which fewer than
/// 32 paths do not have. Without noise all are the value.
fn root_mean_square(squares: &CrossMoments, index: usize) -> [f64; 3] {
    let value = squares.mean(index).sqrt();
    if squares.standard_error(index) <= SAME * squares.mean(index) {
        return [value; 3];
    }
    let (lo, hi) = root_mean_square_interval(squares, index).unwrap_or((0.0, f64::INFINITY));
    [lo, value, hi]
}

/// Upper bound of the error at the finest of three step sizes from the root-mean-square differences
/// of successive ones, d₁ = |y_{4τ} − y_{2τ}| and d₀ = |y_{2τ} − y_τ|: the sum of the differences
/// that would follow, d₀/(2^p − 1) with p = log₂(d₁/d₀), at most 1 and at least ½, for the upper
/// end of d₀. If the differences do not fall, p is ½ for the larger one where both are far below
/// the `wanted` error, as rounding errors are; otherwise it is infinite.
fn left(before: f64, [_, last, most]: [f64; 3], wanted: f64) -> f64 {
    const FALLS: f64 = 0.25;
    let p = log2(before / last);
    match last {
        0.0 => 0.0,
        _ if p >= FALLS && most.is_finite() => most.max(last) / (exp2(p.clamp(0.5, 1.0)) - 1.0),
        _ if before.max(last) <= SETTLED * wanted => before.max(last) / (exp2(0.5) - 1.0),
        _ => f64::INFINITY,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_follows_a_difference_is_bounded_where_differences_fall() {
        let of = |before: f64, last: f64| left(before, [last, last, last], 0.1);
        // Order one leaves the last difference, order ½ 1/(√2 − 1) of it, and no order is trusted
        // beyond one.
        assert_eq!((of(2.0, 1.0), of(8.0, 1.0), of(1.0, 0.0)), (1.0, 1.0, 0.0));
        assert!((of(2f64.sqrt(), 1.0) - (1.0 + 2f64.sqrt())).abs() < 1e-12);
        assert!(of(1.1, 1.0).is_infinite() && of(1.0, f64::NAN).is_infinite());
        assert_eq!(left(2.0, [0.5, 1.0, 1.5], 0.1), 1.5);
        // Rounding errors.
        assert!(of(1e-16, 2e-16) < 5e-16 && of(0.0, 1e-16) < 3e-16 && of(0.0, 1e-3).is_infinite());
    }
}
