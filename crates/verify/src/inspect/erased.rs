//! A system behind functions of slices, so that the checks are compiled once and not once for
//! every system.

use real::{Dual, Real, ScalarFunction, gradient};
use systems::{Invariant, PoissonSystem, vector_field_derivative};

use super::algebra::{Matrix, axis, transposed};

/// A scalar function of y with its derivatives.
pub trait Function {
    fn value(&self, y: &[f64]) -> f64;
    fn gradient(&self, y: &[f64]) -> Vec<f64>;
    fn hessian(&self, y: &[f64]) -> Matrix;
}

/// What the checks need of a system. `weights` are (dt, dw₁, …, dw_M).
pub trait System {
    fn name(&self) -> &'static str;
    fn dimension(&self) -> usize;
    fn noises(&self) -> usize;
    fn in_domain(&self, y: &[f64]) -> bool;
    /// B(y)v.
    fn structure(&self, y: &[f64], v: &[f64]) -> Vec<f64>;
    /// ∂B(y)/∂y_l v.
    fn structure_derivative(&self, y: &[f64], l: usize, v: &[f64]) -> Vec<f64>;
    /// h for these weights, differentiated by dual numbers.
    fn energy(&self, weights: &[f64]) -> Box<dyn Function + '_>;
    /// ∇h as the system implements it.
    fn gradient(&self, y: &[f64], weights: &[f64]) -> Vec<f64>;
    fn averaged_gradient(&self, a: &[f64], b: &[f64], weights: &[f64]) -> Vec<f64>;
    fn averaged_field(&self, a: &[f64], b: &[f64], weights: &[f64]) -> Vec<f64>;
    /// The predicted end of an implicit step and the bound of its residual.
    fn predict(&self, a: &[f64], weights: &[f64]) -> (Vec<f64>, f64);
    /// (B∇h)′v.
    fn field_derivative(&self, y: &[f64], weights: &[f64], v: &[f64]) -> Vec<f64>;
    /// Σ A_ml [fₘ, f_l] as the system implements it.
    fn commutators(&self, y: &[f64], areas: &Matrix) -> Vec<f64>;
    fn invariants(&self) -> Vec<Invariant>;
    /// Invariant number `index`, differentiated by dual numbers.
    fn invariant(&self, index: usize) -> Box<dyn Function + '_>;
}

impl dyn System + '_ {
    /// The weights with h = H₀ (m = 0) or h = Hₘ.
    pub fn weights(&self, m: usize) -> Vec<f64> {
        axis(self.noises() + 1, m)
    }

    /// Hₘ.
    pub fn hamiltonian(&self, m: usize) -> Box<dyn Function + '_> {
        self.energy(&self.weights(m))
    }

    /// B∇h.
    pub fn field(&self, y: &[f64], weights: &[f64]) -> Vec<f64> {
        self.structure(y, &self.gradient(y, weights))
    }

    /// The matrix B(y).
    pub fn matrix(&self, y: &[f64]) -> Matrix {
        let d = self.dimension();
        transposed(&(0..d).map(|j| self.structure(y, &axis(d, j))).collect())
    }

    /// The matrices ∂B(y)/∂y_l.
    pub fn matrix_derivatives(&self, y: &[f64]) -> Vec<Matrix> {
        let d = self.dimension();
        let column = |l: usize, j: usize| self.structure_derivative(y, l, &axis(d, j));
        (0..d).map(|l| transposed(&(0..d).map(|j| column(l, j)).collect())).collect()
    }
}

/// A [`System`] from a [`PoissonSystem`].
pub struct Erased<'a, S, const D: usize, const M: usize>(pub(super) &'a S);

/// The slice as an array; every caller passes a slice of length N.
fn array<const N: usize>(slice: &[f64]) -> [f64; N] {
    let mut array = [0.0; N];
    array.copy_from_slice(slice);
    array
}

