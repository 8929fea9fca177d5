//! The linearly implicit step z = y + B((y+z)/2)·v for B that is affine in y.

use real::{Factored, Partial, Real, fixed, seeded, unrolled};

use crate::PoissonSystem;

/// The solution by elimination without pivoting, for any affine B.
///
/// With A(v)x = B(x)v − B(0)v the equation is (I − ½A)z = y + ½Ay + B(0)v = y + B(y/2)·v + ½B(0)·v.
#[inline(always)]
pub fn cayley_by_elimination<S, R: Real, const D: usize, const M: usize>(
    system: &S,
    y: [R; D],
    v: [R; D],
) -> [R; D]
where
    S: PoissonSystem<D, M>,
{
    let matrix = identity_minus_half(system, v);
    let constant = system.structure([R::zero(); D], v);
    // A y + 2B(0)v = B(y)v + B(0)v.
    let field = system.structure(y, v);
    let mut right = y;
    for i in 0..D {
        right[i] = right[i] + (field[i] + constant[i]) * 0.5;
    }
    Factored::new(matrix).solve(right)
}

/// I − ½A(v) with A(v)x = B(x)v − B(0)v.
#[inline(always)]
pub fn identity_minus_half<S, R: Real, const D: usize, const M: usize>(
    system: &S,
    v: [R; D],
) -> [[R; D]; D]
where
    S: PoissonSystem<D, M>,
{
    let zero = [R::zero(); D];
    let mut matrix = [zero; D];
    unrolled!(R: j in 0..D => {
        let column: [Partial<R>; D] = system.structure(seeded(zero, j), fixed(v));
        for i in 0..D {
            matrix[i][j] = column[i].derivative() * -0.5;
        }
        matrix[j][j] = matrix[j][j] + R::one();
    });
    matrix
}

/// The solution for B(y)v = y × v, Cayley's rotation: z = y + (2/(1+|s|²))·(y × s + (y × s) × s)
/// with s = v/2.
#[inline(always)]
pub fn cayley_cross<R: Real>(y: [R; 3], v: [R; 3]) -> [R; 3] {
    let s = [v[0] * 0.5, v[1] * 0.5, v[2] * 0.5];
    let turned = cross(y, s);
    let twice = cross(turned, s);
    let factor = R::constant(2.0) / (R::one() + (s[0] * s[0] + s[1] * s[1] + s[2] * s[2]));
    [
        y[0] + (turned[0] + twice[0]) * factor,
        y[1] + (turned[1] + twice[1]) * factor,
        y[2] + (turned[2] + twice[2]) * factor,
    ]
}

/// y × v.
#[inline(always)]
pub fn cross<R: Real>(y: [R; 3], v: [R; 3]) -> [R; 3] {
    [y[1] * v[2] - y[2] * v[1], y[2] * v[0] - y[0] * v[2], y[0] * v[1] - y[1] * v[0]]
}

/// (a, b) turned by the angle −2 arctan s: (a, b) + (2s/(1+s²))·(b − sa, −a − sb).
#[inline(always)]
pub fn turned<R: Real>(a: R, b: R, s: R) -> (R, R) {
    let factor = s * 2.0 / (s * s + 1.0);
    (a + (b - s * a) * factor, b - (a + s * b) * factor)
}

/// (a, b) turned by the angle −2h up to ninth order in h, by the diagonal Padé approximation of
/// degree four of e^{2ih}: as [`turned`] with tan h ≈ n/d, n = h(1 − 2h²/21) and d = 1 − 3h²/7 +
/// h⁴/105. It keeps a² + b² for every h.
#[inline(always)]
fn turned_precisely<R: Real>(a: R, b: R, half: R) -> (R, R) {
    let square = half * half;
    let n = half * (R::one() - square * (2.0 / 21.0));
    let d = R::one() - square * (R::constant(3.0 / 7.0) - square * (1.0 / 105.0));
    let factor = n * 2.0 / (n * n + d * d);
    (a + (d * b - n * a) * factor, b - (d * a + n * b) * factor)
}

/// ẏ = y × k yᵢeᵢ for time one: a rotation about axis i, by Cayley's map or up to ninth order.
#[inline(always)]
pub fn turned_about<R: Real>(axis: usize, y: [R; 3], k: R, precisely: bool) -> [R; 3] {
    let (j, l) = ((axis + 1) % 3, (axis + 2) % 3);
    let (mut z, half) = (y, k * 0.5 * y[axis]);
    (z[j], z[l]) =
        if precisely { turned_precisely(y[j], y[l], half) } else { turned(y[j], y[l], half) };
    z
}
