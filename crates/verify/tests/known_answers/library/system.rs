//! The systems of the library: four families, so that few kernels are compiled.

use expectation::Expect;
use real::Real;
use systems::{Damping, Flows, PoissonSystem, Problem, paper::valid};

/// Linear damping with an exact integral.
#[derive(Clone, Copy, Debug)]
pub enum Rate {
    /// γ.
    Constant(f64),
    /// `before` until `at`, `after` from then on.
    Jump { at: f64, before: f64, after: f64 },
}

pub const UNDAMPED: Rate = Rate::Constant(0.0);

impl Rate {
    /// ½, and 3 from 0.37 on.
    pub const JUMP: Self = Self::Jump { at: 0.37, before: 0.5, after: 3.0 };

    /// ∫₀ᵗ γ.
    pub fn until(self, t: f64) -> f64 {
        match self {
            Self::Constant(rate) => rate * t,
            Self::Jump { at, before, after } => before * t.min(at) + after * (t - at).max(0.0),
        }
    }
}

impl Damping for Rate {
    fn rate(&self, t: f64) -> f64 {
        match *self {
            Self::Constant(rate) => rate,
            Self::Jump { at, before, after } => {
                if t < at {
                    before
                } else {
                    after
                }
            }
        }
    }
    fn integral(&self, a: f64, b: f64) -> f64 {
        self.until(b) - self.until(a)
    }
    fn describe(&self) -> String {
        format!("{self:?}")
    }
}

/// A valid problem.
pub fn problem<S: PoissonSystem<D, M>, const D: usize, const M: usize>(
    system: S,
    damping: Rate,
    y0: [f64; D],
    t_end: f64,
) -> Problem<S, Rate, D> {
    valid(Problem::new(system, damping, y0, t_end))
}

/// A system for which an expectation is computed with everything chosen.
pub trait Chosen<const D: usize, const M: usize>: PoissonSystem<D, M> {
    /// By the flows of its parts, if it has them.
    fn expect(problem: &Problem<Self, Rate, D>) -> Expect<'_>
    where
        Self: Sized,
    {
        Expect::new(problem)
    }
}

impl Chosen<2, 1> for Plane {}
impl Chosen<2, 1> for Growth {}
impl Chosen<4, 2> for Planes {}

impl<const M: usize> Chosen<3, M> for Body<M> {
    fn expect(problem: &Problem<Self, Rate, 3>) -> Expect<'_> {
        Expect::by_parts(problem)
    }
}

/// The plane (q, p): H₀ = ½(aq² + bp²) and H₁ = ½σ(q² + p²) − cq, so that dq = bp dt + σp ∘ dW and
/// dp = −aq dt − σq ∘ dW + c dW.
#[derive(Clone, Copy, Debug)]
pub struct Plane {
    pub a: f64,
    pub b: f64,
    pub sigma: f64,
    pub c: f64,
}

impl Plane {
    /// dq = bp dt, dp = −aq dt + dW.
    pub fn additive(a: f64, b: f64) -> Self {
        Self { a, b, sigma: 0.0, c: 1.0 }
    }
}

/// Kubo's oscillator from (1, 0): q + ip is turned by −(ωT + σW(T)) and damped.
pub fn damped_kubo(omega: f64, sigma: f64, rate: Rate, t: f64) -> Problem<Plane, Rate, 2> {
    problem(Plane { a: omega, b: omega, sigma, c: 0.0 }, rate, [1.0, 0.0], t)
}

/// The same without damping.
pub fn kubo(omega: f64, sigma: f64, t: f64) -> Problem<Plane, Rate, 2> {
    damped_kubo(omega, sigma, UNDAMPED, t)
}

/// dq = p dt, dp = dW from the origin to T = 1: p = W(1), and q = ∫W has the variance ⅓.
pub fn integrated() -> Problem<Plane, Rate, 2> {
    problem(Plane::additive(0.0, 1.0), UNDAMPED, [0.0; 2], 1.0)
}

impl PoissonSystem<2, 1> for Plane {
    fn name(&self) -> &'static str {
        "plane"
    }
    #[inline(always)]
    fn structure<R: Real>(&self, _: [R; 2], v: [R; 2]) -> [R; 2] {
        [v[1], -v[0]]
    }
    #[inline(always)]
    fn energy<R: Real>(&self, y: [R; 2], dt: f64, dw: [f64; 1]) -> R {
        let turn = self.sigma * dw[0];
        y[0] * y[0] * (0.5 * (self.a * dt + turn)) + y[1] * y[1] * (0.5 * (self.b * dt + turn))
            - y[0] * (self.c * dw[0])
    }
}

/// x, y > 0 with B = xy·((0, 1), (−1, 0)), H₀ = a ln x + b ln y and H₁ = α ln x + β ln y: the
/// logarithms are ln x(0) + bT + βW − ∫γ and ln y(0) − aT − αW − ∫γ.
#[derive(Clone, Copy, Debug)]
pub struct Growth {
    pub drift: [f64; 2],
    pub noise: [f64; 2],
}

impl PoissonSystem<2, 1> for Growth {
    fn name(&self) -> &'static str {
        "growth"
    }
    #[inline(always)]
    fn structure<R: Real>(&self, y: [R; 2], v: [R; 2]) -> [R; 2] {
        let b = y[0] * y[1];
        [b * v[1], -(b * v[0])]
    }
    #[inline(always)]
    fn energy<R: Real>(&self, y: [R; 2], dt: f64, dw: [f64; 1]) -> R {
        let k = |i: usize| self.drift[i] * dt + self.noise[i] * dw[0];
        y[0].ln() * k(0) + y[1].ln() * k(1)
    }
}

