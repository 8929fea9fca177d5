//! Random skew structures B(y), with and without a Casimir.

use proptest::array::uniform;
use proptest::prelude::*;
use real::Real;

use crate::rounding::dot;

/// A square matrix, by rows.
pub type Matrix<const D: usize> = [[f64; D]; D];

/// A linear or quadratic Casimir.
#[derive(Clone, Copy, Debug)]
pub enum Casimir<const D: usize> {
    /// βᵀy.
    Linear([f64; D]),
    /// ½yᵀQy, Q symmetric: definite, indefinite or rank deficient.
    Quadratic(Matrix<D>),
}

impl<const D: usize> Casimir<D> {
    /// ∇C(y).
    pub fn normal<R: Real>(&self, y: [R; D]) -> [R; D] {
        match self {
            Self::Linear(beta) => beta.map(R::constant),
            Self::Quadratic(q) => times(q, y),
        }
    }
}

/// B(y) up to a positive factor.
#[derive(Clone, Copy, Debug)]
pub enum Base<const D: usize> {
    /// S, skew.
    Constant(Matrix<D>),
    /// Σₖ yₖCₖ with skew Cₖ, like a Lie–Poisson structure but for Jacobi's identity.
    Linear([Matrix<D>; D]),
    /// v ↦ n × v with n = ∇C, in three dimensions.
    Cross(Casimir<D>),
    /// |n|²S + n(Sn)ᵀ − (Sn)nᵀ: S between two projections onto the plane orthogonal to n = ∇C.
    Projected(Casimir<D>, Matrix<D>),
    /// ghᵀ − hgᵀ with g = Kn and h = Ln orthogonal to n = ∇C, since K and L are skew.
    Wedge(Casimir<D>, Matrix<D>, Matrix<D>),
}

/// A positive factor of B(y).
#[derive(Clone, Copy, Debug)]
pub enum Scale<const D: usize> {
    /// 1.
    One,
    /// 1 + (wᵀy)².
    Growing([f64; D]),
    /// 1/(1 + |y|²).
    Bounded,
    /// exp(wᵀy).
    Exponential([f64; D]),
}

/// B(y) = scale·base.
#[derive(Clone, Copy, Debug)]
pub struct Structure<const D: usize> {
    pub scale: Scale<D>,
    pub base: Base<D>,
}

fn times<R: Real, const D: usize>(matrix: &Matrix<D>, v: [R; D]) -> [R; D] {
    let mut product = [R::zero(); D];
    for i in 0..D {
        product[i] = dot(matrix[i].map(R::constant), v);
    }
    product
}

impl<const D: usize> Base<D> {
    fn apply<R: Real>(&self, y: [R; D], v: [R; D]) -> [R; D] {
        let mut result = [R::zero(); D];
        match self {
            Self::Constant(s) => result = times(s, v),
            Self::Linear(c) => {
                for k in 0..D {
                    let part = times(&c[k], v);
                    for i in 0..D {
                        result[i] = result[i] + part[i] * y[k];
                    }
                }
            }
            Self::Cross(casimir) => {
                let n = casimir.normal(y);
                for i in 0..D {
                    let (j, k) = ((i + 1) % D, (i + 2) % D);
                    result[i] = n[j] * v[k] - n[k] * v[j];
                }
            }
            Self::Projected(casimir, s) => {
                let n = casimir.normal(y);
                let (sn, sv) = (times(s, n), times(s, v));
                let (square, along, across) = (dot(n, n), dot(n, v), dot(sn, v));
                for i in 0..D {
                    result[i] = square * sv[i] + n[i] * across - sn[i] * along;
                }
            }
            Self::Wedge(casimir, k, l) => {
                let n = casimir.normal(y);
                let (g, h) = (times(k, n), times(l, n));
                let (gv, hv) = (dot(g, v), dot(h, v));
                for i in 0..D {
                    result[i] = g[i] * hv - h[i] * gv;
                }
            }
        }
        result
    }

    /// Its Casimir, if it was built to have one.
    pub fn casimir(&self) -> Option<Casimir<D>> {
        match self {
            Self::Constant(_) | Self::Linear(_) => None,
            Self::Cross(casimir) | Self::Projected(casimir, _) | Self::Wedge(casimir, ..) => {
                Some(*casimir)
            }
        }
    }
}

