//! Spins with N levels on a lattice.

use faer::c64;
use systems::{SystemError, finite, lattice::Shape};

use crate::{
    MatrixSystem,
    system::{bracket, matrices},
};

/// Couplings of spins S = (N − 1)/2:
/// H = −JΣSᵢ·Sⱼ + Σ(D(Sᶻ)² + K(Sᶻ)⁴ − h·S) in the mean of each site.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SpinCouplings {
    /// J, the exchange of dipoles of neighbours.
    pub exchange: f64,
    /// D.
    pub quadratic: f64,
    /// K.
    pub quartic: f64,
    /// The field h.
    pub field: [f64; 3],
    /// Damping α and temperature kT of a heat bath.
    pub bath: Option<[f64; 2]>,
}

/// SU(N) spins on a lattice: a coherent state ρᵢ = |ψᵢ⟩⟨ψᵢ| of N levels at each site (Zhang and
/// Batista 2021), with dρᵢ = −i\[Vᵢ, ρᵢ\] and Vᵢ = ∂H/∂ρᵢ dt.
///
/// The bath acts through Φ = √(2αkT) E for an orthonormal basis E of the operators of each site,
/// with the shift u = −½β{H, Φ} of its increments: Vᵢ gets √(2αkT)ΣE ∘ dW + iα\[ρᵢ, ∂H/∂ρᵢ\]dt. The
/// law e^{−H/kT} on coherent states is stationary.
#[derive(Clone, Debug)]
pub struct SuSpins {
    n: usize,
    shape: Shape,
    couplings: SpinCouplings,
    /// Sᶻ of the levels, from the highest on, and the entries of S⁺ beside the diagonal.
    levels: Vec<f64>,
    raising: Vec<f64>,
}

/// The levels of Sᶻ and the entries of S⁺ between neighbouring ones.
fn spin(n: usize) -> (Vec<f64>, Vec<f64>) {
    let s = 0.5 * (n as f64 - 1.0);
    let raising = (1..n).map(|j| ((j * (n - j)) as f64).sqrt()).collect();
    ((0..n).map(|j| s - j as f64).collect(), raising)
}

/// Most levels.
const LEVELS: usize = 16;

impl SuSpins {
    /// Spins of n levels on a lattice.
    ///
    /// # Errors
    /// [`SystemError`] unless 2 ≤ n ≤ 16, couplings are finite, α > 0 and kT ≥ 0.
    pub fn new(n: usize, shape: Shape, couplings: SpinCouplings) -> Result<Self, SystemError> {
        let SpinCouplings { exchange, quadratic, quartic, field: [x, y, z], bath } = couplings;
        if !(2..=LEVELS).contains(&n) {
            return Err(SystemError(format!("a spin has from 2 to {LEVELS} levels, got {n}")));
        }
        for number in [exchange, quadratic, quartic, x, y, z] {
            finite("couplings of spins", number)?;
        }
        if let Some([alpha, kt]) = bath
            && !(alpha > 0.0 && alpha.is_finite() && kt >= 0.0 && kt.is_finite())
        {
            let words = "a bath has a damping above 0 and a temperature of at least 0, got";
            return Err(SystemError(format!("{words} {alpha} and {kt}")));
        }
        let (levels, raising) = spin(n);
        Ok(Self { n, shape, couplings, levels, raising })
    }

    /// The mean (Sˣ, Sʸ, Sᶻ) of a site.
    pub fn dipole(&self, w: &[c64], site: usize) -> [f64; 3] {
        let n = self.n;
        let w = &w[site * n * n..(site + 1) * n * n];
        // tr ρS⁺ with the entries of S⁺ above the diagonal.
        let raised = |j: usize| w[j * n + j + 1] * self.raising[j];
        let plus = (0..n - 1).fold(c64::ZERO, |sum, j| sum + raised(j));
        let z = (0..n).map(|j| w[j * n + j].re * self.levels[j]).sum();
        [plus.re, plus.im, z]
    }

    /// Sum of the dipoles of the neighbours of a site, of the upper ones only if `up`.
    fn around(&self, w: &[c64], site: usize, up: bool) -> [f64; 3] {
        let mut sum = [0.0; 3];
        let ends = if up { &[true][..] } else { &[false, true] };
        for axis in 0..3 {
            for next in ends.iter().filter_map(|&up| self.shape.neighbour(site, axis, up)) {
                let dipole = self.dipole(w, next);
                (0..3).for_each(|a| sum[a] += dipole[a]);
            }
        }
        sum
    }

    /// Energy D(Sᶻ)² + K(Sᶻ)⁴ of a level.
    fn level(&self, j: usize) -> f64 {
        let SpinCouplings { quadratic, quartic, .. } = self.couplings;
        let square = self.levels[j] * self.levels[j];
        square * (quadratic + quartic * square)
    }
}

impl MatrixSystem for SuSpins {
    fn name(&self) -> &str {
        "su-spins"
    }

    fn parameters(&self) -> String {
        format!("{} levels, {} sites", self.n, self.shape.sites())
    }

    fn size(&self) -> usize {
        self.n
    }

    fn sites(&self) -> usize {
        self.shape.sites()
    }

    /// A noise for each operator of a basis at each site.
    fn noises(&self) -> usize {
        if self.couplings.bath.is_some() { self.sites() * self.n * self.n } else { 0 }
    }

    fn has_bath(&self) -> bool {
        self.couplings.bath.is_some()
    }

    fn generator(&self, w: &[c64], dt: f64, dw: &[f64], v: &mut [c64]) {
        let (n, SpinCouplings { exchange, field, bath, .. }) = (self.n, self.couplings);
        let sites = v.chunks_exact_mut(n * n).enumerate();
        for (site, v) in sites {
            let around = self.around(w, site, false);
            let [x, y, z] = std::array::from_fn(|a| exchange * around[a] + field[a]);
            v.fill(c64::ZERO);
            for j in 0..n {
                v[j * n + j] = c64::new((self.level(j) - z * self.levels[j]) * dt, 0.0);
                if j + 1 < n {
                    // −xSˣ − ySʸ = −½(x − iy)S⁺ and its adjoint.
                    let above = c64::new(-0.5 * x, 0.5 * y) * (self.raising[j] * dt);
                    (v[(j + 1) * n + j], v[j * n + j + 1]) = (above, above.conj());
                }
            }
        }
        let Some([alpha, kt]) = bath else { return };
        let [mut memory, mut turned] = [[c64::ZERO; LEVELS * LEVELS]; 2];
        let (memory, turned) = (&mut memory[..n * n], &mut turned[..n * n]);
        let size = (2.0 * alpha * kt).sqrt();
        let sites = v.chunks_exact_mut(n * n).zip(w.chunks_exact(n * n));
        for ((v, w), dw) in sites.zip(dw.chunks_exact(n * n)) {
            bracket(n, v, w, memory, turned);
            matrices(n, |i| size * dw[i], memory);
            let added = turned.iter().zip(&*memory);
            v.iter_mut().zip(added).for_each(|(v, (turned, noise))| *v += *turned * alpha + *noise);
        }
    }

    fn energy(&self, w: &[c64]) -> f64 {
        let n = self.n;
        let of_site = |site: usize| {
            let (own, around) = (self.dipole(w, site), self.around(w, site, true));
            let turned: f64 = (0..3)
                .map(|a| own[a] * (self.couplings.exchange * around[a] + self.couplings.field[a]))
                .sum();
            let at = site * n * n;
            (0..n).map(|j| self.level(j) * w[at + j * n + j].re).sum::<f64>() - turned
        };
        (0..self.sites()).map(of_site).sum()
    }
}
