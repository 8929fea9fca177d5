//! A system seen through functions of slices, so that the questions are compiled once and not for
//! every system.

use real::{Dual, Real, ScalarFunction, VectorFunction, directional, gradient};
use systems::{Invariant, PoissonSystem, vector_field, vector_field_derivative};

/// A square matrix, by rows.
pub(super) type Matrix = Vec<Vec<f64>>;

/// What the questions ask of a system. `weights` are (dt, dw₁, …, dw_M).
pub(super) trait Probe {
    fn name(&self) -> &'static str;
    fn dimension(&self) -> usize;
    fn noises(&self) -> usize;
    fn in_domain(&self, y: &[f64]) -> bool;
    /// B(y)v.
    fn structure(&self, y: &[f64], v: &[f64]) -> Vec<f64>;
    /// ∂B(y)/∂y_l v.
    fn structure_derivative(&self, y: &[f64], l: usize, v: &[f64]) -> Vec<f64>;
    fn energy(&self, y: &[f64], weights: &[f64]) -> f64;
    /// ∇h as the system gives it.
    fn gradient(&self, y: &[f64], weights: &[f64]) -> Vec<f64>;
    /// ∇h by dual numbers from the energy.
    fn dual_gradient(&self, y: &[f64], weights: &[f64]) -> Vec<f64>;
    fn averaged_gradient(&self, a: &[f64], b: &[f64], weights: &[f64]) -> Vec<f64>;
    fn averaged_field(&self, a: &[f64], b: &[f64], weights: &[f64]) -> Vec<f64>;
    /// `short_step`, where the system has one.
    fn short_step(&self, a: &[f64], weights: &[f64]) -> Option<(Vec<f64>, f64)>;
    /// Whether `short_steps` of two paths is, to the bit, `short_step` of each.
    fn short_steps_agree(&self, a: &[f64], b: &[f64], weights: &[f64]) -> bool;
    /// ∇²h, rows.
    fn hessian(&self, y: &[f64], weights: &[f64]) -> Matrix;
    /// B∇h.
    fn field(&self, y: &[f64], weights: &[f64]) -> Vec<f64>;
    /// (B∇h)′v.
    fn field_derivative(&self, y: &[f64], weights: &[f64], v: &[f64]) -> Vec<f64>;
    /// Σ A_ml [fₘ, f_l] as the system gives it.
    fn commutators(&self, y: &[f64], areas: &Matrix) -> Vec<f64>;
    fn invariants(&self) -> Vec<Invariant>;
    fn invariant(&self, index: usize, y: &[f64]) -> f64;
    fn invariant_gradient(&self, index: usize, y: &[f64]) -> Vec<f64>;
    fn invariant_hessian(&self, index: usize, y: &[f64]) -> Matrix;
}

/// A system behind [`Probe`].
pub(super) struct Of<'a, S, const D: usize, const M: usize>(pub(super) &'a S);

/// All slices come from vectors that this module or its callers made of length N.
fn array<const N: usize>(slice: &[f64]) -> [f64; N] {
    let mut array = [0.0; N];
    array.copy_from_slice(slice);
    array
}

fn unit<const N: usize>(i: usize) -> [f64; N] {
    let mut unit = [0.0; N];
    unit[i] = 1.0;
    unit
}

struct Structure<'a, S, const D: usize, const M: usize> {
    system: &'a S,
    v: [f64; D],
}

impl<S: PoissonSystem<D, M>, const D: usize, const M: usize> VectorFunction<D, D>
    for Structure<'_, S, D, M>
{
    fn value<R: Real>(&self, y: [R; D]) -> [R; D] {
        self.system.structure(y, self.v.map(R::constant))
    }
}

struct Energy<'a, S, const M: usize> {
    system: &'a S,
    dt: f64,
    dw: [f64; M],
}

impl<S: PoissonSystem<D, M>, const D: usize, const M: usize> ScalarFunction<D>
    for Energy<'_, S, M>
{
    fn value<R: Real>(&self, y: [R; D]) -> R {
        self.system.energy(y, self.dt, self.dw)
    }
}

struct InvariantFunction<'a, S, const M: usize> {
    system: &'a S,
    index: usize,
}

impl<S: PoissonSystem<D, M>, const D: usize, const M: usize> ScalarFunction<D>
    for InvariantFunction<'_, S, M>
{
    fn value<R: Real>(&self, y: [R; D]) -> R {
        self.system.invariant(self.index, y)
    }
}

impl<S: PoissonSystem<D, M>, const D: usize, const M: usize> Of<'_, S, D, M> {
    fn energy_of(&self, weights: &[f64]) -> Energy<'_, S, M> {
        Energy { system: self.0, dt: weights[0], dw: array(&weights[1..]) }
    }
}

/// The derivatives of a gradient along the axes, as rows: symmetric, so they are columns as well.
fn rows<F: ScalarFunction<D>, const D: usize>(f: &F, y: [f64; D]) -> Matrix {
    (0..D)
        .map(|i| {
            let mut seeded = y.map(Dual::fixed);
            seeded[i].derivative = 1.0;
            gradient(f, seeded).map(|component| component.derivative).to_vec()
        })
        .collect()
}