/// (dt, dw).
fn split<const M: usize>(weights: &[f64]) -> (f64, [f64; M]) {
    (weights[0], array(&weights[1..]))
}

/// y with derivative 1 in component l.
fn seeded<const D: usize>(y: &[f64], l: usize) -> [Dual; D] {
    let mut y = array(y).map(Dual::fixed);
    y[l].derivative = 1.0;
    y
}

enum Formula<const M: usize> {
    Energy(f64, [f64; M]),
    Invariant(usize),
}

struct SystemFunction<'a, S, const D: usize, const M: usize> {
    system: &'a S,
    formula: Formula<M>,
}

impl<S: PoissonSystem<D, M>, const D: usize, const M: usize> ScalarFunction<D>
    for SystemFunction<'_, S, D, M>
{
    fn value<R: Real>(&self, y: [R; D]) -> R {
        match self.formula {
            Formula::Energy(dt, dw) => self.system.energy(y, dt, dw),
            Formula::Invariant(index) => self.system.invariant(index, y),
        }
    }
}

impl<S: PoissonSystem<D, M>, const D: usize, const M: usize> Function
    for SystemFunction<'_, S, D, M>
{
    fn value(&self, y: &[f64]) -> f64 {
        ScalarFunction::value(self, array(y))
    }
    fn gradient(&self, y: &[f64]) -> Vec<f64> {
        gradient(self, array(y)).to_vec()
    }
    fn hessian(&self, y: &[f64]) -> Matrix {
        let row = |l| gradient(self, seeded(y, l)).map(|component| component.derivative).to_vec();
        (0..D).map(row).collect()
    }
}

impl<S: PoissonSystem<D, M>, const D: usize, const M: usize> System for Erased<'_, S, D, M> {
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
        self.0.structure(array(y), array(v)).to_vec()
    }
    fn structure_derivative(&self, y: &[f64], l: usize, v: &[f64]) -> Vec<f64> {
        let product = self.0.structure(seeded(y, l), array(v).map(Dual::fixed));
        product.map(|component| component.derivative).to_vec()
    }
    fn energy(&self, weights: &[f64]) -> Box<dyn Function + '_> {
        let (dt, dw) = split(weights);
        Box::new(SystemFunction { system: self.0, formula: Formula::Energy(dt, dw) })
    }
    fn gradient(&self, y: &[f64], weights: &[f64]) -> Vec<f64> {
        let (dt, dw) = split(weights);
        self.0.gradient(array(y), dt, dw).to_vec()
    }
    fn averaged_gradient(&self, a: &[f64], b: &[f64], weights: &[f64]) -> Vec<f64> {
        let (dt, dw) = split(weights);
        self.0.averaged_gradient(array(a), array(b), dt, dw).to_vec()
    }
    fn averaged_field(&self, a: &[f64], b: &[f64], weights: &[f64]) -> Vec<f64> {
        let (dt, dw) = split(weights);
        self.0.averaged_field(array(a), array(b), dt, dw).to_vec()
    }
    fn predict(&self, a: &[f64], weights: &[f64]) -> (Vec<f64>, f64) {
        let (dt, dw) = split(weights);
        let (b, bound) = self.0.predict(array(a), dt, dw);
        (b.to_vec(), bound)
    }
    fn field_derivative(&self, y: &[f64], weights: &[f64], v: &[f64]) -> Vec<f64> {
        let (dt, dw) = split(weights);
        vector_field_derivative(self.0, array(y), dt, dw, array(v)).to_vec()
    }
    fn commutators(&self, y: &[f64], areas: &Matrix) -> Vec<f64> {
        let areas = std::array::from_fn(|m| array(&areas[m]));
        self.0.commutators(array(y), areas).to_vec()
    }
    fn invariants(&self) -> Vec<Invariant> {
        self.0.invariants()
    }
    fn invariant(&self, index: usize) -> Box<dyn Function + '_> {
        Box::new(SystemFunction { system: self.0, formula: Formula::Invariant(index) })
    }
}
