//! **Are the steps of a run short enough?** Means and deviations at τ and at τ/2, on common noise.
//!
//! A few paths are simulated to the final time with the steps of a run and with steps of half the
//! size. The differences of means and of deviations, with their standard errors, say how large the
//! step errors of the run are: about twice the difference at weak order one, 4/3 of it at order
//! two. Chaotic paths separate, but their means agree. Errors that few paths cannot show are named.
//!
//! Of a few long paths the check takes blocks of time: 32 that begin at states of a path, each a
//! thirtieth of it, all at once. What differs along a path grows with time t like t^g, 0 ≤ g ≤ 1,
//! and g is seen from the middle of blocks to their end.

use std::f64::consts::LN_2;

use mc::{
    DriveResolution, Kept, LadderError, Observe, Problem, Setup, Statistic, View, parts::Job,
};
use noise::{Purpose, StreamKey, Truncation};
use real::{
    PathMask, Row, WIDTH,
    elementary::{exp2, ln, powf},
    golden,
};
use serde::Serialize;
use stats::CrossMoments;

/// The step errors of a run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StepCheck {
    /// Number of paths that reached the final time at both step sizes.
    pub paths: u64,
    /// Number of paths that failed at one of the step sizes.
    pub failed: u64,
    /// Integral |∫γ| over the last step. Above [`STIFF`] the damping outruns the step, at τ/2 as at
    /// τ, so that both step sizes may agree on a wrong value.
    pub damping: f64,
    /// Angle by which the fastest motion turns in a step, in radians. Above [`TURN`] the motion is
    /// not resolved at τ/2 either: an average rotation by nearly ±π looks like none, and a mode
    /// that is too slow takes too little energy from the noise, both at τ as at τ/2.
    pub turn: f64,
    /// Time at which a function of t changes within a step by more than from step to step, at τ or
    /// τ/2, so that both may agree on a wrong value; and a number of steps that resolves it, if up
    /// to 2¹² times the steps of the run do.
    pub unresolved: Option<(f64, Option<u64>)>,
    /// Length of the blocks of time that stand for paths, if they do.
    pub blocks: Option<f64>,
    /// The step errors of each observable.
    pub observables: Vec<StepErrors>,
}

/// The step errors of an observable.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StepErrors {
    /// Name of the observable.
    pub observable: String,
    /// Mean of the observable.
    pub mean: Halved,
    /// Standard deviation of the observable.
    pub deviation: Halved,
    /// Root mean square over paths of the difference between τ and τ/2; of blocks, what it grows to
    /// over the time of a path.
    pub along_paths: f64,
}

/// Statistic at τ and its difference from τ/2.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Halved {
    /// Value of the statistic at τ.
    pub value: f64,
    /// Difference: the value at τ minus the value at τ/2.
    pub difference: f64,
    /// The standard error of the difference.
    pub standard_error: f64,
    /// Rounding error that the difference may have.
    pub rounding: f64,
    /// The step error over the difference: 1/(1 − 2^{−p}) at order p, two at order one.
    pub of_error: f64,
}

/// Estimate of a step error, or a bound of it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case", tag = "decided", content = "size")]
pub enum StepError {
    /// Step error below the sampling error; no error larger than this was missed.
    Fine(f64),
    /// Step error of about this size.
    About(f64),
    /// No step error was seen; one larger than this bound, which exceeds the sampling error, would
    /// have been.
    Below(f64),
    /// No step error was seen, but even one as large as the spread of the values would have been
    /// missed.
    CannotTell,
}