impl<S: PoissonSystem<D, M>, const D: usize, const M: usize> Probe for Of<'_, S, D, M> {
    fn name(&self) -> &'static str {
        self.0.name()
    }
    fn dimension(&self) -> usize {
        D
    }
    fn noises(&self) -> usize {
        M
    }
    fn in_domain(&self, y: &[f64]) -> bool {
        self.0.check_domain(array(y)).is_ok()
    }
    fn structure(&self, y: &[f64], v: &[f64]) -> Vec<f64> {
        self.0.structure::<f64>(array(y), array(v)).to_vec()
    }
    fn structure_derivative(&self, y: &[f64], l: usize, v: &[f64]) -> Vec<f64> {
        directional(&Structure::<S, D, M> { system: self.0, v: array(v) }, array(y), unit(l))
            .1
            .to_vec()
    }
    fn energy(&self, y: &[f64], weights: &[f64]) -> f64 {
        self.0.energy::<f64>(array(y), weights[0], array(&weights[1..]))
    }
    fn gradient(&self, y: &[f64], weights: &[f64]) -> Vec<f64> {
        self.0.gradient::<f64>(array(y), weights[0], array(&weights[1..])).to_vec()
    }
    fn dual_gradient(&self, y: &[f64], weights: &[f64]) -> Vec<f64> {
        gradient::<f64, _, D>(&self.energy_of(weights), array(y)).to_vec()
    }
    fn averaged_gradient(&self, a: &[f64], b: &[f64], weights: &[f64]) -> Vec<f64> {
        self.0
            .averaged_gradient::<f64>(array(a), array(b), weights[0], array(&weights[1..]))
            .to_vec()
    }
    fn averaged_field(&self, a: &[f64], b: &[f64], weights: &[f64]) -> Vec<f64> {
        self.0.averaged_field::<f64>(array(a), array(b), weights[0], array(&weights[1..])).to_vec()
    }
    fn short_step(&self, a: &[f64], weights: &[f64]) -> Option<(Vec<f64>, f64)> {
        let (b, bound) = self.0.short_step(array(a), weights[0], array(&weights[1..]));
        S::SOLVES_SHORT_STEPS.then(|| (b.to_vec(), bound))
    }
    fn short_steps_agree(&self, a: &[f64], b: &[f64], weights: &[f64]) -> bool {
        let (a, dt, dw): ([[f64; D]; 2], f64, [f64; M]) =
            ([array(a), array(b)], weights[0], array(&weights[1..]));
        let dw = [dw, dw.map(|w| -0.5 * w)];
        // Sign and payload of a NaN are not specified.
        let bits = |(z, bound): ([f64; D], f64)| {
            let of = |x: f64| if x.is_nan() { f64::NAN } else { x }.to_bits();
            (z.map(of), of(bound))
        };
        let alone = [0, 1].map(|i| bits(self.0.short_step(a[i], dt, dw[i])));
        alone == self.0.short_steps(a, dt, dw).map(bits)
    }
    fn hessian(&self, y: &[f64], weights: &[f64]) -> Matrix {
        rows::<_, D>(&self.energy_of(weights), array(y))
    }
    fn field(&self, y: &[f64], weights: &[f64]) -> Vec<f64> {
        vector_field::<S, f64, D, M>(self.0, array(y), weights[0], array(&weights[1..])).to_vec()
    }
    fn field_derivative(&self, y: &[f64], weights: &[f64], v: &[f64]) -> Vec<f64> {
        vector_field_derivative::<S, f64, D, M>(
            self.0,
            array(y),
            weights[0],
            array(&weights[1..]),
            array(v),
        )
        .to_vec()
    }
    fn commutators(&self, y: &[f64], areas: &Matrix) -> Vec<f64> {
        let mut matrix = [[0.0; M]; M];
        for (row, given) in matrix.iter_mut().zip(areas) {
            *row = array(given);
        }
        self.0.commutators::<f64>(array(y), matrix).to_vec()
    }
    fn invariants(&self) -> Vec<Invariant> {
        self.0.invariants()
    }
    fn invariant(&self, index: usize, y: &[f64]) -> f64 {
        self.0.invariant::<f64>(index, array(y))
    }
    fn invariant_gradient(&self, index: usize, y: &[f64]) -> Vec<f64> {
        gradient::<f64, _, D>(&InvariantFunction::<S, M> { system: self.0, index }, array(y))
            .to_vec()
    }
    fn invariant_hessian(&self, index: usize, y: &[f64]) -> Matrix {
        rows::<_, D>(&InvariantFunction::<S, M> { system: self.0, index }, array(y))
    }
}

/// The matrix B(y).
pub(super) fn matrix(system: &dyn Probe, y: &[f64]) -> Matrix {
    let d = system.dimension();
    transposed(&(0..d).map(|j| system.structure(y, &axis(d, j))).collect())
}

/// The matrices ∂B(y)/∂y_l.
pub(super) fn slopes(system: &dyn Probe, y: &[f64]) -> Vec<Matrix> {
    let d = system.dimension();
    (0..d)
        .map(|l| {
            transposed(&(0..d).map(|j| system.structure_derivative(y, l, &axis(d, j))).collect())
        })
        .collect()
}

/// The weights that pick H₀ (`m` = 0) or Hₘ.
pub(super) fn pick(system: &dyn Probe, m: usize) -> Vec<f64> {
    axis(system.noises() + 1, m)
}

pub(super) fn axis(n: usize, i: usize) -> Vec<f64> {
    let mut axis = vec![0.0; n];
    axis[i] = 1.0;
    axis
}

fn transposed(columns: &Matrix) -> Matrix {
    (0..columns.len()).map(|i| columns.iter().map(|column| column[i]).collect()).collect()
}
