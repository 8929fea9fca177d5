//! What a step of a spin lattice costs.
//!
//! `cargo run --release -p casimir-mc --example lattice_cost [LEVEL]` prints ns per spin and step of
//! cubic lattices with local noise, for several numbers of spins, schemes and threads: the least of
//! several runs. The last column is the time of one thread over that of two.

use std::{sync::Arc, time::Instant};

use mc::LargePath;
use noise::{StreamKey, Truncation};
use real::{Level, limit_to};
use schemes::{Heun, Sexp, SexpLi, Split, run_time::Scheme};
use systems::{
    Constant,
    run_time::{Couplings, Problem, Shape, SpinLattice},
};

const KEY: StreamKey = StreamKey { seed: 1, experiment: 1 };
const RUNS: usize = 5;
/// Spins times steps of a run.
const WORK: usize = 4_000_000;

fn cost(problem: &Problem, scheme: &dyn Scheme, spins: usize, threads: usize) -> f64 {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    pool.install(|| {
        let truncation = Truncation::new(4).unwrap();
        let mut path = LargePath::new(problem, scheme, 1000, truncation, KEY, 0).unwrap();
        let steps = (WORK / spins).max(2) as u64;
        path.advance(steps.min(20)).unwrap();
        let mut least = f64::INFINITY;
        for _ in 0..RUNS {
            let begin = Instant::now();
            path.advance(steps).unwrap();
            least = least.min(begin.elapsed().as_nanos() as f64 / (spins as f64 * steps as f64));
        }
        least
    })
}

fn main() {
    match std::env::args().nth(1).as_deref() {
        Some("baseline") => limit_to(Level::Baseline),
        Some("avx2") => limit_to(Level::Avx2),
        _ => {}
    }
    println!("{}: ns per spin and step with local noise", Level::current().name());
    println!(
        "{:>8} {:>8} {:>10} {:>10} {:>6}",
        "scheme", "spins", "1 thread", "2 threads", "ratio"
    );
    for side in [10, 22, 46, 100] {
        let spins = side * side * side;
        let couplings =
            Couplings { exchange: 1.0, noise: 0.1, local: true, ..Couplings::default() };
        let shape = Shape::periodic(&[side, side, side]).unwrap();
        let lattice = SpinLattice::one_path(shape, couplings).unwrap();
        let sexp_li = SexpLi::at_run_time(&lattice).unwrap();
        let y0 = [0.6, 0.0, 0.8].repeat(spins);
        let damping = Arc::new(Constant::new(0.0).unwrap());
        let problem = Problem::new(Arc::new(lattice), damping, y0, 10.0).unwrap();
        let schemes: [&dyn Scheme; 4] = [&sexp_li, &Heun, &Split, &Sexp];
        for scheme in schemes {
            let [one, two] = [1, 2].map(|threads| cost(&problem, scheme, spins, threads));
            let id = scheme.id();
            println!("{id:>8} {spins:>8} {one:>10.1} {two:>10.1} {:>6.2}", one / two);
        }
    }
}
