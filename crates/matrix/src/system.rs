//! Systems of Hermitian matrices, and their coordinates.

use std::{ops::Range, sync::Arc};

use dgrad::Rule;
use faer::c64;
use real::{Row, WIDTH};
use systems::{
    Form, Invariant,
    paper::valid,
    run_time::{Description, Op, System, Weights, derived},
};

use crate::dense::{columns, product};

/// Equation dW = −i\[∇H₀(W), W\] dt − iΣ\[Lₘ, W\] ∘ dWₘ for Hermitian matrices W of size N at each
/// of some sites, with Hermitian ∇H₀ and Lₘ.
///
/// It is a Lie–Poisson equation on u(N) for −iW with the structure B(W)V = −i\[V, W\], and every
/// tr Wᵏ of a site is a Casimir. Matrices of all sites follow each other, column by column.
pub trait MatrixSystem: Send + Sync {
    /// Name in reports.
    fn name(&self) -> &str;

    /// Parameters in reports.
    fn parameters(&self) -> String {
        String::new()
    }

    /// The size N.
    fn size(&self) -> usize;

    /// Number of sites.
    fn sites(&self) -> usize {
        1
    }

    /// Number of noises.
    fn noises(&self) -> usize;

    /// Whether all Lₘ commute.
    fn noises_commute(&self) -> bool {
        self.noises() < 2
    }

    /// Whether a heat bath adds to ∇H₀.
    fn has_bath(&self) -> bool {
        false
    }

    /// Writes V = ∇H₀(W)dt + ΣLₘdwₘ.
    fn generator(&self, w: &[c64], dt: f64, dw: &[f64], v: &mut [c64]);

    /// H₀(W), of which [`generator`](Self::generator) has the gradient.
    fn energy(&self, w: &[c64]) -> f64;
}

/// Number of real coordinates of a system: N² for each site.
pub fn dimension(system: &(impl MatrixSystem + ?Sized)) -> usize {
    system.sites() * system.size() * system.size()
}

/// Writes matrices from their coordinates, for which ‖W‖² is the sum of squares: the diagonal, and
/// of the entries above it, column by column, the sum and the difference of their real and
/// imaginary parts. (A factor √2 would round, and drift.)
pub fn matrices(n: usize, coordinates: impl Fn(usize) -> f64, w: &mut [c64]) {
    for (site, w) in w.chunks_exact_mut(n * n).enumerate() {
        let mut next = site * n * n + n;
        for k in 0..n {
            w[k * n + k] = c64::new(coordinates(site * n * n + k), 0.0);
            for j in 0..k {
                let [sum, difference] = [coordinates(next), coordinates(next + 1)];
                let entry = c64::new(0.5 * (sum + difference), 0.5 * (sum - difference));
                (w[k * n + j], w[j * n + k], next) = (entry, entry.conj(), next + 2);
            }
        }
    }
}

/// Writes the coordinates of matrices, of their Hermitian parts.
pub fn coordinates(n: usize, w: &[c64], mut write: impl FnMut(usize, f64)) {
    for (site, w) in w.chunks_exact(n * n).enumerate() {
        let mut next = site * n * n + n;
        for k in 0..n {
            write(site * n * n + k, w[k * n + k].re);
            for j in 0..k {
                let mean = (w[k * n + j] + w[j * n + k].conj()) * 0.5;
                write(next, mean.re + mean.im);
                write(next + 1, mean.re - mean.im);
                next += 2;
            }
        }
    }
}

/// Adds ψψ*/|ψ|² of real amplitudes ψ to matrices.
pub fn pure(psi: &[f64], w: &mut Vec<c64>) {
    let (n, norm) = (psi.len(), psi.iter().map(|x| x * x).sum::<f64>());
    w.extend((0..n * n).map(|at| c64::new(psi[at % n] * psi[at / n] / norm, 0.0)));
}

/// Writes −i\[V, W\] for Hermitian matrices of all sites; `memory` has N² numbers.
pub fn bracket(n: usize, v: &[c64], w: &[c64], memory: &mut [c64], out: &mut [c64]) {
    let sites = v.chunks_exact(n * n).zip(w.chunks_exact(n * n));
    for ((v, w), out) in sites.zip(out.chunks_exact_mut(n * n)) {
        product(n, v, w, false, memory);
        columns(n, out, |first, out| {
            for (k, column) in (first..).zip(out.chunks_exact_mut(n)) {
                for (j, out) in column.iter_mut().enumerate() {
                    let [x, y] = [memory[k * n + j], memory[j * n + k]];
                    // −i(x − ȳ).
                    *out = c64::new(x.im + y.im, y.re - x.re);
                }
            }
        });
    }
}

/// Sums of tr Wᵏ over all sites, for k from 1 to `most`.
pub fn traces(n: usize, w: &[c64], most: usize) -> Vec<f64> {
    let mut sums = vec![0.0; most];
    for w in w.chunks_exact(n * n) {
        let (mut power, mut next) = (w.to_vec(), w.to_vec());
        // tr W²ᵏ = ⟨Wᵏ, Wᵏ⟩ and tr W²ᵏ⁺¹ = ⟨Wᵏ, Wᵏ⁺¹⟩.
        sums[0] += (0..n).map(|j| w[j * n + j].re).sum::<f64>();
        for k in 1..=most / 2 {
            sums[2 * k - 1] += inner(&power, &power);
            if 2 * k < most {
                product(n, &power, w, false, &mut next);
                sums[2 * k] += inner(&power, &next);
                std::mem::swap(&mut power, &mut next);
            }
        }
    }
    sums
}

/// ⟨A, B⟩ = Re tr A*B.
pub fn inner(a: &[c64], b: &[c64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a.re * b.re + a.im * b.im).sum()
}

