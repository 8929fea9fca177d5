//! A scheme of your own through `verify`: the stochastic Heun method between two halves of exact
//! damping, and a prediction of `inspect` put to the test.
//!
//! ```text
//! cargo run -p verify --example own_scheme
//! ```

use noise::{StreamKey, Truncation};
use schemes::{EulerMaruyama, Scheme, Step};
use systems::{Cosine, MaxwellBloch, Problem, vector_field};
use verify::{PathScheme, StepSizes, inspect, strong_order};

/// e^{−∫γ, first half}, ẑ + ½(f(ẑ) + f(ẑ + f(ẑ))), e^{−∫γ, second half}.
fn damped_heun(system: &MaxwellBloch, step: &Step, dw: [f64; 1], y: [f64; 3]) -> [f64; 3] {
    let z = y.map(|component| step.first_decay * component);
    let slope = vector_field(system, z, step.tau, dw);
    let ahead = vector_field(system, [0, 1, 2].map(|i| z[i] + slope[i]), step.tau, dw);
    [0, 1, 2].map(|i| step.second_decay * (z[i] + 0.5 * (slope[i] + ahead[i])))
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let problem = Problem::new(MaxwellBloch, Cosine::new(0.5, 2.0)?, [1.0, 2.0, 3.0], 1.0)?;
    let mine = PathScheme { id: "damped Heun", advance: damped_heun };
    let sizes = StepSizes {
        coarsest_steps: 32,
        levels: 6,
        refinement: 4,
        samples: 400,
        truncation: Truncation::new(4)?,
        key: StreamKey { seed: 1, experiment: 0 },
    };
    // Euler–Maruyama has order ½ as a rule, but f₁ = (y₂, 0, 0) does not act on itself.
    let predicted = inspect(&MaxwellBloch)?.order("em").map_or(f64::NAN, |(strong, _)| strong);
    println!("inspect expects strong order {predicted} of em");
    for scheme in [&mine as &dyn Scheme<MaxwellBloch, 3, 1>, &EulerMaruyama] {
        let order = strong_order(scheme, &problem, &sizes)?;
        let rate = order.rate.ok_or("no order can be named")?;
        println!(
            "{:12} strong order {:.3}, 95 % interval [{:.3}, {:.3}]",
            scheme.id(),
            rate.estimate,
            rate.lo,
            rate.hi
        );
        for point in &order.points {
            println!("  {}", serde_json::to_string(point)?);
        }
    }
    Ok(())
}