/// [`Growth`] from (1, 1) to T = 1.
pub fn growth(rate: Rate) -> Problem<Growth, Rate, 2> {
    problem(Growth { drift: [0.4, 0.3], noise: [0.5, 0.6] }, rate, [1.0, 1.0], 1.0)
}

/// so(3), By·v = y × v: H₀ = ½Σ aᵢyᵢ² + c·y and Hₘ = ½k_m|y|² + ½b_my₃² + σ_m·y. A linear
/// Hamiltonian c·y turns y about c, clockwise; ½by₃² turns y about the third axis by −by₃ dt; |y|²
/// has no effect.
#[derive(Clone, Copy, Debug)]
pub struct Body<const M: usize> {
    pub a: [f64; 3],
    pub c: [f64; 3],
    pub k: f64,
    pub b: [f64; M],
    pub sigma: [[f64; 3]; M],
}

impl<const M: usize> Body<M> {
    /// Without drift, and with these linear noises.
    pub fn linear(sigma: [[f64; 3]; M]) -> Self {
        Self { a: [0.0; 3], c: [0.0; 3], k: 0.0, b: [0.0; M], sigma }
    }
}

impl Body<1> {
    /// A symmetric top with H₁ = ½k|y|² + ½by₃², which is ½bH₀ up to a Casimir.
    pub fn top(k: f64, b: f64) -> Self {
        Self { a: [1.0, 1.0, 3.0], k, b: [b], ..Self::linear([[0.0; 3]]) }
    }
}

impl Body<3> {
    /// Noises of size σ along the axes.
    pub fn isotropic(sigma: f64) -> Self {
        Self::linear([[sigma, 0.0, 0.0], [0.0, sigma, 0.0], [0.0, 0.0, sigma]])
    }
}

/// A point of the unit sphere.
pub const START: [f64; 3] = [0.48, 0.6, 0.64];

/// A body from [`START`] to T = 1.
pub fn on_sphere<const M: usize>(body: Body<M>) -> Problem<Body<M>, Rate, 3> {
    problem(body, UNDAMPED, START, 1.0)
}

impl<const M: usize> PoissonSystem<3, M> for Body<M> {
    fn name(&self) -> &'static str {
        "body"
    }
    #[inline(always)]
    fn structure<R: Real>(&self, y: [R; 3], v: [R; 3]) -> [R; 3] {
        [y[1] * v[2] - y[2] * v[1], y[2] * v[0] - y[0] * v[2], y[0] * v[1] - y[1] * v[0]]
    }
    #[inline(always)]
    fn energy<R: Real>(&self, y: [R; 3], dt: f64, dw: [f64; M]) -> R {
        let (square, linear) = self.coefficients(dt, dw);
        let term = |i: usize| y[i] * y[i] * (0.5 * square[i]) + y[i] * linear[i];
        term(0) + term(1) + term(2)
    }
}

impl<const M: usize> Body<M> {
    /// h = Σ ½squareᵢyᵢ² + linearᵢyᵢ.
    #[inline(always)]
    fn coefficients<R: Real>(&self, dt: R, dw: [R; M]) -> ([R; 3], [R; 3]) {
        let (mut square, mut linear) = (self.a.map(|a| dt * a), self.c.map(|c| dt * c));
        for m in 0..M {
            for i in 0..3 {
                square[i] = square[i] + dw[m] * self.k;
                linear[i] = linear[i] + dw[m] * self.sigma[m][i];
            }
            square[2] = square[2] + dw[m] * self.b[m];
        }
        (square, linear)
    }
}

/// Part i is that of yᵢ, whose flow turns y about axis i.
impl<const M: usize> Flows<3, M> for Body<M> {
    const PARTS: usize = 3;

    #[inline(always)]
    fn flow<R: Real>(&self, i: usize, y: [R; 3], dt: R, dw: [R; M]) -> [R; 3] {
        let (square, linear) = self.coefficients(dt, dw);
        let (j, l) = ((i + 1) % 3, (i + 2) % 3);
        let (sine, cosine) = (square[i] * y[i] + linear[i]).sin_cos();
        let mut z = y;
        z[j] = cosine * y[j] + sine * y[l];
        z[l] = cosine * y[l] - sine * y[j];
        z
    }

    #[inline(always)]
    fn precise_flow<R: Real>(&self, part: usize, y: [R; 3], dt: R, dw: [R; M]) -> [R; 3] {
        self.flow(part, y, dt, dw)
    }
}

/// Two planes (q, p), each turned by its own angle −(ω_iT + Σ σ_imW_m): the noises commute.
#[derive(Clone, Copy, Debug)]
pub struct Planes {
    pub omega: [f64; 2],
    /// By plane and noise.
    pub sigma: [[f64; 2]; 2],
}

impl PoissonSystem<4, 2> for Planes {
    fn name(&self) -> &'static str {
        "planes"
    }
    #[inline(always)]
    fn structure<R: Real>(&self, _: [R; 4], v: [R; 4]) -> [R; 4] {
        [v[1], -v[0], v[3], -v[2]]
    }
    #[inline(always)]
    fn energy<R: Real>(&self, y: [R; 4], dt: f64, dw: [f64; 2]) -> R {
        let angle =
            |i: usize| self.omega[i] * dt + self.sigma[i][0] * dw[0] + self.sigma[i][1] * dw[1];
        (y[0] * y[0] + y[1] * y[1]) * (0.5 * angle(0))
            + (y[2] * y[2] + y[3] * y[3]) * (0.5 * angle(1))
    }
}

/// Planes with two noises each, from (1, 0, 1, 0) to T = 1.
pub fn planes(omega: [f64; 2], sigma: [[f64; 2]; 2]) -> Problem<Planes, Rate, 4> {
    problem(Planes { omega, sigma }, UNDAMPED, [1.0, 0.0, 1.0, 0.0], 1.0)
}
