//! The three pictures of `docs/why.md`: a spin that leaves its sphere, a temperature that is wrong,
//! an order that is not there.
//!
//! ```text
//! cargo run --release -p casimir-poisson --features plot --example why -- FOLDER
//! ```

use casimir::mc::Friction;
use casimir::plot::figure::{Trace, convergence, lines};
use casimir::plot::{Kind, Series};
use casimir::prelude::*;
use casimir::systems::RigidBody;
use std::{fs::write, path::PathBuf, sync::Arc};

type Error = Box<dyn std::error::Error>;

/// A spin in a field along z that fluctuates in all directions: B(s)v = s × v.
#[derive(Clone)]
struct Spin {
    field: f64,
    sigma: f64,
}

impl PoissonSystem<3, 3> for Spin {
    fn name(&self) -> &'static str {
        "spin"
    }

    fn structure<R: Real>(&self, s: [R; 3], v: [R; 3]) -> [R; 3] {
        [s[1] * v[2] - s[2] * v[1], s[2] * v[0] - s[0] * v[2], s[0] * v[1] - s[1] * v[0]]
    }

    fn energy<R: Real>(&self, s: [R; 3], dt: f64, dw: [f64; 3]) -> R {
        let sigma = self.sigma;
        s[0] * (sigma * dw[0]) + s[1] * (sigma * dw[1]) + s[2] * (self.field * dt + sigma * dw[2])
    }
}

/// A harmonic oscillator (q, p) in a heat bath of kT = 1: friction g on p, and noise √(2g).
#[derive(Clone)]
struct Oscillator {
    friction: f64,
}

impl PoissonSystem<2, 1> for Oscillator {
    fn name(&self) -> &'static str {
        "oscillator"
    }

    fn structure<R: Real>(&self, _y: [R; 2], v: [R; 2]) -> [R; 2] {
        [v[1], -v[0]]
    }

    fn energy<R: Real>(&self, y: [R; 2], dt: f64, dw: [f64; 1]) -> R {
        let sigma = (2.0 * self.friction).sqrt();
        (y[0] * y[0] + y[1] * y[1]) * (0.5 * dt) - y[0] * (sigma * dw[0])
    }
}

/// |s| along one path, by Heun's method and by `sexp` on the same noise: τ = 0.1.
fn lengths() -> Result<String, Error> {
    let spin = Spin { field: 2.0, sigma: 0.5 };
    let problem = Problem::new(spin, Constant::new(0.0)?, [0.6, 0.0, 0.8], 50.0)?;
    let length = |s: [f64; 3]| s.iter().map(|x| x * x).sum::<f64>().sqrt();
    let traces = [("heun", Setup::of(&problem, &Heun)), ("sexp", Setup::of(&problem, &Sexp))].map(
        |(name, setup)| {
            let key = StreamKey { seed: 1, experiment: 0 };
            let path = Simulation::new(setup, Truncation::new(4)?)
                .observing(StateFunction::new("length", length))
                .path(500, key, 0)?;
            let length = path.column("length").ok_or("it is observed")?;
            println!("{name}: |s| = {} at the end", length[500]);
            let points = path.times().iter().copied().zip(length.iter().copied()).collect();
            Ok::<_, Error>(Trace { name: name.into(), points })
        },
    );
    let [heun, sexp] = traces;
    Ok(lines("The length of a spin", "time", "|s|", &[heun?, sexp?]))
}

/// ⟨p²⟩, which is kT = 1, against the step size.
fn temperatures() -> Result<String, Error> {
    const FRICTION: f64 = 0.02;
    let oscillator = Oscillator { friction: FRICTION };
    // Eight times as long as the friction takes.
    let until = 8.0 / FRICTION;
    let problem = Problem::new(oscillator, Constant::new(0.0)?, [1.0, 0.0], until)?;
    let friction = [Friction { damping: Arc::new(Constant::new(FRICTION)?), components: vec![1] }];
    let square = [Observable { name: "p^2", function: |y: [f64; 2]| y[1] * y[1] }];
    let mut traces = ["heun", "sexp"].map(|name| Trace { name: name.into(), points: Vec::new() });
    for steps in [1250, 1600, 2000, 2500, 3200, 6400] {
        let setups = [Setup::of(&problem, &Heun), Setup::of(&problem, &Sexp)];
        for (trace, setup) in traces.iter_mut().zip(setups) {
            let key = StreamKey { seed: 1, experiment: 1 };
            let settings = StudySettings::new(steps, 1, 10_000, Truncation::new(4)?, key);
            let study = Study::new(&setup.with_friction(&friction), &square, &settings)?.run();
            let end = study.series("p^2").ok_or("it is observed")?.last();
            let (mean, interval) = end.mean.zip(end.mean_interval).ok_or("no path is left")?;
            let tau = until / steps as f64;
            println!("{}: τ = {tau:.4}, ⟨p²⟩ = {mean:.3} in {interval:.3?}", trace.name);
            trace.points.push((tau, mean));
        }
    }
    Ok(lines("The temperature of an oscillator in a bath", "step τ", "⟨p²⟩ / kT", &traces))
}

/// Errors against the step size on a body whose three noises do not commute.
fn orders() -> Result<String, Error> {
    let body = RigidBody::three_noises([2.0, 1.0, 2.0 / 3.0], [1.0, 2.0, 3.0])?;
    let problem = Problem::new(body, Constant::new(0.5)?, [0.45, 0.0, 0.89], 1.0)?;
    let levy = SexpLevy::new(problem.system(), problem.y0());
    let setups =
        [Setup::of(&problem, &Heun), Setup::of(&problem, &Sexp), Setup::of(&problem, &levy)];
    let mut series = Vec::new();
    for (name, setup) in ["heun", "sexp", "sexp-levy"].into_iter().zip(setups) {
        let key = StreamKey { seed: 1, experiment: 2 };
        let order = strong_order(&setup, &StepSizes::new(32, Truncation::new(4)?, key))?;
        println!("{name}: {order}");
        series.push(Series {
            scheme: name.into(),
            quantity: "y(T)".into(),
            points: order.points,
            rate: order.rate,
            max_relative_defect: None,
        });
    }
    Ok(convergence("Errors of a rigid body with three noises", Kind::Strong, &series))
}

fn main() -> Result<(), Error> {
    let folder = std::env::args_os().nth(1).map_or(std::env::temp_dir(), PathBuf::from);
    write(folder.join("why-length.svg"), lengths()?)?;
    write(folder.join("why-temperature.svg"), temperatures()?)?;
    write(folder.join("why-order.svg"), orders()?)?;
    println!("three figures in {}", folder.display());
    Ok(())
}
