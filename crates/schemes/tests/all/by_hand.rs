//! One step of each scheme on the rigid body against formulas written out by hand, solved by a
//! plain iteration.

use crate::common::{
    INERTIA, NOISE_INERTIA, Numbers, any_damping, any_increments, any_state, body,
};
use approx::assert_relative_eq;
use noise::{Noise, Truncation};
use nonlin::{Method, Solver};
use schemes::{EulerMaruyama, Heun, Midpoint, Scheme, Sexp, Step, WithSolver};
use systems::{Cosine, Damping};

/// Sums of some tens of terms, each rounded a few times.
const ROUND_OFF: f64 = 64.0 * f64::EPSILON;

fn close(ours: [f64; 3], exact: [f64; 3], size: f64, what: &str) {
    for i in 0..3 {
        assert!((ours[i] - exact[i]).abs() <= ROUND_OFF * size, "{what}: {ours:?} {exact:?}");
    }
}

/// y × (K y) with K = diag(τ/Iᵢ + ΔWᵢ/Îᵢ).
fn rotation(y: [f64; 3], tau: f64, dw: [f64; 3]) -> [f64; 3] {
    let k: [f64; 3] = std::array::from_fn(|i| tau / INERTIA[i] + dw[i] / NOISE_INERTIA[i]);
    [(k[2] - k[1]) * y[1] * y[2], (k[0] - k[2]) * y[2] * y[0], (k[1] - k[0]) * y[0] * y[1]]
}

fn norm(y: [f64; 3]) -> f64 {
    y.iter().map(|x| x.abs()).sum()
}

#[test]
fn euler_maruyama() {
    let mut numbers = Numbers(31);
    for _ in 0..1000 {
        let damping = any_damping(&mut numbers);
        let tau = 0.01 * (1.1 + numbers.next());
        let step = Step::new(damping.as_ref(), 7, tau).unwrap();
        let dw: [f64; 3] = any_increments(&mut numbers, tau);
        let y: [f64; 3] = any_state(&mut numbers, &body(), [0.0; 3]);

        // τ(f₀ − γ(t_n)y + ½Σ fₘ′fₘ) + Σ fₘΔWₘ; fₘ turns about axis m, so ½fₘ′fₘ = −½(yₘ/Îₘ)²·(y
        // without yₘ).
        let rotated = rotation(y, tau, dw);
        let mut exact = [0.0; 3];
        for i in 0..3 {
            let mut drift = -damping.rate(7.0 * tau) * y[i];
            for m in 0..3 {
                if m != i {
                    drift -= 0.5 * (y[m] / NOISE_INERTIA[m]).powi(2) * y[i];
                }
            }
            exact[i] = y[i] + rotated[i] + tau * drift;
        }
        let ours = EulerMaruyama.step(&body(), &step, &Noise::increments(dw), y);
        close(ours.z, exact, 4.0, "em");
    }
}

#[test]
fn heun() {
    let mut numbers = Numbers(33);
    for _ in 0..1000 {
        let damping = any_damping(&mut numbers);
        let tau = 0.01 * (1.1 + numbers.next());
        let step = Step::new(damping.as_ref(), 7, tau).unwrap();
        let dw: [f64; 3] = any_increments(&mut numbers, tau);
        let y: [f64; 3] = any_state(&mut numbers, &body(), [0.0; 3]);

        let change = |t: f64, y: [f64; 3]| -> [f64; 3] {
            let f = rotation(y, tau, dw);
            std::array::from_fn(|i| f[i] - tau * damping.rate(t) * y[i])
        };
        let first = change(7.0 * tau, y);
        let second = change(8.0 * tau, std::array::from_fn(|i| y[i] + first[i]));
        let exact = std::array::from_fn(|i| y[i] + 0.5 * first[i] + 0.5 * second[i]);
        close(
            Heun.step(&body(), &step, &Noise::increments(dw), y).z,
            exact,
            10.0 * norm(y),
            "heun",
        );
    }
}

/// The solution of z = ψ(z) by 400 iterations, enough for a contraction by 0.9.
fn iterate(start: [f64; 3], map: impl Fn([f64; 3]) -> [f64; 3]) -> [f64; 3] {
    (0..400).fold(start, |z, _| map(z))
}

