//! What a bath does to the equation.

use real::Rows;
use systems::run_time::{Op, System, Weights};

use crate::{BODY, ENERGY, system, texts};

/// The first column of an operation.
fn applied(system: &dyn System, op: Op<&[real::Row]>, h: Weights<'_>) -> Vec<f64> {
    let d = system.description().dimension;
    let mut out = Rows::zero(d);
    let mut scratch = Rows::zero(system.description().scratch_rows());
    system.apply(op, 0..d, h, &mut out, &mut scratch);
    out.iter().map(|row| row[0]).collect()
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The drift y × ∇H₀ + u y × ∇Φ with u = −{H₀, Φ}/2kT and {F, G} = ∇F·(y × ∇G), written by hand
/// for Φ = 0.3x + 0.2yz.
fn by_hand(y: [f64; 3], kt: f64) -> [f64; 3] {
    let energy = [y[0] / 2.0, y[1], 1.5 * y[2]];
    let phi = [0.3, 0.2 * y[2], 0.2 * y[1]];
    let u = -dot(energy, cross(y, phi)) / (2.0 * kt);
    let [free, pushed] = [cross(y, energy), cross(y, phi)];
    std::array::from_fn(|i| free[i] + u * pushed[i])
}

/// Rounding of some hundred operations on numbers of order one.
const ROUNDING: f64 = 1e-14;

#[test]
fn only_increments_are_shifted() {
    let (kt, y) = (0.7, [0.6, -0.3, 0.8]);
    // B(y)v = y × v.
    let definition = texts("x y z", &BODY, ENERGY, &[("0.3*x + 0.2*y*z", kt)]);
    let bathed = system(&definition, &y);
    assert!(bathed.description().has_bath && bathed.description().noises == 1);
    let (rows, dw) = (Rows::splat(&y), Rows::splat(&[0.0]));
    let h = Weights { dt: 1.0, dw: &dw, ..Weights::NONE };
    let field = |y: &Rows| {
        let slope = applied(&bathed, Op::Gradient { y }, h);
        applied(&bathed, Op::Structure { y, v: &Rows::splat(&slope) }, h)
    };
    for (found, expected) in field(&rows).iter().zip(by_hand(y, kt)) {
        assert!((found - expected).abs() < ROUNDING, "{found} {expected}");
    }
    // The noise is that of Φ, and ∇̄h has u at the middle.
    let noise = Weights { dt: 0.0, dw: &Rows::splat(&[1.0]), ..Weights::NONE };
    let slope = applied(&bathed, Op::Gradient { y: &rows }, noise);
    assert_eq!(slope, [0.3, 0.2 * 0.8, 0.2 * -0.3]);
    let [a, b] = [[0.5, -0.1, 0.7], [0.7, -0.5, 0.9]].map(|y| Rows::splat(&y));
    let mean = applied(&bathed, Op::AveragedGradient { a: &a, b: &b }, h);
    // Both are quadratic: the mean gradient is that at the middle, which is y.
    let middle = applied(&bathed, Op::Gradient { y: &rows }, h);
    for (mean, middle) in mean.iter().zip(&middle) {
        assert!((mean - middle).abs() < ROUNDING, "{mean} {middle}");
    }
    // The derivative of what is more than a gradient, by differences.
    let u = [0.2, 0.4, -0.1];
    let along = applied(&bathed, Op::Hessian { y: &rows, u: &Rows::splat(&u) }, h);
    let e = 1e-5;
    let [up, down] = [e, -e].map(|e| {
        let at: [f64; 3] = std::array::from_fn(|i| y[i] + e * u[i]);
        applied(&bathed, Op::Gradient { y: &Rows::splat(&at) }, h)
    });
    for i in 0..3 {
        let slope = (up[i] - down[i]) / (2.0 * e);
        assert!((along[i] - slope).abs() < 1e-9, "{} {slope}", along[i]);
    }
}

/// The mean of a gradient that is not linear has u at the middle, too.
#[test]
fn averages_have_the_drift_at_the_middle() {
    let energy = "x^4/4 + y^2/2 + cos(z)";
    let bathed = system(&texts("x y z", &BODY, energy, &[("sin(x) + y*z", 0.9)]), &[0.3; 3]);
    let free = system(&texts("x y z", &BODY, energy, &[]), &[0.3; 3]);
    let phi = system(&texts("x y z", &BODY, "sin(x) + y*z", &[]), &[0.3; 3]);
    let [a, b] = [[0.5, -0.1, 0.7], [0.9, 0.3, 0.2]];
    let middle: [f64; 3] = std::array::from_fn(|i| 0.5 * (a[i] + b[i]));
    let [a, b] = [a, b].map(|y| Rows::splat(&y));
    let dw = Rows::splat(&[0.4]);
    let (h, one) =
        (Weights { dt: 0.3, dw: &dw, ..Weights::NONE }, Weights { dt: 1.0, ..Weights::NONE });
    let op = Op::AveragedGradient { a: &*a, b: &*b };
    let found = applied(&bathed, op, h);
    let [of_energy, of_phi] = [&free, &phi].map(|system| applied(system, op, one));
    let [x, y, z] = middle;
    let bracket = dot([x * x * x, y, -z.sin()], cross(middle, [x.cos(), z, y]));
    let u = -bracket / (2.0 * 0.9);
    for i in 0..3 {
        let expected = 0.3 * of_energy[i] + (0.4 + 0.3 * u) * of_phi[i];
        assert!((found[i] - expected).abs() < ROUNDING, "{} {expected}", found[i]);
    }
}

#[test]
fn linear_friction_is_found_and_heat_is_what_a_bath_gives() {
    // Φ = σq is friction σ²/2mkT of p.
    let baths = [("0.6*q1", 0.5), ("q2*q2", 0.5), ("0.4*q2", 1.5)];
    let definition =
        texts("q1 q2 p1 p2", &["0 1 0", "0 1", "0"], "p1^2/4 + p2^2/2 + q1^2*q2 + q2^4", &baths);
    let found = system(&definition, &[0.1, 0.2, 0.3, 0.4]);
    let friction = found.friction();
    assert_eq!(friction.iter().map(|one| (one.0, one.1)).collect::<Vec<_>>(), [(0, 2), (2, 3)]);
    let rates = [0.36 / (2.0 * 2.0 * 0.5), 0.16 / (2.0 * 1.5)];
    for ((_, _, rate), expected) in friction.iter().zip(rates) {
        assert!((rate - expected).abs() < ROUNDING, "{rate} {expected}");
    }
    // ½σ²/m − γp²/m of the first, and ½(2q)² − ½(2q)²p²/kT of the second, at q2 = 0.2, p2 = 0.4.
    let heat = |noises: &[usize], friction: &[(usize, f64)]| {
        let mut heat = [0.0];
        found.heat(noises, friction).evaluate_one(&[&[0.1, 0.2, 0.3, 0.4]], &mut heat);
        heat[0]
    };
    let (first, second) = (0.36 / 4.0 * (1.0 - 0.09 / 2.0 / 0.5), 0.08 * (1.0 - 0.16 / 0.5));
    assert!((heat(&[0], &[]) - first).abs() < ROUNDING);
    assert!((heat(&[1], &[]) - second).abs() < ROUNDING);
    // As friction with noise of no bath.
    let plain = system(
        &formula::Definition { noises: vec!["0.6*q1".into()], baths: Vec::new(), ..definition },
        &[0.1, 0.2, 0.3, 0.4],
    );
    let mut heat = [0.0];
    let tape = plain.heat(&[0], &[(2, rates[0])]);
    tape.evaluate_one(&[&[0.1, 0.2, 0.3, 0.4]], &mut heat);
    assert!((heat[0] - first).abs() < ROUNDING);
}

#[test]
fn a_temperature_that_cannot_be_is_named() {
    for (kt, words) in
        [("-1", "positive, got -1"), ("0", "positive, got 0"), ("x", "depends on `x`")]
    {
        let mut definition = texts("x y z", &BODY, ENERGY, &[("x", 1.0)]);
        definition.baths[0].temperature = kt.into();
        let error = formula::FormulaSystem::new(&definition, &[0.6, 0.0, 0.8]).err().unwrap();
        assert_eq!(error.which, formula::Which::Temperature(1));
        assert!(error.message.contains(words), "{error}");
    }
}
