//! Spherical harmonics as matrices.

use faer::c64;
use std::f64::consts::FRAC_1_SQRT_2;

/// Harmonics T_lm of matrices of size N, l < N: the orthonormal eigenmatrices of the Laplacian of
/// Hoppe and Yau (1998), ΔW = −Σₐ\[Sₐ, \[Sₐ, W\]\] with spin matrices Sₐ, of eigenvalue −l(l + 1).
///
/// Δ acts on each diagonal by a tridiagonal matrix. T_lm has the m-th diagonal above the main one,
/// positive at the north pole; it stands for the function Y_lm without the phase of Condon and
/// Shortley. Real harmonics have m ≥ 0 for the cosine of mφ and m < 0 for the sine of |m|φ.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Harmonics {
    n: usize,
}

impl Harmonics {
    /// Largest size: entries of longer diagonals leave the range of numbers.
    pub const LARGEST: usize = 1024;

    /// Harmonics of matrices of size n.
    pub const fn new(n: usize) -> Self {
        Self { n }
    }

    /// Entry j of the diagonal of −Δ on the m-th diagonal of W.
    pub(super) fn diagonal(self, m: usize, j: usize) -> f64 {
        let s = 0.5 * (self.n as f64 - 1.0);
        2.0 * (s * (s + 1.0) - (s - j as f64) * (s - (j + m) as f64))
    }

    /// Minus the entry beside it, which joins j and j + 1.
    pub(super) fn beside(self, m: usize, j: usize) -> f64 {
        let squared = |j: usize| ((j + 1) * (self.n - 1 - j)) as f64;
        (squared(j) * squared(j + m)).sqrt()
    }

    /// The m-th diagonal of T_lm, N − m numbers.
    ///
    /// The recurrence of the eigenvector goes from the pole to the equator, where it grows; the
    /// other half is its mirror image.
    pub fn profile(self, l: usize, m: usize) -> Vec<f64> {
        let length = self.n - m;
        let mut t = vec![0.0; length];
        let value = (l * (l + 1)) as f64;
        t[0] = 1.0;
        for j in 0..(length - 1) / 2 {
            let before = if j > 0 { self.beside(m, j - 1) * t[j - 1] } else { 0.0 };
            t[j + 1] = ((self.diagonal(m, j) - value) * t[j] - before) / self.beside(m, j);
        }
        let sign = if (l - m).is_multiple_of(2) { 1.0 } else { -1.0 };
        for j in 0..length / 2 {
            t[length - 1 - j] = sign * t[j];
        }
        if sign < 0.0 && length % 2 == 1 {
            t[length / 2] = 0.0;
        }
        let size = t.iter().fold(0.0f64, |most, t| most.max(t.abs()));
        let norm = size * t.iter().map(|t| (t / size).powi(2)).sum::<f64>().sqrt();
        t.iter_mut().for_each(|t| *t /= norm);
        t
    }

    /// Adds a multiple of the real harmonic (l, m) to a Hermitian matrix.
    pub fn add(self, w: &mut [c64], l: usize, m: isize, coefficient: f64) {
        add(self.n, w, &self.profile(l, m.unsigned_abs()), m, coefficient);
    }

    /// Coefficient ω_lm of the real harmonic (l, m) in a Hermitian matrix.
    pub fn coefficient(self, w: &[c64], l: usize, m: isize) -> f64 {
        let of = self.complex(w, m.unsigned_abs(), &self.profile(l, m.unsigned_abs()));
        match m {
            0 => of.re,
            1.. => of.re / FRAC_1_SQRT_2,
            _ => -of.im / FRAC_1_SQRT_2,
        }
    }

    /// Σₘ ω_lm² of a Hermitian matrix.
    pub fn power(self, w: &[c64], l: usize) -> f64 {
        let of = |m: usize| self.complex(w, m, &self.profile(l, m)).norm_sqr();
        of(0) + 2.0 * (1..=l).map(of).sum::<f64>()
    }

    /// ⟨T_lm, W⟩ from the diagonal of T_lm.
    pub(super) fn complex(self, w: &[c64], m: usize, profile: &[f64]) -> c64 {
        let entries = profile.iter().enumerate();
        entries.fold(c64::ZERO, |sum, (j, t)| sum + w[(j + m) * self.n + j] * *t)
    }
}

/// Adds a multiple of the real harmonic of order m with this diagonal.
pub fn add(n: usize, w: &mut [c64], profile: &[f64], m: isize, coefficient: f64) {
    let part = match m {
        0 => c64::new(0.5 * coefficient, 0.0),
        1.. => c64::new(coefficient * FRAC_1_SQRT_2, 0.0),
        _ => c64::new(0.0, -coefficient * FRAC_1_SQRT_2),
    };
    let m = m.unsigned_abs();
    for (j, t) in profile.iter().enumerate() {
        let entry = part * *t;
        w[(j + m) * n + j] += entry;
        w[j * n + j + m] += entry.conj();
    }
}
