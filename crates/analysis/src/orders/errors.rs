//! Errors against the limit, from runs alone.

use real::{PathMask, Row, WIDTH};
use stats::{CrossMoments, Point, root_mean_squares};

/// What is recorded of a path with n runs, coarsest first, of which the first L have points: with
/// D = y_{n−2} − y_{n−1} the last difference,
/// |y_l − y_{n−1}|² and ⟨y_l − y_{n−2}, D⟩ for l < L, then |y_k − y_{k+1}|² for k < n − 1, then
/// ⟨y_{n−3} − y_{n−2}, D⟩.
pub fn record(states: &[&[Row]], live: PathMask, levels: usize, numbers: &mut [Row]) {
    let (n, dimension) = (states.len(), states[0].len());
    for p in live.paths() {
        // ⟨y_a − y_b, y_c − y_d⟩.
        let dot = |[a, b]: [usize; 2], [c, d]: [usize; 2]| {
            let difference = |k: usize, l: usize, i: usize| states[k][i][p] - states[l][i][p];
            (0..dimension).map(|i| difference(a, b, i) * difference(c, d, i)).sum::<f64>()
        };
        let last = [n - 2, n - 1];
        for l in 0..levels {
            numbers[l][p] = dot([l, n - 1], [l, n - 1]);
            numbers[levels + l][p] = dot([l, n - 2], last);
        }
        for k in 0..n - 1 {
            numbers[2 * levels + k][p] = dot([k, k + 1], [k, k + 1]);
        }
        numbers[2 * levels + n - 1][p] = dot([n - 3, n - 2], last);
    }
}

/// |y − x|² of the paths that are live.
pub fn squared_distance(y: &[Row], x: &[Row], live: PathMask) -> Row {
    let mut square = [0.0; WIDTH];
    for p in live.paths() {
        square[p] = y.iter().zip(x).map(|(y, x)| (y[p] - x[p]) * (y[p] - x[p])).sum();
    }
    square
}

/// Length of that record.
pub fn record_length(sizes: usize, levels: usize) -> usize {
    2 * levels + sizes
}

/// The squares of successive differences in a record.
pub fn differences(record: &CrossMoments, sizes: usize, levels: usize) -> CrossMoments {
    record.part(2 * levels..2 * levels + sizes - 1)
}

/// Root-mean-square errors against the limit at the first step sizes, for errors of these orders,
/// the most likely one first.
///
/// The error that is left at the finest step is Σ of the differences that would follow. Of the last
/// difference D the part ρ repeats itself along the path, 2^{−p} times as large each time (the
/// error of a drift), and the rest is independent each time (iterated integrals). ρ|D|² is measured
/// as g = 2^{−p}⟨y_{n−3} − y_{n−2}, D⟩, or ρ = 0. With κ = 1/(2^p − 1) and λ = 1/(4^p − 1), E|y_l −
/// y|² = E[|y_l − y_{n−1}|² + 2κ⟨y_l − y_{n−2}, D⟩ + λ|D|² + (2κ + κ² − λ)g]. The value takes ρ = 0
/// where the most likely order is ½. The interval is that of the paths, widened to those of the
/// other orders with either ρ.
pub fn strong_points(taus: &[f64], record: &CrossMoments, orders: &[f64]) -> Vec<Point> {
    let levels = taus.len();
    let points = |p: f64, independent: bool| {
        let row = |l| row(record.length(), levels, l, p, independent);
        root_mean_squares(taus, &record.combined(&(0..levels).map(row).collect::<Vec<_>>()))
    };
    let others = orders.iter().flat_map(|&p| [points(p, true), points(p, false)]);
    widest(std::iter::once(points(orders[0], orders[0] < 0.75)).chain(others))
}

/// The first points, with intervals that contain those of all others at the same step size.
pub fn widest(mut all: impl Iterator<Item = Vec<Point>>) -> Vec<Point> {
    let mut first = all.next().unwrap_or_default();
    for other in all.flatten() {
        for point in &mut first {
            if let (
                Point::Error { tau, lo, hi, .. },
                Point::Error { tau: same, lo: low, hi: high, .. },
            ) = (point, &other)
                && tau == same
            {
                *lo = lo.zip(*low).map(|(a, b)| a.min(b));
                *hi = hi.zip(*high).map(|(a, b)| a.max(b));
            }
        }
    }
    first
}

/// The weights of a record in E|y_l − y|².
fn row(length: usize, levels: usize, l: usize, p: f64, independent: bool) -> Vec<f64> {
    let (last, before) = (length - 2, length - 1);
    let is_finest = 2 * levels + l > last;
    let growth = p.exp2();
    let (kappa, lambda) = (1.0 / (growth - 1.0), 1.0 / (growth * growth - 1.0));
    let mut row = vec![0.0; length];
    row[last] = lambda;
    if !is_finest {
        row[l] = 1.0;
    }
    if !independent {
        let cross = if is_finest { 0.0 } else { 2.0 * kappa };
        row[levels + l] = cross;
        row[before] = (cross + kappa * kappa - lambda) / growth;
    }
    row
}
