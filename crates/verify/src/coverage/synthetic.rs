//! Orders from synthetic squared errors.

use mc::CrossMoments;

use super::data::{Outliers, Synthetic};
use super::{Expected, Tally, Z, encloses, point_encloses};
use crate::order::{Logarithms, Terms, fit_strong};
use crate::results::Rate;
use crate::strong::root_mean_squares;

/// Step sizes 2⁻⁵ … 2⁻¹².
const TAUS: [f64; 8] =
    [0.03125, 0.015625, 0.0078125, 0.00390625, 0.001953125, 0.0009765625, 0.00048828125, 0.000244140625];
const FINEST: f64 = TAUS[7];

pub(super) fn ends(rate: &Rate) -> (f64, f64) {
    (rate.lo, rate.hi)
}

pub(super) fn bootstrap_ends(rate: &Rate) -> Option<(f64, f64)> {
    rate.bootstrap_lo.zip(rate.bootstrap_hi)
}

/// The twin that takes the levels for independent, or uses all of them whatever their tails.
pub(super) fn naive(taus: &[f64], squares: &CrossMoments, terms: Terms, independent: bool) -> Option<(f64, f64)> {
    let mut logarithms = Logarithms::new(taus, squares, (0..taus.len()).collect())?;
    if independent {
        logarithms.forget_covariance();
    }
    let estimate = logarithms.fit(terms)?;
    Some((estimate.order - Z * estimate.se, estimate.order + Z * estimate.se))
}

pub(super) fn rows(tally: &mut Tally<'_>) {
    use Expected::{Calibrated, Miscovers, Warned};
    let half = Synthetic::new(0.5);
    let straight = [
        ("order ½", half),
        ("order 1, next order of the error 4τ", Synthetic { curvature: 4.0, ..Synthetic::new(1.0) }),
    ];
    for (case, data) in straight {
        let intervals = [
            ("rate", Calibrated),
            ("rate, bootstrap-t", Calibrated),
            ("strong point, coarsest", Calibrated),
            ("strong point, bootstrap-t", Calibrated),
            ("rate of a straight line with levels taken for independent", Miscovers),
        ];
        tally.add(case, intervals, |key| {
            let squares = data.squares(&TAUS, key);
            let rate = fit_strong(&TAUS, None, &squares);
            let truth = |level: usize| data.mean_square(&TAUS, level).sqrt();
            [
                encloses(rate.as_ref().map(ends), data.order),
                encloses(rate.as_ref().and_then(bootstrap_ends), data.order),
                root_mean_squares(&TAUS, &squares).first().is_some_and(|point| point_encloses(point, |_| truth(0))),
                encloses(crate::order::root_mean_square_interval(&squares, 0), truth(0)),
                encloses(naive(&TAUS, &squares, Terms::STRAIGHT, true), data.order),
            ]
        });
    }
    let against_reference = [
        ("order ½ against a reference 4 times finer", Synthetic { reference: Some(FINEST / 4.0), ..half }),
        (
            "order ½ against a reference twice finer, next order 4τ",
            Synthetic { reference: Some(FINEST / 2.0), curvature: 4.0, ..half },
        ),
    ];
    for (case, data) in against_reference {
        let intervals =
            [("rate", Calibrated), ("rate, bootstrap-t", Calibrated), ("rate with the reference forgotten", Miscovers)];
        tally.add(case, intervals, |key| {
            let squares = data.squares(&TAUS, key);
            let rate = fit_strong(&TAUS, data.reference, &squares);
            [
                encloses(rate.as_ref().map(ends), data.order),
                encloses(rate.as_ref().and_then(bootstrap_ends), data.order),
                encloses(naive(&TAUS, &squares, Terms { reference: None, curvature: true }, false), data.order),
            ]
        });
    }
    let outliers = Outliers { one_in: 2000.0, factor: 30.0, levels: 3 };
    let one = Synthetic { paths: 1000, ..Synthetic::new(1.0) };
    let coarse = Synthetic { outliers: Some(outliers), ..one };
    let intervals = [
        ("rate", Calibrated),
        ("rate, bootstrap-t", Calibrated),
        ("rate with all levels, whatever their tails", Miscovers),
        ("strong point, coarsest", Warned),
        ("strong point, bootstrap-t", Warned),
    ];
    tally.add("order 1, one path in 2000 with 30 times the error at the 3 coarsest steps", intervals, |key| {
        let squares = coarse.squares(&TAUS, key);
        let rate = fit_strong(&TAUS, None, &squares);
        let truth = coarse.mean_square(&TAUS, 0).sqrt();
        [
            encloses(rate.as_ref().map(ends), coarse.order),
            encloses(rate.as_ref().and_then(bootstrap_ends), coarse.order),
            encloses(naive(&TAUS, &squares, Terms { reference: None, curvature: true }, false), coarse.order),
            root_mean_squares(&TAUS, &squares).first().is_some_and(|point| point_encloses(point, |_| truth)),
            encloses(crate::order::root_mean_square_interval(&squares, 0), truth),
        ]
    });
    let everywhere = Synthetic { outliers: Some(Outliers { levels: TAUS.len(), ..outliers }), ..one };
    tally.add(
        "order 1, one path in 2000 with 30 times the error at all steps",
        [("rate", Warned), ("rate, bootstrap-t", Warned)],
        |key| {
            let rate = fit_strong(&TAUS, None, &everywhere.squares(&TAUS, key));
            [
                encloses(rate.as_ref().map(ends), everywhere.order),
                encloses(rate.as_ref().and_then(bootstrap_ends), everywhere.order),
            ]
        },
    );
}
