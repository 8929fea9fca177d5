//! y₀ = 0 and other points where nothing moves.

use systems::{Constant, Damping, IntegerExponents, LotkaVolterra, Pendulum, PoissonSystem};

use super::{Claim, Context, Measured, Words, body, valid};
use crate::method::Method;
use crate::path::{Path, truncated_noise};
use crate::results::Case;

const TAU: f64 = 1.0 / 16.0;
const STEPS: u64 = 128;

/// Largest distance from y₀.
fn distance<S: PoissonSystem<D, M>, const D: usize, const M: usize>(
    context: &Context,
    system: &S,
    damping: &dyn Damping,
    y0: [f64; D],
    method: Method,
) -> Measured {
    let path = Path { system, damping, y0, tau: TAU, steps: STEPS };
    let mut worst = 0.0f64;
    let end =
        path.run(method, &mut truncated_noise::<M>(context.key(), 0, TAU), &mut |_, _, y, _| {
            worst = (0..D).map(|i| (y[i] - y0[i]).abs()).fold(worst, f64::max);
        });
    Measured { figure: worst, stop: end.err() }
}

pub(super) fn case(context: &Context) -> Case {
    let (none, some) = (valid(Constant::new(0.0)), valid(Constant::new(2.0)));
    let (pendulum, still) = (valid(Pendulum::new(1.0)), valid(Pendulum::new(0.0)));
    let lotka_volterra = valid(LotkaVolterra::<IntegerExponents<1, 1>>::integer(1.0));
    let mut rows = Vec::new();
    let mut add =
        |setting: &str, methods: Vec<Method>, bound: f64, measure: &dyn Fn(Method) -> Measured| {
            for method in methods {
                rows.push(Claim::AtMost(bound).row(setting, None, method.id(), measure(method)));
            }
        };
    add("rigid body, y₀ = 0, γ = 2", Method::all(3), 0.0, &|m| {
        distance(context, &body(), &some, [0.0; 3], m)
    });
    add("rigid body, y₀ = (0, 1, 0), γ = 0", Method::all(3), 0.0, &|m| {
        distance(context, &body(), &none, [0.0, 1.0, 0.0], m)
    });
    add("pendulum, y₀ = 0, γ = 2", Method::all(1), 0.0, &|m| {
        distance(context, &pendulum, &some, [0.0; 2], m)
    });
    // The float next to π is no equilibrium: sin of it is −(π − float) ≈ 1.2e-16, and the distance
    // grows like e^t.
    let upright = f64::EPSILON * (TAU * STEPS as f64).exp();
    add("pendulum upright, γ = 0, no noise", Method::all(1), upright, &|m| {
        distance(context, &still, &none, [0.0, std::f64::consts::PI], m)
    });
    // With y₁ = y₂ = y₃ and a = −1: B∇H = y₁ (y₂ terms) vanishes where a v₂ + v₃ = 0, v₁ = v₃ and
    // v₁ = v₂.
    add("Lotka–Volterra, y₀ = (½, ½, ½), γ = 0", Method::all(1), LV_BOUND, &|m| {
        distance(context, &lotka_volterra, &none, [0.5; 3], m)
    });
    Words {
        title: "Zero and equilibria",
        setup: "128 steps of τ = 1/16, truncated increments.",
        mathematics: "Where B∇Hₘ = 0 for all m and γy = 0 the solution stays. At y₀ = (½, ½, ½) all components of ∇H of the Lotka–Volterra system with a = b = −1 are equal, and B∇H = 0.",
        quantity: "largest distance of a component from y₀",
        guarantee: "Every scheme stays exactly where products of zeros are zeros. The upright pendulum starts an ulp from its equilibrium and leaves it like e^t; the bound is ε e^T. Lotka–Volterra stays exactly, since \
                    equal numbers are subtracted from each other.",
        varied: "system and start",
    }
    .with(context, rows)
}

/// All three components of ∇H are the same floating-point number, and so are those of a quadrature
/// of it.
const LV_BOUND: f64 = 0.0;
