//! Lotka–Volterra with integer exponents and with the same exponents taken for real ones.

use crate::common::{Numbers, Region};
use approx::{assert_abs_diff_eq, assert_relative_eq};
use systems::{
    Exponents, IntegerExponents, LotkaVolterra, PoissonSystem, RealExponents, ito_correction,
    vector_field,
};

/// y^n as e^{n ln y} with |n ln y| below 6: relative error 2·6·ε, twice in a quotient of powers,
/// and some products.
const ROUND_OFF: f64 = 64.0 * f64::EPSILON;

#[track_caller]
fn close(one: [f64; 3], other: [f64; 3], terms: f64) {
    assert_abs_diff_eq!(one[..], other[..], epsilon = ROUND_OFF * terms);
}

fn agree<E: Exponents>(integer: LotkaVolterra<E>, real: LotkaVolterra<RealExponents>) {
    let mut numbers = Numbers(21);
    for _ in 0..500 {
        let y: [f64; 3] = Region::Positive.point(&mut numbers);
        let v: [f64; 3] = numbers.vector();
        let (dt, [dw]) = (numbers.next(), numbers.vector::<1>());
        let largest = |x: [f64; 3]| x.iter().fold(1.0, |m: f64, x| m.max(x.abs()));

        let (one, other): ([f64; 3], [f64; 3]) = (integer.structure(y, v), real.structure(y, v));
        close(one, other, largest(one));
        let (one, other): ([f64; 3], [f64; 3]) =
            (integer.gradient(y, dt, [dw]), real.gradient(y, dt, [dw]));
        close(one, other, largest(one));
        // Not so far apart that 12 nodes would not do.
        let b = std::array::from_fn(|i| y[i] + 0.1 * v[i]);
        let (one, other): ([f64; 3], [f64; 3]) =
            (integer.averaged_gradient(y, b, dt, [dw]), real.averaged_gradient(y, b, dt, [dw]));
        close(one, other, largest(one));
        // In the fields the powers cancel, so the terms are the products of degree two, up to
        // 6·1.7².
        close(vector_field(&integer, y, dt, [dw]), vector_field(&real, y, dt, [dw]), 18.0);
        close(ito_correction(&integer, y), ito_correction(&real, y), 6.0 * 18.0 * 1.7);
        let (one, other): (f64, f64) = (integer.energy(y, dt, [dw]), real.energy(y, dt, [dw]));
        assert_relative_eq!(one, other, epsilon = 0.0, max_relative = ROUND_OFF);
        let (one, other): (f64, f64) = (integer.invariant(1, y), real.invariant(1, y));
        assert_abs_diff_eq!(one, other, epsilon = ROUND_OFF * 6.0);
    }
    assert_eq!(integer.invariants(), real.invariants());
}

#[test]
fn integer_and_real_exponents_agree() {
    agree(
        LotkaVolterra::<IntegerExponents<1, 1>>::integer(1.0).unwrap(),
        LotkaVolterra::new(-1.0, -1.0, 1.0).unwrap(),
    );
    agree(
        LotkaVolterra::<IntegerExponents<2, 2>>::integer(1.3).unwrap(),
        LotkaVolterra::new(-1.0, -2.0, 1.3).unwrap(),
    );
    agree(
        LotkaVolterra::<IntegerExponents<3, 2>>::integer(0.5).unwrap(),
        LotkaVolterra::new(-1.5, -2.0, 0.5).unwrap(),
    );
    agree(
        LotkaVolterra::<IntegerExponents<2, 4>>::integer(1.0).unwrap(),
        LotkaVolterra::new(-0.5, -4.0, 1.0).unwrap(),
    );
}

#[test]
fn the_discrete_gradient_of_a_polynomial_is_exact_however_far() {
    // From one corner of the region to the other, where a quadrature of real powers would be
    // visibly off.
    let system = LotkaVolterra::<IntegerExponents<4, 5>>::integer(1.0).unwrap();
    let (a, b) = ([0.3, 1.7, 0.5], [1.7, 0.3, 1.5]);
    let mean: [f64; 3] = system.averaged_gradient(a, b, 1.0, [0.0]);
    let work: f64 = (0..3).map(|i| mean[i] * (b[i] - a[i])).sum();
    let terms: f64 = (0..3).map(|i| (mean[i] * (b[i] - a[i])).abs()).sum();
    let energy = |y| -> f64 { system.invariant(0, y) };
    assert_abs_diff_eq!(work, energy(b) - energy(a), epsilon = ROUND_OFF * terms);
}
