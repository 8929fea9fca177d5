//! What a step of a spin lattice costs.
//!
//! `cargo run --release -p casimir-lattice --features measuring --example lattice_cost [LEVEL]` prints
//! ns per spin and step of cubic lattices with local noise, for several numbers of spins, schemes
//! and threads: the least of the runs of some seconds. The last column is the time of one thread
//! over that of two. Then follow steps of `sexp` on a chain of 100 spins, the larger ones without
//! contraction.

use std::{sync::Arc, time::Instant};

use lattice::LargePath;
use noise::{StreamKey, Truncation};
use nonlin::BlockStatus;
use real::{Rows, Simd, limit_to};
use schemes::{Heun, Sexp, SexpLi, Split, Step, run_time::Scheme};
use systems::{
    Constant,
    lattice::{Couplings, Shape, SpinLattice},
    run_time::Problem,
};

const KEY: StreamKey = StreamKey { seed: 1, experiment: 1 };
const SECONDS: f64 = 5.0;
/// Spins times steps of a run.
const WORK: usize = 4_000_000;

/// The least cost on one thread and on two, in runs that take turns.
fn costs(problem: &Problem, scheme: &dyn Scheme, spins: usize) -> [f64; 2] {
    let steps = (WORK / spins).max(2) as u64;
    let mut paths = [1, 2].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let truncation = Truncation::new(4).unwrap();
        let path = LargePath::new(problem, scheme, 1000, truncation, KEY, 0).unwrap();
        (pool, path)
    });
    let (mut least, start) = ([f64::INFINITY; 2], Instant::now());
    while start.elapsed().as_secs_f64() < SECONDS {
        for ((pool, path), least) in paths.iter_mut().zip(&mut least) {
            let begin = Instant::now();
            pool.install(|| path.advance(steps).unwrap());
            let ns = begin.elapsed().as_nanos() as f64;
            *least = least.min(ns / (spins as f64 * steps as f64));
        }
    }
    least
}

fn main() {
    match std::env::args().nth(1).as_deref() {
        Some("baseline") => limit_to(Simd::Baseline),
        Some("avx2") => limit_to(Simd::Avx2),
        _ => {}
    }
    println!("{}: ns per spin and step with local noise", Simd::current().name());
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
            let [one, two] = costs(&problem, scheme, spins);
            let id = scheme.about().id;
            println!("{id:>8} {spins:>8} {one:>10.1} {two:>10.1} {:>6.2}", one / two);
        }
    }
    implicit();
}

/// One step of `sexp` on 32 paths of a chain.
fn implicit() {
    println!("\nsexp on 32 paths of a chain of 100 spins");
    let couplings =
        Couplings { exchange: 1.0, anisotropy: 0.5, noise: 0.8, ..Couplings::default() };
    let chain = SpinLattice::on_paths(Shape::open(&[100]).unwrap(), couplings).unwrap();
    let damping = Constant::new(0.0).unwrap();
    let mut paths = Sexp.stepper(&chain).unwrap();
    for tau in [0.05, 0.2, 0.3, 0.4, 0.45, 0.5, 0.7] {
        let step = Step::new(&damping, 0, tau).unwrap();
        let noise = Rows::splat(&[0.1, -0.2, 0.3]).into();
        let (mut least, mut status) = (f64::INFINITY, BlockStatus::explicit());
        for _ in 0..5 {
            for (component, row) in paths.state_mut().iter_mut().enumerate() {
                let angle = 0.37 * (component / 3) as f64;
                *row = [[angle.sin(), 0.6 * angle.cos(), 0.8 * angle.cos()][component % 3]; 32];
            }
            let begin = Instant::now();
            paths.step(&step, &noise, &mut status);
            least = least.min(begin.elapsed().as_secs_f64());
        }
        let way =
            if status.robust.is_empty() { "sweeps of three evaluations" } else { "Newton steps" };
        println!("step {tau:.2}: {:7.3} ms, {} {way}", 1e3 * least, status.iterations(0));
    }
}
