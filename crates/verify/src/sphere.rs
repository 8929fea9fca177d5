//! Expectations of the damped stochastic rigid body without sampling and without time-stepping
//! errors that matter.
//!
//! The Casimir ½|y|² obeys its conformal law on every path, so y = r(t)u with r = |y₀|e^{−Γ(t)}, Γ
//! = ∫γ, and u stays on the unit sphere: du = r B(u)∇H₀(u)dt + r Σ B(u)∇Hₘ(u) ∘ dWₘ. With the
//! rotations R_j f = (e_j × u)·∇f about the axes, the field B∇H of H = ½Σ k_j u_j² is −Σ k_j u_j
//! R_j; u_j and R_j commute. Hence u has the generator
//!
//! L_t = −r Σ κ_j X_j + ½r² Σ k_j² X_j²,  X_j = u_j R_j,  κ_j = 1/I_j,  k_j = 1/Î_j.
//!
//! The moments q = E[h(u(t))] of a basis h of L²(S²) solve q′ = L_tᵀq, q(0) = h(u₀). The basis is
//! that of the spherical harmonics Y_lm (mean square one, Condon–Shortley phase) in the real form
//! h_lm = (Re + Im)(iˡ Y_lm), l ≤ N, |m| ≤ l. From the textbook actions of u₃, u₁ ± iu₂ and of the
//! ladder operators on Y_lm,
//!
//! X₁ = −½Z + V,  X₂ = −½Z − V,  X₃ = Z,  all skew-symmetric, where
//!
//! - Z takes h_lm to m √(((l+1)² − m²)/(4(l+1)² − 1)) h_{l+1,m}, minus the transpose of that,
//! - V takes h_lm to −β(l, m) h_{l+1,m+2} + β(l, −m) h_{l+1,m−2}, minus the transpose of that, with
//!   β(l, m) = ¼ √((l+m+1)(l+m+2)(l+m+3)(l−m)/((2l+1)(2l+3))).
//!
//! Cut off at degree N, they are still skew-symmetric, so the cut-off L_t is a skew-symmetric
//! matrix plus a negative semidefinite one: |q| cannot grow, whatever N. The noise vanishes on the
//! three axes, so L_t is degenerate there, and convergence in N is observed (the tests pin it), not
//! proved. For the weak problem of the paper an error falls by a factor of 10 or more from N to N +
//! 8, and more slowly for a start on an axis, where the law is a point mass.

use dgrad::Rule;
use mc::Observable;
use real::elementary::{exp, sin_cos_turn};
use systems::{Damping, PoissonSystem, Problem, RigidBody};

/// E[φ(y(T))] for every observable φ, with spherical harmonics up to `degree`.
///
/// φ has to be smooth: φ(r(T)u) is expanded up to degree 48 or `degree` if that is less, which is
/// exact to round-off for polynomials of no higher degree, and with 48 for sines and cosines of a
/// component as long as r(T) is below 10. For the weak problem of the paper the error is 1e-8 with
/// degree 32, 1e-12 with 64 and round-off with 96. The work grows as the fourth power of the
/// degree.
#[must_use]
pub fn rigid_body_expectations<G: Damping, const M: usize>(
    problem: &Problem<RigidBody<M>, G, 3>,
    degree: usize,
    observables: &[Observable<3>],
) -> Vec<f64> {
    let moments = moments(problem, degree, steps(problem, degree));
    let r = radius(problem, problem.t_end);
    means(&moments, degree, r, observables)
}

/// r(t) = |y₀|e^{−Γ(t)}.
fn radius<S, G: Damping>(problem: &Problem<S, G, 3>, t: f64) -> f64 {
    norm(problem.y0) * exp(-problem.damping.integral(0.0, t))
}

fn norm(y: [f64; 3]) -> f64 {
    (y[0] * y[0] + y[1] * y[1] + y[2] * y[2]).sqrt()
}

/// Position of (l, m).
fn index(l: usize, m: i64) -> usize {
    ((l * (l + 1)) as i64 + m) as usize
}

