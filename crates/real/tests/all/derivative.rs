//! `gradient` against derivatives taken by hand, first and second order.

use proptest::prelude::*;
use real::{Real, ScalarFunction, along, gradient};

/// f = x² y + eˣ sin y + √(1 + z²) + x/(2 + z²).
struct Scalar;
impl ScalarFunction<3> for Scalar {
    fn value<R: Real>(&self, [x, y, z]: [R; 3]) -> R {
        x * x * y + x.exp() * y.sin() + (z * z + 1.0).sqrt() + x / (z * z + 2.0)
    }
}

fn scalar_gradient([x, y, z]: [f64; 3]) -> [f64; 3] {
    let quotient = z * z + 2.0;
    [
        2.0 * x * y + x.exp() * y.sin() + 1.0 / quotient,
        x * x + x.exp() * y.cos(),
        z / (1.0 + z * z).sqrt() - 2.0 * x * z / (quotient * quotient),
    ]
}

/// ½|∇f|² of a vector function, to nest `gradient` inside `gradient`.
struct HalfSquareOfGradient;
impl ScalarFunction<3> for HalfSquareOfGradient {
    fn value<R: Real>(&self, y: [R; 3]) -> R {
        let g = gradient(&Cubic, y);
        (g[0] * g[0] + g[1] * g[1] + g[2] * g[2]) * 0.5
    }
}

/// x³/3 + y³/3 + z³/3, whose gradient is (x², y², z²).
struct Cubic;
impl ScalarFunction<3> for Cubic {
    fn value<R: Real>(&self, [x, y, z]: [R; 3]) -> R {
        (x.powi(3) + y.powi(3) + z.powi(3)) / 3.0
    }
}

const POINT: std::ops::Range<f64> = -3.0..3.0;
/// No formula here has more than 16 operations, none amplifies, and no term exceeds e³ + 27 < 64.
const TOLERANCE: f64 = 16.0 * 64.0 * f64::EPSILON;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    #[test]
    fn the_gradient_is_the_one_by_hand(y in [POINT, POINT, POINT]) {
        let (ours, exact) = (gradient(&Scalar, y), scalar_gradient(y));
        for i in 0..3 {
            prop_assert!((ours[i] - exact[i]).abs() < TOLERANCE, "{:?} {:?}", ours, exact);
        }
    }

    #[test]
    fn derivatives_nest(y in [POINT, POINT, POINT]) {
        // ½Σ x⁴ has the gradient 2x³; the inner gradient runs on dual numbers.
        let ours = gradient(&HalfSquareOfGradient, y);
        for i in 0..3 {
            prop_assert!((ours[i] - 2.0 * y[i].powi(3)).abs() < TOLERANCE, "{:?}", ours);
        }
    }

    #[test]
    fn the_slope_along_a_vector_is_the_product(y in [POINT, POINT, POINT], v in [POINT, POINT, POINT]) {
        let dual = Scalar.value(along(y, v));
        // The value is not touched by differentiation.
        prop_assert_eq!(Scalar.value(y).to_bits(), dual.value.to_bits());
        let exact: f64 = scalar_gradient(y).iter().zip(v).map(|(g, v)| g * v).sum();
        prop_assert!((dual.derivative() - exact).abs() < 9.0 * TOLERANCE, "{dual:?} {exact}");
    }
}