impl<const D: usize> Structure<D> {
    /// B(y)·v. Not inlined: a test has no need for speed, and it is compiled for many kinds of
    /// numbers.
    #[inline(never)]
    pub fn apply<R: Real>(&self, y: [R; D], v: [R; D]) -> [R; D] {
        let mut result = self.base.apply(y, v);
        let one = R::one();
        let factor = match self.scale {
            Scale::One => return result,
            Scale::Growing(w) => {
                let along = dot(w.map(R::constant), y);
                one + along * along
            }
            Scale::Bounded => one / (one + dot(y, y)),
            Scale::Exponential(w) => dot(w.map(R::constant), y).exp(),
        };
        for i in 0..D {
            result[i] = result[i] * factor;
        }
        result
    }
}

/// Numbers in [−size, size].
pub fn vector<const D: usize>(size: f64) -> impl Strategy<Value = [f64; D]> + Clone {
    uniform(-size..size)
}

/// Entries of skew matrices: B∇H is then of the size of y, and most truncated steps can be solved.
const SKEW: f64 = 0.5;

/// A skew matrix.
pub fn skew<const D: usize>() -> impl Strategy<Value = Matrix<D>> + Clone {
    uniform(vector(SKEW)).prop_map(|mut matrix: Matrix<D>| {
        for i in 0..D {
            matrix[i][i] = 0.0;
            for j in 0..i {
                matrix[i][j] = -matrix[j][i];
            }
        }
        matrix
    })
}

/// Σ wₖ uₖuₖᵀ over the first `rank` vectors.
fn symmetric<const D: usize>(vectors: Matrix<D>, weights: [f64; D], rank: usize) -> Matrix<D> {
    let mut matrix = [[0.0; D]; D];
    for i in 0..D {
        for j in 0..D {
            for k in 0..rank {
                matrix[i][j] += weights[k] * (vectors[k][i] * vectors[k][j]);
            }
        }
    }
    matrix
}

/// A symmetric matrix: positive definite (almost surely), indefinite, or of a rank between 1 and D
/// − 1.
pub fn symmetric_matrix<const D: usize>() -> impl Strategy<Value = Matrix<D>> + Clone {
    let vectors = || uniform(vector(1.0));
    prop_oneof![
        vectors().prop_map(|u| symmetric(u, [0.5; D], D)),
        (vectors(), vector(1.0)).prop_map(|(u, weights)| symmetric(u, weights, D)),
        (vectors(), vector(1.0), 1..D).prop_map(|(u, weights, rank)| symmetric(u, weights, rank)),
    ]
}

/// A linear or quadratic Casimir.
fn casimir<const D: usize>() -> impl Strategy<Value = Casimir<D>> + Clone {
    prop_oneof![
        1 => vector(1.0).prop_map(Casimir::Linear),
        3 => symmetric_matrix().prop_map(Casimir::Quadratic),
    ]
}

fn scaled<const D: usize>(
    base: impl Strategy<Value = Base<D>>,
) -> impl Strategy<Value = Structure<D>> {
    let scale = prop_oneof![
        3 => Just(Scale::One),
        1 => vector(0.5).prop_map(Scale::Growing),
        1 => Just(Scale::Bounded),
        1 => vector(0.5).prop_map(Scale::Exponential),
    ];
    (scale, base).prop_map(|(scale, base)| Structure { scale, base })
}

fn base_with_casimir<const D: usize>(
    casimir: impl Strategy<Value = Casimir<D>> + Clone,
) -> impl Strategy<Value = Base<D>> {
    // The cross product stands in for another projection in other dimensions.
    let cross =
        |(casimir, s)| if D == 3 { Base::Cross(casimir) } else { Base::Projected(casimir, s) };
    prop_oneof![
        (casimir.clone(), skew()).prop_map(cross),
        (casimir.clone(), skew()).prop_map(|(casimir, s)| Base::Projected(casimir, s)),
        (casimir, skew(), skew()).prop_map(|(casimir, k, l)| Base::Wedge(casimir, k, l)),
    ]
}

fn base_without_casimir<const D: usize>() -> impl Strategy<Value = Base<D>> {
    prop_oneof![skew().prop_map(Base::Constant), uniform(skew()).prop_map(Base::Linear)]
}

/// B(y) with a linear or quadratic Casimir, D ≥ 3.
pub fn with_casimir<const D: usize>() -> impl Strategy<Value = Structure<D>> {
    scaled(base_with_casimir(casimir()))
}

/// B(y) with a quadratic Casimir, D ≥ 3.
pub fn with_quadratic_casimir<const D: usize>() -> impl Strategy<Value = Structure<D>> {
    scaled(base_with_casimir(symmetric_matrix().prop_map(Casimir::Quadratic)))
}

/// Any B(y).
pub fn any_structure<const D: usize>() -> impl Strategy<Value = Structure<D>> {
    scaled(prop_oneof![base_without_casimir(), base_with_casimir(casimir())])
}