/// A skew-symmetric matrix: the entries c at (upper, lower) and −c at (lower, upper).
struct Skew(Vec<(usize, usize, f64)>);

impl Skew {
    fn apply(&self, q: &[f64]) -> Vec<f64> {
        let mut result = vec![0.0; q.len()];
        for &(lower, upper, c) in &self.0 {
            result[upper] += c * q[lower];
            result[lower] -= c * q[upper];
        }
        result
    }
}

/// L_tᵀ, cut off at some degree.
struct Generator {
    /// Z and V.
    z: Skew,
    v: Skew,
    /// Σ κ_j X_j = d₀Z + d₁V.
    drift: [f64; 2],
    /// Σ k_j² X_j² = s₀Z² + s₁(ZV + VZ) + s₂V².
    squares: [f64; 3],
    /// Σ |κ_j| and Σ k_j².
    sizes: [f64; 2],
}

impl Generator {
    fn new<const M: usize>(body: &RigidBody<M>, degree: usize) -> Self {
        let (mut z, mut v) = (Vec::new(), Vec::new());
        for l in 0..degree {
            let n = l as i64;
            let square = ((n + 1) * (n + 1)) as f64;
            let beta = |m: i64| {
                let product = ((n + m + 1) * (n + m + 2) * (n + m + 3) * (n - m)) as f64;
                0.25 * (product / ((2 * n + 1) * (2 * n + 3)) as f64).sqrt()
            };
            for m in -n..=n {
                let along = m as f64 * ((square - (m * m) as f64) / (4.0 * square - 1.0)).sqrt();
                z.push((index(l, m), index(l + 1, m), along));
                if m < n {
                    v.push((index(l, m), index(l + 1, m + 2), -beta(m)));
                }
                if m > -n {
                    v.push((index(l, m), index(l + 1, m - 2), beta(-m)));
                }
            }
        }
        // ∇H₀ and Σ∇Hₘ at (1, 1, 1).
        let drift = body.gradient([1.0; 3], 1.0, [0.0; M]);
        let squares = body.gradient([1.0; 3], 0.0, [1.0; M]).map(|k| k * k);
        Self {
            z: Skew(z),
            v: Skew(v),
            drift: [drift[2] - 0.5 * (drift[0] + drift[1]), drift[0] - drift[1]],
            squares: [
                squares[2] + 0.25 * (squares[0] + squares[1]),
                0.5 * (squares[1] - squares[0]),
                squares[0] + squares[1],
            ],
            sizes: [drift.iter().map(|k| k.abs()).sum(), squares.iter().sum()],
        }
    }

    /// L_tᵀq at the radius r.
    fn transposed(&self, r: f64, q: &[f64]) -> Vec<f64> {
        let (zq, vq) = (self.z.apply(q), self.v.apply(q));
        let ([d0, d1], [s0, s1, s2]) =
            (self.drift.map(|d| d * r), self.squares.map(|s| 0.5 * r * r * s));
        let combine = |d: f64, a: f64, b: f64| -> Vec<f64> {
            (0..q.len()).map(|i| d * q[i] + a * zq[i] + b * vq[i]).collect()
        };
        let mut result = self.z.apply(&combine(d0, s0, s1));
        let across = self.v.apply(&combine(d1, s1, s2));
        result.iter_mut().zip(across).for_each(|(a, b)| *a += b);
        result
    }
}

/// Steps of the classical Runge–Kutta method, which is stable where Re λ ≤ 0 and |λ|h ≤ 2.6.
///
/// |X_j| ≤ (N + 1)/2 by Gershgorin's theorem for X₃ and by symmetry for the others. Low degrees take as many steps
/// as degree 64, for accuracy.
fn steps<G: Damping, const M: usize>(problem: &Problem<RigidBody<M>, G, 3>, degree: usize) -> u32 {
    const SAMPLES: u32 = 256;
    let size = 0.5 * (degree.max(64) + 1) as f64;
    let r = (0..=SAMPLES)
        .map(|i| radius(problem, problem.t_end * f64::from(i) / f64::from(SAMPLES)))
        .fold(0.0, f64::max);
    let [drift, squares] = Generator::new(&problem.system, 0).sizes;
    let rate = r * size * drift + 0.5 * r * r * size * size * squares;
    (0.5 * rate * problem.t_end).ceil().max(1.0) as u32
}

