//! A system behind functions of slices, so that the checks are compiled once and not once for
//! every system.

use real::{Dual, Real, ScalarFunction, gradient, jacobian};
use systems::{HamiltonianIncrement, Invariant, PoissonSystem};

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
    /// The matrices ∂B(y)/∂y_l.
    fn matrix_derivatives(&self, y: &[f64]) -> Vec<Matrix>;
    /// h for these weights, differentiated by dual numbers.
    fn energy(&self, weights: &[f64]) -> Box<dyn Function + '_>;
    /// ∇h as the system implements it.
    fn gradient(&self, y: &[f64], weights: &[f64]) -> Vec<f64>;
    /// The averaged gradient and the averaged field.
    fn averages(&self, a: &[f64], b: &[f64], weights: &[f64]) -> [Vec<f64>; 2];
    /// The predicted end of an implicit step and the bound of its residual.
    fn predict(&self, a: &[f64], weights: &[f64]) -> (Vec<f64>, f64);
    /// B∇h and (B∇h)′.
    fn field(&self, y: &[f64], weights: &[f64]) -> (Vec<f64>, Matrix);
    /// Σ A_ml [fₘ, f_l] as the system implements it.
    fn commutators(&self, y: &[f64], areas: &Matrix) -> Vec<f64>;
    /// The claimed invariants, differentiated by dual numbers.
    fn invariants(&self) -> Vec<(Invariant, Box<dyn Function + '_>)>;
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

    /// The matrix B(y).
    pub fn matrix(&self, y: &[f64]) -> Matrix {
        let d = self.dimension();
        transposed(&(0..d).map(|j| self.structure(y, &axis(d, j))).collect())
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

fn derivatives<const D: usize>(y: [Dual; D]) -> Vec<f64> {
    y.map(|component| component.derivative).to_vec()
}

/// y with derivative 1 in component l.
fn seeded<const D: usize>(y: &[f64], l: usize) -> [Dual; D] {
    let mut y = array(y).map(Dual::fixed);
    y[l].derivative = 1.0;
    y
}

/// An invariant of a system, by its number.
struct NumberedInvariant<'a, S, const M: usize>(&'a S, usize);

impl<S: PoissonSystem<D, M>, const D: usize, const M: usize> ScalarFunction<D>
    for NumberedInvariant<'_, S, M>
{
    fn value<R: Real>(&self, y: [R; D]) -> R {
        self.0.invariant(self.1, y)
    }
}

/// A [`Function`] from a [`ScalarFunction`].
struct ErasedFunction<F, const D: usize>(F);

impl<F: ScalarFunction<D>, const D: usize> Function for ErasedFunction<F, D> {
    fn value(&self, y: &[f64]) -> f64 {
        self.0.value(array(y))
    }
    fn gradient(&self, y: &[f64]) -> Vec<f64> {
        gradient(&self.0, array(y)).to_vec()
    }
    fn hessian(&self, y: &[f64]) -> Matrix {
        (0..D).map(|l| derivatives(gradient(&self.0, seeded::<D>(y, l)))).collect()
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
    fn matrix_derivatives(&self, y: &[f64]) -> Vec<Matrix> {
        let unit = |j| array(&axis(D, j)).map(Dual::fixed);
        let column = |l, j| derivatives(self.0.structure(seeded::<D>(y, l), unit(j)));
        (0..D).map(|l| transposed(&(0..D).map(|j| column(l, j)).collect())).collect()
    }
    fn energy(&self, weights: &[f64]) -> Box<dyn Function + '_> {
        let (dt, dw) = split(weights);
        Box::new(ErasedFunction::<_, D>(HamiltonianIncrement { system: self.0, dt, dw }))
    }
    fn gradient(&self, y: &[f64], weights: &[f64]) -> Vec<f64> {
        let (dt, dw) = split(weights);
        self.0.gradient(array(y), dt, dw).to_vec()
    }
    fn averages(&self, a: &[f64], b: &[f64], weights: &[f64]) -> [Vec<f64>; 2] {
        let (a, b, (dt, dw)) = (array(a), array(b), split(weights));
        let gradient = self.0.averaged_gradient(a, b, dt, dw);
        [gradient, self.0.averaged_field(a, b, dt, dw)].map(Vec::from)
    }
    fn predict(&self, a: &[f64], weights: &[f64]) -> (Vec<f64>, f64) {
        let (dt, dw) = split(weights);
        let (b, bound) = self.0.predict(array(a), dt, dw);
        (b.to_vec(), bound)
    }
    fn field(&self, y: &[f64], weights: &[f64]) -> (Vec<f64>, Matrix) {
        let (dt, dw) = split(weights);
        let (field, rows) = jacobian(&HamiltonianIncrement { system: self.0, dt, dw }, array(y));
        (field.to_vec(), rows.map(Vec::from).into())
    }
    fn commutators(&self, y: &[f64], areas: &Matrix) -> Vec<f64> {
        let areas = std::array::from_fn(|m| array(&areas[m]));
        self.0.commutators(array(y), areas).to_vec()
    }
    fn invariants(&self) -> Vec<(Invariant, Box<dyn Function + '_>)> {
        let function = |index| ErasedFunction::<_, D>(NumberedInvariant(self.0, index));
        let claims = self.0.invariants().into_iter().enumerate();
        claims.map(|(index, claim)| (claim, Box::new(function(index)) as _)).collect()
    }
}
