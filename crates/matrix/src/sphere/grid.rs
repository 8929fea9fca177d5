//! Functions on a grid of the sphere, and their matrices.

use dgrad::Rule;
use faer::c64;
use real::elementary::sin_cos;
use std::f64::consts::{PI, TAU};
use systems::SystemError;

use super::Harmonics;

/// Longitudes from 0 on, evenly spaced, at given latitudes: point k of latitude i has the number
/// `longitudes`·i + k.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    /// The sines of the latitudes.
    pub sines: Vec<f64>,
    /// Number of longitudes.
    pub longitudes: usize,
}

/// The grid with n Gaussian latitudes from north to south and 2n longitudes, and the weights of the
/// latitudes, whose sum is 2: integrals of harmonics of degrees below n are exact.
///
/// # Errors
/// [`SystemError`] unless 1 ≤ n ≤ 512.
pub fn gauss(n: usize) -> Result<(Grid, Vec<f64>), SystemError> {
    let rule = Rule::new(n).map_err(|error| SystemError(error.to_string()))?;
    let sines = rule.nodes().iter().map(|x| 1.0 - 2.0 * x).collect();
    let weights = rule.weights().iter().map(|w| 2.0 * w).collect();
    Ok((Grid { sines, longitudes: 2 * n }, weights))
}

impl Grid {
    /// Values of the function Σω_lm Y_lm of a Hermitian matrix of size n.
    pub fn values(&self, n: usize, w: &[c64]) -> Vec<f64> {
        let mut values = vec![0.0; self.sines.len() * self.longitudes];
        self.each_order(n, |m, legendre, turns| {
            let harmonics = Harmonics::new(n);
            let coefficient = |l| harmonics.complex(w, m, &harmonics.profile(l, m));
            let coefficients: Vec<c64> = (m..n).map(coefficient).collect();
            let twice = if m == 0 { 1.0 } else { 2.0 };
            for (row, legendre) in values.chunks_mut(self.longitudes).zip(legendre) {
                let of = legendre.iter().zip(&coefficients);
                let sum = of.fold(c64::ZERO, |sum, (p, c)| sum + *c * *p * twice);
                for (value, (sine, cosine)) in row.iter_mut().zip(turns) {
                    *value += sum.re * cosine - sum.im * sine;
                }
            }
        });
        values
    }

    /// The Hermitian matrix of size n of a function with these values: its harmonics of degrees
    /// below n, by sums with these weights of the latitudes.
    pub fn matrix(&self, n: usize, values: &[f64], weights: &[f64]) -> Vec<c64> {
        let mut w = vec![c64::ZERO; n * n];
        let share = TAU / self.longitudes as f64;
        self.each_order(n, |m, legendre, turns| {
            let mut coefficients = vec![c64::ZERO; n - m];
            let latitudes = legendre.iter().zip(values.chunks(self.longitudes)).zip(weights);
            for ((legendre, row), weight) in latitudes {
                let turned = row.iter().zip(turns);
                let of = turned.fold(c64::ZERO, |sum, (value, (sine, cosine))| {
                    sum + c64::new(value * cosine, -value * sine)
                });
                for (c, p) in coefficients.iter_mut().zip(legendre) {
                    *c += of * (p * weight * share);
                }
            }
            for (l, c) in (m..n).zip(coefficients) {
                for (j, t) in Harmonics::new(n).profile(l, m).iter().enumerate() {
                    w[(j + m) * n + j] += c * *t;
                }
            }
            for j in 0..n - m {
                w[j * n + j + m] = w[(j + m) * n + j].conj();
            }
        });
        w
    }

    /// Calls `of` for each order m < n with P_lm of all latitudes for l from m on, orthonormal
    /// with e^{imφ}, and with the sines and cosines of mφ.
    fn each_order(&self, n: usize, mut of: impl FnMut(usize, &[Vec<f64>], &[(f64, f64)])) {
        let mut sectoral: Vec<f64> = vec![1.0 / (4.0 * PI).sqrt(); self.sines.len()];
        for m in 0..n {
            let turn = |k: usize| {
                let part = (k * m % self.longitudes) as f64 / self.longitudes as f64;
                sin_cos(TAU * part)
            };
            let turns: Vec<(f64, f64)> = (0..self.longitudes).map(turn).collect();
            let all = sectoral.iter().zip(&self.sines);
            let legendre: Vec<Vec<f64>> = all.map(|(first, x)| column(n, m, *first, *x)).collect();
            of(m, &legendre, &turns);
            let next = ((2 * m + 3) as f64 / (2 * m + 2) as f64).sqrt();
            let all = sectoral.iter_mut().zip(&self.sines);
            all.for_each(|(p, x)| *p *= next * ((1.0 - x) * (1.0 + x)).max(0.0).sqrt());
        }
    }
}

/// P_lm(x) for l from m to n − 1, from that of l = m.
fn column(n: usize, m: usize, first: f64, x: f64) -> Vec<f64> {
    let square = |k: usize| (k * k) as f64;
    let factor = |l: usize| ((4.0 * square(l) - 1.0) / (square(l) - square(m))).sqrt();
    let mut p = vec![first];
    for l in m + 1..n {
        let before = if l > m + 1 { p[l - m - 2] / factor(l - 1) } else { 0.0 };
        p.push(factor(l) * (x * p[l - m - 1] - before));
    }
    p
}