/// E[h_lm(u(T))] by the classical Runge–Kutta method.
fn moments<G: Damping, const M: usize>(
    problem: &Problem<RigidBody<M>, G, 3>,
    degree: usize,
    steps: u32,
) -> Vec<f64> {
    let generator = Generator::new(&problem.system, degree);
    let length = norm(problem.y0);
    // At y₀ = 0 the radius stays zero, and so does L_t, for any u₀.
    let start = if length > 0.0 { problem.y0.map(|y| y / length) } else { [0.0, 0.0, 1.0] };
    let mut q = harmonics(start, degree);
    let h = problem.t_end / f64::from(steps);
    let shifted = |q: &[f64], k: &[f64], weight: f64| -> Vec<f64> {
        q.iter().zip(k).map(|(q, k)| q + weight * k).collect()
    };
    for n in 0..steps {
        let [r0, r1, r2] = [0.0, 0.5, 1.0].map(|stage| radius(problem, (f64::from(n) + stage) * h));
        let k1 = generator.transposed(r0, &q);
        let k2 = generator.transposed(r1, &shifted(&q, &k1, 0.5 * h));
        let k3 = generator.transposed(r1, &shifted(&q, &k2, 0.5 * h));
        let k4 = generator.transposed(r2, &shifted(&q, &k3, h));
        for i in 0..q.len() {
            q[i] += h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]);
        }
    }
    q
}

/// h_lm(u) for l ≤ `degree`.
///
/// Y_mm and then Y_lm for l > m by the recursions that u₁ + iu₂ and u₃ obey; Y_{l,−m} = (−1)ᵐ conj
/// Y_lm.
fn harmonics(u: [f64; 3], degree: usize) -> Vec<f64> {
    // (Re + Im)(iˡ(x + iy)).
    let rotated = |l: usize, x: f64, y: f64| match l % 4 {
        0 => x + y,
        1 => x - y,
        2 => -x - y,
        _ => y - x,
    };
    let mut h = vec![0.0; (degree + 1) * (degree + 1)];
    let (mut x, mut y) = (1.0, 0.0);
    for m in 0..=degree {
        let n = m as f64;
        let sign = if m % 2 == 0 { 1.0 } else { -1.0 };
        // Y_lm, and Y_{l−1,m} times √((l² − m²)/(4l² − 1)).
        let (mut now, mut before) = ([x, y], [0.0; 2]);
        for l in m..=degree {
            h[index(l, m as i64)] = rotated(l, now[0], now[1]);
            h[index(l, -(m as i64))] = sign * rotated(l, now[0], -now[1]);
            let square = ((l + 1) * (l + 1)) as f64;
            let a = ((square - n * n) / (4.0 * square - 1.0)).sqrt();
            let next = [0, 1].map(|i| (u[2] * now[i] - before[i]) / a);
            (now, before) = (next, now.map(|part| a * part));
        }
        let c = -((2.0 * n + 3.0) / (2.0 * n + 2.0)).sqrt();
        (x, y) = (c * (u[0] * x - u[1] * y), c * (u[0] * y + u[1] * x));
    }
    h
}

/// The degree up to which φ(r(T)u) is expanded.
const EXPANSION: usize = 48;

/// Means of φ(ru) for u of the density Σ q_lm h_lm with respect to the uniform law, by
/// Gauss–Legendre in u₃ and equal weights along the circles: exact for polynomials of degree
/// 2·`EXPANSION` + 1.
fn means(moments: &[f64], degree: usize, r: f64, observables: &[Observable<3>]) -> Vec<f64> {
    let rule = Rule::new(EXPANSION + 1)
        .unwrap_or_else(|error| unreachable!("the number of nodes is allowed: {error}"));
    let longitudes = 2 * EXPANSION + 2;
    let mut means = vec![0.0; observables.len()];
    for (&eta, &weight) in rule.nodes().iter().zip(rule.weights()) {
        let width = 2.0 * (eta * (1.0 - eta)).sqrt();
        for k in 0..longitudes {
            let (sin, cos) = sin_cos_turn(k as f64 / longitudes as f64);
            let u = [width * cos, width * sin, 2.0 * eta - 1.0];
            let density: f64 =
                harmonics(u, degree.min(EXPANSION)).iter().zip(moments).map(|(h, q)| h * q).sum();
            let mass = weight * density / longitudes as f64;
            for (mean, observable) in means.iter_mut().zip(observables) {
                *mean += mass * (observable.function)(u.map(|u| r * u));
            }
        }
    }
    means
}

