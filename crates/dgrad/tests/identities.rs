//! ∇̄H(a, b)·(b − a) = H(b) − H(a), symmetry, consistency, and closed forms against quadrature.

use dgrad::{
    GradientField, Rule, ShortMean, averaged, averaged_by_degree, mean_cosine, mean_sine,
    nodes_for_degree,
};
use proptest::prelude::*;
use real::{Degree, Dual, Real};

struct Sine;
impl GradientField<1> for Sine {
    fn gradient<R: Real>(&self, y: [R; 1]) -> [R; 1] {
        [y[0].cos()]
    }
}

/// H = y₁² y₂² y₃, whose gradient has degree 4.
struct Monomial;
impl GradientField<3> for Monomial {
    fn gradient<R: Real>(&self, [x, y, z]: [R; 3]) -> [R; 3] {
        [x * y * y * z * 2.0, x * x * y * z * 2.0, x * x * y * y]
    }
}
fn monomial([x, y, z]: [f64; 3]) -> f64 {
    x * x * y * y * z
}

/// H = ln(1 + |y|²): no polynomial.
struct Logarithm;
impl GradientField<2> for Logarithm {
    fn gradient<R: Real>(&self, [x, y]: [R; 2]) -> [R; 2] {
        let s = x * x + y * y + 1.0;
        [x * 2.0 / s, y * 2.0 / s]
    }
}

/// [`Logarithm`] of the first two of five components.
struct Five;
impl GradientField<5> for Five {
    fn gradient<R: Real>(&self, [x, y, ..]: [R; 5]) -> [R; 5] {
        let [x, y] = Logarithm.gradient([x, y]);
        [x, y, R::zero(), R::zero(), R::zero()]
    }
}

fn dot<const D: usize>(mean: [f64; D], a: [f64; D], b: [f64; D]) -> f64 {
    (0..D).map(|i| mean[i] * (b[i] - a[i])).sum()
}

