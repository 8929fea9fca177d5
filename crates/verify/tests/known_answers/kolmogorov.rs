//! Expectations of the damped stochastic rigid body from the Kolmogorov equation on the sphere,
//! without sampling: where the values come from that `expectation::Expect` is compared with.
//!
//! y = r(t)u with r = |y₀|e^{−∫γ} and |u| = 1. The moments q = E[h(u(t))] of spherical harmonics h
//! obey q′ = Lᵀq with the generator L of u: with X_j = u_j R_j, where R_j is the rotation about
//! axis j, κ_j = 1/I_j and k_j the coefficients of the noises,
//!
//! L = −r Σ κ_j X_j + ½r² Σ k_j² X_j².
//!
//! From the textbook actions of u₃, u₁ ± iu₂ and of the ladder operators, X₁ = −½Z + V, X₂ = −½Z −
//! V, X₃ = Z with skew-symmetric Z and V, see [`Skew::new`].

use dgrad::Rule;
use systems::{
    Constant, Damping, PoissonSystem, Problem, RigidBody,
    paper::{rigid_body_three_noises, valid},
};

/// Position of (l, m), |m| ≤ l, in a vector of all harmonics.
fn index(l: usize, m: i64) -> usize {
    ((l * (l + 1)) as i64 + m) as usize
}

/// √((l² − m²)/(4l² − 1)): u₃Y_{l−1,m} is this times Y_lm, plus a multiple of Y_{l−2,m}.
fn raising(l: usize, m: i64) -> f64 {
    let square = (l * l) as f64;
    ((square - (m * m) as f64) / (4.0 * square - 1.0)).sqrt()
}

/// h_lm(u) = (Re + Im)(iˡ Y_lm(u)) for l ≤ `degree`, where Y_lm are the spherical harmonics of mean
/// square one: an orthonormal basis, by the recursions that u₁ + iu₂ and u₃ obey.
fn harmonics(u: [f64; 3], degree: usize) -> Vec<f64> {
    let rotated = |l: usize, x: f64, y: f64| [x + y, x - y, -x - y, y - x][l % 4];
    let mut h = vec![0.0; (degree + 1) * (degree + 1)];
    let (mut x, mut y) = (1.0, 0.0);
    for order in 0..=degree {
        let m = order as i64;
        let sign = if m % 2 == 0 { 1.0 } else { -1.0 };
        // Y_lm, and Y_{l−1,m} times raising(l, m).
        let (mut now, mut before) = ([x, y], [0.0; 2]);
        for l in order..=degree {
            h[index(l, m)] = rotated(l, now[0], now[1]);
            h[index(l, -m)] = sign * rotated(l, now[0], -now[1]);
            let a = raising(l + 1, m);
            let next = [0, 1].map(|i| (u[2] * now[i] - before[i]) / a);
            (now, before) = (next, now.map(|part| a * part));
        }
        let n = m as f64;
        let c = -((2.0 * n + 3.0) / (2.0 * n + 2.0)).sqrt();
        (x, y) = (c * (u[0] * x - u[1] * y), c * (u[0] * y + u[1] * x));
    }
    h
}

/// A skew-symmetric matrix: the entries c at (upper, lower) and −c at (lower, upper).
struct Skew(Vec<(usize, usize, f64)>);

impl Skew {
    /// Z takes h_lm to m √(((l+1)² − m²)/(4(l+1)² − 1)) h_{l+1,m}; V takes it to −β(l, m)
    /// h_{l+1,m+2} + β(l, −m) h_{l+1,m−2} with β(l, m) = ¼ √((l+m+1)(l+m+2)(l+m+3)(l−m) /
    /// ((2l+1)(2l+3))). Cut off at a degree they stay skew-symmetric, so |q| cannot grow.
    fn new(degree: usize) -> [Self; 2] {
        let (mut z, mut v) = (Vec::new(), Vec::new());
        for l in 0..degree {
            let n = l as i64;
            let beta = |m: i64| {
                let product = ((n + m + 1) * (n + m + 2) * (n + m + 3) * (n - m)) as f64;
                0.25 * (product / ((2 * n + 1) * (2 * n + 3)) as f64).sqrt()
            };
            for m in -n..=n {
                z.push((index(l, m), index(l + 1, m), m as f64 * raising(l + 1, m)));
                if m < n {
                    v.push((index(l, m), index(l + 1, m + 2), -beta(m)));
                }
                if m > -n {
                    v.push((index(l, m), index(l + 1, m - 2), beta(-m)));
                }
            }
        }
        [Self(z), Self(v)]
    }

    fn apply(&self, q: &[f64]) -> Vec<f64> {
        let mut result = vec![0.0; q.len()];
        for &(lower, upper, c) in &self.0 {
            result[upper] += c * q[lower];
            result[lower] -= c * q[upper];
        }
        result
    }
}

/// Σ of vectors with weights.
fn sum<const N: usize>(terms: [(f64, &[f64]); N]) -> Vec<f64> {
    (0..terms[0].1.len()).map(|i| terms.iter().map(|(weight, q)| weight * q[i]).sum()).collect()
}

