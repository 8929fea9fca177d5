//! The bins of a histogram.

use real::WIDTH;
use serde::{Deserialize, Serialize};

/// Bins of equal width, with an underflow below and an overflow above. Bin number k, counted from
/// 0, is lo + k·width ≤ x < lo + (k + 1)·width.
///
/// The width is a power of two and `lo` a multiple of it. So every edge is exact, and a value lies
/// in the bin that it is counted in, to the last bit. (A value below 10⁻³²³ widths counts as zero.)
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Grid {
    /// The lowest edge.
    pub lo: f64,
    /// The width of a bin.
    pub width: f64,
    /// Number of bins.
    pub bins: u32,
}

/// Margin of the range of a pilot at both ends, as a part of its length.
const MARGIN: f64 = 0.125;
/// Least margin, as a part of the size of the range, so that edges are exact: bins of a constant
/// are wider than a thousand roundings.
const MIN_MARGIN: f64 = 1.0 / (1u64 << 32) as f64;
/// Size beyond which values are never inside of a grid.
const LARGEST: f64 = 1e300;

impl Grid {
    /// The grid of `bins` bins that covers the values of a pilot and a margin around them; around
    /// zero without values.
    pub fn covering(range: Option<(f64, f64)>, bins: u32) -> Self {
        let (lo, hi) = range.unwrap_or((0.0, 0.0));
        let [lo, hi] = [lo, hi].map(|end| end.clamp(-LARGEST, LARGEST));
        let size = lo.abs().max(hi.abs());
        let margin = match (MARGIN * (hi - lo)).max(MIN_MARGIN * size) {
            0.0 => 1.0,
            margin => margin.max(f64::MIN_POSITIVE * 2f64.powi(60)),
        };
        let (lo, hi) = (lo - margin, hi + margin);
        let mut width = power_of_two_below((hi - lo) / f64::from(bins));
        let used = |width: f64| (hi / width).floor() - (lo / width).floor() + 1.0;
        while used(width) > f64::from(bins) {
            width *= 2.0;
        }
        // Bins that are left over widen the grid on both sides.
        let spare = ((f64::from(bins) - used(width)) / 2.0).floor();
        Self { lo: ((lo / width).floor() - spare) * width, width, bins }
    }

    /// Edge number k, from 0 to the number of bins.
    pub fn edge(&self, k: u32) -> f64 {
        self.lo + f64::from(k) * self.width
    }

    /// A power of two as a unit in which squares of the values neither overflow nor vanish: one,
    /// where they do not anyhow.
    pub(super) fn unit(&self) -> f64 {
        const FAR: f64 = (1u128 << 64) as f64;
        let length = self.width * f64::from(self.bins);
        if (1.0 / FAR..FAR).contains(&length) { 1.0 } else { power_of_two_below(length) }
    }

    /// 1/[`unit`](Self::unit), exactly and without a division: with the opposite exponent.
    pub(super) fn scale(&self) -> f64 {
        f64::from_bits((2046 << 52) - self.unit().to_bits())
    }

    /// Number of counts: bins, underflow and overflow.
    pub fn cells(&self) -> usize {
        self.bins as usize + 2
    }

    /// Writes the places where the values are counted: 0 for the underflow, k + 1 for bin k, the
    /// number of bins + 1 for the overflow. Anything for NaN.
    pub fn place(&self, values: &[f64; WIDTH], places: &mut [u32; WIDTH]) {
        // Powers of two: both products are exact.
        let scale = 1.0 / self.width;
        place(values, scale, self.lo * scale - 1.0, self.bins, places);
    }
}

/// The largest power of two that is no larger than x, for x that is normal.
fn power_of_two_below(x: f64) -> f64 {
    f64::from_bits(x.to_bits() & f64::INFINITY.to_bits())
}

/// 2⁵²: the low bits of n + 2⁵² are those of the integer n.
const TO_INTEGER: f64 = 4_503_599_627_370_496.0;

real::kernel! {
    fn place(
        values: &'a [f64; WIDTH],
        scale: f64,
        before: f64,
        bins: u32,
        places: &'a mut [u32; WIDTH]
    ) {
        let last = f64::from(bins) + 1.0;
        for p in 0..WIDTH {
            let place = (values[p] * scale).floor() - before;
            let place = if place > 0.0 { place } else { 0.0 };
            let place = if place < last { place } else { last };
            places[p] = (place + TO_INTEGER).to_bits() as u32;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn place(grid: &Grid, x: f64) -> u32 {
        let mut places = [0; WIDTH];
        grid.place(&[x; WIDTH], &mut places);
        places[7]
    }

    #[test]
    fn a_value_lies_in_its_bin_to_the_last_bit() {
        let ranges = [
            (-4.1, 3.7),
            (0.3, 0.3),
            (0.0, 0.0),
            (1e8 - 4.0, 1e8 + 4.0),
            (-1e-300, 1e-300),
            (-f64::MAX, f64::MAX),
            (5e-324, 1e-310),
            (-7.0, -6.999),
        ];
        for range in ranges {
            for bins in [2, 3, 100, 512, 65536] {
                let grid = Grid::covering(Some(range), bins);
                let (first, last) = (grid.edge(0), grid.edge(bins));
                let [lo, hi] = [range.0, range.1].map(|end: f64| end.clamp(-LARGEST, LARGEST));
                assert!(first < lo && hi < last, "{range:?} {bins}: {grid:?}");
                assert_eq!((place(&grid, first.next_down()), place(&grid, last)), (0, bins + 1));
                assert_eq!((place(&grid, -f64::MAX), place(&grid, f64::MAX)), (0, bins + 1));
                for k in [0, 1, bins / 2, bins - 1] {
                    let (edge, next) = (grid.edge(k), grid.edge(k + 1));
                    assert!(next - edge == grid.width, "{range:?} {bins}: {grid:?}");
                    // The number before zero is zero in units of the width.
                    let before = if next == 0.0 { -1e-16 * grid.width } else { next.next_down() };
                    let found = [edge, edge.next_up(), before].map(|x| place(&grid, x));
                    assert_eq!(found, [k + 1; 3], "{range:?} {bins} {k}: {grid:?}");
                }
            }
        }
        assert!(place(&Grid::covering(None, 8), f64::NAN) <= 9);
        let units = ranges
            .map(|range| Grid::covering(Some(range), 512))
            .map(|grid| (grid.unit(), grid.scale()));
        assert!(units.iter().all(|(unit, scale)| unit * scale == 1.0), "{units:?}");
    }

    #[test]
    fn a_grid_is_little_wider_than_its_range() {
        for hi in [1.0, 1.3, 1.99, 2.0, 1e-9, 1e9] {
            let grid = Grid::covering(Some((0.0, hi)), 512);
            let length = grid.edge(512) - grid.edge(0);
            assert!(length >= 1.25 * hi && length <= 2.6 * hi, "{hi}: {grid:?}");
        }
    }
}
