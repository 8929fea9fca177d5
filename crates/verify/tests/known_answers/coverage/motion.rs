//! Weak orders and errors of geometric Brownian motion, which have closed forms.

use analysis::FinalMoments;
use mc::{Ladder, Run, View, bind};
use noise::{StreamKey, Truncation};
use real::Row;
use schemes::EulerMaruyama;
use stats::{CrossMoments, Expansion, weak_errors};
use systems::paper::valid;

use super::{
    Expected::{Calibrated, Miscovers, Silent},
    Tally, normal_covers, point_checks, warns,
};
use crate::library::system::{Growth, UNDAMPED, problem};

/// dX = aX dt + bX dW (Itô), X(0) = 1.
const DRIFT: f64 = 0.6;
const VOLATILITY: f64 = 0.5;
/// Step sizes 2⁻² … 2⁻⁸.
const EXPONENTS: std::ops::RangeInclusive<u32> = 2..=8;
const PATHS: u64 = 400;

/// E[X_N] − E[X(1)] = (1 + aτ)ᴺ − eᵃ of Euler–Maruyama.
fn weak_error(tau: f64) -> f64 {
    (1.0 + DRIFT * tau).powi((1.0 / tau).round() as i32) - DRIFT.exp()
}

/// The weak error as the weak panels measure it: differences between neighbouring steps, each on
/// paths of its own.
pub fn rows(tally: &mut Tally) {
    // X = x, and y = 1.
    let stratonovich = DRIFT - 0.5 * VOLATILITY * VOLATILITY;
    let system = Growth { drift: [0.0, stratonovich], noise: [0.0, VOLATILITY] };
    let motion = problem(system, UNDAMPED, [1.0; 2], 1.0);
    let taus: Vec<f64> = EXPONENTS.map(|exponent| 0.5f64.powi(exponent as i32)).collect();
    tally.add("weak error of Euler–Maruyama on geometric Brownian motion", |key| {
        let difference = |exponent: u32| -> CrossMoments {
            let own = StreamKey { experiment: key.experiment + (u64::from(exponent) << 32), ..key };
            let runs = [1, 0].map(|level| Run::new(bind(&motion, &EulerMaruyama), level)).into();
            let ladder = valid(Ladder::new(
                &mc::Problem::of(&motion),
                2 << exponent,
                1,
                Truncation::none(),
                own,
                runs,
            ));
            let values = |view: &View<'_>, difference: &mut [Row]| {
                let [one, other] = [0, 1].map(|run| view.state(run)[0]);
                difference[0] = std::array::from_fn(|p| one[p] - other[p]);
            };
            let new = || FinalMoments::new(ladder.coarse_steps(), 1, &values);
            ladder.run(PATHS, new, &|_| ()).statistic.moments
        };
        let differences: Vec<CrossMoments> = EXPONENTS.map(difference).collect();
        let (points, rate) = weak_errors(&taus, &differences, 0, Expansion::EveryPower);
        let truth = |level: usize| weak_error(taus[level]);
        // As if the tail below the finest step had no error.
        let [before, finest] = [taus.len() - 2, taus.len() - 1];
        let value = differences[before].mean(0) + 2.0 * differences[finest].mean(0);
        let se = differences[before].standard_error(0);
        let [coarse_covers, ..] = point_checks(points.first(), truth(0));
        let [fine_covers, ..] = point_checks(points.last(), truth(finest));
        let without_tail = "weak point, finest but one, with the reference taken for exact";
        vec![
            ("weak rate", Calibrated, rate.as_ref().is_some_and(|rate| rate.covers(1.0))),
            ("weak point, coarsest", Calibrated, coarse_covers),
            ("weak point, finest", Calibrated, fine_covers),
            (without_tail, Miscovers, normal_covers(value, se, truth(before))),
            ("warning of the weak rate", Silent, warns(rate.as_ref())),
        ]
    });
}
