//! How often intervals cover the truth.

mod data;

use mc::CrossMoments;
use noise::StreamKey;
use rayon::prelude::*;

use crate::order::{Logarithms, Terms, fit_strong, fit_weak};
use crate::results::{Point, Rate};
use data::{Geometric, Outliers, Synthetic};

/// How often one kind of interval covered the truth.
#[derive(Clone, Debug, PartialEq)]
pub struct CoverageRow {
    /// The data.
    pub case: &'static str,
    /// The interval.
    pub interval: &'static str,
    /// Its nominal coverage.
    pub nominal: f64,
    /// Data sets whose interval contains the truth.
    pub covered: u64,
    /// Data sets.
    pub replications: u64,
}

const TAUS: [f64; 8] =
    [0.03125, 0.015625, 0.0078125, 0.00390625, 0.001953125, 0.0009765625, 0.00048828125, 0.000244140625];

fn tally<const N: usize>(
    rows: &mut Vec<CoverageRow>,
    case: &'static str,
    intervals: [&'static str; N],
    replications: u64,
    covered: impl Fn(u64) -> [bool; N] + Sync,
) {
    let start = std::time::Instant::now();
    let counts = (0..replications).into_par_iter().map(|r| covered(r).map(u64::from)).reduce(
        || [0; N],
        |mut a, b| {
            a.iter_mut().zip(b).for_each(|(a, b)| *a += b);
            a
        },
    );
    eprintln!("{case} {:?}", start.elapsed());
    for (interval, covered) in intervals.into_iter().zip(counts) {
        rows.push(CoverageRow { case, interval, nominal: 0.95, covered, replications });
    }
}

fn contains(rate: Option<&Rate>, order: f64) -> bool {
    rate.is_some_and(|rate| rate.lo <= order && order <= rate.hi)
}
fn boot(rate: Option<&Rate>, order: f64) -> bool {
    rate.is_some_and(|rate| rate.bootstrap_lo.unwrap() <= order && order <= rate.bootstrap_hi.unwrap())
}

fn diagonal(taus: &[f64], squares: &CrossMoments, terms: Terms, order: f64) -> bool {
    let mut l = Logarithms::new(taus, squares, (0..taus.len()).collect()).unwrap();
    l.forget_covariance();
    let e = l.fit(terms).unwrap();
    (e.order - order).abs() <= 1.96 * e.se
}
fn plain(taus: &[f64], squares: &CrossMoments, terms: Terms, order: f64) -> bool {
    let l = Logarithms::new(taus, squares, (0..taus.len()).collect()).unwrap();
    let e = l.fit(terms).unwrap();
    (e.order - order).abs() <= 1.96 * e.se
}

/// Coverage.
pub fn coverage(replications: u64, seed: u64) -> Vec<CoverageRow> {
    let mut rows = Vec::new();
    let base = Synthetic::new(0.5);
    let heavy = Outliers { one_in: 2000.0, factor: 30.0, levels: 3 };
    for (i, (case, s)) in [
        ("half", base),
        ("one", Synthetic::new(1.0)),
        ("half curv4", Synthetic { curvature: 4.0, ..base }),
        ("half curv16", Synthetic { curvature: 16.0, ..base }),
        ("half ref/4", Synthetic { reference: Some(TAUS[7] / 4.0), ..base }),
        ("half ref/2", Synthetic { reference: Some(TAUS[7] / 2.0), ..base }),
        ("half ref/2 curv", Synthetic { reference: Some(TAUS[7] / 2.0), curvature: 4.0, ..base }),
        ("half n100", Synthetic { paths: 100, ..base }),
        ("heavy 400", Synthetic { outliers: Some(heavy), ..Synthetic::new(1.0) }),
        ("heavy 2000", Synthetic { outliers: Some(heavy), paths: 2000, ..Synthetic::new(1.0) }),
        ("heavy all 400", Synthetic { outliers: Some(Outliers { levels: 8, ..heavy }), ..Synthetic::new(1.0) }),
    ]
    .into_iter()
    .enumerate()
    {
        tally(&mut rows, case, ["rate", "boot", "plain", "diagonal", "noref"], replications, |r| {
            let squares = s.squares(&TAUS, StreamKey { seed, experiment: ((i as u64) << 32) + r });
            let rate = fit_strong(&TAUS, s.reference, &squares);
            let terms = Terms { reference: s.reference, curvature: true };
            [
                contains(rate.as_ref(), s.order),
                boot(rate.as_ref(), s.order),
                plain(&TAUS, &squares, terms, s.order),
                diagonal(&TAUS, &squares, terms, s.order),
                contains(fit_strong(&TAUS, None, &squares).as_ref(), s.order),
            ]
        });
    }
    for (i, (case, g)) in [
        ("gbm em .3 .5", Geometric { drift: 0.3, volatility: 0.5, milstein: false, first: 2, last: 8, paths: 400 }),
        ("gbm em .1 .25", Geometric { drift: 0.1, volatility: 0.25, milstein: false, first: 2, last: 8, paths: 400 }),
        ("gbm mil", Geometric { drift: 0.3, volatility: 0.25, milstein: true, first: 2, last: 8, paths: 400 }),
        ("gbm mil 1000", Geometric { drift: 0.3, volatility: 0.25, milstein: true, first: 2, last: 8, paths: 1000 }),
    ]
    .into_iter()
    .enumerate()
    {
        let taus = g.taus();
        tally(&mut rows, case, ["rate", "boot", "plain", "diagonal", "coarse", "fine", "bcoarse", "bfine", "neff<30", "neff<100", "median width >.1"], replications, |r| {
            let mut squares = CrossMoments::new(taus.len());
            g.for_each_path(StreamKey { seed, experiment: ((100 + i as u64) << 32) + r }, |x, exact| {
                squares.add(&x.iter().map(|x| (x - exact).powi(2)).collect::<Vec<_>>());
            });
            let rate = fit_strong(&taus, None, &squares);
            let terms = Terms { reference: None, curvature: true };
            let order = if g.milstein { 1.0 } else { 0.5 };
            let points = crate::strong::root_mean_squares(&taus, &squares);
            let point = |l: usize| match points[l] {
                Point::Error { tau, value, se } => (value - g.mean_square(tau).sqrt()).abs() <= 1.96 * se,
                Point::Value { .. } => false,
            };
            let bpoint = |l: usize| {
                let (lo, hi) = crate::order::root_mean_square_interval(&squares, l).unwrap();
                let truth = g.mean_square(taus[l]).sqrt();
                lo <= truth && truth <= hi
            };
            [
                contains(rate.as_ref(), order),
                boot(rate.as_ref(), order),
                plain(&taus, &squares, terms, order),
                diagonal(&taus, &squares, terms, order),
                point(0),
                point(taus.len() - 1),
                bpoint(0),
                bpoint(taus.len() - 1),
                squares.effective_samples(0) < 30.0,
                squares.effective_samples(0) < 100.0,
                rate.as_ref().unwrap().hi - rate.as_ref().unwrap().lo > 0.1,
            ]
        });
    }
    let g = Geometric { drift: 0.6, volatility: 0.5, milstein: false, first: 2, last: 8, paths: 400 };
    let taus = g.taus();
    let tail = Geometric { first: 8, last: 9, ..g };
    tally(&mut rows, "weak", ["rate", "coarse", "fine", "none"], replications, |r| {
        let mut main = CrossMoments::new(taus.len() - 1);
        g.for_each_path(StreamKey { seed, experiment: (200 << 32) + r }, |x, _| {
            main.add(&x.windows(2).map(|x| x[0] - x[1]).collect::<Vec<_>>());
        });
        let mut rest = CrossMoments::new(1);
        tail.for_each_path(StreamKey { seed, experiment: (201 << 32) + r }, |x, _| rest.add(&[x[0] - x[1]]));
        let series = crate::weak::weak_series("y1", &taus, &main, &rest);
        let point = |l: usize| match series.points[l] {
            Point::Error { tau, value, se } => (value - g.weak_error(tau)).abs() <= 1.96 * se,
            Point::Value { .. } => false,
        };
        [contains(series.rate.as_ref(), 1.0), point(0), point(taus.len() - 1), series.rate.is_none()]
    });
    let _ = fit_weak;
    rows
}
