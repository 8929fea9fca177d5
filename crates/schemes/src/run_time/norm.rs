//! Sums over the components of states.

use real::{Row, WIDTH};
use systems::run_time::{Lanes, System};

/// Most rows whose terms are summed in one piece.
const PIECE: usize = 1536;

real::kernel! {
    /// Sums of |z − y|, |y − x| and |z| over the rows of states x, y, z.
    pub fn changes(states: [&'a [Row]; 3]) -> [Row; 3] {
        let ([x, y, z], mut sums) = (states, [[0.0; WIDTH]; 3]);
        for ((x, y), z) in x.iter().zip(y).zip(z) {
            for p in 0..WIDTH {
                sums[0][p] += (z[p] - y[p]).abs();
                sums[1][p] += (y[p] - x[p]).abs();
                sums[2][p] += z[p].abs();
            }
        }
        sums
    }
}

real::kernel! {
    /// Sums of x·y over the rows of states x, y and any third.
    pub fn products(states: [&'a [Row]; 3]) -> [Row; 1] {
        let ([x, y, _], mut sum) = (states, [0.0; WIDTH]);
        for (x, y) in x.iter().zip(y) {
            for p in 0..WIDTH {
                sum[p] += x[p] * y[p];
            }
        }
        [sum]
    }
}

/// A function that sums over the rows of states.
type OverRows<const N: usize> = fn([&[Row]; 3]) -> [Row; N];

/// The sums over the components of every path, in their order. If the numbers of a row belong to
/// one path, every number of the result is the sum over that path. The bits do not depend on the
/// number of threads.
pub fn sums<const N: usize>(
    system: &dyn System,
    over_rows: OverRows<N>,
    states: [&[Row]; 3],
) -> [Row; N] {
    match system.description().layout.lanes {
        Lanes::Paths => over_rows(states),
        Lanes::Components => over_path(over_rows, states).map(|sum| [sum; WIDTH]),
    }
}

/// The sums over a path: of two halves of it, down to pieces that are always the same.
fn over_path<const N: usize>(over_rows: OverRows<N>, states: [&[Row]; 3]) -> [f64; N] {
    let pieces = states[0].len().div_ceil(PIECE);
    if pieces <= 1 {
        return over_rows(states).map(|sum| sum.iter().fold(0.0, |sum, term| sum + term));
    }
    let half = pieces / 2 * PIECE;
    let (first, second) = rayon::join(
        || over_path(over_rows, states.map(|state| &state[..half])),
        || over_path(over_rows, states.map(|state| &state[half..])),
    );
    std::array::from_fn(|n| first[n] + second[n])
}