fn middle(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| 0.5 * (a[i] + b[i]))
}

#[test]
fn midpoint_and_sexp() {
    let mut numbers = Numbers(32);
    let damping = Cosine::new(0.5, 2.0).unwrap();
    for n in 0..1000 {
        let tau = 0.005 * (1.1 + numbers.next());
        let step = Step::new(&damping, n, tau).unwrap();
        let dw: [f64; 3] = any_increments(&mut numbers, tau);
        let y: [f64; 3] = any_state(&mut numbers, &body(), [0.0; 3]);
        let (start, half, end) = (n as f64 * tau, (n as f64 + 0.5) * tau, (n as f64 + 1.0) * tau);

        let gamma = 0.5 * (2.0 * half).cos();
        let exact = iterate(y, |z| {
            let m = middle(y, z);
            let f = rotation(m, tau, dw);
            std::array::from_fn(|i| y[i] + f[i] - tau * gamma * m[i])
        });
        for method in [Method::FixedPoint, Method::Newton] {
            let solver = Solver::new(method);
            let scheme = WithSolver { formula: Midpoint, solver };
            let ours = scheme.step(&body(), &step, &Noise::increments(dw), y);
            // |y| up to 3, and roundings amplified by 1/(1 − 0.9) at most.
            close(ours.z, exact, 10.0 * norm(y), "midpoint");
        }

        // ∫γ = ¼ sin 2t. H is quadratic, so ∇̄H is the gradient at the midpoint.
        let integral = |a: f64, b: f64| 0.25 * ((2.0 * b).sin() - (2.0 * a).sin());
        let before = y.map(|x| x * (-integral(start, half)).exp());
        let z = iterate(before, |z| {
            let f = rotation(middle(before, z), tau, dw);
            std::array::from_fn(|i| before[i] + f[i])
        });
        let exact = z.map(|x| x * (-integral(half, end)).exp());
        for method in [Method::FixedPoint, Method::Newton] {
            let solver = Solver::new(method);
            let scheme = WithSolver { formula: Sexp, solver };
            let ours = scheme.step(&body(), &step, &Noise::increments(dw), y);
            close(ours.z, exact, 10.0 * norm(y), "sexp");
        }
    }
}

#[test]
fn a_step_holds_time_and_damping() {
    let damping = Cosine::new(0.5, 2.0).unwrap();
    let step = Step::new(&damping, 5, 0.125).unwrap();
    assert_eq!((step.t, step.tau), (0.625, 0.125));
    assert_eq!(step.rate_at_start, damping.rate(0.625));
    assert_eq!(step.rate_at_middle, damping.rate(0.6875));
    assert_eq!(step.rate_at_end, damping.rate(0.75));
    let halves = [damping.integral(0.625, 0.6875), damping.integral(0.6875, 0.75)];
    assert_eq!(step.damping_integral(), halves[0] + halves[1]);
    // The exponential is good to 1.1 ulp.
    for (decay, half) in [step.first_decay, step.second_decay].into_iter().zip(halves) {
        assert_relative_eq!(decay, (-half).exp(), epsilon = 0.0, max_relative = 2.0 * f64::EPSILON);
    }
    // Grid times of nested grids agree exactly.
    let coarse = Step::new(&damping, 3, 0.25).unwrap();
    assert_eq!(Step::new(&damping, 6, 0.125).unwrap().t, coarse.t);
}

#[test]
fn bad_step_sizes_are_refused_by_name() {
    let damping = Cosine::new(0.5, 2.0).unwrap();
    for bad in [0.0, -0.1, f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let error = Step::new(&damping, 0, bad).unwrap_err();
        assert!(error.to_string().ends_with(&format!("tau = {bad}")), "{error}");
        let _: Box<dyn std::error::Error> = Box::new(error);
    }
    // A step of one or more is fine for the scheme; it is truncation that refuses it.
    assert!(Step::new(&damping, 0, 1.0).is_ok());
    assert!(Truncation::new(4).unwrap().bound(1.0).is_err());
}
