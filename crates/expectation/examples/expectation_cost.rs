//! What expectations cost: E[cos y₃] of the rigid body with three noises, with everything chosen.
//!
//! ```text
//! cargo run --release -p casimir-mc --features measuring --example expectation_cost -- 1e-3 1e-4
//! ```
//!
//! prints path-steps and seconds for each half-width of the 95 % interval, bias included, and how
//! far the estimate is from the value of the Kolmogorov equation.

use std::time::Instant;

use expectation::Expect;
use mc::Observable;
use systems::{Cosine, Problem, RigidBody};

/// E[cos y₃(1)] by spherical harmonics (`crates/verify/tests/known_answers/kolmogorov.rs`).
const EXACT: f64 = 0.797_719_935_281_68;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut accuracies: Vec<f64> =
        std::env::args().skip(1).map(|text| text.parse()).collect::<Result<_, _>>()?;
    if accuracies.is_empty() {
        accuracies = vec![1e-3, 1e-4];
    }
    let body = RigidBody::three_noises([2.0, 1.0, 2.0 / 3.0], [1.0, 2.0, 3.0])?;
    let problem =
        Problem::new(body, Cosine::new(0.5, 2.0)?, [1.1f64.cos(), 0.0, 1.1f64.sin()], 1.0)?;
    let cos_y3 = Observable { name: "cos y3", function: |y: [f64; 3]| y[2].cos() };
    for accuracy in accuracies {
        for (name, expect) in
            [("by parts", Expect::by_parts(&problem)), ("in general", Expect::new(&problem))]
        {
            let start = Instant::now();
            let found = expect.run(&[&cos_y3], accuracy)?;
            let (seconds, estimate) = (start.elapsed().as_secs_f64(), &found.estimates[0]);
            println!(
                "{name}, {accuracy:.0e}: {} path-steps, {seconds:.2} s, {} ± {:e}, off by {:+.1e}",
                found.cost,
                estimate.value,
                estimate.half_width(),
                estimate.value - EXACT
            );
        }
    }
    Ok(())
}
