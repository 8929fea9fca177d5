//! A path of a million spins that goes on from its checkpoint.
//!
//! `cargo run --release -p casimir-lattice --features measuring --example restart STEPS [FILE]` prints
//! the seconds and a hash of the state at the end. Kill it, and start it again: with a file it goes
//! on from there, and the hash is the same.

use std::{sync::Arc, time::Instant};

use lattice::LargePath;
use mc::{
    Checkpoint,
    parts::{Program, hash},
};
use noise::{StreamKey, Truncation};
use schemes::SexpLi;
use systems::{
    Constant,
    lattice::{Couplings, Shape, SpinLattice},
    run_time::Problem,
};

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    let steps = arguments[1].parse().unwrap();
    let couplings = Couplings { exchange: 1.0, noise: 0.1, local: true, ..Couplings::default() };
    let shape = Shape::periodic(&[100, 100, 100]).unwrap();
    let lattice = SpinLattice::one_path(shape, couplings).unwrap();
    let scheme = SexpLi::at_run_time(&lattice).unwrap();
    let (damping, y0) = (Arc::new(Constant::new(0.0).unwrap()), [0.6, 0.0, 0.8].repeat(1_000_000));
    let problem = Problem::new(Arc::new(lattice), damping, y0, 0.01 * steps as f64).unwrap();
    let (key, truncation) = (StreamKey { seed: 1, experiment: 1 }, Truncation::new(4).unwrap());
    let program = Program { input: format!("{steps} steps"), ..Program::default() };
    let checkpoint = arguments.get(2).map(|file| Checkpoint::new(file, program));
    let mut path = LargePath::new(&problem, &scheme, steps, truncation, key, 0).unwrap();
    if let Some(checkpoint) = &checkpoint {
        path = path.keeping(checkpoint).unwrap();
        eprintln!("from step {}", path.steps_done());
    }
    let begin = Instant::now();
    path.advance(steps - path.steps_done()).unwrap();
    let spins: Vec<f64> = path.state().as_flattened().to_vec();
    println!("{:.2} s, {}", begin.elapsed().as_secs_f64(), hash(&spins));
}
