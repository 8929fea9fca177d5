//! Quantum systems with classical noise.

use faer::c64;
use systems::SystemError;

use crate::{MatrixSystem, dense::product, system::inner};

/// Density matrix ρ with dρ = −i\[H, ρ\]dt − iΣ\[Lₘ, ρ\] ∘ dWₘ. The spectrum of each path is kept;
/// the mean obeys Lindblad's equation dρ/dt = −i\[H, ρ\] − ½Σ\[Lₘ, \[Lₘ, ρ\]\].
#[derive(Clone, Debug)]
pub struct Quantum {
    n: usize,
    hamiltonian: Vec<c64>,
    noises: Vec<Vec<c64>>,
    commute: bool,
}

/// Entries of operators that differ by less, relative to the largest, are equal.
const ROUNDING: f64 = 1e-12;

impl Quantum {
    /// System of n levels from the matrices H and L₁, …, column by column.
    ///
    /// # Errors
    /// [`SystemError`] unless all matrices have n² entries, n ≥ 2, and are Hermitian and finite.
    pub fn new(
        n: usize,
        hamiltonian: Vec<c64>,
        noises: Vec<Vec<c64>>,
    ) -> Result<Self, SystemError> {
        for (m, operator) in [&hamiltonian].into_iter().chain(&noises).enumerate() {
            let name = if m == 0 { "H".into() } else { format!("L{m}") };
            if n < 2 || operator.len() != n * n {
                let entries = operator.len();
                let message = format!("{name} has {entries} entries, not those of {n} levels");
                return Err(SystemError(message));
            }
            let most = operator.iter().fold(0.0f64, |most, x| most.max(x.norm_sqr())).sqrt();
            let fits = |j: usize, k: usize| {
                let difference = operator[k * n + j] - operator[j * n + k].conj();
                difference.norm_sqr().sqrt() <= ROUNDING * most
            };
            let all = (0..n * n).map(|at| (at % n, at / n));
            if let Some((j, k)) = all.into_iter().find(|&(j, k)| !fits(j, k)) {
                let (a, b) = (operator[k * n + j], operator[j * n + k]);
                let (j, k) = (j + 1, k + 1);
                return Err(SystemError(format!(
                    "{name} must be Hermitian: its entry ({j}, {k}) is {a}, that of ({k}, {j}) {b}"
                )));
            }
        }
        let commute = noises.iter().enumerate().all(|(m, a)| {
            noises[..m].iter().all(|b| {
                let [mut ab, mut ba] = [vec![c64::ZERO; n * n], vec![c64::ZERO; n * n]];
                product(n, a, b, false, &mut ab);
                product(n, b, a, false, &mut ba);
                let size = inner(&ab, &ab);
                ab.iter().zip(&ba).all(|(x, y)| (x - y).norm_sqr() <= ROUNDING.powi(2) * size)
            })
        });
        Ok(Self { n, hamiltonian, noises, commute })
    }
}

impl MatrixSystem for Quantum {
    fn name(&self) -> &str {
        "quantum"
    }

    fn parameters(&self) -> String {
        format!("{} levels, {} noises", self.n, self.noises.len())
    }

    fn size(&self) -> usize {
        self.n
    }

    fn noises(&self) -> usize {
        self.noises.len()
    }

    fn noises_commute(&self) -> bool {
        self.commute
    }

    fn generator(&self, _: &[c64], dt: f64, dw: &[f64], v: &mut [c64]) {
        v.iter_mut().zip(&self.hamiltonian).for_each(|(v, h)| *v = *h * dt);
        for (noise, dw) in self.noises.iter().zip(dw) {
            v.iter_mut().zip(noise).for_each(|(v, l)| *v += *l * *dw);
        }
    }

    fn energy(&self, w: &[c64]) -> f64 {
        inner(w, &self.hamiltonian)
    }
}
