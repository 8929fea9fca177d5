//! Functions of matrices, as studies and expectations take them.

use std::sync::Arc;

use faer::c64;
use mc::Observe;
use real::{PathMask, Row};

use crate::{
    MatrixSystem, Quantum, Sphere, SuSpins,
    system::{dimension, inner, matrices},
};

type OfMatrices = dyn Fn(&[c64]) -> f64 + Send + Sync;

/// A function of the matrices of a system, with its name.
#[derive(Clone)]
pub struct Function {
    name: String,
    n: usize,
    dimension: usize,
    of: Arc<OfMatrices>,
}

impl Function {
    /// A function of a system and its matrices.
    pub fn new<S: MatrixSystem + 'static>(
        name: impl Into<String>,
        system: &Arc<S>,
        of: impl Fn(&S, &[c64]) -> f64 + Send + Sync + 'static,
    ) -> Self {
        let (n, dimension, own) = (system.size(), dimension(&**system), Arc::clone(system));
        Self { name: name.into(), n, dimension, of: Arc::new(move |w| of(&own, w)) }
    }
}

/// Rows after the coordinates are not read.
impl Observe for Function {
    fn name(&self) -> &str {
        &self.name
    }

    /// Paths that are equal to the first one are not computed again.
    fn evaluate(&self, y: &[Row], live: PathMask, values: &mut Row) {
        let (y, mut w) = (&y[..self.dimension], vec![c64::ZERO; self.dimension]);
        let mut first: Option<usize> = None;
        for p in live.paths() {
            let known = first.filter(|&q| y.iter().all(|y| y[p].to_bits() == y[q].to_bits()));
            values[p] = match known {
                Some(q) => values[q],
                None => {
                    matrices(self.n, |i| y[i][p], &mut w);
                    (self.of)(&w)
                }
            };
            first.get_or_insert(p);
        }
    }
}

impl Sphere {
    /// Energy ½∫|u|², enstrophy ∫ω², and the energies of degrees from 1 to `most`: `energy1`, ….
    pub fn functions(self: &Arc<Self>, most: usize) -> Vec<Function> {
        let of_degree = |l: usize| {
            Function::new(format!("energy{l}"), self, move |fluid, w| {
                fluid.harmonics().power(&fluid.relative(w), l) / (2 * l * (l + 1)) as f64
            })
        };
        let energy = Function::new("energy", self, Self::kinetic_energy);
        let enstrophy = Function::new("enstrophy", self, |_, w| inner(w, w));
        [energy, enstrophy].into_iter().chain((1..=most).map(of_degree)).collect()
    }
}

impl SuSpins {
    /// Means over the sites: dipole `mx`, `my`, `mz`, populations `p1`, …, and `energy`.
    pub fn functions(self: &Arc<Self>) -> Vec<Function> {
        let mean = |(axis, name)| {
            Function::new(name, self, move |spins, w| {
                let sites = spins.sites();
                (0..sites).map(|site| spins.dipole(w, site)[axis]).sum::<f64>() / sites as f64
            })
        };
        let energy =
            Function::new("energy", self, |spins, w| spins.energy(w) / spins.sites() as f64);
        let means = ["mx", "my", "mz"].into_iter().enumerate().map(mean);
        means.chain(populations(self)).chain([energy]).collect()
    }
}

impl Quantum {
    /// Populations `p1`, …, `energy` tr Hρ, `purity` tr ρ², and entries above the diagonal:
    /// `re1_2`, `im1_2`, ….
    pub fn functions(self: &Arc<Self>) -> Vec<Function> {
        let n = self.size();
        let entry = |part: &str, j: usize, k: usize, of: fn(c64) -> f64| {
            let name = format!("{part}{}_{}", j + 1, k + 1);
            Function::new(name, self, move |_, w| of(w[k * n + j]))
        };
        let pairs = (0..n).flat_map(|k| (0..k).map(move |j| (j, k)));
        let entries =
            pairs.flat_map(|(j, k)| [entry("re", j, k, |x| x.re), entry("im", j, k, |x| x.im)]);
        let energy = Function::new("energy", self, Self::energy);
        let purity = Function::new("purity", self, |_, w| inner(w, w));
        populations(self).chain([energy, purity]).chain(entries).collect()
    }
}

/// Mean population of each level over the sites.
fn populations<S: MatrixSystem + 'static>(system: &Arc<S>) -> impl Iterator<Item = Function> {
    let n = system.size();
    (0..n).map(move |j| {
        Function::new(format!("p{}", j + 1), system, move |system, w| {
            w.chunks(n * n).map(|w| w[j * n + j].re).sum::<f64>() / system.sites() as f64
        })
    })
}