/// A system of matrices in its coordinates: the [`System`] of problems, inspections and of schemes
/// for any system.
pub struct InCoordinates<S: ?Sized> {
    /// The system of matrices.
    pub system: Arc<S>,
    description: Description,
}

/// Casimirs that tables have: tr W², tr W³ and tr W⁴, summed over sites.
const LAWS: [Invariant; 3] = {
    let two = Invariant::quadratic_casimir("C2", "tr W²");
    let three =
        Invariant { name: "C3", formula: "tr W³", form: Form::Homogeneous, degree: 3.0, ..two };
    [two, three, Invariant { name: "C4", formula: "tr W⁴", degree: 4.0, ..three }]
};

/// Whether path p has the bits of path 0.
fn is_first(rows: &[Row], p: usize) -> bool {
    rows.iter().all(|row| row[p].to_bits() == row[0].to_bits())
}

/// The increments of path p.
fn increments(h: Weights<'_>, p: usize) -> Vec<f64> {
    h.dw.iter().map(|row| row[p]).collect()
}

impl<S: MatrixSystem + ?Sized> InCoordinates<S> {
    /// The system in its coordinates.
    pub fn new(system: Arc<S>) -> Self {
        let description = Description {
            parameters: system.parameters(),
            has_bath: system.has_bath(),
            invariants: LAWS[..system.size().clamp(2, 4) - 1].to_vec(),
            noises_commute: system.noises_commute(),
            ..Description::new(
                system.name(),
                dimension(&*system),
                system.noises(),
                valid(Rule::new(1)),
            )
        };
        Self { system, description }
    }

    /// The matrices of path p.
    fn read(&self, rows: &[Row], p: usize) -> Vec<c64> {
        let mut w = vec![c64::ZERO; self.description.dimension];
        matrices(self.system.size(), |i| rows[i][p], &mut w);
        w
    }

    /// V = ∇H₀(W)dt + ΣLₘdwₘ.
    fn generator(&self, w: &[c64], dt: f64, dw: &[f64]) -> Vec<c64> {
        let mut v = vec![c64::ZERO; w.len()];
        self.system.generator(w, dt, dw, &mut v);
        v
    }

    /// −i\[V, W\].
    fn field(&self, v: &[c64], w: &[c64]) -> Vec<c64> {
        let n = self.system.size();
        let (mut memory, mut out) = (vec![c64::ZERO; n * n], vec![c64::ZERO; w.len()]);
        bracket(n, v, w, &mut memory, &mut out);
        out
    }

    /// Operation on one path.
    fn on_path(&self, op: Op<&[Row]>, h: Weights<'_>, p: usize, out: &mut [Row]) {
        let read = |rows: &[Row]| self.read(rows, p);
        let dw = increments(h, p);
        let result = match op {
            Op::Structure { y, v } => self.field(&read(v), &read(y)),
            Op::StructureAlong { u, v, .. } => self.field(&read(v), &read(u)),
            Op::Gradient { y } => self.generator(&read(y), h.dt, &dw),
            // The central difference is exact for quadratic gradients.
            Op::Hessian { y, u } => {
                let (y, u) = (read(y), read(u));
                let scale = (inner(&y, &y) / inner(&u, &u).max(f64::MIN_POSITIVE)).sqrt().max(1e-9);
                let at = |by: f64| {
                    let moved: Vec<c64> = y.iter().zip(&u).map(|(y, u)| *y + *u * by).collect();
                    self.generator(&moved, h.dt, &dw)
                };
                let both = at(scale).into_iter().zip(at(-scale));
                both.map(|(a, b)| (a - b) * (0.5 / scale)).collect()
            }
            Op::ItoCorrection { y } => {
                let (y, noises) = (read(y), self.system.noises());
                let mut sum = vec![c64::ZERO; y.len()];
                for m in 0..noises {
                    let mut dw = vec![0.0; noises];
                    dw[m] = 1.0;
                    let v = self.generator(&y, 0.0, &dw);
                    let twice = self.field(&v, &self.field(&v, &y));
                    sum.iter_mut().zip(twice).for_each(|(sum, of)| *sum += of * 0.5);
                }
                sum
            }
            _ => panic!("{} has no {op:?}", self.description.name),
        };
        coordinates(self.system.size(), &result, |i, value| out[i][p] = value);
    }
}

impl<S: MatrixSystem + ?Sized> System for InCoordinates<S> {
    fn description(&self) -> &Description {
        &self.description
    }

    /// Equal paths are computed once.
    fn apply(
        &self,
        op: Op<&[Row]>,
        _: Range<usize>,
        h: Weights<'_>,
        out: &mut [Row],
        scratch: &mut [Row],
    ) {
        if op.is_average() {
            return derived(self, op, h, out, scratch);
        }
        for p in 0..WIDTH {
            if p > 0 && is_first(h.dw, p) && op.arguments().all(|rows| is_first(rows, p)) {
                out.iter_mut().for_each(|row| row[p] = row[0]);
            } else {
                self.on_path(op, h, p, out);
            }
        }
    }

    /// The Hamiltonian of a noise is ⟨W, Lₘ⟩.
    fn energy(&self, y: &[Row], h: Weights<'_>, out: &mut Row, _: &mut [Row]) {
        for p in 0..WIDTH {
            let w = self.read(y, p);
            let noise = inner(&w, &self.generator(&w, 0.0, &increments(h, p)));
            out[p] = self.system.energy(&w) * h.dt + noise;
        }
    }

    fn invariant(&self, index: usize, y: &[Row], out: &mut Row, _: &mut [Row]) {
        for p in 0..WIDTH {
            out[p] = if p > 0 && is_first(y, p) {
                out[0]
            } else {
                traces(self.system.size(), &self.read(y, p), index + 2)[index + 1]
            };
        }
    }
}
