//! What a step of one large path costs: `sexp-li` and `heun` on a cubic lattice of spins with local
//! noise, which is drawn.
//!
//! Printed are ns per spin and step for 10³ to 10⁶ spins on one thread and on two, the least of
//! some runs, and the bytes per spin that the process holds. An argument that is a number limits
//! the spins.

use std::time::{Duration, Instant};

use noise::{SiteNoise, SiteTiles, StreamKey};
use nonlin::BlockStatus;
use real::Rows;
use schemes::{Heun, SexpLi, Step, run_time::Scheme};
use systems::{
    Constant,
    run_time::{Couplings, Shape, SpinLattice, System},
};

const KEY: StreamKey = StreamKey { seed: 1, experiment: 1 };
const RUNS: usize = 5;
const TAU: f64 = 0.01;
/// Spin steps of a run.
const SPIN_STEPS: usize = 8_000_000;

/// Increments of all sites, halves in parallel.
fn draw(tiles: SiteTiles<'_>) {
    if tiles.count() < 2 {
        return tiles.fill(TAU.sqrt());
    }
    let (first, second) = tiles.halves();
    rayon::join(|| draw(first), || draw(second));
}

/// ns per spin and step: of all, and of the noise alone.
fn measure(scheme: &dyn Scheme, edge: usize) -> (f64, f64) {
    let k =
        Couplings { exchange: 1.0, noise: 0.1, local: true, damping: 0.1, ..Default::default() };
    let shape = Shape::periodic(&[edge; 3]).expect("a shape");
    let lattice = SpinLattice::one_path(shape, k).expect("memory");
    let sites = lattice.dimension() / 3;
    let mut path = scheme.stepper(&lattice).expect("memory");
    for site in 0..sites {
        let (row, lane) = lattice.place(3 * site + site % 3);
        path.state_mut()[row][lane] = 1.0;
    }
    let mut noise =
        SiteNoise::new(KEY, 0, lattice.noise_rows(), lattice.tile_rows()).expect("memory");
    let mut dw = Rows::zero(lattice.noise_rows()).expect("memory");
    let step = Step::new(&Constant::new(0.0).expect("finite"), 0, TAU).expect("0 < τ");
    let mut status = BlockStatus::explicit();
    let steps = (SPIN_STEPS / sites).max(2);
    let (mut least, mut least_noise) = (Duration::MAX, Duration::MAX);
    for _ in 0..RUNS {
        let (start, mut drawing) = (Instant::now(), Duration::ZERO);
        for _ in 0..steps {
            let begin = Instant::now();
            draw(noise.tiles(&mut dw));
            drawing += begin.elapsed();
            path.step(&step, &dw, &mut status);
        }
        least = least.min(start.elapsed());
        least_noise = least_noise.min(drawing);
    }
    assert!(lattice.length_defect(path.state(), 1.0) < 1e-2 || scheme.id() == "heun");
    let each = |time: Duration| time.as_secs_f64() * 1e9 / (steps * sites) as f64;
    (each(least), each(least_noise))
}

/// Memory of the process in bytes; zero where it is not known.
fn resident() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find(|line| line.starts_with("VmHWM"));
    let kib = line.and_then(|line| line.split_whitespace().nth(1)?.parse::<f64>().ok());
    kib.unwrap_or(0.0) * 1024.0
}

fn main() {
    let most = std::env::args().filter_map(|argument| argument.parse().ok()).next();
    let edges =
        [10usize, 22, 46, 100].into_iter().filter(|e| e.pow(3) <= most.unwrap_or(usize::MAX));
    println!("ns per spin and step: all (noise alone)\n");
    println!("scheme   threads     spins       all     noise   bytes per spin");
    for edge in edges {
        let sites = edge.pow(3);
        for (id, threads) in [("sexp-li", 1), ("sexp-li", 2), ("heun", 1)] {
            let pool =
                rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
            let before = resident();
            let (all, noise) = pool.install(|| match id {
                "heun" => measure(&Heun, edge),
                _ => {
                    let k = Couplings { local: true, noise: 1.0, ..Default::default() };
                    let one = SpinLattice::on_paths(Shape::open(&[1]).expect("a shape"), k);
                    let scheme = SexpLi::at_run_time(&one.expect("finite")).expect("affine");
                    measure(&scheme, edge)
                }
            });
            let bytes = (resident() - before) / sites as f64;
            println!("{id:8} {threads:7} {sites:9} {all:9.2} {noise:9.2} {bytes:16.0}");
        }
    }
}