/// Integral ∫γ over a step from which noise and forces within the step are damped by less than a
/// third of the right amount, or by more than three times it.
pub const STIFF: f64 = 2.0;
/// Turn of a step from which half a step turns by more than a right angle.
pub const TURN: f64 = std::f64::consts::PI;
/// Largest part of paths that may fail: after more failures the others do not represent the
/// equation.
const MAX_FAILED: f64 = 0.1;
/// Standard errors that a difference exceeds by chance with probability 0.003, 0.005 at 32 paths.
const SEEN: f64 = 3.0;
/// Standard errors that a difference which was not seen may hide.
const HIDDEN: f64 = 2.0;
/// Part of the sampling error below which a step error is not reported.
const WORTH: f64 = 0.1;
/// Rounding relative to the terms of a mean, and of the root of a difference of their squares.
const ROUNDING: [f64; 2] = [1e-12, 1e-7];
/// Largest relative change of the components by which rounding errors of φ are seen.
const CHANGE: f64 = 1e-10;
/// Number of paths of the run for each path of the check, and number of paths that the run
/// simulates besides for its bins: three steps for each step of the run make a tenth.
const SHARE: u64 = 30;
const PILOT: u64 = 1024;
/// Doublings of the steps of which it is asked whether they resolve H(t).
const MAX_DOUBLINGS: u32 = 12;
/// Steps of a path from which few of them are checked by blocks of time, and the parts of its time
/// that a block is one of: three steps for each of a block make a tenth.
const LONG: u64 = 100_000;
const PARTS: u64 = 30;
/// Largest number of blocks: the check then sees a fiftieth of a deviation.
const MAX_BLOCKS: u64 = 256;

impl StepCheck {
    /// Whether steps of half the size would show a step error.
    pub fn resolves(&self) -> bool {
        let all = (self.failed + self.paths) as f64;
        let motion = self.damping <= STIFF && self.turn <= TURN && self.unresolved.is_none();
        motion && self.failed as f64 <= MAX_FAILED * all
    }

    /// The part of its energy that the fastest motion lacks, if noise drives it and damping limits
    /// it: x²/(1 + x²), x = ωτ/2 for a turn by ωτ in a step. In a step of the midpoint rule a kick
    /// σΔW to p moves p by σΔW/(1 + x²) and ωq by x times that: (p² + ω²q²)/2 gains σ²τ/2/(1 + x²).
    pub fn energy_lost(&self) -> f64 {
        let square = 0.25 * self.turn * self.turn;
        square / (1.0 + square)
    }

    /// Judges a step error where the half-width of the sampling error is `sampling` and the
    /// deviation of the values is `spread`.
    pub fn step_error(&self, halved: Halved, sampling: f64, spread: f64) -> StepError {
        let Halved { difference, standard_error, rounding, of_error, .. } = halved;
        let (size, noise) = (difference.abs(), standard_error.max(rounding));
        let hidden = of_error * (size + HIDDEN * noise);
        if !self.resolves() {
            StepError::CannotTell
        } else if size > SEEN * noise && of_error * size > WORTH * sampling {
            StepError::About(of_error * size)
        } else if hidden <= sampling.max(10.0 * rounding) {
            StepError::Fine(hidden)
        } else if hidden <= spread {
            StepError::Below(hidden)
        } else {
            StepError::CannotTell
        }
    }
}

/// Number of paths of the check for a run of `run` paths: the check costs at most a tenth of the
/// run. One path where neither noise nor initial values are random.
pub fn checked_paths(run: u64, problem: &Problem<'_>) -> u64 {
    let width = WIDTH as u64;
    if problem.silent && problem.initial.is_none() {
        return 1;
    }
    width * (run.saturating_add(PILOT) / (SHARE * width)).clamp(1, MAX_BLOCKS)
}

/// Whether the steps of a few paths are checked by blocks of time, which begin at
/// [`states`](block_starts): where there are many steps, and nothing depends on time.
pub fn is_by_blocks(run: u64, steps: u64, problem: &Problem<'_>) -> bool {
    let constant = problem.dampings().all(|damping| {
        [0.37, 1.0].iter().all(|part| damping.rate(part * problem.t_end) == damping.rate(0.0))
    });
    run < WIDTH as u64 && steps >= LONG && problem.in_time.is_empty() && constant
}

