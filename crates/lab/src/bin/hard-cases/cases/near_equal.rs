//! Discrete gradients at a = b and next to it.

use anyhow::Result;
use dgrad::{GradientField, averaged_with_error};
use systems::{
    HamiltonianIncrement, IntegerExponents, LotkaVolterra, Pendulum, Poisson3, PoissonSystem,
    RealExponents,
};

use super::{Case, Context, Words, each};
use crate::results::{Row, Setting};
use crate::rounding::length;

pub const CASE: Case = Case {
    words: Words {
        id: "near-equal",
        title: "Equal and nearly equal arguments of a discrete gradient",
        setup: "∇̄h(a, b) of the pendulum (sine), the three-dimensional Poisson system (cosine), \
                Lotka–Volterra with integer and with real exponents; the components of b are those \
                of a times 1 + distance and 1 − distance alternately.",
        mathematics: "∇̄h(a, b) = ∫₀¹∇h((1−η)a + ηb)dη is smooth, with ∇̄h(a, a) = ∇h(a). The \
                      textbook quotient (H(b) − H(a))/(b − a) cancels as b → a.",
        quantity: "largest error of a component relative to |∇h|, against 49 Gauss–Legendre nodes",
        guarantee: "32ε at every distance: the closed forms and the quadratures divide by nothing \
                    that vanishes.",
        varied: "distance",
        plot: None,
    },
    rows,
};

/// Relative distances between a and b: none, one ulp, and on.
const DISTANCES: [f64; 7] = [0.0, f64::EPSILON, 1e-12, 1e-8, 1e-4, 1e-2, 1e-1];

/// Rounding of ∇̄: each of at most 49 terms of either sum is rounded a few times, but the errors of
/// a sum of positive weights that add up to one do not exceed those of its largest terms: 8ε for
/// the terms and 24·½ε twice for the sums. At a distance of a tenth the 12 nodes of real powers
/// leave (0.1)²⁴ of a function whose derivatives grow like n!.
const BOUND: f64 = 32.0 * f64::EPSILON;

fn rows(_: &Context) -> Result<Vec<Row>> {
    let (pendulum, poisson) = (Pendulum::new(1.0)?, Poisson3::new(1.0)?);
    let integer = LotkaVolterra::<IntegerExponents<2, 2>>::integer(1.0)?;
    let real = LotkaVolterra::<RealExponents>::new(-1.0, -1.5, 1.0)?;
    each(DISTANCES, |distance| {
        let words = if distance == f64::EPSILON { "one ulp".into() } else { distance.to_string() };
        let setting = Setting { words, x: Some(distance) };
        let row = |name, error| Row::new(&setting, name, None).with_figure(error).at_most(BOUND);
        Ok(vec![
            row("sine", error(&pendulum, [0.3, 1.2], distance)?),
            row("cosine", error(&poisson, [1.0, 2.0, 3.0], distance)?),
            row("polynomial", error(&integer, [0.2, 0.4, 0.6], distance)?),
            row("real powers", error(&real, [0.2, 0.4, 0.6], distance)?),
        ])
    })
}

/// The largest error of a component of ∇̄h(a, b), relative to |∇h|, against a rule with 2·24 + 1
/// nodes; NaN if a component is.
fn error<S: PoissonSystem<D, 1>, const D: usize>(
    system: &S,
    a: [f64; D],
    distance: f64,
) -> Result<f64> {
    let mut b = a;
    for i in 0..D {
        b[i] += a[i] * distance * if i % 2 == 0 { 1.0 } else { -1.0 };
    }
    let field = HamiltonianIncrement { system, dt: 0.75, dw: [0.5] };
    let (exact, _) = averaged_with_error(&field, a, b, 24)?;
    let mean = system.averaged_gradient(a, b, 0.75, [0.5]);
    let size = length(field.gradient(a));
    let errors = (0..D).map(|i| (mean[i] - exact[i]).abs() / size);
    Ok(errors.fold(0.0, |worst, error| if error > worst || error.is_nan() { error } else { worst }))
}