#[cfg(test)]
mod tests {
    use super::*;
    use mc::{Ladder, Run, Statistic, View};
    use noise::{StreamKey, Truncation};
    use real::elementary::{cos, sin};
    use schemes::Sexp;
    use stats::Moments;
    use systems::paper::{INERTIA, NOISE_INERTIA, half_cosine, rigid_body_start, valid};
    use systems::{Constant, Cosine, ito_correction, unit_noise, vector_field};

    fn paper_problem() -> Problem<RigidBody<3>, Cosine, 3> {
        let body = valid(RigidBody::three_noises(INERTIA, NOISE_INERTIA));
        valid(Problem::new(body, half_cosine(), rigid_body_start(), 1.0))
    }

    fn observables() -> Vec<Observable<3>> {
        let functions: [fn([f64; 3]) -> f64; 12] = [
            |y| y[0],
            |y| y[1],
            |y| y[2],
            |y| y[0] * y[0],
            |y| y[1] * y[1],
            |y| y[2] * y[2],
            |y| cos(y[0]),
            |y| cos(y[1]),
            |y| cos(y[2]),
            |y| sin(y[0]),
            |y| sin(y[1]),
            |y| sin(y[2]),
        ];
        functions.map(|function| Observable { name: "", function }).to_vec()
    }

    fn components() -> [Observable<3>; 3] {
        let observable = |function| Observable { name: "", function };
        [observable(|y| y[0]), observable(|y| y[1]), observable(|y| y[2])]
    }

    fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
        assert_eq!(a.len(), b.len());
        a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    }

    const POINTS: [[f64; 3]; 4] =
        [[0.6, 0.0, 0.8], [-0.3, 1.1, 0.4], [0.2, -0.5, -0.7], [0.0, 0.0, 1.3]];

    /// The twelve values of the paper's weak problem: degrees 96 to 160 agree on them to 4e-15. The
    /// backward Kolmogorov equation on the torus of latitude and longitude, by Fourier collocation
    /// on 96 × 96 points, agrees to 1.2e-10.
    const PAPER: [f64; 12] = [
        0.308620463445559,
        -0.233428857078511,
        0.640708528251050,
        0.105887422320291,
        0.108838912251908,
        0.419944545588163,
        0.947654279520736,
        0.946539300600389,
        0.797719935281682,
        0.302294381877426,
        -0.226157774971460,
        0.595235773057583,
    ];

    #[test]
    fn the_harmonics_obey_the_addition_theorem() {
        // Σ_m h_lm(u)h_lm(v) = (2l + 1)P_l(u·v).
        for (u, v) in [(POINTS[0], POINTS[1]), (POINTS[1], POINTS[2]), (POINTS[2], POINTS[3])] {
            let [u, v] = [u, v].map(|y| y.map(|component| component / norm(y)));
            let (a, b) = (harmonics(u, 20), harmonics(v, 20));
            let x = u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
            let (mut legendre, mut before) = (1.0, 0.0);
            for l in 0..=20 {
                let n = l as f64;
                let row = l * l..(l + 1) * (l + 1);
                let sum: f64 = row.map(|i| a[i] * b[i]).sum();
                assert!((sum / (2.0 * n + 1.0) - legendre).abs() < 1e-13, "{l}: {sum} {legendre}");
                (legendre, before) =
                    (((2.0 * n + 1.0) * x * legendre - n * before) / (n + 1.0), legendre);
            }
        }
    }

    /// L of the Itô equation, ∇f·(f₀ + ½Σ fₘ′fₘ) + ½Σ fₘᵀ∇²f fₘ, by differences of fourth order.
    fn generator_by_differences<const M: usize>(
        body: &RigidBody<M>,
        y: [f64; 3],
        f: impl Fn([f64; 3]) -> Vec<f64>,
    ) -> Vec<f64> {
        const STEP: f64 = 2e-3;
        let along = |direction: [f64; 3]| {
            let at = |n: f64| f(std::array::from_fn(|i| y[i] + n * STEP * direction[i]));
            [-2.0, -1.0, 0.0, 1.0, 2.0].map(at)
        };
        let (drift, correction) = (vector_field(body, y, 1.0, [0.0; M]), ito_correction(body, y));
        let values = along(std::array::from_fn(|i| drift[i] + correction[i]));
        let mut result: Vec<f64> = (0..values[0].len())
            .map(|i| {
                (8.0 * (values[3][i] - values[1][i]) - (values[4][i] - values[0][i]))
                    / (12.0 * STEP)
            })
            .collect();
        for m in 0..M {
            let values = along(vector_field(body, y, 0.0, unit_noise(m)));
            for i in 0..result.len() {
                let far = values[4][i] + values[0][i];
                let near = values[3][i] + values[1][i];
                result[i] += 0.5 * (16.0 * near - far - 30.0 * values[2][i]) / (12.0 * STEP * STEP);
            }
        }
        result
    }

    #[test]
    fn the_generator_is_that_of_the_ito_equation() {
        // The field has degree 2 and u has degree 0 in y: L h(y/|y|) is the generator of u at the
        // radius |y|.
        const DEGREE: usize = 4;
        let body = valid(RigidBody::three_noises([2.0, 0.7, 1.3], [1.1, 0.9, 2.5]));
        for y in POINTS {
            let r = norm(y);
            let spherical = |y: [f64; 3]| harmonics(y.map(|component| component / norm(y)), DEGREE);
            let expected = generator_by_differences(&body, y, spherical);
            // Two degrees more, since L raises degrees by two.
            let generator = Generator::new(&body, DEGREE + 2);
            let found =
                generator.transposed(r, &harmonics(y.map(|component| component / r), DEGREE + 2));
            let difference = largest_difference(&found[..expected.len()], &expected);
            assert!(difference < 1e-8, "{y:?}: {difference:e}");
        }
    }

    #[test]
    fn one_noise_and_no_drift_turn_about_an_axis() {
        // y₁ = r(t)u₁, and y₂, y₃ turn by a Gaussian angle of variance v = u₁²/Î² ∫r².
        let body = valid(RigidBody::one_noise([1.5; 3], 0.8));
        let start = [0.9, -0.5, 0.4];
        let problem = valid(Problem::new(body, valid(Constant::new(0.6)), start, 1.5));
        let decay = (-0.9f64).exp();
        let v = (start[0] / 0.8) * (start[0] / 0.8) * (1.0 - (-1.8f64).exp()) / 1.2;
        let squares =
            (start[1] * start[1] + start[2] * start[2], start[1] * start[1] - start[2] * start[2]);
        let expected = [
            decay * start[0],
            decay * start[1] * (-0.5 * v).exp(),
            decay * start[2] * (-0.5 * v).exp(),
            decay * decay * 0.5 * (squares.0 + squares.1 * (-2.0 * v).exp()),
            (decay * start[0]).cos(),
        ];
        let mut observables = components().to_vec();
        observables.push(Observable { name: "", function: |y| y[1] * y[1] });
        observables.push(Observable { name: "", function: |y| y[0].cos() });
        let found = rigid_body_expectations(&problem, 32, &observables);
        assert!(largest_difference(&found, &expected) < 1e-13, "{found:?} {expected:?}");
    }

    #[test]
    fn a_start_on_an_axis_or_at_the_origin_stays_there() {
        // On an axis the noise vanishes and the density is a point mass: nothing converges more
        // slowly.
        let body = valid(RigidBody::three_noises(INERTIA, NOISE_INERTIA));
        for start in [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [0.0; 3]] {
            let problem = valid(Problem::new(body, valid(Constant::new(0.5)), start, 1.0));
            let found = rigid_body_expectations(&problem, 48, &components());
            let expected = start.map(|y| y * (-0.5f64).exp());
            assert!(largest_difference(&found, &expected) < 1e-9, "{found:?}");
        }
    }

    #[test]
    fn the_squares_add_up_to_the_casimir() {
        let problem = paper_problem();
        let found = rigid_body_expectations(&problem, 16, &observables());
        let squares: f64 = found[3..6].iter().sum();
        assert!((squares - (-0.5 * 2f64.sin()).exp()).abs() < 1e-14, "{squares}");
    }

    #[test]
    fn values_settle_with_the_degree() {
        let problem = paper_problem();
        for (degree, tolerance) in
            [(16, 1e-5), (24, 4e-7), (32, 2e-8), (48, 2e-10), (64, 2e-12), (80, 1e-13)]
        {
            let difference = largest_difference(
                &rigid_body_expectations(&problem, degree, &observables()),
                &PAPER,
            );
            assert!(difference < tolerance, "{degree}: {difference:e}");
        }
    }

    #[test]
    fn halving_the_time_step_changes_nothing() {
        let problem = paper_problem();
        let at =
            |steps| means(&moments(&problem, 32, steps), 32, radius(&problem, 1.0), &observables());
        let steps = steps(&problem, 32);
        let difference = largest_difference(&at(steps), &at(2 * steps));
        assert!(difference < 1e-13, "{steps}: {difference:e}");
    }

    #[test]
    fn the_axes_are_treated_alike() {
        // Turning the names of the axes round turns the values round; the harmonics know one axis
        // from the others.
        let turned = |x: [f64; 3]| [x[1], x[2], x[0]];
        let body = valid(RigidBody::three_noises(turned(INERTIA), turned(NOISE_INERTIA)));
        let problem = valid(Problem::new(body, half_cosine(), turned(rigid_body_start()), 1.0));
        let found = rigid_body_expectations(&problem, 24, &observables());
        let expected = rigid_body_expectations(&paper_problem(), 24, &observables());
        for kind in 0..4 {
            let [found, expected] =
                [&found, &expected].map(|values| [0, 1, 2].map(|j| values[3 * kind + j]));
            assert!(
                largest_difference(&found, &turned(expected)) < 1e-13,
                "{found:?} {expected:?}"
            );
        }
    }

    /// Means of all observables at the final time.
    struct Final {
        observables: Vec<Observable<3>>,
        moments: Vec<Moments>,
        last_time: u64,
    }

    impl Statistic<3> for Final {
        fn observe(&mut self, view: &View<'_, 3>) {
            if view.time == self.last_time {
                for p in view.live.paths() {
                    let y = view.states[0].path(p);
                    for (moments, observable) in self.moments.iter_mut().zip(&self.observables) {
                        moments.add((observable.function)(y));
                    }
                }
            }
        }

        fn merge(&mut self, later: Self) {
            self.moments
                .iter_mut()
                .zip(later.moments)
                .for_each(|(earlier, later)| earlier.merge(later));
        }
    }

    #[test]
    fn sampled_paths_agree() {
        let problem = paper_problem();
        let (sexp, key) = (Sexp::default(), StreamKey { seed: 20, experiment: 3 });
        let truncation = Truncation::new(4).unwrap();
        let ladder =
            Ladder::new(&problem, 128, 0, truncation, key, vec![Run::new(&sexp, 0)]).unwrap();
        let new = || Final {
            observables: observables(),
            moments: vec![Moments::default(); 12],
            last_time: ladder.coarse_steps(),
        };
        let outcome = ladder.run(32_768, new, &|_| ());
        for (moments, exact) in outcome.statistic.moments.iter().zip(PAPER) {
            // The weak error at this step is below one standard error.
            let deviation = (moments.mean() - exact) / moments.standard_error();
            assert!(deviation.abs() < 5.0, "{exact}: {deviation} standard errors");
        }
    }
}