/// States at 32 times of the table of a path, in rows, from those of its components.
pub fn block_starts(components: &[&[f64]]) -> Vec<Row> {
    let at = |values: &[f64], p: usize| values[p * (values.len() - 1) / WIDTH];
    components.iter().map(|values| std::array::from_fn(|p| at(values, p))).collect()
}

/// Checks the steps of a run, as a piece of work of a job with the name "steps"; `None` if the
/// results are not here. `fastest` is the rate of the fastest motion, see
/// [`fastest`](inspect::facts::fastest()). `told` reports the path-steps that are done: three for
/// each step of a path. `blocks` are [states](block_starts) where blocks of time begin that stand
/// for paths.
///
/// # Errors
/// [`LadderError`] if the scheme cannot be run on steps of half the size.
pub fn step_check(
    setup: &Setup<'_>,
    observables: &[&dyn Observe],
    (steps, paths, blocks): (u64, u64, Option<&[Row]>),
    fastest: f64,
    (truncation, key): (Truncation, StreamKey),
    (job, told): (&Job, &(dyn Fn(u64) + Sync)),
) -> Result<Option<StepCheck>, LadderError> {
    let (run, end) = (steps, setup.problem.t_end);
    let (steps, paths, each) = match blocks {
        Some(_) => (2 * (run / (2 * PARTS)), WIDTH as u64, 2),
        None => (run, paths, 1),
    };
    let mut short = setup.clone();
    short.problem.t_end = end * (steps as f64 / run as f64);
    let (twice, family) = (steps.saturating_mul(2), (key, Purpose::StepCheck));
    let mut ladder = short.ladder(twice, 1, truncation, family, paths)?.telling(told);
    if let Some(starts) = blocks {
        ladder = ladder.starting(|_, _| starts.to_vec());
    }
    let initial = setup.start();
    let centered = observables.iter().map(|&phi| {
        let value = phi.values(&initial, PathMask::first(1))[0];
        (phi, if value.is_finite() { value } else { 0.0 })
    });
    let observables: &[Centered<'_>] = &centered.collect::<Vec<_>>();
    let new = || {
        let sums = vec![CrossMoments::new(4); each * observables.len()];
        AtBoth { each, sums, steps, observables }
    };
    let Some(measured) = ladder.run_in(job, "steps", paths, new) else { return Ok(None) };
    let all = observables.iter().zip(measured.statistic.sums.chunks(each)).map(|(phi, sums)| {
        let mut found = errors(*phi, &sums[each - 1], steps);
        if each > 1 {
            let before = errors(*phi, &sums[0], steps).along_paths;
            let growth = (found.along_paths / before).clamp(1.0, 2.0);
            // t^g over PARTS blocks, with 2^g = growth.
            let grown = powf(PARTS as f64, ln(growth) / LN_2);
            found.along_paths *= if grown.is_nan() { 1.0 } else { grown };
        }
        found
    });
    let drive = DriveResolution::new(&setup.problem);
    let unresolved = drive.unresolved(run.saturating_mul(2)).map(|t| {
        let mut finer = (1..=MAX_DOUBLINGS).map_while(|k| run.checked_shl(k));
        (t, finer.find(|steps| drive.unresolved(2 * steps).is_none()))
    });
    let (tau, dampings) = (end / run as f64, setup.problem.dampings());
    Ok(Some(StepCheck {
        damping: dampings.map(|one| one.integral(end - tau, end).abs()).fold(0.0, f64::max),
        turn: fastest * end / run as f64,
        unresolved,
        blocks: blocks.map(|_| short.problem.t_end),
        paths: paths - measured.failed,
        failed: measured.failed,
        observables: all.collect(),
    }))
}

/// An observable φ with a value c near its own.
type Centered<'a> = (&'a dyn Observe, f64);

/// Moments of a = φ_τ − c, b = φ_{τ/2} − c, a² − b² and the change of φ_τ by [changes](CHANGE) of
/// the components, for each observable φ, at the end, and of blocks in the middle before.
struct AtBoth<'a> {
    /// Number of times.
    each: usize,
    sums: Vec<CrossMoments>,
    steps: u64,
    observables: &'a [Centered<'a>],
}

