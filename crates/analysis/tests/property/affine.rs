//! Random structures that are affine in y, with quadratic Casimirs.
//!
//! B(y) = T·B₀(T⁻¹(y − c))·Tᵀ for a Lie–Poisson structure B₀, a random shift c, and a product T of
//! shears with integer entries, so that T and T⁻¹ are exact. A Casimir C₀ becomes C₀(T⁻¹(y − c)).

use proptest::array::uniform;
use proptest::prelude::*;
use real::Real;
use systems::PoissonSystem;

use crate::rounding::dot;
use crate::structure::{Matrix, vector};

/// A Lie–Poisson structure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Algebra {
    /// so(3) on each three components; what is left does not move. The Casimir is |y|².
    Rotations,
    /// e(3) for y = (m, p). The Casimirs are m·p and |p|², of which none is definite.
    Motions,
}

/// A Lie–Poisson structure in other coordinates.
#[derive(Clone, Copy, Debug)]
pub struct Affine<const D: usize> {
    pub algebra: Algebra,
    /// T.
    forward: Matrix<D>,
    /// T⁻¹.
    backward: Matrix<D>,
    /// c.
    shift: [f64; D],
    /// Added to an entry on the diagonal of B: a mistake unless zero.
    pub spoilt: f64,
}

fn times<R: Real, const D: usize>(matrix: &Matrix<D>, x: [R; D]) -> [R; D] {
    std::array::from_fn(|i| dot(matrix[i].map(R::constant), x))
}

fn transposed<const D: usize>(matrix: &Matrix<D>) -> Matrix<D> {
    std::array::from_fn(|i| std::array::from_fn(|j| matrix[j][i]))
}

/// a × b of the components from i and from j on, added to those of `sum` from k on.
fn add_cross<R: Real, const D: usize>(
    sum: &mut [R; D],
    k: usize,
    (a, i): ([R; D], usize),
    (b, j): ([R; D], usize),
) {
    for n in 0..3 {
        let (next, last) = ((n + 1) % 3, (n + 2) % 3);
        sum[k + n] = sum[k + n] + a[i + next] * b[j + last] - a[i + last] * b[j + next];
    }
}

impl<const D: usize> Affine<D> {
    /// T⁻¹(y − c).
    fn original<R: Real>(&self, y: [R; D]) -> [R; D] {
        times(&self.backward, std::array::from_fn(|i| y[i] - self.shift[i]))
    }

    /// The number of Casimirs.
    pub fn casimirs(&self) -> usize {
        match self.algebra {
            Algebra::Rotations => 1,
            Algebra::Motions => 2,
        }
    }

    /// Casimir number `index` at y.
    pub fn casimir<R: Real>(&self, index: usize, y: [R; D]) -> R {
        let y = self.original(y);
        let of = |i: usize, j: usize| y[i] * y[j] + y[i + 1] * y[j + 1] + y[i + 2] * y[j + 2];
        match (self.algebra, index) {
            (Algebra::Rotations, _) => dot(y, y),
            (Algebra::Motions, 0) => of(0, 3),
            (Algebra::Motions, _) => of(3, 3),
        }
    }
}

impl<const D: usize> PoissonSystem<D, 1> for Affine<D> {
    fn name(&self) -> &'static str {
        "affine"
    }

    #[inline(never)]
    fn structure<R: Real>(&self, y: [R; D], v: [R; D]) -> [R; D] {
        let (y, u) = (self.original(y), times(&transposed(&self.forward), v));
        let mut product = [R::zero(); D];
        match self.algebra {
            Algebra::Rotations => {
                for k in (0..D / 3).map(|spin| 3 * spin) {
                    add_cross(&mut product, k, (y, k), (u, k));
                }
            }
            // (m × u + p × w, p × u) for (u, w).
            Algebra::Motions => {
                add_cross(&mut product, 0, (y, 0), (u, 0));
                add_cross(&mut product, 0, (y, 3), (u, 3));
                add_cross(&mut product, 3, (y, 3), (u, 0));
            }
        }
        let mut product = times(&self.forward, product);
        product[0] = product[0] + v[0] * self.spoilt;
        product
    }

    fn energy<R: Real>(&self, y: [R; D], dt: f64, dw: [f64; 1]) -> R {
        y[0] * (dt + dw[0])
    }
}

/// Row `to` of T is that row plus `factor` times row `from`; T⁻¹ follows.
fn sheared<const D: usize>(affine: &mut Affine<D>, to: usize, from: usize, factor: f64) {
    for j in 0..D {
        affine.forward[to][j] += factor * affine.forward[from][j];
        affine.backward[j][from] -= factor * affine.backward[j][to];
    }
}

/// Shears of a structure.
const SHEARS: usize = 4;

/// An algebra in random coordinates.
pub fn affine<const D: usize>(algebra: Algebra) -> impl Strategy<Value = Affine<D>> {
    let shear = (0..D, 1..D, prop_oneof![Just(-1.0), Just(1.0)]);
    (uniform::<_, SHEARS>(shear), vector(1.0)).prop_map(move |(shears, shift)| {
        let one: Matrix<D> =
            std::array::from_fn(|i| std::array::from_fn(|j| f64::from(u8::from(i == j))));
        let mut affine = Affine { algebra, forward: one, backward: one, shift, spoilt: 0.0 };
        for (to, distance, factor) in shears {
            sheared(&mut affine, to, (to + distance) % D, factor);
        }
        affine
    })
}
