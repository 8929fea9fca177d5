//! Sums over the components of states.

use real::{Kernel, Row, WIDTH, dispatch};
use systems::run_time::{Lanes, System};

/// Most rows whose terms are summed in one piece.
const PIECE: usize = 1536;

/// A term for each component of up to three states.
pub trait Term: Copy + Sync {
    fn of(self, x: f64, y: f64) -> f64;
}

/// |x − y|.
#[derive(Clone, Copy)]
pub struct Distance;
impl Term for Distance {
    #[inline(always)]
    fn of(self, x: f64, y: f64) -> f64 {
        (x - y).abs()
    }
}

/// x·y.
#[derive(Clone, Copy)]
pub struct Product;
impl Term for Product {
    #[inline(always)]
    fn of(self, x: f64, y: f64) -> f64 {
        x * y
    }
}

/// |x|.
#[derive(Clone, Copy)]
pub struct Size;
impl Term for Size {
    #[inline(always)]
    fn of(self, x: f64, _: f64) -> f64 {
        x.abs()
    }
}

/// The sum of terms over the components of every path, in their order. If the numbers of a row
/// belong to one path, every number of the result is the sum over that path. The bits do not depend
/// on the number of threads.
pub fn sum<T: Term>(system: &dyn System, term: T, x: &[Row], y: &[Row]) -> Row {
    match system.description().layout.lanes {
        Lanes::Paths => dispatch(Sum { term, x, y }),
        Lanes::Components => [over_path(term, x, y); WIDTH],
    }
}

/// The sum over a path: of two halves of it, down to pieces that are always the same.
fn over_path<T: Term>(term: T, x: &[Row], y: &[Row]) -> f64 {
    let pieces = x.len().div_ceil(PIECE);
    if pieces <= 1 {
        return dispatch(Sum { term, x, y }).iter().fold(0.0, |sum, term| sum + term);
    }
    let half = pieces / 2 * PIECE;
    let ((x, later_x), (y, later_y)) = (x.split_at(half), y.split_at(half));
    let (first, second) =
        rayon::join(|| over_path(term, x, y), || over_path(term, later_x, later_y));
    first + second
}

struct Sum<'a, T> {
    term: T,
    x: &'a [Row],
    y: &'a [Row],
}

impl<T: Term> Kernel for Sum<'_, T> {
    type Output = Row;
    #[inline(always)]
    fn run(self) -> Row {
        let mut sum = [0.0; WIDTH];
        for (x, y) in self.x.iter().zip(self.y) {
            for p in 0..WIDTH {
                sum[p] += self.term.of(x[p], y[p]);
            }
        }
        sum
    }
}
