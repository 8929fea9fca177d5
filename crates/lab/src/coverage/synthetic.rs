//! Orders from synthetic squared errors.

use stats::{CrossMoments, Logarithms, Rate, Terms, fit_strong, root_mean_squares};

use super::data::{Outliers, Synthetic};
use super::{Expected, Tally, Z, bar_encloses, encloses, point_encloses, point_warns};

/// Step sizes 2⁻⁵ … 2⁻¹².
const TAUS: [f64; 8] = [
    0.03125,
    0.015625,
    0.0078125,
    0.00390625,
    0.001953125,
    0.0009765625,
    0.00048828125,
    0.000244140625,
];
const FINEST: f64 = TAUS[7];

pub(super) fn ends(rate: &Rate) -> (f64, f64) {
    (rate.lo, rate.hi)
}

pub(super) fn bootstrap_ends(rate: &Rate) -> Option<(f64, f64)> {
    rate.bootstrap_lo.zip(rate.bootstrap_hi)
}

/// The twin that takes the levels for independent, or uses all of them whatever their tails.
pub(super) fn naive(
    taus: &[f64],
    squares: &CrossMoments,
    terms: Terms,
    independent: bool,
) -> Option<(f64, f64)> {
    let mut logarithms = Logarithms::new(taus, squares, (0..taus.len()).collect())?;
    if independent {
        logarithms.forget_covariance();
    }
    let estimate = logarithms.fit(terms)?;
    Some((estimate.order - Z * estimate.se, estimate.order + Z * estimate.se))
}

