//! Orders from synthetic squared errors.

use noise::{StreamKey, WienerPath};
use stats::{Bend, CrossMoments, Rate, fit_strong, root_mean_squares};

use super::{
    Check, Expected,
    Expected::{Calibrated, Covers, Miscovers, Raised, Silent},
    Tally, naive, point_checks, rate_checks, warns,
};

/// Step sizes 2⁻⁵ … 2⁻¹².
const TAUS: [f64; 8] = [
    1.0 / 32.0,
    1.0 / 64.0,
    1.0 / 128.0,
    1.0 / 256.0,
    1.0 / 512.0,
    1.0 / 1024.0,
    1.0 / 2048.0,
    1.0 / 4096.0,
];

/// Squares C τ^{2p}(1 + bτ)(1 − τ_ref/τ)Z² of paths, with Z normal and most of its
/// variance shared between the levels of a path.
#[derive(Clone, Copy)]
struct Synthetic {
    order: f64,
    /// b.
    curvature: f64,
    /// τ_ref, if the squares are not those of differences but of errors against a run at that step.
    reference: Option<f64>,
    outliers: Option<Outliers>,
    /// Factor of the squares at every other step size: with another one than 1, no power law.
    uneven: f64,
    paths: u64,
}

/// Share of the variance of Z that the levels of a path have in common: their squares then have the
/// correlation 0.64, as errors at neighbouring steps have.
const SHARED: f64 = 0.8;

/// Some paths have larger errors on the coarse levels, as those have whose increments are clipped.
#[derive(Clone, Copy)]
struct Outliers {
    /// One path in this many.
    one_in: f64,
    /// Factor of the error.
    factor: f64,
    /// How many of the coarsest levels are hit.
    levels: usize,
}

impl Synthetic {
    const fn new(order: f64) -> Self {
        Self { order, curvature: 0.0, reference: None, outliers: None, uneven: 1.0, paths: 400 }
    }

    /// Root of the mean square of the error at the coarsest level.
    fn coarsest(&self) -> f64 {
        let factor = self
            .outliers
            .map_or(1.0, |Outliers { factor, one_in, .. }| 1.0 + (factor * factor - 1.0) / one_in);
        (self.scale(0) * factor).sqrt()
    }

    /// Mean square of the error at a level without outliers.
    fn scale(&self, level: usize) -> f64 {
        let tau = TAUS[level];
        let reference = self.reference.map_or(0.0, |reference| reference / tau);
        let uneven = if level % 2 == 1 { self.uneven } else { 1.0 };
        tau.powf(2.0 * self.order) * (1.0 + self.curvature * tau) * (1.0 - reference) * uneven
    }

    fn squares(&self, key: StreamKey) -> CrossMoments {
        let scales: [f64; TAUS.len()] = std::array::from_fn(|level| self.scale(level));
        let mut squares = CrossMoments::new(TAUS.len());
        for path in 0..self.paths {
            let mut noise = WienerPath::<1>::new(key, path);
            let shared = noise.normal();
            let mut errors = scales.map(|scale| {
                scale * (SHARED.sqrt() * shared + (1.0 - SHARED).sqrt() * noise.normal()).powi(2)
            });
            if let Some(Outliers { one_in, factor, levels }) = self.outliers {
                // For two independent normals exp(−(x² + y²)/2) is uniform.
                let (x, y) = (noise.normal(), noise.normal());
                if (-0.5 * (x * x + y * y)).exp() < 1.0 / one_in {
                    errors[..levels].iter_mut().for_each(|error| *error *= factor * factor);
                }
            }
            squares.add(&errors);
        }
        squares
    }

    fn draw(&self, key: StreamKey) -> Data {
        let squares = self.squares(key);
        let rate = fit_strong(&TAUS, &squares);
        let coarsest = root_mean_squares(&TAUS[..1], &squares);
        let point = point_checks(coarsest.first(), self.coarsest());
        let warns = warns(rate.as_ref());
        Data { order: self.order, squares, rate, point, warns }
    }
}

/// A data set with the order that is fitted to it.
struct Data {
    order: f64,
    squares: CrossMoments,
    rate: Option<Rate>,
    /// Of the root-mean-square error at the coarsest step.
    point: [bool; 3],
    warns: bool,
}

impl Data {
    fn naive(&self, bend: Option<Bend>, independent: bool) -> bool {
        naive(&TAUS, &self.squares, bend, independent, self.order)
    }
}

const POINT: &str = "strong point, coarsest";
const NORMAL_POINT: &str = "strong point, coarsest, value ± 1.96 se";
const POINT_WARNING: &str = "warning at the coarsest point";
const RATE_WARNING: &str = "warning of the rate";

/// A case: its data, what is required of the intervals of its rate, and its other checks.
fn add(
    tally: &mut Tally,
    case: &'static str,
    data: Synthetic,
    expected: Expected,
    others: fn(&Data) -> Vec<Check>,
) {
    tally.add(case, |key| {
        let drawn = data.draw(key);
        let mut checks = rate_checks(drawn.rate.as_ref(), data.order, expected);
        checks.extend(others(&drawn));
        checks
    });
}

pub fn rows(tally: &mut Tally) {
    let half = Synthetic::new(0.5);
    let one = Synthetic::new(1.0);

    let calm = |drawn: &Data| {
        let independent = "rate of a straight line with levels taken for independent";
        vec![
            (POINT, Calibrated, drawn.point[0]),
            (NORMAL_POINT, Calibrated, drawn.point[1]),
            (independent, Miscovers, drawn.naive(None, true)),
            (POINT_WARNING, Silent, drawn.point[2]),
            (RATE_WARNING, Silent, drawn.warns),
        ]
    };
    add(tally, "order ½", half, Covers, calm);
    let curved = Synthetic { curvature: 4.0, ..one };
    add(tally, "order 1, next order of the error 4τ", curved, Covers, calm);

    // The twin of differences: errors against a run of the same scheme.
    let near = Synthetic { reference: Some(TAUS[7] / 2.0), ..half };
    let case = "order ½, errors against a reference twice finer in the place of differences";
    add(tally, case, near, Miscovers, |_| Vec::new());

    tally.add("order ½ with every other mean square twice too large", |key| {
        let uneven = Synthetic { uneven: 2.0, ..half };
        let same = "warning of the rate of the same data without";
        vec![(RATE_WARNING, Raised, uneven.draw(key).warns), (same, Silent, half.draw(key).warns)]
    });

    let hit = |outliers| Synthetic { paths: 1000, outliers: Some(outliers), ..one };
    let coarse = Outliers { one_in: 2000.0, factor: 30.0, levels: 3 };
    let case = "order 1, one path in 2000 with 30 times the error at the 3 coarsest steps";
    add(tally, case, hit(coarse), Covers, |drawn| {
        let all_levels = "rate with all levels, whatever their tails";
        vec![(all_levels, Miscovers, drawn.naive(Some(Bend::LINEAR), false))]
    });
    // Here a thousand paths have ten such errors; none, and nothing to warn of, with probability
    // 4e-5. Neither interval can know of those that are absent from a data set.
    let often = Outliers { one_in: 100.0, levels: TAUS.len(), ..coarse };
    tally.add("order 1, one path in 100 with 30 times the error at all steps", |key| {
        let drawn = hit(often).draw(key);
        vec![(POINT_WARNING, Raised, drawn.point[2]), (RATE_WARNING, Raised, drawn.warns)]
    });
}
