//! Euler's equations on the rotating sphere by matrices (Zeitlin 1991, 2004).

mod grid;
mod harmonics;

use faer::c64;
use std::f64::consts::PI;
use systems::{SystemError, finite};

pub use grid::{Grid, gauss};
pub use harmonics::Harmonics;

use crate::{MatrixSystem, system::inner};
use harmonics::add;

/// Noise of a fluid: a stream function that is a real harmonic (l, m) times a strength.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stirring {
    /// The degree l.
    pub degree: usize,
    /// The order m, from −l to l.
    pub order: isize,
    /// The strength σ.
    pub strength: f64,
}

impl Stirring {
    /// Isotropic noise: all orders of a degree.
    pub fn isotropic(degree: usize, strength: f64) -> impl Iterator<Item = Self> {
        let most = degree as isize;
        (-most..=most).map(move |order| Self { degree, order, strength })
    }
}

/// Zeitlin's model of ω_t = {v, ω} with v = (−Δ)⁻¹(ω − f) on the sphere of radius one, where ω is
/// the absolute vorticity and f = 2Ω cos θ that of the rotation, with transport noise: dω =
/// {v, ω}dt + Σσₘ{Yₘ, ω} ∘ dWₘ and {x, y} = z.
///
/// W = Σω_lm T_lm has the coefficients of ω by real spherical harmonics, so that ‖W‖² is the
/// enstrophy ∫ω² and ½⟨W − F, (−Δ)⁻¹(W − F)⟩ the energy ½∫|u|². The bracket {f, g} is −is\[F, G\]
/// with s = √(N(N² − 1)/16π); Hamiltonians have this factor, H₀ that of `advection` besides.
pub struct Sphere {
    harmonics: Harmonics,
    n: usize,
    /// Factor of H₀, with s.
    advection: f64,
    rotation: f64,
    /// Coefficient of T₁₀ in F, and its diagonal.
    planetary: (f64, Vec<f64>),
    stirring: Vec<(Stirring, Vec<f64>)>,
    /// Inverse pivots of −Δ on the diagonals of W, and minus the entries beside: of all diagonals
    /// at their entry 0, at their entry 1, ….
    laplacian: Vec<[f64; 2]>,
}

/// s = √(N(N² − 1)/16π): {f, g} is −is\[F, G\].
pub fn bracket_scale(n: usize) -> f64 {
    let n = n as f64;
    (n * (n * n - 1.0) / (16.0 * PI)).sqrt()
}

impl Sphere {
    /// Fluid of matrices of size n on a sphere that rotates with the rate Ω, with its noises.
    /// `advection` multiplies H₀: one, or zero for noise alone.
    ///
    /// # Errors
    /// [`SystemError`] unless 2 ≤ n ≤ 1024, numbers are finite, and noises have degrees from 1 to
    /// n − 1 and orders up to these.
    pub fn new(
        n: usize,
        rotation: f64,
        advection: f64,
        stirring: impl IntoIterator<Item = Stirring>,
    ) -> Result<Self, SystemError> {
        if !(2..=Harmonics::LARGEST).contains(&n) {
            let most = Harmonics::LARGEST;
            return Err(SystemError(format!("matrices have a size from 2 to {most}, got {n}")));
        }
        finite("the rotation", rotation)?;
        finite("the advection", advection)?;
        let (harmonics, scale) = (Harmonics::new(n), bracket_scale(n));
        let noise = |one: Stirring| {
            let Stirring { degree, order, strength } = one;
            let m = order.unsigned_abs();
            if degree == 0 || degree >= n || m > degree || !strength.is_finite() {
                return Err(SystemError(format!(
                    "a noise has a degree from 1 to {}, an order up to it and a finite strength, \
                     got ({degree}, {order}) of {strength}",
                    n - 1
                )));
            }
            Ok((Stirring { strength: strength * scale, ..one }, harmonics.profile(degree, m)))
        };
        let stirring = stirring.into_iter().map(noise).collect::<Result<_, _>>()?;
        let mut laplacian: Vec<[f64; 2]> = Vec::with_capacity(n * (n + 1) / 2);
        for j in 0..n {
            for m in 0..n - j {
                let before = laplacian.len().checked_sub(n + 1 - j).map(|at| laplacian[at]);
                let before = before.map_or(0.0, |[pivot, beside]| beside.powi(2) * pivot);
                let pivot = 1.0 / (harmonics.diagonal(m, j) - before);
                laplacian.push([pivot, harmonics.beside(m, j)]);
            }
        }
        // Δ of a constant is zero.
        laplacian[n * (n + 1) / 2 - 1] = [0.0; 2];
        // cos θ = √(4π/3) Y₁₀.
        let planetary = (2.0 * rotation * (4.0 * PI / 3.0).sqrt(), harmonics.profile(1, 0));
        Ok(Self {
            harmonics,
            n,
            advection: advection * scale,
            rotation,
            planetary,
            stirring,
            laplacian,
        })
    }

