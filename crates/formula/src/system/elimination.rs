//! Linear systems on rows, for dimensions whose elimination is too long for a tape.

use real::{Kernel, Row, WIDTH};

/// Replaces `x` by the solution of A x = b on each path, with b in `x` and A in `matrix`, row by
/// row. No pivoting; the order of operations is that of [`real::Factored`].
pub struct Eliminate<'a> {
    pub matrix: &'a mut [Row],
    pub x: &'a mut [Row],
}

impl Kernel for Eliminate<'_> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let Self { matrix, x } = self;
        let n = x.len();
        for k in 0..n {
            let (above, below) = matrix.split_at_mut((k + 1) * n);
            let pivots = &mut above[k * n..];
            invert(&mut pivots[k]);
            for row in below.chunks_exact_mut(n) {
                let (left, right) = row.split_at_mut(k + 1);
                let factor = &mut left[k];
                multiply(factor, &pivots[k]);
                for (entry, pivot) in right.iter_mut().zip(&pivots[k + 1..]) {
                    subtract(entry, factor, pivot);
                }
            }
        }
        for k in 0..n {
            let (known, rest) = x.split_at_mut(k + 1);
            for (i, entry) in rest.iter_mut().enumerate() {
                subtract(entry, &matrix[(k + 1 + i) * n + k], &known[k]);
            }
        }
        for k in (0..n).rev() {
            let (rest, known) = x.split_at_mut(k + 1);
            for (j, entry) in known.iter().enumerate() {
                subtract(&mut rest[k], &matrix[k * n + k + 1 + j], entry);
            }
            multiply(&mut rest[k], &matrix[k * n + k]);
        }
    }
}

// Results are values that overlap with nothing, so that the loops are vectorised.

#[inline(always)]
fn invert(a: &mut Row) {
    let mut value = [0.0; WIDTH];
    for p in 0..WIDTH {
        value[p] = 1.0 / a[p];
    }
    *a = value;
}

#[inline(always)]
fn multiply(a: &mut Row, b: &Row) {
    let mut value = [0.0; WIDTH];
    for p in 0..WIDTH {
        value[p] = a[p] * b[p];
    }
    *a = value;
}

/// a − b·c.
#[inline(always)]
fn subtract(a: &mut Row, b: &Row, c: &Row) {
    let mut value = [0.0; WIDTH];
    for p in 0..WIDTH {
        value[p] = a[p] - b[p] * c[p];
    }
    *a = value;
}
