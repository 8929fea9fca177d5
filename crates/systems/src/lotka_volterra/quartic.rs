//! The implicit step with H = y₁²y₂²y₃, by Newton's method.
//!
//! With half the change u = (b − a)/2, the midpoint m = a + u and κ the weight of the step times c,
//! the equation b = a + averaged_field(a, b) is
//!
//! u_j = k_j N_j/(m₁m₂), k = (κ/2, κ), N_j = ½∫_{−1}^{1} y₁y₂·y_j q_j ds on y = m + su, q₁ = y₂ −
//! 2y₃, q₂ = y₃ − y₁,
//!
//! and u₃ = −2u₁ − u₂ by the linear Casimir: two unknowns, and N is a mean of polynomials in s.

/// Longer steps are declined: the bound asks for |u_j| ≤ m_j/4 for j = 1, 2 and a prediction within
/// m_j/32 of the solution, the branch for |κ|·(2|y₁| + |y₂| + |y₃|) ≤ ½.
const LARGEST_RATIO: f64 = 0.25;
const LARGEST_MOVE: f64 = 1.0 / 32.0;
const LARGEST_WEIGHT: f64 = 0.5;
/// So close to the coordinate planes, in μY below, B has a pole, and the bound and the roundings of
/// the averages are large: an iteration that began at the solution would see nothing but roundings
/// and never end.
const LARGEST_SPREAD: f64 = 4096.0;

/// The b of a and κ, and the bound of ‖b − a − averaged_field(a, b)‖₁.
///
/// Three evaluations of the midpoint rule predict u to 10⁻⁶ on usual steps of 2⁻⁸, to 10⁻⁴ on one
/// in a thousand of them and to 10⁻² on the longest that are accepted; four Newton steps with the
/// matrix of the first gain three digits each on those and five to ten on usual ones.
///
/// What the last of them, δ, leaves is the change of the matrix since the first times δ. Let ‖·‖ be
/// the sum over all three components, Y ≥ Σ|y_i| and μ = 1/m₁ + 1/m₂ at the end. With w_i = u_i/m_i
/// the map is k_j times the mean of (1 + sw₁)(1 + sw₂)y_jq_j. The derivatives of w_i are (1 −
/// w_i)/m_i and −2(1 − w_i)/m_i², |w_i| ≤ 0.3 on a way that is so short and ends below ¼; y_jq_j is
/// at most Y²/2, its first derivatives 2Y(1 + s) and its second 2(1 + s)². Together the second
/// derivatives of the map are at most |k_j|S, where S = 3.6 + 3.2 μY + 0.8 (μY)² with 1.24 μY for
/// μY, which is what it may be on the way. So ‖b − a − averaged_field‖ ≤ 2(3|k₁| +
/// 2|k₂|)·S·‖way‖·‖δ‖.
///
/// The branch that begins at a stays in |u_j| ≤ m_j/8 for |κ|(2m₁ + m₂ + m₃) ≤ 1/9, and the map
/// contracts there: it is the one found. Up to the ½ that is accepted a test follows it.
#[inline(always)]
pub(super) fn short_step(a: [f64; 3], kappa: f64) -> ([f64; 3], f64) {
    Prediction::new(a, kappa).next().next().next().newton().next().next().next().end()
}

/// The same of two paths, in turn.
#[inline(always)]
pub(super) fn short_steps(
    [a, b]: [[f64; 3]; 2],
    [kappa, other_kappa]: [f64; 2],
) -> [([f64; 3], f64); 2] {
    let (one, other) = (Prediction::new(a, kappa), Prediction::new(b, other_kappa));
    let (one, other) = (one.next(), other.next());
    let (one, other) = (one.next(), other.next());
    let (one, other) = (one.next(), other.next());
    let (one, other) = (one.newton(), other.newton());
    let (one, other) = (one.next(), other.next());
    let (one, other) = (one.next(), other.next());
    let (one, other) = (one.next(), other.next());
    [one.end(), other.end()]
}

/// u by the midpoint rule u_j = k_j m_j q_j(m): the equation without what the average adds to the
/// midpoint.
#[derive(Clone, Copy)]
struct Prediction {
    a: [f64; 3],
    kappa: f64,
    u: [f64; 2],
}

impl Prediction {
    #[inline(always)]
    fn new(a: [f64; 3], kappa: f64) -> Self {
        Self { a, kappa, u: [0.0, 0.0] }
    }

