//! States of extreme size, next to poles of the structure, or at rest.

use noise::WienerRows;
use systems::{
    Constant, IntegerExponents, LotkaVolterra, Pendulum, PoissonSystem, RigidBody,
    paper::{INERTIA, NOISE_INERTIA, half_cosine, rigid_body_start, sine},
};
use verify::rounding::law_bound;

use crate::{
    Case, Context, Rows, each,
    paths::{CASIMIR, Experiment, Law},
};

/// States from 10⁻¹⁵⁰ to 10¹⁵⁰.
///
/// Rigid body with three noises, γ = ½cos 2t, 64 steps of τ = 1/64, no areas. State and moments of
/// inertia are multiplied by a power of two.
///
/// The solution scales with them, in floating point bit by bit.
pub const SCALES: Case = Case {
    id: "scales",
    quantity: "largest difference from the solution of scale one, relative to |y₀|",
    guarantee: "No scheme or stopping test depends on the scale, up to one sweep.",
    varied: "scale",
    rows: scales,
};

fn scales(context: &Context) -> Rows {
    let (key, steps, tau) = (context.key, 64, 1.0 / 64.0_f64);
    let scaled = |scale: f64| {
        let [body, noise] = [INERTIA, NOISE_INERTIA].map(|inertia| inertia.map(|i| i * scale));
        let system = (RigidBody::three_noises(body, noise)?, half_cosine());
        let start = rigid_body_start().map(|y| y * scale);
        let experiment = Experiment::new(context, system, start, (steps, tau))?;
        // The weights 1/Î² of the areas overflow or underflow.
        let without_areas = experiment.with_noise(move |first_path| {
            let mut increments = WienerRows::new(key, first_path);
            Box::new(move |noise| increments.increments(tau.sqrt(), &mut noise.increments))
        });
        anyhow::Ok(without_areas.with_parts())
    };
    let plain = scaled(1.0)?;
    // Powers of two next to 10⁻¹⁵⁰ … 10¹⁵⁰.
    each([-498, -332, -166, 166, 332, 498], |exponent| {
        let scale = 2f64.powi(exponent);
        let decimal = f64::from(exponent) * std::f64::consts::LOG10_2;
        let setting = format!("2^{exponent} ≈ 1e{decimal:+.0}");
        scaled(scale)?.rows(setting, |row, scheme, paths| {
            let (a, b) = (plain.run(scheme)?[0].end(), paths[0].end());
            let difference = (0..3).map(|i| (b[i] / scale - a[i]).abs()).fold(0.0, f64::max);
            Ok(row.with_figure(difference).at_most(law_bound(steps, 1.0)))
        })
    })
}

/// y₀ = 0 and other points where nothing moves.
///
/// 128 steps of τ = 1/16.
///
/// Where B∇Hₘ = 0 for all m and γy = 0 the solution stays.
pub const EQUILIBRIA: Case = Case {
    id: "equilibria",
    quantity: "largest distance of a component from y₀",
    guarantee: "Every scheme stays exactly. The upright pendulum starts an ulp from its \
                equilibrium and leaves it like εe^t.",
    varied: "system and start",
    rows: equilibria,
};

const REST: (u64, f64) = (128, 1.0 / 16.0);

fn equilibria(context: &Context) -> Rows {
    let body = RigidBody::three_noises(INERTIA, NOISE_INERTIA)?;
    let (pendulum, still) = (Pendulum::new(1.0)?, Pendulum::new(0.0)?);
    let volterra = LotkaVolterra::<IntegerExponents<1, 1>>::integer(1.0)?;
    let (none, some) = (Constant::new(0.0)?, Constant::new(2.0)?);
    // The float next to π is no equilibrium: its sine is 1.2e-16, and the distance grows like e^t.
    let (pi, grown) = (std::f64::consts::PI, f64::EPSILON * (REST.0 as f64 * REST.1).exp());
    Ok([
        stay(context, "rigid body, y₀ = 0, γ = 2", (body, some), [0.0; 3], 0.0)?,
        stay(context, "rigid body, y₀ = (0, 1, 0), γ = 0", (body, none), [0.0, 1.0, 0.0], 0.0)?,
        stay(context, "pendulum, y₀ = 0, γ = 2", (pendulum, some), [0.0; 2], 0.0)?,
        stay(context, "pendulum upright, γ = 0, no noise", (still, none), [0.0, pi], grown)?,
        stay(context, "Lotka–Volterra, y₀ = (½, ½, ½), γ = 0", (volterra, none), [0.5; 3], 0.0)?,
    ]
    .concat())
}

/// The largest distance from y₀, at most `bound`.
fn stay<S: PoissonSystem<D, M>, const D: usize, const M: usize>(
    context: &Context,
    setting: &str,
    system: (S, Constant),
    y0: [f64; D],
    bound: f64,
) -> Rows {
    let experiment = Experiment::new(context, system, y0, REST)?;
    experiment.rows(setting, |row, _, paths| {
        let states = paths[0].states.iter();
        let components = states.flat_map(|y| (0..D).map(|i| (y[i] - y0[i]).abs()));
        Ok(row.with_figure(components.fold(0.0, f64::max)).at_most(bound))
    })
}

/// Next to the coordinate planes, where the structure has its poles.
///
/// Several paths of Lotka–Volterra, a = −1, b = −2, γ = sin t, up to t = 2.
///
/// The solution stays positive. The Casimir 2y₁ + y₂ + y₃ follows e^(−∫γ). B has poles where y₁ =
/// 0 or y₂ = 0.
pub const LOTKA_VOLTERRA: Case = Case {
    id: "lotka-volterra",
    quantity: "largest relative distance of the Casimir from its law, before a path ends",
    guarantee: "`sexp` and `sexp-li` are positive and on the law to rounding, or end with a typed \
                error. No scheme is positive by construction.",
    varied: "start and τ",
    rows: lotka_volterra,
};

/// The law of a linear Casimir costs half of what a quadratic one costs, but its coefficients
/// differ by two. They are positive: there is no cancellation in the octant.
const LINEAR: Law = Law { invariants: &[1], weight: 2.0, ..CASIMIR };

fn lotka_volterra(context: &Context) -> Rows {
    let paths = context.many(64, 8);
    let starts = [
        ("y₁ = 1e-12", [1e-12, 0.4, 0.6]),
        ("y₂ = 1e-12", [0.2, 1e-12, 0.6]),
        ("y₃ = 1e-12", [0.2, 0.4, 1e-12]),
        ("all 1e-12", [1e-12; 3]),
    ];
    let settings = starts.into_iter().flat_map(|start| [16, 64, 256].map(|n| (start, n)));
    each(settings, |((name, y0), per_unit)| {
        let system = LotkaVolterra::<IntegerExponents<2, 2>>::integer(1.0)?;
        let steps = (2 * per_unit, 1.0 / per_unit as f64);
        let experiment = Experiment::new(context, (system, sine()), y0, steps)?;
        let setting = format!("{name}, τ = 1/{per_unit}");
        Experiment { paths, ..experiment }.law_rows(setting, &LINEAR, |_| None)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_casimir_has_positive_coefficients() {
        let system = LotkaVolterra::<IntegerExponents<2, 2>>::integer(1.0).unwrap();
        for i in 0..3 {
            let mut y = [0.0; 3];
            y[i] = 1.0;
            let value: f64 = system.invariant(1, y);
            assert!((1.0..=2.0).contains(&value));
        }
    }
}