const POINT: std::ops::Range<f64> = -3.0..3.0;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn short_means_are_the_means(a in -20.0..20.0f64, h in -0.7..0.7f64, w in -2.0..2.0f64) {
        for (short, mean) in [
            (ShortMean::of_cosine(a, w), mean_cosine(Dual::fixed(a), Dual::variable(a + h))),
            (ShortMean::of_sine(a, w), mean_sine(Dual::fixed(a), Dual::variable(a + h))),
        ] {
            let h = (a + h) - a;
            let value = short.value(h);
            // The middle of a and a + h, which the general form takes, is rounded.
            let allowed = (4.0 + a.abs()) * f64::EPSILON * w.abs();
            prop_assert!((value - w * mean.value).abs() <= allowed, "{} {}", value, mean.value);
            let (estimate, slope) = short.estimate_with_slope(h);
            prop_assert!(
                (estimate - value).abs()
                    <= w.abs() * h.abs().powi(9) / 3.5e6 + 4.0 * f64::EPSILON * w.abs()
            );
            prop_assert!(
                (slope - w * mean.derivative()).abs() <= w.abs() * h.powi(8) / 2.8e6 + allowed
            );
            prop_assert!(
                (short.quadratic(h) - value).abs() <= w.abs() * h.abs().powi(3) / 24.0 + 1e-15
            );
            prop_assert!((short.cubic(h) - value).abs() <= w.abs() * h.powi(4) / 120.0 + 1e-15);
            let (cubic, slope) = short.cubic_with_slope(h);
            prop_assert_eq!(cubic, short.cubic(h));
            prop_assert!(
                (slope - w * mean.derivative()).abs() <= w.abs() * h.abs().powi(3) / 30.0 + allowed
            );
        }
    }

    #[test]
    fn sine_identity_to_round_off(a in -20.0..20.0f64, b in -20.0..20.0f64) {
        // sin b − sin a and its product form: a few roundings of numbers of size ≤ 20 in the
        // argument.
        let difference = mean_cosine(a, b) * (b - a);
        prop_assert!((difference - (b.sin() - a.sin())).abs() < 64.0 * f64::EPSILON);
        let difference = mean_sine(a, b) * (b - a);
        prop_assert!((difference - (a.cos() - b.cos())).abs() < 64.0 * f64::EPSILON);
    }

    #[test]
    fn sine_without_cancellation(a in POINT, exponent in -16.0..0.0f64) {
        // The mean of the cosine over [a, a + h] differs from cos a by at most h/2.
        let h = 10f64.powf(exponent);
        let mean: f64 = mean_cosine(a, a + h);
        prop_assert!((mean - a.cos()).abs() <= 0.5 * h + 4.0 * f64::EPSILON);
        prop_assert!((mean_cosine(a, a) - a.cos()).abs() <= 2.0 * f64::EPSILON);
    }

    #[test]
    fn closed_form_and_quadrature_agree(a in POINT, b in POINT) {
        // 20 nodes on an interval of length ≤ 6: remainder 6^{40}(20!)⁴/(41 (40!)³) < 1e-30.
        let by_nodes: [f64; 1] = averaged::<20, _, _, 1>(&Sine, [a], [b]);
        prop_assert!((by_nodes[0] - mean_cosine(a, b)).abs() < 32.0 * f64::EPSILON);
    }

    #[test]
    fn polynomials_are_exact_with_the_fewest_nodes(
        a in [POINT, POINT, POINT],
        b in [POINT, POINT, POINT],
    ) {
        const NODES: usize = nodes_for_degree(4);
        prop_assert_eq!(NODES, 3);
        let mean: [f64; 3] = averaged::<NODES, _, _, 3>(&Monomial, a, b);
        // Terms of size up to 2·3⁴·6 in each of three products, tens of roundings.
        let scale = 3f64.powi(4) * 6.0 * 6.0;
        prop_assert!(
            (dot(mean, a, b) - (monomial(b) - monomial(a))).abs() < 16.0 * f64::EPSILON * scale
        );
    }

    #[test]
    fn nodes_by_degree_are_those_of_the_rule(a in [POINT, POINT], b in [POINT, POINT]) {
        let by = |degree| averaged_by_degree(&Logarithm, degree, a, b);
        let rules = [
            averaged::<1, f64, _, 2>(&Logarithm, a, b),
            averaged::<2, _, _, 2>(&Logarithm, a, b),
            averaged::<3, _, _, 2>(&Logarithm, a, b),
            averaged::<8, _, _, 2>(&Logarithm, a, b),
        ];
        for (degree, rule) in [(1, 0), (2, 0), (3, 1), (4, 1), (5, 2), (6, 2), (7, 3)] {
            prop_assert_eq!(by(Degree::of(degree)), rules[rule]);
        }
        prop_assert_eq!(by(Degree::NONE), rules[3]);
        // More than four dimensions are a loop.
        let five = |[x, y]: [f64; 2]| [x, y, 1.0, 2.0, 3.0];
        let mean: [f64; 5] = averaged::<8, _, _, 5>(&Five, five(a), five(b));
        prop_assert_eq!(averaged_by_degree(&Five, Degree::NONE, five(a), five(b)), mean);
    }

    #[test]
    fn the_gradient_is_symmetric_and_consistent(a in [POINT, POINT], b in [POINT, POINT]) {
        let forward: [f64; 2] = averaged::<8, _, _, 2>(&Logarithm, a, b);
        let backward: [f64; 2] = averaged::<8, _, _, 2>(&Logarithm, b, a);
        let same: [f64; 2] = averaged::<8, _, _, 2>(&Logarithm, a, a);
        let gradient = Logarithm.gradient(a);
        for i in 0..2 {
            prop_assert!((forward[i] - backward[i]).abs() < 16.0 * f64::EPSILON);
            prop_assert!((same[i] - gradient[i]).abs() < 16.0 * f64::EPSILON);
        }
    }
}

/// The twin of the exactness tests: one node fewer than needed is visibly wrong.
#[test]
fn too_few_nodes_break_the_identity() {
    let (a, b) = ([1.0, 2.0, 3.0], [2.0, 1.0, -1.0]);
    let mean: [f64; 3] = averaged::<2, _, _, 3>(&Monomial, a, b);
    assert!((dot(mean, a, b) - (monomial(b) - monomial(a))).abs() > 1e-3);
}

#[test]
fn short_means_of_long_steps_are_none() {
    for h in [0.71, -3.0, 1e300, f64::INFINITY, f64::NAN] {
        assert!(ShortMean::of_sine(1.0, 1.0).value(h).is_nan());
    }
    assert!(
        ShortMean::of_cosine(f64::NAN, 1.0).value(0.1).is_nan()
            && ShortMean::of_cosine(2e6, 1.0).value(0.1).is_nan()
    );
}

#[test]
fn an_interval_has_its_length() {
    // ∫₁³ y² = 26/3, and from right to left with the other sign.
    let rule = Rule::new(2).unwrap();
    assert!((rule.integrate(1.0, 3.0, |y| y * y) - 26.0 / 3.0).abs() < 1e-14);
    assert!((rule.integrate(3.0, 1.0, |y| y * y) + 26.0 / 3.0).abs() < 1e-14);
}
