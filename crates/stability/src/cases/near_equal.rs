//! Discrete gradients at a = b and next to it.

use dgrad::{GradientField, averaged_with_error};
use systems::{
    HamiltonianIncrement, IntegerExponents, LotkaVolterra, Pendulum, Poisson3, PoissonSystem,
    RealExponents,
};

use super::{Claim, Context, Measured, Words, valid};
use crate::results::{Case, Row};

/// Relative distances between a and b: none, one ulp, and on.
const DISTANCES: [f64; 7] = [0.0, f64::EPSILON, 1e-12, 1e-8, 1e-4, 1e-2, 1e-1];

/// The largest error of a component of ∇̄h(a, b), relative to |∇h|, against a rule with 2·24 + 1
/// nodes.
fn error<S: PoissonSystem<D, 1>, const D: usize>(system: &S, a: [f64; D], distance: f64) -> f64 {
    let mut b = a;
    for i in 0..D {
        b[i] += a[i] * distance * if i % 2 == 0 { 1.0 } else { -1.0 };
    }
    let field = HamiltonianIncrement { system, dt: 0.75, dw: [0.5] };
    let Ok((exact, _)) = averaged_with_error(&field, a, b, 24) else { return f64::NAN };
    let mean = system.averaged_gradient(a, b, 0.75, [0.5]);
    let size = super::length(field.gradient(a));
    (0..D)
        .map(|i| (mean[i] - exact[i]).abs() / size)
        .fold(0.0, |worst, e| if e.is_nan() { e } else { f64::max(worst, e) })
}

/// Rounding of ∇̄: each of at most 49 terms of either sum is rounded a few times, but the errors of
/// a sum of positive weights that add up to one do not exceed those of its largest terms: 8ε for
/// the terms and 24·½ε twice for the sums.
const BOUND: f64 = 32.0 * f64::EPSILON;

pub(super) fn case(context: &Context) -> Case {
    let (pendulum, poisson) = (valid(Pendulum::new(1.0)), valid(Poisson3::new(1.0)));
    let integer = valid(LotkaVolterra::<IntegerExponents<2, 2>>::integer(1.0));
    let real = valid(LotkaVolterra::<RealExponents>::new(-1.0, -1.5, 1.0));
    let mut rows: Vec<Row> = Vec::new();
    for distance in DISTANCES {
        let mut add = |name: &str, figure: f64, exact: bool| {
            let claim = if exact { Claim::AtMost(BOUND) } else { Claim::Nothing };
            let setting =
                if distance == f64::EPSILON { "one ulp".to_owned() } else { format!("{distance}") };
            rows.push(claim.row(&setting, Some(distance), name, Measured { figure, stop: None }));
        };
        add("sine", error(&pendulum, [0.3, 1.2], distance), true);
        add("cosine", error(&poisson, [1.0, 2.0, 3.0], distance), true);
        add("polynomial", error(&integer, [0.2, 0.4, 0.6], distance), true);
        // At a distance of a tenth the 12 nodes of real powers leave (0.1)²⁴ of a function whose
        // derivatives grow like n!.
        add("real powers", error(&real, [0.2, 0.4, 0.6], distance), true);
    }
    Words {
        title: "Equal and nearly equal arguments of a discrete gradient",
        setup: "∇̄h(a, b) of the pendulum (sine), the three-dimensional Poisson system (cosine), Lotka–Volterra with integer and with real exponents; b = a(1 ± distance) in turn.",
        mathematics: "∇̄h(a, b) = ∫₀¹∇h((1−η)a + ηb)dη is smooth, with ∇̄h(a, a) = ∇h(a). The textbook quotient (H(b) − H(a))/(b − a) cancels as b → a.",
        quantity: "largest error of a component relative to |∇h|, against 49 Gauss–Legendre nodes",
        guarantee: "32ε at every distance: the closed forms and the quadratures divide by nothing that vanishes.",
        varied: "distance",
    }
    .with(context, rows)
}
