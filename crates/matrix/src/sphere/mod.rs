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
    /// Inverse pivots of −Δ on each diagonal, one after the other.
    pivots: Vec<f64>,
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
        let mut pivots = Vec::with_capacity(n * (n + 1) / 2);
        for m in 0..n {
            let mut inverse = 0.0;
            for j in 0..n - m {
                let before = if j > 0 { harmonics.beside(m, j - 1).powi(2) * inverse } else { 0.0 };
                inverse = 1.0 / (harmonics.diagonal(m, j) - before);
                pivots.push(inverse);
            }
        }
        // Δ of a constant is zero.
        pivots[n - 1] = 0.0;
        // cos θ = √(4π/3) Y₁₀.
        let planetary = (2.0 * rotation * (4.0 * PI / 3.0).sqrt(), harmonics.profile(1, 0));
        Ok(Self {
            harmonics,
            n,
            advection: advection * scale,
            rotation,
            planetary,
            stirring,
            pivots,
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

    /// Writes V = a(−Δ)⁻¹(W − F), diagonal by diagonal.
    fn stream(&self, w: &[c64], a: f64, v: &mut [c64]) {
        let (n, harmonics) = (self.n, self.harmonics);
        let (rate, profile) = &self.planetary;
        let mut first = 0;
        for m in 0..n {
            let length = n - m;
            let pivots = &self.pivots[first..first + length];
            first += length;
            let at = |j: usize| (j + m) * n + j;
            let mean =
                if m == 0 { (0..n).map(|j| w[at(j)].re).sum::<f64>() / n as f64 } else { 0.0 };
            let mut before = c64::ZERO;
            for j in 0..length {
                let known = if m == 0 { mean + rate * profile[j] } else { 0.0 };
                let beside = if j > 0 { harmonics.beside(m, j - 1) * pivots[j - 1] } else { 0.0 };
                before = w[at(j)] - known + before * beside;
                v[at(j)] = before;
            }
            let mut after = c64::ZERO;
            for j in (0..length).rev() {
                let beside = if j + 1 < length { harmonics.beside(m, j) } else { 0.0 };
                after = (v[at(j)] + after * beside) * pivots[j];
                v[at(j)] = after;
            }
            let mean =
                if m == 0 { (0..n).map(|j| v[at(j)].re).sum::<f64>() / n as f64 } else { 0.0 };
            for j in 0..length {
                let entry = (v[at(j)] - mean) * a;
                (v[at(j)], v[j * n + j + m]) = (entry, entry.conj());
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