    /// The harmonics.
    pub fn harmonics(&self) -> Harmonics {
        self.harmonics
    }

    /// W − F, the relative vorticity.
    pub fn relative(&self, w: &[c64]) -> Vec<c64> {
        let mut relative = w.to_vec();
        add(self.n, &mut relative, &self.planetary.1, 0, -self.planetary.0);
        relative
    }

    /// W of the relative vorticity with these coefficients of harmonics (l, m), m from −l to l for
    /// l = 1, 2, ….
    pub fn vorticity(&self, coefficients: &[f64]) -> Vec<c64> {
        let mut w = vec![c64::ZERO; self.n * self.n];
        add(self.n, &mut w, &self.planetary.1, 0, self.planetary.0);
        let orders = (1..self.n).flat_map(|l| (-(l as isize)..=l as isize).map(move |m| (l, m)));
        for ((l, m), x) in orders.zip(coefficients).filter(|(_, x)| **x != 0.0) {
            self.harmonics.add(&mut w, l, m, *x);
        }
        w
    }

    /// The energy ½∫|u|².
    pub fn kinetic_energy(&self, w: &[c64]) -> f64 {
        let mut v = vec![c64::ZERO; w.len()];
        self.stream(w, 1.0, &mut v);
        0.5 * inner(&self.relative(w), &v)
    }

    /// Writes V = a(−Δ)⁻¹(W − F), all diagonals at once: entry m of column j from the main diagonal
    /// down is entry j of the m-th.
    fn stream(&self, w: &[c64], a: f64, v: &mut [c64]) {
        let n = self.n;
        let mean = |w: &[c64]| (0..n).map(|j| w[j * (n + 1)].re).sum::<f64>() / n as f64;
        let (rate, profile) = &self.planetary;
        let (of_w, mut first) = (mean(w), 0);
        for j in 0..n {
            let (done, column) = v.split_at_mut(j * (n + 1));
            let column = &mut column[..n - j];
            column.copy_from_slice(&w[j * (n + 1)..][..n - j]);
            column[0] -= of_w + rate * profile[j];
            if j > 0 {
                let before = &done[(j - 1) * (n + 1)..];
                let pairs = before.iter().zip(&self.laplacian[first..]);
                for (v, (before, [pivot, beside])) in column.iter_mut().zip(pairs) {
                    *v += before * (beside * pivot);
                }
                first += n + 1 - j;
            }
        }
        for j in (0..n).rev() {
            let (before, after) = v.split_at_mut((j + 1) * n);
            let column = &mut before[j * (n + 1)..];
            let after = after.iter().skip(j + 1).chain([&c64::ZERO]);
            let rows = after.zip(&self.laplacian[first..]);
            for (v, (after, [pivot, beside])) in column.iter_mut().zip(rows) {
                *v = (*v + after * beside) * *pivot;
            }
            first -= if j > 0 { n + 1 - j } else { 0 };
        }
        let of_v = mean(v);
        for j in 0..n {
            v[j * (n + 1)] -= of_v;
            for k in j..n {
                v[j * n + k] *= a;
                v[k * n + j] = v[j * n + k].conj();
            }
        }
    }
}

impl MatrixSystem for Sphere {
    fn name(&self) -> &str {
        "sphere-euler"
    }

    fn parameters(&self) -> String {
        let Self { n, rotation, stirring, .. } = self;
        format!("N = {n}, rotation = {rotation}, {} noises", stirring.len())
    }

    fn size(&self) -> usize {
        self.n
    }

    fn noises(&self) -> usize {
        self.stirring.len()
    }

    /// Zonal noises commute.
    fn noises_commute(&self) -> bool {
        self.stirring.len() < 2 || self.stirring.iter().all(|(one, _)| one.order == 0)
    }

    fn generator(&self, w: &[c64], dt: f64, dw: &[f64], v: &mut [c64]) {
        match dt * self.advection {
            0.0 => v.fill(c64::ZERO),
            a => self.stream(w, a, v),
        }
        for ((Stirring { order, strength, .. }, profile), dw) in self.stirring.iter().zip(dw) {
            add(self.n, v, profile, *order, strength * dw);
        }
    }

    fn energy(&self, w: &[c64]) -> f64 {
        self.advection * self.kinetic_energy(w)
    }
}
