//! A star in the damped Hénon–Heiles potential, shaken in stiffness and in the strength of its
//! cubic part: two noises. Written from `docs/guide.md` alone, in an empty folder.
//!
//! ```text
//! cargo run -p casimir-poisson --example henon_heiles
//! ```

use casimir::dgrad::averaged;
use casimir::prelude::*;
use casimir::systems::{DampingFunction, HamiltonianIncrement};

/// y = (q₁, q₂, p₁, p₂), B = J canonical.
struct HenonHeiles {
    stiffness_noise: f64,
    cubic_noise: f64,
}

impl PoissonSystem<4, 2> for HenonHeiles {
    fn name(&self) -> &'static str {
        "henon-heiles"
    }

    #[inline(always)]
    fn structure<R: Real>(&self, _y: [R; 4], v: [R; 4]) -> [R; 4] {
        [v[2], v[3], -v[0], -v[1]]
    }

    /// H₀ = ½|p|² + ½|q|² + q₁²q₂ − q₂³/3, H₁ = ½σ|q|², H₂ = ρ(q₁²q₂ − q₂³/3).
    #[inline(always)]
    fn energy<R: Real>(&self, y: [R; 4], dt: f64, dw: [f64; 2]) -> R {
        let kinetic = (y[2] * y[2] + y[3] * y[3]) * 0.5;
        let harmonic = (y[0] * y[0] + y[1] * y[1]) * 0.5;
        let cubic = y[0] * y[0] * y[1] - y[1].powi(3) / 3.0;
        kinetic * dt
            + harmonic * (dt + self.stiffness_noise * dw[0])
            + cubic * (dt + self.cubic_noise * dw[1])
    }

    /// A cubic energy: two nodes are exact.
    #[inline(always)]
    fn averaged_gradient<R: Real>(&self, a: [R; 4], b: [R; 4], dt: f64, dw: [f64; 2]) -> [R; 4] {
        averaged::<2, _, _, 4>(&HamiltonianIncrement { system: self, dt, dw }, a, b)
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let star = HenonHeiles { stiffness_noise: 0.2, cubic_noise: 0.3 };
    // The friction of a gas that thins out.
    let friction = DampingFunction::new(|t| 0.3 / (1.0 + t), 8)?;
    let problem = Problem::new(star, friction, [0.0, 0.1, 0.35, 0.1], 16.0)?;
    println!("{}\n", inspect_problem(&problem)?);

    // The noises commute, as the report says: no Lévy areas are needed for strong order 1.
    let sexp = Sexp;
    let key = StreamKey { seed: 1, experiment: 0 };
    let truncation = Truncation::new(4)?;
    let path = Simulation::new(Setup::of(&problem, &sexp), truncation)
        .every(64)
        .observing(StateFunction::new("energy", |y| problem.system().energy(y, 1.0, [0.0; 2])))
        .path(512, key, 0)?;
    write_csv(&[path], &mut std::io::stdout())?;

    let sizes = StepSizes { samples: 128, ..StepSizes::new(512, truncation, key) };
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
