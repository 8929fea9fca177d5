//! Two schemes of your own, one explicit and one implicit, and their strong orders.
//!
//! ```text
//! cargo run --release -p casimir-poisson --example own_scheme
//! ```

use casimir::prelude::*;
use casimir::schemes::EulerMaruyama;
use casimir::systems::{Cosine, MaxwellBloch};

/// Heun's method between two halves of exact damping:
/// ẑ = e^{−∫γ, first half} y_n, z = ẑ + ½(f(ẑ) + f(ẑ + f(ẑ))), y_{n+1} = e^{−∫γ, second half} z.
struct DampedHeun;

impl Explicit for DampedHeun {
    const ID: &'static str = "damped Heun";

    #[inline(always)]
    fn advance<H: Increment>(&self, h: H, y: H::Vector) -> H::Vector {
        let start = y * h.step().first_decay;
        let slope = h.field(start);
        let ahead = h.field(start + slope);
        (start + (slope + ahead) * 0.5) * h.step().second_decay
    }
}

/// The midpoint rule between two halves of exact damping: z = ẑ + f((ẑ + z)/2).
struct ConformalMidpoint;

impl Implicit for ConformalMidpoint {
    const ID: &'static str = "conformal midpoint";
    const EXACT_DAMPING: bool = true;

    #[inline(always)]
    fn psi<H: Increment>(&self, h: H, start: H::Vector, z: H::Vector) -> H::Vector {
        start + h.field((start + z) * 0.5)
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let problem = Problem::new(MaxwellBloch, Cosine::new(0.5, 2.0)?, [1.0, 2.0, 3.0], 1.0)?;
    let key = StreamKey { seed: 1, experiment: 0 };
    let sizes = StepSizes::new(32, Truncation::new(4)?, key);
    // Euler–Maruyama has order ½ as a rule, but f₁ = (y₂, 0, 0) does not act on itself.
    let system = Compiled::new(*problem.system(), problem.y0());
    let report = inspect(&system, &InspectSettings::of(&problem))?;
    let predicted = report.order("em").map_or(f64::NAN, |(strong, _)| strong);
    println!("inspect expects strong order {predicted} of em");
    let schemes: [&dyn Scheme<MaxwellBloch, 3, 1>; 3] =
        [&DampedHeun, &ConformalMidpoint, &EulerMaruyama];
    for scheme in schemes {
        let order = strong_order(&Setup::of(&problem, scheme), &sizes)?;
        println!("{:20} strong {order}", scheme.about().id);
        for point in &order.points {
            println!("  {}", serde_json::to_string(point)?);
        }
    }
    Ok(())
}
