//! From two formulas to E[q(T)] with an interval, for Kubo's oscillator, of which the exact value is
//! known: e^(−(γ + ½σ²)T) cos T.

use casimir::{mc::expect, prelude::*};

struct Kubo;

impl PoissonSystem<2, 1> for Kubo {
    fn structure<R: Real>(&self, _: [R; 2], v: [R; 2]) -> [R; 2] {
        [v[1], -v[0]]
    }
    fn energy<R: Real>(&self, y: [R; 2], dt: f64, dw: [f64; 1]) -> R {
        (y[0] * y[0] + y[1] * y[1]) * (0.5 * (dt + 0.5 * dw[0]))
    }
    fn name(&self) -> &'static str {
        "kubo"
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let problem = Problem::new(Kubo, Constant::new(0.1)?, [1.0, 0.0], 2.0)?;
    let q = Observable { name: "q", function: |y: [f64; 2]| y[0] };
    let (from, to) = expect(&problem, &[q], 1e-5)?.estimates[0].interval();
    println!("E[q] is in [{from:.6}, {to:.6}], and is {:.6}", (-0.45f64).exp() * 2f64.cos());
    Ok(())
}
