//! A charged particle in a trap, across a magnetic field that is not uniform, in an electric field
//! that fluctuates: the program of `docs/guide.md`.

use casimir::prelude::*;

/// A charged particle in the plane, y = (x, y, u, v): a harmonic trap, a magnetic field b₀ + b₁x
/// across the plane, and an electric field along x that fluctuates.
#[derive(Clone)]
struct Particle {
    trap: f64,
    field: f64,
    gradient: f64,
    noise: f64,
}

impl PoissonSystem<4, 1> for Particle {
    fn name(&self) -> &'static str {
        "charged-particle"
    }

    /// ẋ = ∂H/∂u, ẏ = ∂H/∂v, u̇ = −∂H/∂x + b ∂H/∂v, v̇ = −∂H/∂y − b ∂H/∂u.
    #[inline(always)]
    fn structure<R: Real>(&self, y: [R; 4], v: [R; 4]) -> [R; 4] {
        let b = y[0] * self.gradient + self.field;
        [v[2], v[3], b * v[3] - v[0], -(b * v[2]) - v[1]]
    }

    /// H₀ = ½(u² + v²) + ½k(x² + y²), H₁ = −σx.
    #[inline(always)]
    fn energy<R: Real>(&self, y: [R; 4], dt: f64, dw: [f64; 1]) -> R {
        let kinetic = (y[2] * y[2] + y[3] * y[3]) * 0.5;
        let trap = (y[0] * y[0] + y[1] * y[1]) * (0.5 * self.trap);
        (kinetic + trap) * dt - y[0] * (self.noise * dw[0])
    }
}

type Error = Box<dyn std::error::Error>;

fn main() -> Result<(), Error> {
    let particle = Particle { trap: 1.0, field: 2.0, gradient: 0.5, noise: 0.4 };
    let problem = Problem::new(particle, Constant::new(0.2)?, [1.0, 0.0, 0.0, 0.5], 8.0)?;
    let system = Compiled::new(problem.system().clone(), problem.y0());
    println!("{}\n", inspect(&system, &InspectSettings::of(&problem))?);
    one_path(&problem)?;
    many_paths(&problem)?;
    order(&problem)
}

fn one_path(problem: &Problem<Particle, Constant, 4>) -> Result<(), Error> {
    let sexp = Sexp;
    let key = StreamKey { seed: 1, experiment: 0 };
    let path = Simulation::new(Setup::of(problem, &sexp), Truncation::new(4)?)
        .every(32)
        .observing(StateFunction::new("energy", |y| problem.system().energy(y, 1.0, [0.0])))
        .path(256, key, 0)?;
    write_csv(&[path], &mut std::io::stdout())?;
    Ok(())
}

fn many_paths(problem: &Problem<Particle, Constant, 4>) -> Result<(), Error> {
    let sexp = Sexp;
    let key = StreamKey { seed: 1, experiment: 0 };
    let paths = Simulation::new(Setup::of(problem, &sexp), Truncation::new(4)?)
        .every(64)
        .observing(StateFunction::new("energy", |y| problem.system().energy(y, 1.0, [0.0])))
        .paths(256, key, 0..400)?;
    // A path that fails ends early: each mean is of the paths that it has.
    let times = paths.iter().map(|path| path.times()).max_by_key(|times| times.len());
    for (row, t) in times.unwrap_or_default().iter().enumerate() {
        let values = paths.iter().filter_map(|path| path.column("energy")?.get(row));
        let values: Vec<f64> = values.copied().collect();
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        println!("t = {t}: mean energy {mean:.3} of {} paths", values.len());
    }
    let file = std::env::temp_dir().join("particle.json");
    std::fs::write(&file, serde_json::to_string(&paths)?)?;
    println!("all paths: {}", file.display());
    Ok(())
}

fn order(problem: &Problem<Particle, Constant, 4>) -> Result<(), Error> {
    let key = StreamKey { seed: 1, experiment: 1 };
    let sizes = StepSizes::new(512, Truncation::new(4)?, key);
    println!("strong {}", strong_order(&Setup::of(problem, &Sexp), &sizes)?);
    Ok(())
}