    /// k_j.
    #[inline(always)]
    fn k(self) -> [f64; 2] {
        [0.5 * self.kappa, self.kappa]
    }

    #[inline(always)]
    fn next(self) -> Self {
        let (k, Point { m, .. }) = (self.k(), Point::new(self.a, self.u));
        Self { u: [k[0] * m[0] * (m[1] - 2.0 * m[2]), k[1] * m[1] * (m[2] - m[0])], ..self }
    }

    /// Newton's step from here.
    #[inline(always)]
    fn newton(self) -> Iterate {
        let point = Point::new(self.a, self.u);
        let means = point.means();
        let matrix = means.matrix(&point, self.k());
        let change = matrix.solve(means.residual(self.k(), self.u));
        Iterate { first: self, matrix, change, u: minus(self.u, change) }
    }
}

/// An iterate of Newton's method with the matrix of the first.
#[derive(Clone, Copy)]
struct Iterate {
    first: Prediction,
    matrix: Matrix,
    /// The last change.
    change: [f64; 2],
    u: [f64; 2],
}

impl Iterate {
    #[inline(always)]
    fn next(self) -> Self {
        let Self { first, matrix, u, .. } = self;
        let change = matrix.solve(Point::new(first.a, u).means().residual(first.k(), u));
        Self { change, u: minus(u, change), ..self }
    }

    /// b and the bound of what it lacks.
    #[inline(always)]
    fn end(self) -> ([f64; 3], f64) {
        let Self { first: Prediction { a, kappa, u: first }, change, .. } = self;
        let end = Point::new(a, self.u);
        let moved = minus(self.u, first);
        let way = size(moved) + size(change);
        let largest = [end.largest(0), end.largest(1), end.largest(2)];
        let sum = largest[0] + largest[1] + largest[2];
        let ratio = (end.m[0] + end.m[1]) * sum / (end.m[0] * end.m[1]);
        let second = 3.6 + ratio * (4.0 + 1.25 * ratio);
        let bound = (7.0 * kappa.abs()) * second * way * size(change);
        let near =
            end.contains([moved[0].abs() + change[0].abs(), moved[1].abs() + change[1].abs()]);
        let inside = end.inside() & near;
        let short =
            (kappa.abs() * (sum + largest[0]) <= LARGEST_WEIGHT) & (ratio <= LARGEST_SPREAD);
        let bound = if inside & short { bound } else { f64::INFINITY };
        ([a[0] + 2.0 * end.u[0], a[1] + 2.0 * end.u[1], a[2] + 2.0 * end.u[2]], bound)
    }
}

/// The sum of the absolute values of the three components of a change in the two unknowns.
#[inline(always)]
fn size(change: [f64; 2]) -> f64 {
    change[0].abs() + change[1].abs() + (2.0 * change[0] + change[1]).abs()
}

#[inline(always)]
fn minus(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] - b[0], a[1] - b[1]]
}

/// The midpoint and half the change.
#[derive(Clone, Copy)]
struct Point {
    m: [f64; 3],
    u: [f64; 3],
}

impl Point {
    #[inline(always)]
    fn new(a: [f64; 3], u: [f64; 2]) -> Self {
        let u = [u[0], u[1], -(2.0 * u[0] + u[1])];
        Self { m: [a[0] + u[0], a[1] + u[1], a[2] + u[2]], u }
    }

    #[inline(always)]
    fn inside(&self) -> bool {
        (self.u[0].abs() <= LARGEST_RATIO * self.m[0])
            & (self.u[1].abs() <= LARGEST_RATIO * self.m[1])
    }

    #[inline(always)]
    fn contains(&self, way: [f64; 2]) -> bool {
        (way[0] <= LARGEST_MOVE * self.m[0]) & (way[1] <= LARGEST_MOVE * self.m[1])
    }

    /// The largest |y_i| on the way.
    #[inline(always)]
    fn largest(&self, i: usize) -> f64 {
        self.m[i].abs() + self.u[i].abs()
    }

    /// With y₁y₂ = A + sB + s²C and y_jq_j = D + sE + s²F the mean of the product is
    /// A(D + F/3) + BE/3 + C(D/3 + F/5).
    #[inline(always)]
    fn means(&self) -> Means {
        let Self { m, u } = *self;
        let (n, v) = ([m[1] - 2.0 * m[2], m[2] - m[0]], [u[1] - 2.0 * u[2], u[2] - u[0]]);
        let product = [m[0] * m[1], m[0] * u[1] + u[0] * m[1], u[0] * u[1]];
        let third = product[1] * (1.0 / 3.0);
        let rows = [
            Row::new(product, third, (m[0], u[0]), (n[0], v[0])),
            Row::new(product, third, (m[1], u[1]), (n[1], v[1])),
        ];
        Means { product, third, inverse: 1.0 / product[0], n, v, rows }
    }
}

