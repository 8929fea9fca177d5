//! Harmonics and expectations against identities and known values.

use systems::{
    Constant,
    paper::{INERTIA, NOISE_INERTIA, rigid_body_three_noises, valid},
};

use super::{harmonics::harmonics, integration::norm, *};
use crate::panels::{phi, weak_observables};

const COMPONENTS: [Observable<3>; 3] =
    [phi("y1", |y| y[0]), phi("y2", |y| y[1]), phi("y3", |y| y[2])];

fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    // NaN stays.
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, analysis::worse)
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
    let mut observables = COMPONENTS.to_vec();
    observables.push(phi("", |y| y[1] * y[1]));
    observables.push(phi("", |y| y[0].cos()));
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
        let found = rigid_body_expectations(&problem, 48, &COMPONENTS);
        let expected = start.map(|y| y * (-0.5f64).exp());
        assert!(largest_difference(&found, &expected) < 1e-9, "{found:?}");
    }
}

#[test]
fn values_settle_with_the_degree() {
    let problem = rigid_body_three_noises(1.0);
    for (degree, tolerance) in
        [(16, 1e-5), (24, 4e-7), (32, 2e-8), (48, 2e-10), (64, 2e-12), (80, 1e-13)]
    {
        let difference = largest_difference(
            &rigid_body_expectations(&problem, degree, &weak_observables()),
            &PAPER,
        );
        assert!(difference < tolerance, "{degree}: {difference:e}");
    }
}
