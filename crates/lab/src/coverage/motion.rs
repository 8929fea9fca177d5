//! Orders and errors of geometric Brownian motion, whose mean-square and weak errors have closed
//! forms.

use noise::StreamKey;
use stats::{
    Bend, CrossMoments,
    Expected::{Calibrated, Miscovers, Silent, Stated},
    fit_strong, normal_covers, root_mean_squares, weak_errors,
};

use super::{Tally, geometric::Geometric, naive, point_checks, rate_checks, warns};

pub fn rows(tally: &mut Tally) {
    let euler =
        Geometric { drift: 0.1, volatility: 0.25, milstein: false, first: 2, last: 7, paths: 1000 };
    let milstein = Geometric { milstein: true, first: 4, last: 9, paths: 600, ..euler };
    strong(tally, "Euler–Maruyama on geometric Brownian motion, 1000 paths", euler, 0.5);
    strong(tally, "Milstein on geometric Brownian motion, 600 paths", milstein, 1.0);
    weak(tally);
}

fn strong(tally: &mut Tally, case: &'static str, motion: Geometric, order: f64) {
    let taus = motion.taus();
    let finest = taus.len() - 1;
    tally.add(case, |key| {
        let mut squares = CrossMoments::new(taus.len());
        motion.for_each_path(key, |solutions, exact| {
            let errors = solutions.iter().map(|solution| (solution - exact).powi(2));
            squares.add(&errors.collect::<Vec<_>>());
        });
        let rate = fit_strong(&taus, &squares);
        let points = root_mean_squares(&taus, &squares);
        let truth = |level: usize| motion.mean_square(taus[level]).sqrt();
        let [coarse, coarse_normal, _] = point_checks(points.first(), truth(0));
        let [fine, fine_normal, fine_warns] = point_checks(points.last(), truth(finest));
        // The mean of n squares of centred normals has the relative standard error √(2/n).
        let measured = squares.mean(finest).sqrt();
        let normal_se = 0.5 * measured * (2.0 / motion.paths as f64).sqrt();
        let as_normal = normal_covers(measured, normal_se, truth(finest));
        let independent = naive(&taus, &squares, Some(Bend::LINEAR), true, order);
        let mut checks = rate_checks(rate.as_ref(), order, Calibrated);
        checks.extend([
            ("rate with levels taken for independent", Miscovers, independent),
            ("strong point, coarsest", Calibrated, coarse),
            ("strong point, coarsest, value ± 1.96 se", Stated, coarse_normal),
            ("strong point, finest", Calibrated, fine),
            ("strong point, finest, value ± 1.96 se", Stated, fine_normal),
            ("strong point, finest, as if errors were normal", Miscovers, as_normal),
            ("warning at the finest point", Silent, fine_warns),
            ("warning of the rate", Silent, warns(rate.as_ref())),
        ]);
        checks
    });
}

/// The weak error as the weak panels measure it: differences between neighbouring steps, each on
/// paths of its own.
fn weak(tally: &mut Tally) {
    let (first, last) = (2, 8);
    let motion =
        Geometric { drift: 0.6, volatility: 0.5, milstein: false, first, last, paths: 400 };
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
