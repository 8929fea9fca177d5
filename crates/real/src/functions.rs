//! What functions of numbers of any type are made of, without branches.

use crate::Real;

/// 1/(2k+1)! for k = 0 … 9. The first omitted term is below 2^-65 of sinh x for |x| ≤ 1.
const SINH_SERIES: [f64; 10] = inverse_factorials(1, 2);

/// 1/n! for n = `first`, `first` + `step`, …, exact up to the quotient for n ≤ 22.
pub const fn inverse_factorials<const N: usize>(first: usize, step: usize) -> [f64; N] {
    let mut inverse = [1.0; N];
    let (mut factorial, mut n, mut k) = (1.0, 1, 0);
    while k < N {
        while n < first + k * step {
            n += 1;
            factorial *= n as f64;
        }
        inverse[k] = 1.0 / factorial;
        k += 1;
    }
    inverse
}

/// sinh and cosh of x with |x| = `size`; or ±`size`, with the sign of x.
#[inline(always)]
pub fn sinh_cosh<R: Real>(x: R, size: R) -> (R, R) {
    let square = x * x;
    let mut sum = R::constant(SINH_SERIES[9]);
    for k in (1..9).rev() {
        sum = sum * square + SINH_SERIES[k];
    }
    let short = x + x * (square * sum);
    let (up, down) = (size.exp(), size.exp().recip());
    let long = (up - down) * 0.5;
    let long = R::where_less(x, R::zero(), -long, long);
    (R::where_less(size, R::one(), short, long), (up + down) * 0.5)
}

/// `b`, or `a` if that is NaN.
#[inline(always)]
pub fn unless_nan<R: Real>(a: R, b: R) -> R {
    let not_below = R::where_less(R::zero(), a, b, a);
    R::where_less(a, R::constant(f64::INFINITY), b, not_below)
}
