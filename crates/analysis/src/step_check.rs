//! **Are the steps of a run short enough?** Means and deviations at τ and at τ/2, on common noise.
//!
//! A few paths are simulated to the final time with the steps of a run and with twice as many. The
//! differences of means and of deviations, with their standard errors, say how large the step
//! errors of the run are: about twice the difference at weak order one, 4/3 of it at order two.
//! Chaotic paths part, but their means agree. What cannot be seen with so few paths is said.

use mc::{
    DriveResolution, Kept, LadderError, Observe, Problem, Setup, Statistic, View, parts::Job,
};
use noise::{Purpose, StreamKey, Truncation};
use real::{PathMask, WIDTH, elementary::exp2};
use serde::Serialize;
use stats::CrossMoments;

/// The step errors of a run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StepCheck {
    /// Number of paths that came to their end at both step sizes.
    pub paths: u64,
    /// Number of those that did not.
    pub failed: u64,
    /// |∫γ| over the last step. Above [`STIFF`] the damping outruns the step, at τ/2 as at τ, so
    /// that the two may agree on what is wrong.
    pub damping: f64,
    /// By how much the fastest motion turns in a step, in radians. Above [`TURN`] it is not
    /// resolved at τ/2 either: an average rotation by nearly ±π looks like none, and a mode that is
    /// too slow takes too little energy from the noise, both at τ as at τ/2.
    pub turn: f64,
    /// Where H(t) changes within a step by more than from step to step, at τ or τ/2, so that both
    /// may agree on what is wrong: the time, and a number of steps that resolves it, if 2¹² times
    /// as many do.
    pub unresolved: Option<(f64, Option<u64>)>,
    /// The step errors of each observable.
    pub observables: Vec<StepErrors>,
}

/// The step errors of an observable.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StepErrors {
    /// Its name.
    pub observable: String,
    /// Of its mean.
    pub mean: Halved,
    /// Of its deviation.
    pub deviation: Halved,
    /// The root mean square of the difference along paths.
    pub along_paths: f64,
}

/// A statistic at τ and at τ/2.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Halved {
    /// At τ.
    pub value: f64,
    /// That at τ minus that at τ/2.
    pub difference: f64,
    /// The standard error of the difference.
    pub standard_error: f64,
    /// What rounding may make of the difference.
    pub rounding: f64,
    /// The step error over the difference: 1/(1 − 2^{−p}) at order p, two at order one.
    pub of_error: f64,
}

/// What is known of a step error.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case", tag = "decided", content = "size")]
pub enum StepError {
    /// Below the sampling error; none larger than this was missed.
    Fine(f64),
    /// About this.
    About(f64),
    /// None was seen, and one larger than this, which is above the sampling error, would have been.
    Below(f64),
    /// None was seen, but one as large as the spread of the values would not have been.
    CannotTell,
}

/// From this ∫γ of a step on, noise and forces within the step are damped by less than a third of
/// what they should, or by more than three times.
pub const STIFF: f64 = 2.0;
/// From this turn of a step on, half a step turns by more than a right angle.
pub const TURN: f64 = std::f64::consts::PI;
/// More failed paths than this part of all: those that are left are not what the equation does.
const MAX_FAILED: f64 = 0.1;
/// Standard errors that a difference exceeds by chance with probability 0.003, 0.005 at 32 paths.
const SEEN: f64 = 3.0;
/// Standard errors that a difference which was not seen may hide.
const HIDDEN: f64 = 2.0;
/// A step error below this part of the sampling error is not worth a word.
const WORTH: f64 = 0.1;
/// Rounding relative to the terms of a mean, and of the root of a difference of their squares.
const ROUNDING: [f64; 2] = [1e-12, 1e-7];
/// Paths of the check for each path of the run, and paths that the run simulates besides for its
/// bins: three steps for each of its own make a tenth.
const SHARE: u64 = 30;
const PILOT: u64 = 1024;
/// Doublings of the steps of which it is asked whether they resolve H(t).
const MAX_DOUBLINGS: u32 = 12;
/// Most blocks: the check then sees a fiftieth of a deviation.
const MAX_BLOCKS: u64 = 256;

impl StepCheck {
    /// Whether steps of half the size would show what is wrong.
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