impl Statistic for AtBoth<'_> {
    fn observe(&mut self, view: &View<'_>) {
        let (is_end, each) = (view.time == self.steps, self.each);
        if !(is_end || each > 1 && 2 * view.time == self.steps) {
            return;
        }
        let sums = self.sums.iter_mut().skip(if is_end { each - 1 } else { 0 }).step_by(each);
        let mut changed = view.state(0).to_vec();
        for (i, row) in changed.iter_mut().enumerate() {
            let part = CHANGE * (2.0 * golden(i as f64 + 1.0) - 1.0);
            row.iter_mut().for_each(|y| *y += part * *y);
        }
        for ((phi, center), sums) in self.observables.iter().zip(sums) {
            let values = [0, 1].map(|run| phi.values(view.state(run), view.live));
            let changed = phi.values(&changed, view.live);
            for p in view.live.paths() {
                let [a, b] = values.map(|row| row[p] - center);
                let change = changed[p] - values[0][p];
                let change = if change.is_finite() { change } else { 0.0 };
                sums.add(&[a, b, a * a - b * b, change]);
            }
        }
    }

    fn merge(&mut self, later: Self) {
        self.sums.iter_mut().zip(&later.sums).for_each(|(sum, more)| sum.merge(more));
    }
}

impl Kept for AtBoth<'_> {
    type Sums = Vec<CrossMoments>;

    fn sums(&self) -> &Self::Sums {
        &self.sums
    }

    fn sums_mut(&mut self) -> &mut Self::Sums {
        &mut self.sums
    }
}

/// The step errors of an observable from its moments after `steps`.
fn errors((phi, center): Centered<'_>, moments: &CrossMoments, steps: u64) -> StepErrors {
    let (count, a, b) = (moments.count() as f64, moments.mean(0), moments.mean(1));
    // Of one path there is no variance, and without noise none is needed.
    let covariance = |k, l| match moments.count() {
        0 => f64::NAN,
        1 => 0.0,
        _ => moments.covariance_of_means(k, l),
    };
    let error = |row: [f64; 3]| {
        let terms = (0..9).map(|k| row[k / 3] * row[k % 3] * covariance(k / 3, k % 3));
        terms.sum::<f64>().max(0.0).sqrt()
    };
    // What is left of a difference of squares by rounding.
    let root = ROUNDING[1] * a.abs();
    let above = |x: f64| if x <= root { 0.0 } else { x };
    // A sum that is zero by symmetry has the rounding errors of its terms: 64ε√n of the components,
    // where 8ε√n is by chance, times the sensitivity of φ.
    let change = (moments.mean(3).powi(2) + count * covariance(3, 3)).max(0.0).sqrt();
    let of_terms = 64.0 * (steps as f64).sqrt() * f64::EPSILON / CHANGE * change;
    let mean = Halved {
        value: center + a,
        difference: a - b,
        standard_error: above(error([1.0, -1.0, 0.0])),
        rounding: (ROUNDING[0] * (center.abs() + a.abs())).max(of_terms),
        of_error: 1.0 / (1.0 - exp2(-phi.weak_order())),
    };
    let [first, second] = [0, 1].map(|k| above((count * covariance(k, k)).max(0.0).sqrt()));
    let sum = first + second;
    let deviation = Halved {
        value: first,
        difference: first - second,
        // Of the variance, by its linear part in the three means.
        standard_error: if sum > 0.0 { error([-2.0 * a, 2.0 * b, 1.0]) / sum } else { 0.0 },
        rounding: mean.rounding + root,
        ..mean
    };
    let along = (mean.difference.powi(2) + count * mean.standard_error.powi(2)).sqrt();
    let along_paths = if along <= of_terms { 0.0 } else { along };
    StepErrors { observable: phi.name().into(), mean, deviation, along_paths }
}