pub(super) fn rows(tally: &mut Tally<'_>) {
    use Expected::{Calibrated, Miscovers, Raised, Silent, Stated};
    let half = Synthetic::new(0.5);
    let straight = [
        ("order ½", half),
        (
            "order 1, next order of the error 4τ",
            Synthetic { curvature: 4.0, ..Synthetic::new(1.0) },
        ),
    ];
    for (case, data) in straight {
        let intervals = [
            ("rate", Calibrated),
            ("rate, bootstrap-t", Calibrated),
            ("strong point, coarsest", Calibrated),
            ("strong point, coarsest, value ± 1.96 se", Calibrated),
            ("rate of a straight line with levels taken for independent", Miscovers),
            ("warning at the coarsest point", Silent),
            ("warning of the rate", Silent),
        ];
        tally.add(case, intervals, |key| {
            let squares = data.squares(&TAUS, key);
            let rate = fit_strong(&TAUS, None, &squares);
            let truth = |_| data.mean_square(&TAUS, 0).sqrt();
            let points = root_mean_squares(&TAUS, &squares);
            [
                encloses(rate.as_ref().map(ends), data.order),
                encloses(rate.as_ref().and_then(bootstrap_ends), data.order),
                points.first().is_some_and(|point| point_encloses(point, truth)),
                points.first().is_some_and(|point| bar_encloses(point, truth)),
                encloses(naive(&TAUS, &squares, Terms::STRAIGHT, true), data.order),
                points.first().is_some_and(point_warns),
                warns(rate.as_ref()),
            ]
        });
    }
    let against_reference = [
        (
            "order ½ against a reference 4 times finer",
            Synthetic { reference: Some(FINEST / 4.0), ..half },
        ),
        (
            "order ½ against a reference twice finer, next order 4τ",
            Synthetic { reference: Some(FINEST / 2.0), curvature: 4.0, ..half },
        ),
    ];
    for (case, data) in against_reference {
        let intervals = [
            ("rate", Calibrated),
            ("rate, bootstrap-t", Calibrated),
            ("rate with the reference forgotten", Miscovers),
            ("warning of the rate", Silent),
            ("warning of the rate with the reference forgotten", Stated),
        ];
        tally.add(case, intervals, |key| {
            let squares = data.squares(&TAUS, key);
            let rate = fit_strong(&TAUS, data.reference, &squares);
            [
                encloses(rate.as_ref().map(ends), data.order),
                encloses(rate.as_ref().and_then(bootstrap_ends), data.order),
                encloses(
                    naive(&TAUS, &squares, Terms { reference: None, curvature: true }, false),
                    data.order,
                ),
                warns(rate.as_ref()),
                warns(fit_strong(&TAUS, None, &squares).as_ref()),
            ]
        });
    }
    let uneven = Synthetic { uneven: 2.0, ..half };
    tally.add(
        "order ½ with every other mean square twice too large",
        [("warning of the rate", Raised), ("warning of the rate of the same data without", Silent)],
        |key| {
            [uneven, half]
                .map(|data| warns(fit_strong(&TAUS, None, &data.squares(&TAUS, key)).as_ref()))
        },
    );
    let outliers = Outliers { one_in: 2000.0, factor: 30.0, levels: 3 };
    let one = Synthetic { paths: 1000, ..Synthetic::new(1.0) };
    let coarse = Synthetic { outliers: Some(outliers), ..one };
    let intervals = [
        ("rate", Calibrated),
        ("rate, bootstrap-t", Calibrated),
        ("rate with all levels, whatever their tails", Miscovers),
        ("strong point, coarsest", Stated),
        ("strong point, coarsest, value ± 1.96 se", Stated),
    ];
    tally.add(
        "order 1, one path in 2000 with 30 times the error at the 3 coarsest steps",
        intervals,
        |key| {
            let squares = coarse.squares(&TAUS, key);
            let rate = fit_strong(&TAUS, None, &squares);
            let truth = |_| coarse.mean_square(&TAUS, 0).sqrt();
            let points = root_mean_squares(&TAUS, &squares);
            [
                encloses(rate.as_ref().map(ends), coarse.order),
                encloses(rate.as_ref().and_then(bootstrap_ends), coarse.order),
                encloses(
                    naive(&TAUS, &squares, Terms { reference: None, curvature: true }, false),
                    coarse.order,
                ),
                points.first().is_some_and(|point| point_encloses(point, truth)),
                points.first().is_some_and(|point| bar_encloses(point, truth)),
            ]
        },
    );
    let everywhere = Outliers { levels: TAUS.len(), ..outliers };
    let seldom = Synthetic { outliers: Some(everywhere), ..one };
    tally.add(
        "order 1, one path in 2000 with 30 times the error at all steps",
        [("rate", Stated), ("rate, bootstrap-t", Stated)],
        |key| {
            let rate = fit_strong(&TAUS, None, &seldom.squares(&TAUS, key));
            [
                encloses(rate.as_ref().map(ends), seldom.order),
                encloses(rate.as_ref().and_then(bootstrap_ends), seldom.order),
            ]
        },
    );
    // Here a thousand paths have ten such errors; none, and nothing to warn of, with probability
    // 4e-5.
    let often = Synthetic { outliers: Some(Outliers { one_in: 100.0, ..everywhere }), ..one };
    let intervals = [
        ("rate", Stated),
        ("rate, bootstrap-t", Stated),
        ("strong point, coarsest", Stated),
        ("warning at the coarsest point", Raised),
        ("warning of the rate", Raised),
    ];
    tally.add("order 1, one path in 100 with 30 times the error at all steps", intervals, |key| {
        let squares = often.squares(&TAUS, key);
        let rate = fit_strong(&TAUS, None, &squares);
        let points = root_mean_squares(&TAUS, &squares);
        [
            encloses(rate.as_ref().map(ends), often.order),
            encloses(rate.as_ref().and_then(bootstrap_ends), often.order),
            points
                .first()
                .is_some_and(|point| point_encloses(point, |_| often.mean_square(&TAUS, 0).sqrt())),
            points.first().is_some_and(point_warns),
            warns(rate.as_ref()),
        ]
    });
}

/// Whether there is a rate with a warning.
pub(super) fn warns(rate: Option<&Rate>) -> bool {
    rate.is_some_and(|rate| rate.warning.is_some())
}
