//! How B depends on y, which decides whether a step can be linearly implicit.

use real::{Bounded, Degree, elementary};

use crate::{PoissonSystem, cayley::identity_minus_half, field};

/// Dependence of the structure matrix B on y.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Linearity {
    /// Not at all.
    Constant,
    /// B(y) − B(0) is linear in y, as for every Lie–Poisson system.
    Affine,
    /// In another way, or its formula does not show it.
    Other,
}

/// Dependence of B on y, shown by its formula: the degree of every column B(y)eⱼ as a polynomial in
/// y, which [`Bounded`] bounds, at this point. A formula made of pieces may be something else
/// elsewhere.
pub fn linearity<S: PoissonSystem<D, M>, const D: usize, const M: usize>(
    system: &S,
    y: [f64; D],
) -> Linearity {
    let (degree, pieces) = Bounded::piecewise(|| {
        (0..D).fold(Degree::CONSTANT, |degree, j| {
            let mut unit = [Bounded::exact(0.0); D];
            unit[j] = Bounded::exact(1.0);
            let column = system.structure(y.map(Bounded::variable), unit);
            column.iter().fold(degree, |degree, entry| degree + entry.degree)
        })
    });
    match degree {
        _ if pieces => Linearity::Other,
        Degree::CONSTANT => Linearity::Constant,
        Degree::VARIABLE => Linearity::Affine,
        _ => Linearity::Other,
    }
}

/// Vectors v that [`always_solvable`] tries, and their sizes ‖v‖ from least to largest.
const TRIED: u32 = 64;
const SIZES: [f64; 2] = [0.1, 1e3];

/// Relative error of a determinant by elimination, with a margin: D ε times a growth of the pivots.
const ROUNDING: f64 = 1e-9;

/// Whether z = y + B((y+z)/2)·v has a solution for every v, found by search: B is constant, or it
/// is affine and det(I − ½A(v)) ≥ 1 for 64 vectors v of many directions and sizes, where A(v)x =
/// B(x)v − B(0)v.
///
/// If all eigenvalues of A(v) are imaginary for all v, as where a quadratic Casimir is positive
/// definite, the determinant is Π(1 + ωᵢ²/4). A real eigenvalue λ of A(v) makes I − ½A(2v/λ)
/// singular, and the determinant is below one on the way there.
pub fn always_solvable<S: PoissonSystem<D, M>, const D: usize, const M: usize>(
    system: &S,
    y: [f64; D],
) -> bool {
    match linearity(system, y) {
        Linearity::Constant => true,
        Linearity::Other => false,
        Linearity::Affine => shown_solvable(D, |v| {
            let v: [f64; D] = std::array::from_fn(|i| v[i]);
            vec![identity_minus_half(system, v).map(Vec::from).to_vec()]
        }),
    }
}

/// A square matrix, row by row.
type Matrix = Vec<Vec<f64>>;

/// The search of [`always_solvable`], for the diagonal blocks of I − ½A(v) of any dimension.
pub fn shown_solvable(dimension: usize, blocks: impl Fn(&[f64]) -> Vec<Matrix>) -> bool {
    let determinant = |v: &[f64]| blocks(v).into_iter().map(determinant).product::<f64>();
    (0..TRIED).all(|n| determinant(&direction(n, dimension)) >= 1.0 - ROUNDING)
}

/// Vector number n: a direction by multiples of the golden ratio, of a size between [`SIZES`].
fn direction(n: u32, dimension: usize) -> Vec<f64> {
    let position = f64::from(n) / f64::from(TRIED - 1);
    let size = SIZES[0] * elementary::powf(SIZES[1] / SIZES[0], position);
    let v: Vec<f64> = (0..dimension).map(|i| field::direction(n, dimension, i)).collect();
    let norm = v.iter().map(|x| x * x).sum::<f64>().sqrt();
    v.iter().map(|x| x * size / norm).collect()
}

/// The determinant, by elimination with pivoting.
fn determinant(mut a: Matrix) -> f64 {
    let mut determinant = 1.0;
    for k in 0..a.len() {
        let largest =
            (k..a.len()).max_by(|&i, &j| a[i][k].abs().total_cmp(&a[j][k].abs())).unwrap_or(k);
        if largest != k {
            a.swap(k, largest);
            determinant = -determinant;
        }
        let (above, below) = a.split_at_mut(k + 1);
        let pivot = &above[k];
        determinant *= pivot[k];
        for row in below {
            let factor = row[k] / pivot[k];
            for j in k + 1..row.len() {
                row[j] -= factor * pivot[j];
            }
        }
    }
    determinant
}
