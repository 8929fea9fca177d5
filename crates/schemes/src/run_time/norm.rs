//! Sums over the components of states.

use real::{Kernel, Row, WIDTH, dispatch};
use systems::run_time::{Lanes, System};

/// Most rows whose terms are summed in one piece.
const PIECE: usize = 1536;

/// Terms of N sums, for each component of three states.
pub trait Terms<const N: usize>: Copy + Sync {
    fn of(self, states: [f64; 3]) -> [f64; N];
}

/// |z − y|, |y − x| and |z|.
#[derive(Clone, Copy)]
pub struct Changes;
impl Terms<3> for Changes {
    #[inline(always)]
    fn of(self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        [(z - y).abs(), (y - x).abs(), z.abs()]
    }
}

/// x·y.
#[derive(Clone, Copy)]
pub struct Product;
impl Terms<1> for Product {
    #[inline(always)]
    fn of(self, [x, y, _]: [f64; 3]) -> [f64; 1] {
        [x * y]
    }
}

/// The sums of terms over the components of every path, in their order. If the numbers of a row
/// belong to one path, every number of the result is the sum over that path. The bits do not depend
/// on the number of threads.
pub fn sums<T: Terms<N>, const N: usize>(
    system: &dyn System,
    terms: T,
    states: [&[Row]; 3],
) -> [Row; N] {
    match system.description().layout.lanes {
        Lanes::Paths => dispatch(Sums::<T, N> { terms, states }),
        Lanes::Components => over_path(terms, states).map(|sum| [sum; WIDTH]),
    }
}

/// The sums over a path: of two halves of it, down to pieces that are always the same.
fn over_path<T: Terms<N>, const N: usize>(terms: T, states: [&[Row]; 3]) -> [f64; N] {
    let pieces = states[0].len().div_ceil(PIECE);
    if pieces <= 1 {
        let sums = dispatch(Sums::<T, N> { terms, states });
        return sums.map(|sum| sum.iter().fold(0.0, |sum, term| sum + term));
    }
    let half = pieces / 2 * PIECE;
    let (first, second) = rayon::join(
        || over_path(terms, states.map(|state| &state[..half])),
        || over_path(terms, states.map(|state| &state[half..])),
    );
    std::array::from_fn(|n| first[n] + second[n])
}

struct Sums<'a, T, const N: usize> {
    terms: T,
    states: [&'a [Row]; 3],
}

impl<T: Terms<N>, const N: usize> Kernel for Sums<'_, T, N> {
    type Output = [Row; N];
    #[inline(always)]
    fn run(self) -> [Row; N] {
        let mut sums = [[0.0; WIDTH]; N];
        let [x, y, z] = self.states;
        for ((x, y), z) in x.iter().zip(y).zip(z) {
            for p in 0..WIDTH {
                let terms = self.terms.of([x[p], y[p], z[p]]);
                for n in 0..N {
                    sums[n][p] += terms[n];
                }
            }
        }
        sums
    }
}
