//! What a step of one large path costs: `sexp-li` and `heun` on a cubic lattice of spins with local
//! noise, which is drawn.
//!
//! Printed are ns per spin and step for 10³ to 10⁶ spins, the least of some runs: processor time of
//! one thread, which others on the machine disturb least, the part of it that is the noise, and the
//! time that passes with one thread and with two. An argument that is a number limits the spins.
//! `crates/lab/peers/spin_lattice.py` measures the same with other programs.

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

/// ns per spin and step: of the processor, the part of it that is the noise, and that pass.
fn measure(scheme: &dyn Scheme, edge: usize) -> [f64; 3] {
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
    let mut least = [Duration::MAX; 3];
    for _ in 0..RUNS {
        let (start, begin, mut drawing) = (Instant::now(), processor(), Duration::ZERO);
        for _ in 0..steps {
            let begin = processor();
            draw(noise.tiles(&mut dw));
            drawing += processor() - begin;
            path.step(&step, &dw, &mut status);
        }
        let times = [processor() - begin, drawing, start.elapsed()];
        least = std::array::from_fn(|n| least[n].min(times[n]));
    }
    least.map(|time| time.as_secs_f64() * 1e9 / (steps * sites) as f64)
}

/// Processor time of this thread.
fn processor() -> Duration {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
    Duration::new(time.tv_sec as u64, time.tv_nsec as u32)
}

fn main() {
    let one = Shape::open(&[1]).and_then(|one| SpinLattice::on_paths(one, Couplings::default()));
    let sexp_li = SexpLi::at_run_time(&one.expect("a lattice")).expect("affine");
    let most = std::env::args().filter_map(|argument| argument.parse().ok()).next();
    let edges =
        [10usize, 22, 46, 100].into_iter().filter(|e| e.pow(3) <= most.unwrap_or(usize::MAX));
    println!("ns per spin and step\n");
    println!("scheme       spins  processor      noise  passing  passing, two threads");
    for edge in edges {
        let schemes: [&dyn Scheme; 2] = [&sexp_li, &Heun];
        for scheme in schemes {
            let [one, two] = [1, 2].map(|threads| {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
                pool.expect("threads").install(|| measure(scheme, edge))
            });
            let [processor, noise, passing] = one;
            println!(
                "{:8} {:9} {processor:10.2} {noise:10.2} {passing:8.2} {:21.2}",
                scheme.id(),
                edge.pow(3),
                two[2]
            );
        }
    }
}
