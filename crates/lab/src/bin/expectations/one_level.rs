//! Quasi-Monte Carlo on one level.

use anyhow::Result;
use mc::{Observable, Run, View};
use noise::StreamKey;
use schemes::{Nv, Sweep};
use systems::{Cosine, Problem, RigidBody};
use verify::FinalMoments;

use crate::{
    cost::{Found, MOST_STEPS},
    scrambles::{Scrambles, means},
};

/// Independent scrambles, and the points of each in the first round.
const SCRAMBLES: u64 = 32;
const FIRST_POINTS: u64 = 128;
/// Least number of steps: errors at n, n/2 and n/4 steps are compared.
const LEAST_STEPS: u64 = 4;

/// E[φ(y(T))] by `nv`, the mean of φ over both orders of the noises, and Sobol points.
///
/// Each point gives φ at n, n/2 and n/4 steps, so Richardson's R_n = (4E_n − E_{n/2})/3. Its error
/// falls as τ⁴, and (R_n − R_{n/2})/3 bounds it if it falls as τ². Steps are doubled while this is
/// significantly above ε/4, and points until the interval is ε long. A round computes all its points
/// anew, and counts.
pub fn one_level(
    problem: &Problem<RigidBody<3>, Cosine, 3>,
    key: StreamKey,
    observable: &Observable<3>,
    accuracy: f64,
) -> Result<Found> {
    let nv = Nv::of_parts();
    let orders = [nv.with_sweep(Sweep::Forward), nv.with_sweep(Sweep::Backward)];
    let runs =
        || (0..3).flat_map(|level| orders.each_ref().map(|one| Run::new(one, level))).collect();
    let values = |view: &View<'_>, p: usize, numbers: &mut [f64]| {
        let phi = |run: usize| (observable.function)(view.path(run, p));
        let [fine, half, quarter] = [0, 2, 4].map(|run| 0.5 * (phi(run) + phi(run + 1)));
        let extrapolated = |fine: f64, coarse: f64| (4.0 * fine - coarse) / 3.0;
        numbers[0] = extrapolated(fine, half);
        numbers[1] = (numbers[0] - extrapolated(half, quarter)) / 3.0;
    };
    let (mut steps, mut points, mut path_steps) = (LEAST_STEPS, FIRST_POINTS, 0);
    loop {
        let scrambles = Scrambles { key, count: SCRAMBLES, points };
        let new = || FinalMoments::new(steps / 4, 2, &values);
        let measured = scrambles.each(problem, (steps, 2), runs, new)?;
        // Both orders at n, n/2 and n/4 steps.
        path_steps += SCRAMBLES * points * (7 * steps / 2);
        let (found, failed) = means(&measured, |last| &last.moments);
        let [(value, spread), (bias, margin)] = [found[0], found[1]];
        let half_width = spread + bias.abs() + margin;
        let (biased, wide) = (bias.abs() - margin > 0.25 * accuracy, half_width > accuracy);
        let limited = 2 * path_steps > MOST_STEPS;
        if biased && !limited {
            (steps, points) = (2 * steps, FIRST_POINTS);
        } else if wide && !limited {
            points *= 2;
        } else {
            let decisions = vec![format!(
                "one level of {steps} steps, extrapolated with order 2; {SCRAMBLES} scrambles of \
                 {points} Sobol points"
            )];
            let (reached, finest_steps) = (!biased && !wide && failed == 0, steps);
            return Ok(Found { value, half_width, reached, path_steps, finest_steps, decisions });
        }
    }
}