/// N_j, and what it is made of.
#[derive(Clone, Copy)]
struct Row {
    p: f64,
    e: f64,
    q: f64,
    mean: f64,
}

impl Row {
    /// From A, B, C, B/3 and the values of y_j and q_j in the middle with half their changes.
    #[inline(always)]
    fn new(product: [f64; 3], third: f64, (m, u): (f64, f64), (n, v): (f64, f64)) -> Self {
        let (d, e, f) = (m * n, m * v + u * n, u * v);
        let [p, q] = means_of_ends(d, f);
        Self { p, e, q, mean: product[0] * p + third * e + product[2] * q }
    }
}

/// D + F/3 and D/3 + F/5.
#[inline(always)]
fn means_of_ends(d: f64, f: f64) -> [f64; 2] {
    [d + f * (1.0 / 3.0), d * (1.0 / 3.0) + f * 0.2]
}

/// The averages at a point.
struct Means {
    /// A, B and C.
    product: [f64; 3],
    /// B/3.
    third: f64,
    /// 1/A.
    inverse: f64,
    /// q_j at the midpoint and of half the change.
    n: [f64; 2],
    v: [f64; 2],
    rows: [Row; 2],
}

impl Means {
    /// u_j − k_jN_j/A.
    #[inline(always)]
    fn residual(&self, k: [f64; 2], u: [f64; 2]) -> [f64; 2] {
        [u[0] - self.image(k, 0), u[1] - self.image(k, 1)]
    }

    /// k_jN_j/A.
    #[inline(always)]
    fn image(&self, k: [f64; 2], j: usize) -> f64 {
        k[j] * self.rows[j].mean * self.inverse
    }

    /// The derivative of −k_jN_j/A along a direction, from those of A, C, D and F.
    #[inline(always)]
    fn slope(&self, k: [f64; 2], j: usize, [a, c, d, f]: [f64; 4]) -> f64 {
        let Row { p, e, q, .. } = self.rows[j];
        let [dp, dq] = means_of_ends(d, f);
        let middle = (a + c) * (1.0 / 3.0) * e + self.third * (d + f);
        let mean = (a * p + self.product[0] * dp) + middle + (c * q + self.product[2] * dq);
        (self.image(k, j) * a - k[j] * mean) * self.inverse
    }

    /// The derivative of the residual by u₁ and u₂, along which (m, u) changes by (1, 0, −2) and
    /// (0, 1, −1). At s = −1 is the start, which does not change: dB = dA + dC and dE = dD + dF.
    #[inline(always)]
    fn matrix(&self, point: &Point, k: [f64; 2]) -> Matrix {
        let Point { m, u } = *point;
        let (n, v) = (self.n, self.v);
        let along_first = [
            self.slope(k, 0, [m[1], u[1], n[0] + 4.0 * m[0], v[0] + 4.0 * u[0]]),
            self.slope(k, 1, [m[1], u[1], -3.0 * m[1], -3.0 * u[1]]),
        ];
        let along_second = [
            self.slope(k, 0, [m[0], u[0], 3.0 * m[0], 3.0 * u[0]]),
            self.slope(k, 1, [m[0], u[0], n[1] - m[1], v[1] - u[1]]),
        ];
        Matrix::inverse([
            [1.0 + along_first[0], along_second[0]],
            [along_first[1], 1.0 + along_second[1]],
        ])
    }
}

/// The inverse of a matrix.
#[derive(Clone, Copy)]
struct Matrix([[f64; 2]; 2]);

impl Matrix {
    #[inline(always)]
    fn inverse([[a, b], [c, d]]: [[f64; 2]; 2]) -> Self {
        let determinant = 1.0 / (a * d - b * c);
        Self([[d * determinant, -b * determinant], [-c * determinant, a * determinant]])
    }

    #[inline(always)]
    fn solve(self, [x, y]: [f64; 2]) -> [f64; 2] {
        let Self([[a, b], [c, d]]) = self;
        [a * x + b * y, c * x + d * y]
    }
}
