//! Orders and errors of geometric Brownian motion, whose mean-square and weak errors have closed forms.

use mc::CrossMoments;
use noise::StreamKey;

use super::data::Geometric;
use super::synthetic::{bootstrap_ends, ends, naive};
use super::{Expected, Tally, Z, encloses, point_encloses};
use crate::order::{Terms, fit_strong, root_mean_square_interval};
use crate::strong::root_mean_squares;
use crate::weak::weak_series;

pub(super) fn rows(tally: &mut Tally<'_>) {
    use Expected::{Calibrated, Miscovers, Warned};
    let euler = Geometric { drift: 0.1, volatility: 0.25, milstein: false, first: 2, last: 7, paths: 1000 };
    let milstein = Geometric { drift: 0.1, volatility: 0.25, milstein: true, first: 4, last: 9, paths: 600 };
    let cases = [
        ("Euler–Maruyama on geometric Brownian motion, 1000 paths", euler, 0.5, Warned),
        ("Milstein on geometric Brownian motion, 600 paths", milstein, 1.0, Warned),
    ];
    for (case, motion, order, coarse) in cases {
        let taus = motion.taus();
        let finest = taus.len() - 1;
        let intervals = [
            ("rate", Calibrated),
            ("rate, bootstrap-t", Calibrated),
            ("rate with levels taken for independent", Miscovers),
            ("strong point, coarsest", coarse),
            ("strong point, coarsest, bootstrap-t", Calibrated),
            ("strong point, finest", Calibrated),
            ("strong point, finest, as if errors were normal", Miscovers),
        ];
        tally.add(case, intervals, |key| {
            let mut squares = CrossMoments::new(taus.len());
            motion.for_each_path(key, |solutions, exact| {
                squares.add(&solutions.iter().map(|solution| (solution - exact).powi(2)).collect::<Vec<_>>());
            });
            let rate = fit_strong(&taus, None, &squares);
            let points = root_mean_squares(&taus, &squares);
            let truth = |tau: f64| motion.mean_square(tau).sqrt();
            // The mean of n squares of centred normals has the relative standard error √(2/n).
            let normal = 0.5 * Z * (2.0 / motion.paths as f64).sqrt();
            let measured = squares.mean(finest).sqrt();
            [
                encloses(rate.as_ref().map(ends), order),
                encloses(rate.as_ref().and_then(bootstrap_ends), order),
                encloses(naive(&taus, &squares, Terms { reference: None, curvature: true }, true), order),
                points.first().is_some_and(|point| point_encloses(point, truth)),
                encloses(root_mean_square_interval(&squares, 0), truth(taus[0])),
                points.last().is_some_and(|point| point_encloses(point, truth)),
                encloses(Some((measured * (1.0 - normal), measured * (1.0 + normal))), truth(taus[finest])),
            ]
        });
    }
    weak(tally);
}

/// The weak error as the weak panels measure it: differences between neighbouring steps, and a Richardson tail from
/// paths of its own.
fn weak(tally: &mut Tally<'_>) {
    use Expected::{Calibrated, Miscovers};
    let motion = Geometric { drift: 0.6, volatility: 0.5, milstein: false, first: 2, last: 8, paths: 400 };
    let tail = Geometric { first: 8, last: 9, ..motion };
    let taus = motion.taus();
    let intervals = [
        ("weak rate", Calibrated),
        ("weak point, coarsest", Calibrated),
        ("weak point, finest", Calibrated),
        ("weak point, finest but one, with the reference taken for exact", Miscovers),
    ];
    tally.add("weak error of Euler–Maruyama on geometric Brownian motion", intervals, |key| {
        let mut main = CrossMoments::new(taus.len() - 1);
        motion.for_each_path(key, |solutions, _| {
            main.add(&solutions.windows(2).map(|pair| pair[0] - pair[1]).collect::<Vec<_>>());
        });
        let mut rest = CrossMoments::new(1);
        let own = StreamKey { experiment: key.experiment + (1 << 39), ..key };
        tail.for_each_path(own, |solutions, _| rest.add(&[solutions[0] - solutions[1]]));
        let series = weak_series("y1", &taus, &main, &rest);
        let truth = |tau: f64| motion.weak_error(tau);
        // The twin: as if 2d̃ had no error.
        let (before, last) = (taus.len() - 2, taus.len() - 1);
        let forgetful = main.covariance_of_means(last - 1, last - 1).sqrt();
        let value = main.mean(last - 1) + 2.0 * rest.mean(0);
        [
            encloses(series.rate.as_ref().map(ends), 1.0),
            series.points.first().is_some_and(|point| point_encloses(point, truth)),
            series.points.last().is_some_and(|point| point_encloses(point, truth)),
            encloses(Some((value - Z * forgetful, value + Z * forgetful)), truth(taus[before])),
        ]
    });
}
