//! A damped open Toda lattice of two particles in a harmonic trap, pushed by a common fluctuating
//! force: one noise. Written from `docs/guide.md` alone, in an empty folder.
//!
//! ```text
//! cargo run -p casimir-poisson --example toda
//! ```

use casimir::prelude::*;

/// Two particles on a line, y = (q₁, q₂, p₁, p₂), with a Toda bond e^(q₁−q₂), each in a unit trap.
struct Toda {
    noise: f64,
}

impl PoissonSystem<4, 1> for Toda {
    fn name(&self) -> &'static str {
        "toda-2"
    }

    /// Canonical: q̇ = ∂H/∂p, ṗ = −∂H/∂q.
    #[inline(always)]
    fn structure<R: Real>(&self, _y: [R; 4], v: [R; 4]) -> [R; 4] {
        [v[2], v[3], -v[0], -v[1]]
    }

    /// H₀ = ½(p₁² + p₂²) + e^(q₁−q₂) + ½(q₁² + q₂²), H₁ = σ(q₁ + q₂).
    #[inline(always)]
    fn energy<R: Real>(&self, y: [R; 4], dt: f64, dw: [f64; 1]) -> R {
        let kinetic = (y[2] * y[2] + y[3] * y[3]) * 0.5;
        let trap = (y[0] * y[0] + y[1] * y[1]) * 0.5;
        let bond = (y[0] - y[1]).exp();
        (kinetic + trap + bond) * dt + (y[0] + y[1]) * (self.noise * dw[0])
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let problem =
        Problem::new(Toda { noise: 0.3 }, Constant::new(0.2)?, [0.5, -0.5, 0.0, 0.5], 8.0)?;
    println!("{}\n", inspect_problem(&problem)?);

    let sexp = Sexp;
    let truncation = Truncation::new(4)?;
    let path = Simulation::new(Setup::of(&problem, &sexp), truncation)
        .every(32)
        .observing(StateFunction::new("energy", |y| problem.system().energy(y, 1.0, [0.0])))
        .path(256, StreamKey { seed: 1, experiment: 0 }, 0)?;
    write_csv(&[path], &mut std::io::stdout())?;

    let key = StreamKey { seed: 1, experiment: 1 };
    let sizes = StepSizes { samples: 200, ..StepSizes::new(256, truncation, key) };
    println!(
        "strong {}",
        strong_order(
            &Setup::of(&problem, &sexp),
            &sizes,
            &ReferenceSolution::independent(&problem)
        )?
    );
    Ok(())
}
