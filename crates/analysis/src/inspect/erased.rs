//! A system behind functions of slices, so that the checks are compiled once and not once for
//! every system.

use real::{Bounded, Degree, Dual, Real, ScalarFunction, directional, gradient};
use systems::{HamiltonianIncrement, Invariant, PoissonSystem};

use super::{
    advice::{Override, WithoutIteration},
    algebra::{Matrix, axis, transposed},
};

/// A scalar function of y with its derivatives.
pub trait Function {
    fn value(&self, y: &[f64]) -> Bounded;
    fn gradient(&self, y: &[f64]) -> Vec<Bounded>;
    fn hessian(&self, y: &[f64]) -> Matrix<Bounded>;
}

/// What the checks need of a system. `weights` are (dt, dw₁, …, dw_M). Results carry bounds of
/// their rounding errors.
pub trait System {
    fn name(&self) -> &str;
    fn dimension(&self) -> usize;
    fn noises(&self) -> usize;
    fn in_domain(&self, y: &[f64]) -> bool;
    /// Whether B or the energy may be made of pieces, see [`Bounded::piecewise`].
    fn piecewise(&self, y: &[f64]) -> bool;
    /// B(y)v.
    fn structure(&self, y: &[f64], v: &[Bounded]) -> Vec<Bounded>;
    /// The matrices ∂B(y)/∂y_l.
    fn matrix_derivatives(&self, y: &[f64]) -> Vec<Matrix<Bounded>>;
    /// h for these weights, differentiated by dual numbers.
    fn energy(&self, weights: &[f64]) -> Box<dyn Function + '_>;
    /// ∇h as the system implements it.
    fn gradient(&self, y: &[f64], weights: &[f64]) -> Vec<Bounded>;
    /// The averaged gradient and the averaged field.
    fn averages(&self, a: &[f64], b: &[f64], weights: &[f64]) -> [Vec<Bounded>; 2];
    /// The predicted end of an implicit step and the bound of its residual.
    fn predict(&self, a: &[f64], weights: &[f64]) -> (Vec<f64>, f64);
    /// B∇h and (B∇h)′.
    fn field(&self, y: &[f64], weights: &[f64]) -> (Vec<Bounded>, Matrix<Bounded>);
    /// Σ A_ml [fₘ, f_l] as the system implements it.
    fn commutators(&self, y: &[f64], areas: &Matrix) -> Vec<Bounded>;
    /// What `sexp-li` and `nv` say of the system around y.
    fn without_iteration(&self, y: &[f64]) -> WithoutIteration;
    /// The methods that are worth writing out.
    fn overrides(&self, points: &[Vec<f64>]) -> Vec<Override>;
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
    pub fn matrix(&self, y: &[f64]) -> Matrix<Bounded> {
        let d = self.dimension();
        let unit = |j| axis(d, j).into_iter().map(Bounded::exact).collect::<Vec<_>>();
        transposed(&(0..d).map(|j| self.structure(y, &unit(j))).collect())
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

fn variables<const D: usize>(y: &[f64]) -> [Bounded; D] {
    array(y).map(Bounded::variable)
}

fn derivatives<const D: usize>(y: [Dual<Bounded>; D]) -> Vec<Bounded> {
    y.map(|component| component.derivative()).to_vec()
}

/// y with derivative 1 in component l.
fn seeded<const D: usize>(y: &[f64], l: usize) -> [Dual<Bounded>; D] {
    let mut y = variables(y).map(Dual::fixed);
    y[l] = Dual::new(y[l].value, Bounded::exact(1.0));
    y
}

/// The values of a formula; those of one with pieces are no polynomial.
pub(super) fn values(formula: impl FnOnce() -> Vec<Bounded>) -> Vec<Bounded> {
    let (mut values, piecewise) = Bounded::piecewise(formula);
    if piecewise {
        values.iter_mut().for_each(|x| x.degree = Degree::NONE);
    }
    values
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
    fn value(&self, y: &[f64]) -> Bounded {
        values(|| vec![self.0.value(variables(y))])[0]
    }
    fn gradient(&self, y: &[f64]) -> Vec<Bounded> {
        values(|| gradient(&self.0, variables(y)).to_vec())
    }
    fn hessian(&self, y: &[f64]) -> Matrix<Bounded> {
        let row = |l| values(|| derivatives(gradient(&self.0, seeded::<D>(y, l))));
        (0..D).map(row).collect()
    }
}

impl<S: PoissonSystem<D, M>, const D: usize, const M: usize> System for Erased<'_, S, D, M> {
    fn name(&self) -> &str {
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
    fn piecewise(&self, y: &[f64]) -> bool {
        let h = HamiltonianIncrement { system: self.0, dt: 1.0, dw: [1.0; M] };
        let along = [Bounded::exact(1.0); D];
        Bounded::piecewise(|| directional(&h, variables(y), along)).1
    }
    fn structure(&self, y: &[f64], v: &[Bounded]) -> Vec<Bounded> {
        let v = std::array::from_fn(|i| v[i]);
        values(|| self.0.structure(variables(y), v).to_vec())
    }
    fn matrix_derivatives(&self, y: &[f64]) -> Vec<Matrix<Bounded>> {
        let unit = |j| array(&axis(D, j)).map(|x| Dual::fixed(Bounded::exact(x)));
        let column = |l, j| values(|| derivatives(self.0.structure(seeded::<D>(y, l), unit(j))));
        (0..D).map(|l| transposed(&(0..D).map(|j| column(l, j)).collect())).collect()
    }
    fn energy(&self, weights: &[f64]) -> Box<dyn Function + '_> {
        let (dt, dw) = split(weights);
        Box::new(ErasedFunction::<_, D>(HamiltonianIncrement { system: self.0, dt, dw }))
    }
    fn gradient(&self, y: &[f64], weights: &[f64]) -> Vec<Bounded> {
        let (dt, dw) = split(weights);
        values(|| self.0.gradient(variables(y), dt, dw).to_vec())
    }
    fn averages(&self, a: &[f64], b: &[f64], weights: &[f64]) -> [Vec<Bounded>; 2] {
        let (a, b, (dt, dw)) = (variables(a), variables(b), split(weights));
        [
            values(|| self.0.averaged_gradient(a, b, dt, dw).to_vec()),
            values(|| self.0.averaged_field(a, b, dt, dw).to_vec()),
        ]
    }
    fn predict(&self, a: &[f64], weights: &[f64]) -> (Vec<f64>, f64) {
        let (dt, dw) = split(weights);
        let (b, bound) = self.0.predict(array(a), dt, dw);
        (b.to_vec(), bound)
    }
    fn field(&self, y: &[f64], weights: &[f64]) -> (Vec<Bounded>, Matrix<Bounded>) {
        let (dt, dw) = split(weights);
        let h = HamiltonianIncrement { system: self.0, dt, dw };
        let along = |l| {
            let direction = array(&axis(D, l)).map(Bounded::exact);
            values(|| {
                let (field, slope) = directional(&h, variables(y), direction);
                [field, slope].concat()
            })
        };
        let columns: Matrix<Bounded> = (0..D).map(along).collect();
        let field = columns[0][..D].to_vec();
        let columns = columns.iter().map(|column| column[D..].to_vec()).collect();
        (field, transposed(&columns))
    }
    fn commutators(&self, y: &[f64], areas: &Matrix) -> Vec<Bounded> {
        let areas = std::array::from_fn(|m| array(&areas[m]));
        values(|| self.0.commutators(variables(y), areas).to_vec())
    }
    fn without_iteration(&self, y: &[f64]) -> WithoutIteration {
        WithoutIteration::of(self.0, array(y))
    }
    fn overrides(&self, points: &[Vec<f64>]) -> Vec<Override> {
        Override::worthwhile(self.0, points)
    }
    fn invariants(&self) -> Vec<(Invariant, Box<dyn Function + '_>)> {
        let function = |index| ErasedFunction::<_, D>(NumberedInvariant(self.0, index));
        let claims = self.0.invariants().into_iter().enumerate();
        claims.map(|(index, claim)| (claim, Box::new(function(index)) as _)).collect()
    }
}
