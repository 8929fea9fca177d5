//! What E[cos y₃] of the rigid body with three noises costs, by multilevel Monte Carlo and by
//! single paths.
//!
//! ```text
//! cargo run --release -p casimir-mc --example expectation_cost -- 1e-3 1e-4
//! cargo run --release -p casimir-mc --example expectation_cost -- 1e-3 1e-4 1e-5 --long
//! ```
//!
//! prints path-steps, seconds and seconds of processor time for each half-width of the 95 %
//! interval, bias included, and how far the estimate is from the value of the Kolmogorov equation.
//! Single paths are run as long as they take no more than `LIMIT` path-steps; beyond, and without
//! `--long`, the cost is what they would take at their last measured ε³·cost, and is marked so.

use std::time::Instant;

use mc::multilevel::{Coupling, Estimator, Expectation, ExpectationSettings, expectation};
use mc::{Observable, Setup};
use noise::{StreamKey, Truncation};
use rustix::time::{ClockId, clock_gettime};
use schemes::Sexp;
use systems::{Cosine, Problem, RigidBody};

/// E[cos y₃(1)] by spherical harmonics (`analysis::rigid_body_expectations`).
const EXACT: f64 = 0.797_719_935_281_68;
const LIMIT: f64 = 2e9;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (long, accuracies): (Vec<String>, Vec<String>) =
        std::env::args().skip(1).partition(|text| text == "--long");
    let limit = if long.is_empty() { LIMIT } else { f64::INFINITY };
    let mut accuracies: Vec<f64> =
        accuracies.iter().map(|text| text.parse()).collect::<Result<_, _>>()?;
    if accuracies.is_empty() {
        accuracies = vec![1e-3, 1e-4];
    }
    accuracies.sort_by(|a, b| b.total_cmp(a));
    let body = RigidBody::three_noises([2.0, 1.0, 2.0 / 3.0], [1.0, 2.0, 3.0])?;
    let problem =
        Problem::new(body, Cosine::new(0.5, 2.0)?, [1.1f64.cos(), 0.0, 1.1f64.sin()], 1.0)?;
    let cos_y3 = [Observable { name: "cos y3", function: |y: [f64; 3]| y[2].cos() }];
    let key = StreamKey { seed: 1, experiment: 1 };
    let settings = ExpectationSettings {
        max_cost: 1 << 40,
        ..ExpectationSettings::new(key, Truncation::new(4)?, 2, Coupling::Antithetic)
    };
    let sexp = Sexp;
    // ε³·cost of single paths and seconds a path-step, as last measured.
    let mut last: Option<(f64, f64)> = None;
    for accuracy in accuracies {
        let start = Clocks::now();
        let result =
            expectation(&Setup::of(&problem, &sexp), &cos_y3, accuracy, &settings, &|_| ())?;
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
            Some((cost, rate)) if cost > limit => {
                println!(
                    "single paths  {accuracy:.0e}: about {cost:.1e} path-steps, {:.0} s (not run)",
                    cost * rate
                );
            }
            _ => {
                let start = Clocks::now();
                let settings =
                    ExpectationSettings { estimator: Estimator::SinglePaths, ..settings };
                let result = expectation(
                    &Setup::of(&problem, &sexp),
                    &cos_y3,
                    accuracy,
                    &settings,
                    &|_| (),
                )?;
                let cost = result.cost as f64;
                last = Some((cost * accuracy.powi(3), start.wall.elapsed().as_secs_f64() / cost));
                print("single paths", accuracy, &result, start);
            }
        }
    }
    Ok(())
}

/// When something began, on the wall and for the processors.
struct Clocks {
    wall: Instant,
    processor: f64,
}

impl Clocks {
    fn now() -> Self {
        Self { wall: Instant::now(), processor: processor_seconds() }
    }
}

/// Seconds that the threads of this process have spent on the processors; what else the machine
/// does disturbs them less than the wall clock.
fn processor_seconds() -> f64 {
    let time = clock_gettime(ClockId::ProcessCPUTime);
    time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9
}

fn print(method: &str, accuracy: f64, result: &Expectation, start: Clocks) {
    let estimate = &result.estimates[0];
    println!(
        "{method}  {accuracy:.0e}: {:.3e} path-steps, {:.2} s, {:.2} s of processor time, \
         {:.6} ± {:.1e}, off by {:+.1e}; variance falls like τ^{}",
        result.cost as f64,
        start.wall.elapsed().as_secs_f64(),
        processor_seconds() - start.processor,
        estimate.value,
        estimate.half_width(),
        estimate.value - EXACT,
        estimate.beta.as_ref().map_or("?".to_owned(), |beta| format!(
            "{:.2} [{:.2}, {:.2}]",
            beta.value, beta.lower, beta.upper
        )),
    );
    for warning in &result.warnings {
        println!("    {warning}");
    }
}