    /// What is known of a step error where the half-width of the sampling error is `sampling`, and
    /// the deviation of the values is `spread`.
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

/// Paths of the check of a run of `run` paths: it costs at most a tenth of the run. One where
/// neither noise nor initial values are random.
pub fn checked_paths(run: u64, problem: &Problem<'_>) -> u64 {
    let width = WIDTH as u64;
    match problem.noises == 0 && problem.initial.is_none() {
        true => 1,
        false => width * ((run.saturating_add(PILOT)) / (SHARE * width)).clamp(1, MAX_BLOCKS),
    }
}

/// Checks the steps of a run, as a piece of work of a job with the name "steps"; `None` if the
/// results are not here. `fastest` is the rate of the fastest motion, see
/// [`fastest`](inspect::facts::fastest()). It is `told` the path-steps that are done: three for each
/// step of a path.
///
/// # Errors
/// [`LadderError`] if the scheme cannot be run on twice as many steps.
pub fn step_check(
    setup: &Setup<'_>,
    observables: &[&dyn Observe],
    steps: u64,
    paths: u64,
    fastest: f64,
    (truncation, key): (Truncation, StreamKey),
    (job, told): (&Job, &(dyn Fn(u64) + Sync)),
) -> Result<Option<StepCheck>, LadderError> {
    let (twice, family) = (steps.saturating_mul(2), (key, Purpose::StepCheck));
    let ladder = setup.ladder(twice, 1, truncation, family, paths)?.telling(told);
    let initial = setup.start();
    let center = |phi: &&dyn Observe| {
        let value = phi.values(&initial, PathMask::first(1))[0];
        if value.is_finite() { value } else { 0.0 }
    };
    let centers: Vec<f64> = observables.iter().map(center).collect();
    let new = || {
        let sums = vec![CrossMoments::new(3); observables.len()];
        AtBoth { sums, steps, observables, centers: &centers }
    };
    let Some(measured) = ladder.run_in(job, "steps", paths, new) else { return Ok(None) };
    let of =
        |((phi, &center), sums): ((&&dyn Observe, &f64), &CrossMoments)| errors(*phi, center, sums);
    let end = setup.problem.t_end;
    let drive = DriveResolution::new(&setup.problem);
    let resolved = |steps: &u64| drive.unresolved(2 * steps).is_none();
    let unresolved = drive
        .unresolved(twice)
        .map(|t| (t, (1..=MAX_DOUBLINGS).map_while(|k| steps.checked_shl(k)).find(resolved)));
    let (last, dampings) = (end - end / steps as f64, setup.problem.dampings());
    Ok(Some(StepCheck {
        damping: dampings.map(|one| one.integral(last, end).abs()).fold(0.0, f64::max),
        turn: fastest * end / steps as f64,
        unresolved,
        paths: paths - measured.failed,
        failed: measured.failed,
        observables: observables
            .iter()
            .zip(&centers)
            .zip(&measured.statistic.sums)
            .map(of)
            .collect(),
    }))
}

/// For each observable the moments of a = φ_τ − c, b = φ_{τ/2} − c and a² − b².
struct AtBoth<'a> {
    sums: Vec<CrossMoments>,
    steps: u64,
    observables: &'a [&'a dyn Observe],
    centers: &'a [f64],
}

impl Statistic for AtBoth<'_> {
    fn observe(&mut self, view: &View<'_>) {
        if view.time != self.steps {
            return;
        }
        for ((phi, center), sums) in self.observables.iter().zip(self.centers).zip(&mut self.sums) {
            let values = [0, 1].map(|run| phi.values(view.state(run), view.live));
            for p in view.live.paths() {
                let [a, b] = values.map(|row| row[p] - center);
                sums.add(&[a, b, a * a - b * b]);
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

/// The step errors of an observable from its moments.
fn errors(phi: &dyn Observe, center: f64, moments: &CrossMoments) -> StepErrors {
    let (count, mean) = (moments.count() as f64, |k| moments.mean(k));
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
    let (a, b) = (mean(0), mean(1));
    // What is left of a difference of squares by rounding.
    let root = ROUNDING[1] * a.abs();
    let above = |x: f64| if x <= root { 0.0 } else { x };
    let mean = Halved {
        value: center + a,
        difference: a - b,
        standard_error: above(error([1.0, -1.0, 0.0])),
        rounding: ROUNDING[0] * (center.abs() + a.abs()),
        of_error: 1.0 / (1.0 - exp2(-phi.weak_order())),
    };
    let deviations = [0, 1].map(|k| above((count * covariance(k, k)).max(0.0).sqrt()));
    let sum = deviations[0] + deviations[1];
    let deviation = Halved {
        value: deviations[0],
        difference: deviations[0] - deviations[1],
        // Of the variance, by its linear part in the three means.
        standard_error: if sum > 0.0 { error([-2.0 * a, 2.0 * b, 1.0]) / sum } else { 0.0 },
        rounding: mean.rounding + root,
        of_error: mean.of_error,
    };
    let along_paths = (mean.difference.powi(2) + count * mean.standard_error.powi(2)).sqrt();
    StepErrors { observable: phi.name().into(), mean, deviation, along_paths }
}
