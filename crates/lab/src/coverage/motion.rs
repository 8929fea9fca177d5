//! Orders and errors of geometric Brownian motion, whose mean-square and weak errors have closed
//! forms.

use noise::StreamKey;
use stats::{CrossMoments, Terms, fit_strong, root_mean_squares};

use super::data::Geometric;
use super::synthetic::{bootstrap_ends, ends, naive, warns};
use super::{Expected, Tally, Z, bar_encloses, encloses, point_encloses, point_warns};
use crate::panels::weak::weak_series;

pub(super) fn rows(tally: &mut Tally<'_>) {
    use Expected::{Calibrated, Miscovers, Silent, Stated};
    let euler =
        Geometric { drift: 0.1, volatility: 0.25, milstein: false, first: 2, last: 7, paths: 1000 };
    let milstein =
        Geometric { drift: 0.1, volatility: 0.25, milstein: true, first: 4, last: 9, paths: 600 };
    let cases = [
        ("Euler–Maruyama on geometric Brownian motion, 1000 paths", euler, 0.5),
        ("Milstein on geometric Brownian motion, 600 paths", milstein, 1.0),
    ];
    for (case, motion, order) in cases {
        let taus = motion.taus();
        let finest = taus.len() - 1;
        let intervals = [
            ("rate", Calibrated),
            ("rate, bootstrap-t", Calibrated),
            ("rate with levels taken for independent", Miscovers),
            ("strong point, coarsest", Calibrated),
            ("strong point, coarsest, value ± 1.96 se", Stated),
            ("strong point, finest", Calibrated),
            ("strong point, finest, value ± 1.96 se", Stated),
            ("strong point, finest, as if errors were normal", Miscovers),
            ("warning at the finest point", Silent),
            ("warning of the rate", Silent),
        ];
        tally.add(case, intervals, |key| {
            let mut squares = CrossMoments::new(taus.len());
            motion.for_each_path(key, |solutions, exact| {
                squares.add(
                    &solutions
                        .iter()
                        .map(|solution| (solution - exact).powi(2))
                        .collect::<Vec<_>>(),
                );
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
                encloses(
                    naive(&taus, &squares, Terms { reference: None, curvature: true }, true),
                    order,
                ),
                points.first().is_some_and(|point| point_encloses(point, truth)),
                points.first().is_some_and(|point| bar_encloses(point, truth)),
                points.last().is_some_and(|point| point_encloses(point, truth)),
                points.last().is_some_and(|point| bar_encloses(point, truth)),
                encloses(
                    Some((measured * (1.0 - normal), measured * (1.0 + normal))),
                    truth(taus[finest]),
                ),
                points.last().is_some_and(point_warns),
                warns(rate.as_ref()),
            ]
        });
    }
    weak(tally);
}

/// The weak error as the weak panels measure it: differences between neighbouring steps, each on
/// paths of its own.
fn weak(tally: &mut Tally<'_>) {
    use Expected::{Calibrated, Miscovers, Silent};
    let (first, last) = (2, 8);
    let motion =
        Geometric { drift: 0.6, volatility: 0.5, milstein: false, first, last, paths: 400 };
    let taus = motion.taus();
    let intervals = [
        ("weak rate", Calibrated),
        ("weak point, coarsest", Calibrated),
        ("weak point, finest", Calibrated),
        ("weak point, finest but one, with the reference taken for exact", Miscovers),
        ("warning of the weak rate", Silent),
    ];
    tally.add("weak error of Euler–Maruyama on geometric Brownian motion", intervals, |key| {
        let differences: Vec<CrossMoments> = (first..=last)
            .map(|exponent| {
                let pair = Geometric { first: exponent, last: exponent + 1, ..motion };
                let own =
                    StreamKey { experiment: key.experiment + (u64::from(exponent) << 32), ..key };
                let mut moments = CrossMoments::new(1);
                pair.for_each_path(own, |solutions, _| moments.add(&[solutions[0] - solutions[1]]));
                moments
            })
            .collect();
        let series = weak_series("y1", &taus, &differences.iter().collect::<Vec<_>>());
        let truth = |tau: f64| motion.weak_error(tau);
        // The twin: as if the tail had no error.
        let [before, finest] = [&differences[taus.len() - 2], &differences[taus.len() - 1]];
        let forgetful = before.covariance_of_means(0, 0).sqrt();
        let value = before.mean(0) + 2.0 * finest.mean(0);
        [
            encloses(series.rate.as_ref().map(ends), 1.0),
            series.points.first().is_some_and(|point| point_encloses(point, truth)),
            series.points.last().is_some_and(|point| point_encloses(point, truth)),
            encloses(
                Some((value - Z * forgetful, value + Z * forgetful)),
                truth(taus[taus.len() - 2]),
            ),
            warns(series.rate.as_ref()),
        ]
    });
}
