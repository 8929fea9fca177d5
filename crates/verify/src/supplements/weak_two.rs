//! `rigid-body-weak-two`: the weak order of `nv` on the problem of the weak panels.
//!
//! The bias of `nv` is of order τ²: at the steps of the weak panels it is lost in the noise of
//! random paths. So steps are long here, paths few-dimensional integrals, and points scrambled
//! Sobol points. φ is averaged over both orders of the noises, as `expectation::Expect` does. The
//! difference between two step sizes is that of both orders at the coarse one, and at the fine one
//! of the one order, and of the other order on swapped increments: its variance falls like τ². Each
//! difference has scrambles of its own, whose means are the samples.

use mc::{NextNoise, Problem, bind_owned};
use noise::QuasiWiener;
use schemes::{Nv, Sweep};

use crate::{
    panels::weak::{difference_ladder, moments_of, series},
    *,
};

/// Number of scrambles: many, so that their mean is nearly normal.
const SCRAMBLES: u64 = 64;

/// Test functions, of the twelve of the weak panels, whose bias stands out most from the noise; the
/// bias of functions of y₃ is a tenth of that of y₂.
const OBSERVABLES: [Observable<3>; 3] =
    [phi("y2", |y| y[1]), phi("y1^2", |y| y[0] * y[0]), phi("y2^2", |y| y[1] * y[1])];

/// Weak errors and orders of `nv`.
pub fn measure(conditions: &Conditions) -> Findings {
    let problem = rigid_body_three_noises(1.0);
    let points: u64 = conditions.choose(1 << 15, 1 << 9);
    let samples = SCRAMBLES * points;
    // Step sizes 2⁻¹ … 2⁻⁵.
    let grid = [1, 2, 3, 4].map(|l| DifferenceSamples { tau: power_of_half(l), samples });
    let differences =
        |part, sizes: &DifferenceSamples| differences(conditions.key(part), sizes.tau, points);
    let (series, failures) = series("nv", &grid, &OBSERVABLES, Expansion::EvenPowers, differences);
    let claim = |Series { quantity, rate, .. }: &Series| {
        let statement = format!("nv has weak order 2 for φ = {quantity}");
        let measured = Evidence::order_bound(2.0, rate.clone());
        Claim::new("weak-two", statement, measured).about(conditions.id, "nv").proven(false)
    };
    let claims = series.iter().map(claim).collect();
    let words = [
        "Rigid body, three noises: weak error of nv",
        BODY_3,
        "Not in the paper, whose scheme has weak order 1.",
    ];
    let reference = format!(
        "sums of differences between neighbouring steps, of means over both orders of the noises; \
         {SCRAMBLES} scrambles of {points} Sobol points for each; below the finest step a \
         Richardson tail. The order is fitted to the differences, without the tail."
    );
    let panel = Panel {
        samples,
        reference,
        differences: grid.to_vec(),
        failures,
        series,
        ..panel(words, conditions.id, Kind::Weak, &Problem::of(&problem), "τ = 2^-1 … 2^-4")
    };
    Findings { panels: vec![panel], claims }
}

/// Moments over scrambles of the mean differences between a step size and half of it, and the paths
/// that failed.
fn differences(key: StreamKey, tau: f64, points: u64) -> (CrossMoments, Vec<String>) {
    let problem = rigid_body_three_noises(1.0);
    let nv = |sweep| bind_owned(&problem, Box::new(Nv { sweep }));
    let [forward, backward] = [Sweep::Forward, Sweep::Backward].map(nv);
    let steps = (2.0 * problem.t_end() / tau).round() as u64;
    let (mut moments, mut failures) = (CrossMoments::new(OBSERVABLES.len()), Vec::new());
    for scramble in 0..SCRAMBLES {
        let runs = vec![
            Run::new(forward.clone(), 1),
            Run::new(backward.clone(), 1),
            Run::new(forward.clone(), 0),
            Run::swapped(backward.clone(), 0),
        ];
        let wiener = valid(QuasiWiener::new(key, scramble, steps, 3, problem.t_end()));
        // The increments of 32 points of the scramble, step by step.
        let increments = move |first_point| -> NextNoise {
            let mut all = vec![[0.0; WIDTH]; wiener.dimensions()];
            wiener.block(first_point, &mut all);
            let mut next = 0;
            Box::new(move |noise| {
                noise.increments.copy_from_slice(&all[next..next + 3]);
                next += 3;
            })
        };
        let ladder = difference_ladder(&Problem::of(&problem), tau, key, runs);
        let (found, failed) =
            moments_of(&ladder.with_noise(increments), points, OBSERVABLES.len(), |view, p, f| {
                let phi = |run| (OBSERVABLES[f].function)(view.path(run, p));
                0.5 * (phi(0) + phi(1) - (phi(2) + phi(3)))
            });
        failures.extend(failed);
        moments.add(&found.means());
    }
    (moments, failures)
}
