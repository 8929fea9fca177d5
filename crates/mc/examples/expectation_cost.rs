//! What E[cos y₃] of the rigid body with three noises costs, by multilevel Monte Carlo and by single paths.
//!
//! ```text
//! cargo run --release -p mc --example expectation_cost -- 1e-3 1e-4
//! ```
//!
//! prints path-steps and seconds for each half-width of the 95 % interval, bias included, and how far the estimate is from
//! the value of the Kolmogorov equation. Single paths are run as long as they take no more than `LIMIT` path-steps; beyond,
//! the cost is what they would take at their last measured ε³·cost, and is marked so.

use std::time::Instant;

use mc::Observable;
use mc::multilevel::{Coupling, Expectation, Settings, expectation, expectation_plain};
use noise::{StreamKey, Truncation};
use schemes::Sexp;
use systems::{Cosine, Problem, RigidBody};

/// E[cos y₃(1)] by spherical harmonics (`verify::rigid_body_expectations`).
const EXACT: f64 = 0.797_719_935_281_68;
const LIMIT: f64 = 2e9;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut accuracies: Vec<f64> = std::env::args().skip(1).map(|text| text.parse()).collect::<Result<_, _>>()?;
    if accuracies.is_empty() {
        accuracies = vec![1e-3, 1e-4];
    }
    accuracies.sort_by(|a, b| b.total_cmp(a));
    let body = RigidBody::three_noises([2.0, 1.0, 2.0 / 3.0], [1.0, 2.0, 3.0])?;
    let problem = Problem::new(body, Cosine::new(0.5, 2.0)?, [1.1f64.cos(), 0.0, 1.1f64.sin()], 1.0)?;
    let cos_y3 = [Observable { name: "cos y3", function: |y: [f64; 3]| y[2].cos() }];
    let key = StreamKey { seed: 1, experiment: 1 };
    let settings = Settings { max_cost: 1 << 40, ..Settings::new(key, Truncation::new(4)?, 2, Coupling::Antithetic) };
    let sexp = Sexp::default();
    // ε³·cost of single paths and seconds a path-step, as last measured.
    let mut last: Option<(f64, f64)> = None;
    for accuracy in accuracies {
        let start = Instant::now();
        let result = expectation(&sexp, &problem, &cos_y3, accuracy, &settings, &|_| ())?;
        print("multilevel  ", accuracy, &result, start);
        for level in &result.levels {
            let value = &level.values[0];
            println!(
                "    level {} τ = {:<8} {:>10} paths, mean {:+.2e}, variance {:.2e} = {:.2e} τ²",
                level.level,
                level.tau,
                level.samples,
                value.mean,
                value.variance,
                value.variance / (level.tau * level.tau)
            );
        }
        let expected = last.map(|(constant, rate)| (constant / accuracy.powi(3), rate));
        match expected {
            Some((cost, rate)) if cost > LIMIT => {
                println!("single paths  {accuracy:.0e}: about {cost:.1e} path-steps, {:.0} s (not run)", cost * rate);
            }
            _ => {
                let start = Instant::now();
                let result = expectation_plain(&sexp, &problem, &cos_y3, accuracy, &settings, &|_| ())?;
                let cost = result.cost as f64;
                last = Some((cost * accuracy.powi(3), start.elapsed().as_secs_f64() / cost));
                print("single paths", accuracy, &result, start);
            }
        }
    }
    Ok(())
}

fn print(method: &str, accuracy: f64, result: &Expectation, start: Instant) {
    let estimate = &result.estimates[0];
    println!(
        "{method}  {accuracy:.0e}: {:.3e} path-steps, {:.2} s, {:.6} ± {:.1e}, off by {:+.1e}; variance falls like τ^{}",
        result.cost as f64,
        start.elapsed().as_secs_f64(),
        estimate.value,
        estimate.half_width(),
        estimate.value - EXACT,
        estimate
            .beta
            .as_ref()
            .map_or("?".to_owned(), |beta| format!("{:.2} [{:.2}, {:.2}]", beta.value, beta.lower, beta.upper)),
    );
    for warning in &result.warnings {
        println!("    {warning}");
    }
}
