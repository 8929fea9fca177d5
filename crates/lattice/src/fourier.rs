//! Discrete Fourier transforms of 32 lists at a time.

use std::f64::consts::TAU;

use real::{
    Row, WIDTH,
    elementary::{cos, sin},
};

/// Real and imaginary parts of 32 numbers.
pub type Complex = [Row; 2];

/// cos φ and sin φ for φ = 2πx.
pub fn turned(x: f64) -> [f64; 2] {
    let angle = TAU * x;
    [cos(angle), sin(angle)]
}

/// cos φ and sin φ for φ = 2πk/n.
pub fn turn(k: usize, n: usize) -> [f64; 2] {
    turned((k % n) as f64 / n as f64)
}

/// The numbers e^{−2πik/n} for k < n/2; n is a power of two.
pub fn twiddles(n: usize) -> Vec<[f64; 2]> {
    (0..n / 2).map(|k| turn(k, n)).map(|[c, s]| [c, -s]).collect()
}

real::kernel! {
    /// Σ x_j e^{−2πijk/n} in the place of x_k, for a power of two n (Cooley and Tukey 1965).
    pub fn transform(x: &'a mut [Complex], twiddles: &'a [[f64; 2]]) {
        let n = x.len();
        let bits = n.trailing_zeros();
        for k in 1..n {
            let mirrored = k.reverse_bits() >> (usize::BITS - bits);
            if k < mirrored {
                x.swap(k, mirrored);
            }
        }
        let mut half = 1;
        while half < n {
            for block in x.chunks_exact_mut(2 * half) {
                let (low, high) = block.split_at_mut(half);
                for (k, (a, b)) in low.iter_mut().zip(high).enumerate() {
                    let [c, s] = twiddles[k * (n / (2 * half))];
                    for p in 0..WIDTH {
                        let (re, im) = (b[0][p] * c - b[1][p] * s, b[0][p] * s + b[1][p] * c);
                        (b[0][p], b[1][p]) = (a[0][p] - re, a[1][p] - im);
                        (a[0][p], a[1][p]) = (a[0][p] + re, a[1][p] + im);
                    }
                }
            }
            half *= 2;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_transform_is_the_sum() {
        for n in [2, 8, 64] {
            let number = |k: usize| ((k * k + 3 * k) % 17) as f64 / 17.0 - 0.4;
            let at = |j: usize, p: usize| [number(j + p), number(3 * j + 1 + p)];
            let row = |j: usize, c: usize| std::array::from_fn(|p| at(j, p)[c]);
            let mut x: Vec<Complex> = (0..n).map(|j| [row(j, 0), row(j, 1)]).collect();
            transform(&mut x, &twiddles(n));
            for (k, found) in x.iter().enumerate() {
                for p in [0, 5, 31] {
                    let term = |j: usize| {
                        let ([re, im], [c, s]) = (at(j, p), turn(j * k, n));
                        [re * c + im * s, im * c - re * s]
                    };
                    for part in 0..2 {
                        let sum: f64 = (0..n).map(|j| term(j)[part]).sum();
                        // log₂ n additions of numbers below n, and the terms of the sum.
                        assert!((found[part][p] - sum).abs() < 1e-15 * (n * n) as f64, "{n}, {k}");
                    }
                }
            }
        }
    }
}
