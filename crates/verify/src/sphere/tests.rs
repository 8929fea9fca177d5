//! Harmonics, generator and expectations against identities and known values.

use systems::{
    Constant, Cosine, ito_correction,
    paper::{
        INERTIA, NOISE_INERTIA, half_cosine, rigid_body_start, rigid_body_three_noises, valid,
    },
    unit_noise, vector_field,
};

use super::{
    generator::{Generator, norm_bound},
    harmonics::harmonics,
    integration::{moments, norm, steps},
    *,
};
use crate::panels::{phi, weak_observables};

fn paper_problem() -> Problem<RigidBody<3>, Cosine, 3> {
    rigid_body_three_noises(1.0)
}

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
            (8.0 * (values[3][i] - values[1][i]) - (values[4][i] - values[0][i])) / (12.0 * STEP)
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
fn the_squares_add_up_to_the_casimir() {
    let problem = paper_problem();
    let found = rigid_body_expectations(&problem, 16, &weak_observables());
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
            &rigid_body_expectations(&problem, degree, &weak_observables()),
            &PAPER,
        );
        assert!(difference < tolerance, "{degree}: {difference:e}");
    }
}

#[test]
fn halving_the_time_step_changes_nothing() {
    let problem = paper_problem();
    let at = |steps| {
        means(&moments(&problem, 32, steps), 32, radius(&problem, 1.0), &weak_observables())
    };
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
    let found = rigid_body_expectations(&problem, 24, &weak_observables());
    let expected = rigid_body_expectations(&paper_problem(), 24, &weak_observables());
    for kind in 0..4 {
        let [found, expected] =
            [&found, &expected].map(|values| [0, 1, 2].map(|j| values[3 * kind + j]));
        assert!(largest_difference(&found, &turned(expected)) < 1e-13, "{found:?} {expected:?}");
    }
}

#[test]
fn the_bound_of_the_generator_is_linear_in_the_drift_and_quadratic_in_the_noise() {
    // Inertia that moves next to nothing.
    const HEAVY: [f64; 3] = [1e12; 3];
    let of = |inertia: [f64; 3], noise: [f64; 3], degree: usize, r: f64| {
        norm_bound(&valid(RigidBody::three_noises(inertia, noise)), degree, r)
    };
    let close = |found: f64, exact: f64| (found / exact - 1.0).abs() < 1e-9;
    let (drift, noise) = (of(INERTIA, HEAVY, 3, 1.0), of(HEAVY, NOISE_INERTIA, 3, 1.0));
    assert!(close(of(INERTIA, HEAVY, 3, 2.0), 2.0 * drift) && drift > 0.1);
    assert!(close(of(HEAVY, NOISE_INERTIA, 3, 2.0), 4.0 * noise) && noise > 0.1);
    // So with the degree: from four to eight functions of one order.
    assert!(close(of(INERTIA, HEAVY, 7, 1.0), 2.0 * drift));
    assert!(close(of(HEAVY, NOISE_INERTIA, 7, 1.0), 4.0 * noise));
    assert!(close(of(INERTIA, NOISE_INERTIA, 3, 1.0), drift + noise));
}
