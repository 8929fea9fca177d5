//! Weak orders and errors of geometric Brownian motion, which have closed forms.

use noise::StreamKey;
use stats::{
    CrossMoments,
    Expected::{Calibrated, Miscovers, Silent},
    normal_covers, weak_errors,
};

use super::{Tally, geometric::Geometric, point_checks, warns};

/// The weak error as the weak panels measure it: differences between neighbouring steps, each on
/// paths of its own.
pub fn rows(tally: &mut Tally) {
    let (first, last) = (2, 8);
    let motion = Geometric { drift: 0.6, volatility: 0.5, first, last, paths: 400 };
    let taus = motion.taus();
    tally.add("weak error of Euler–Maruyama on geometric Brownian motion", |key| {
        let difference = |exponent: u32| {
            let pair = Geometric { first: exponent, last: exponent + 1, ..motion };
            let own = StreamKey { experiment: key.experiment + (u64::from(exponent) << 32), ..key };
            let mut moments = CrossMoments::new(1);
            pair.for_each_path(own, |solutions, _| moments.add(&[solutions[0] - solutions[1]]));
            moments
        };
        let differences: Vec<CrossMoments> = (first..=last).map(difference).collect();
        let (points, rate) = weak_errors(&taus, &differences.iter().collect::<Vec<_>>());
        let truth = |level: usize| motion.weak_error(taus[level]);
        // As if the tail below the finest step had no error.
        let [before, finest] = [taus.len() - 2, taus.len() - 1];
        let value = differences[before].mean(0) + 2.0 * differences[finest].mean(0);
        let se = differences[before].covariance_of_means(0, 0).sqrt();
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