/// E[φ(y(T))] with harmonics up to `degree`, by the classical Runge–Kutta method in time. The error
/// for the weak problem of the paper is 1e-8 with degree 32 and 1e-12 with 64.
fn expectations<G: Damping, const M: usize>(
    problem: &Problem<RigidBody<M>, G, 3>,
    degree: usize,
    functions: &[fn([f64; 3]) -> f64],
) -> Vec<f64> {
    let (body, y0, t_end) = (problem.system(), problem.y0(), problem.t_end());
    let length = y0.iter().map(|y| y * y).sum::<f64>().sqrt();
    let radius = |t: f64| length * (-problem.damping().integral(0.0, t)).exp();
    let drift = body.gradient([1.0; 3], 1.0, [0.0; M]);
    let squares = body.gradient([1.0; 3], 0.0, [1.0; M]).map(|k| k * k);
    let [z, v] = Skew::new(degree);
    let transposed = |r: f64, q: &[f64]| {
        let (zq, vq) = (z.apply(q), v.apply(q));
        let [d0, d1] = [drift[2] - 0.5 * (drift[0] + drift[1]), drift[0] - drift[1]];
        let [s0, s1, s2] = [
            squares[2] + 0.25 * (squares[0] + squares[1]),
            0.5 * (squares[1] - squares[0]),
            squares[0] + squares[1],
        ]
        .map(|s| 0.5 * r * r * s);
        let along = z.apply(&sum([(d0 * r, q), (s0, &zq), (s1, &vq)]));
        sum([(1.0, &along), (1.0, &v.apply(&sum([(d1 * r, q), (s1, &zq), (s2, &vq)])))])
    };
    // ‖X_j‖ ≤ (degree + 1)/2; the method is accurate where ‖L‖h is below two.
    let size = 0.5 * (degree.max(64) + 1) as f64;
    let most = (0..=256).map(|i| radius(t_end * f64::from(i) / 256.0)).fold(0.0, f64::max);
    let rate = most * size * drift.iter().map(|k| k.abs()).sum::<f64>()
        + 0.5 * (most * size).powi(2) * squares.iter().sum::<f64>();
    let steps = (0.5 * rate * t_end).ceil().max(1.0) as u32;
    let mut q = harmonics(y0.map(|y| y / length), degree);
    let h = t_end / f64::from(steps);
    for n in 0..steps {
        let [r0, r1, r2] = [0.0, 0.5, 1.0].map(|stage| radius((f64::from(n) + stage) * h));
        let k1 = transposed(r0, &q);
        let k2 = transposed(r1, &sum([(1.0, &q), (0.5 * h, &k1)]));
        let k3 = transposed(r1, &sum([(1.0, &q), (0.5 * h, &k2)]));
        let k4 = transposed(r2, &sum([(1.0, &q), (h, &k3)]));
        let sixth = h / 6.0;
        q = sum([(1.0, &q), (sixth, &k1), (2.0 * sixth, &k2), (2.0 * sixth, &k3), (sixth, &k4)]);
    }
    // φ(ru) is expanded up to degree 48: Gauss–Legendre in u₃, equal weights along the circles.
    let (rule, longitudes, r) = (valid(Rule::new(49)), 98, radius(t_end));
    let mut means = vec![0.0; functions.len()];
    for (&eta, &weight) in rule.nodes().iter().zip(rule.weights()) {
        let width = 2.0 * (eta * (1.0 - eta)).sqrt();
        for k in 0..longitudes {
            let (sin, cos) =
                (std::f64::consts::TAU * f64::from(k) / f64::from(longitudes)).sin_cos();
            let u = [width * cos, width * sin, 2.0 * eta - 1.0];
            let density: f64 =
                harmonics(u, degree.min(48)).iter().zip(&q).map(|(h, q)| h * q).sum();
            let mass = weight * density / f64::from(longitudes);
            for (mean, function) in means.iter_mut().zip(functions) {
                *mean += mass * function(u.map(|u| r * u));
            }
        }
    }
    means
}

fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, analysis::worse)
}

/// y₁ = r(t)u₁, and y₂, y₃ turn by a normal angle of variance v = u₁²/Î² ∫r².
#[test]
fn one_noise_and_no_drift_turn_about_an_axis() {
    let body = valid(RigidBody::one_noise([1.5; 3], 0.8));
    let [a, b, c] = [0.9, -0.5, 0.4];
    let problem = valid(Problem::new(body, valid(Constant::new(0.6)), [a, b, c], 1.5));
    let decay = (-0.9f64).exp();
    let v = (a / 0.8f64).powi(2) * (1.0 - (-1.8f64).exp()) / 1.2;
    let (turned, twice) = ((-0.5 * v).exp(), (-2.0 * v).exp());
    let square = 0.5 * decay * decay * (b * b + c * c + (b * b - c * c) * twice);
    let exact = [decay * a, decay * b * turned, decay * c * turned, square, (decay * a).cos()];
    let functions: [fn([f64; 3]) -> f64; 5] =
        [|y| y[0], |y| y[1], |y| y[2], |y| y[1] * y[1], |y| y[0].cos()];
    let found = expectations(&problem, 32, &functions);
    assert!(largest_difference(&found, &exact) < 1e-13, "{found:?} {exact:?}");
}

/// The values that the statements about expectations compare with.
#[test]
fn values_of_the_weak_problem_settle_with_the_degree() {
    let functions = verify::weak_observables().map(|phi| phi.function);
    for (degree, tolerance) in [(24, 4e-7), (48, 2e-10), (64, 2e-12)] {
        let found = expectations(&rigid_body_three_noises(1.0), degree, &functions);
        let difference = largest_difference(&found, &verify::KOLMOGOROV);
        assert!(difference < tolerance, "{degree}: {difference:e}");
    }
}
