//! The same noise for two programs: increments as a table, and the path that they drive.
//!
//! ```text
//! cargo run -p casimir-poisson --example recorded_noise -- [increments.csv [path.csv]]
//! ```
//!
//! Reads the table if it is there, else draws one and writes it; then follows the rigid body along
//! it with three schemes and writes the states beside one another. Any other code that reads the
//! increments can be compared path by path.

use std::path::PathBuf;

use casimir::mc::{Recording, Setup, Simulation};
use casimir::prelude::*;
use casimir::schemes::{EulerMaruyama, Midpoint};
use casimir::systems::{Cosine, RigidBody};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1).map(PathBuf::from);
    let increments =
        arguments.next().unwrap_or_else(|| std::env::temp_dir().join("increments.csv"));
    let states = arguments.next().unwrap_or_else(|| std::env::temp_dir().join("path.csv"));
    if !increments.exists() {
        let drawn = Recording::<3>::draw(StreamKey { seed: 1, experiment: 0 }, 0, 512, 1.0, false)?;
        std::fs::write(&increments, drawn.to_string())?;
    }
    let name = increments.display();
    let recording: Recording<3> = std::fs::read_to_string(&increments)?
        .parse()
        .map_err(|error| format!("{name}: {error}"))?;
    println!("{name}: {} steps of {}", recording.increments().len(), recording.tau());

    let body = RigidBody::three_noises([2.0, 1.0, 2.0 / 3.0], [1.0, 2.0, 3.0])?;
    let t_end = recording.tau() * recording.increments().len() as f64;
    let problem = Problem::new(body, Cosine::new(0.5, 2.0)?, [0.45, 0.0, 0.89], t_end)?;
    let (sexp, midpoint) = (Sexp, Midpoint);
    let mut paths = Vec::new();
    for scheme in [&sexp as &dyn Scheme<RigidBody<3>, 3, 3>, &midpoint, &EulerMaruyama] {
        let path = Simulation::new(Setup::of(&problem, scheme), Truncation::none())
            .recorded(&recording)?;
        let end: Vec<f64> =
            path.columns[1..4].iter().filter_map(|column| column.values.last().copied()).collect();
        let defect =
            path.column("C defect").and_then(|defects| defects.last().copied()).unwrap_or(f64::NAN);
        println!("{:9} y(T) = {end:.6?}, conformal defect of C {defect:+.1e}", scheme.id());
        paths.push(path);
    }
    write_csv(&paths, &mut std::io::BufWriter::new(std::fs::File::create(&states)?))?;
    println!("states: {}", states.display());
    Ok(())
}
