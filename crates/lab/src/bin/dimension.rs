//! Time against dimension: the fixed point against Newton's method without a matrix, on chains of
//! up to ten thousand spins.
//!
//! `cargo xtask dimension` builds and runs this. For each dimension and each strength of the
//! coupling one implicit step of `sexp` is solved by the fixed point, on 32 paths and on one, and
//! by Newton's method on one path. Time is the best of many, per path.

use std::time::{Duration, Instant};

use anyhow::Result;
use clap::Parser;
use lab::command::table;
use nonlin::{BlockStatus, Method, Solver};
use rayon::ThreadPoolBuilder;
use real::{Level, Row, Rows, WIDTH};
use schemes::{
    Sexp, Step, WithSolver,
    run_time::{Scheme, Stepper},
};
use systems::{
    Constant,
    run_time::{Couplings, Lanes, Shape, SpinLattice, System, Weights},
};

/// Time against dimension.
#[derive(Parser)]
#[command(name = "cargo xtask dimension", version)]
struct Arguments {
    /// One repetition of each, to see that everything runs.
    #[arg(long)]
    quick: bool,
}

/// Step size 2⁻⁸, and increments of the size that they usually have.
const TAU: f64 = 1.0 / 256.0;
const INCREMENTS: [f64; 3] = [0.0625, -0.0625, 0.0625];
/// Exchange constants, from one that hardly contributes to ones with which the iteration hardly
/// contracts, or not at all.
const EXCHANGES: [f64; 5] = [1.0, 32.0, 64.0, 96.0, 128.0];
const SPINS: [usize; 5] = [2, 10, 100, 1000, 10_000];
/// For each number of the table.
const BUDGET: Duration = Duration::from_millis(300);

/// Spins of length one, each turned against the one before.
fn set(system: &SpinLattice, state: &mut [Row]) {
    for component in 0..system.dimension() {
        let angle = 0.7 * (component / 3) as f64;
        let value = [0.8 * angle.cos(), 0.8 * angle.sin(), 0.6][component % 3];
        let (row, place) = system.place(component);
        match system.lanes() {
            Lanes::Paths => state[row] = [value; WIDTH],
            Lanes::Components => state[row][place] = value,
        }
    }
}

/// How fast the plain iteration contracts: the ratio of its changes number 9 and 8.
fn contraction(system: &SpinLattice, decay: f64, h: Weights<'_>) -> Result<f64> {
    let rows = || Rows::zero(system.rows());
    let (mut start, mut z, mut field) = (rows()?, rows()?, rows()?);
    let mut scratch = Rows::zero(system.scratch_rows())?;
    set(system, &mut start);
    start.iter_mut().flatten().for_each(|y| *y *= decay);
    z.copy_from_slice(&start);
    let (mut before, mut ratio) = (f64::NAN, f64::NAN);
    for _ in 0..9 {
        system.averaged_field(&start, &z, h, &mut field, &mut scratch);
        let mut change = 0.0;
        for ((z, start), field) in z.iter_mut().zip(start.iter()).zip(field.iter()) {
            change += (start[0] + field[0] - z[0]).abs();
            *z = std::array::from_fn(|p| start[p] + field[p]);
        }
        (ratio, before) = (change / before, change);
    }
    Ok(ratio)
}

/// The best time of as many steps as fit into the budget, one at least, in seconds, and the status
/// of the last.
fn best(
    budget: Duration,
    path: &mut dyn Stepper,
    system: &SpinLattice,
    (step, dw): (&Step, &Rows),
) -> (f64, BlockStatus) {
    let (whole, mut best, mut status) = (Instant::now(), f64::INFINITY, BlockStatus::explicit());
    loop {
        set(system, path.state_mut());
        let start = Instant::now();
        path.step(step, dw, &mut status);
        best = best.min(start.elapsed().as_secs_f64());
        if whole.elapsed() >= budget {
            return (best, status);
        }
    }
}

/// A time in microseconds, and how the solver ended.
fn cell(seconds: f64, status: &BlockStatus) -> String {
    let iterations = status.iterations(0);
    let end = match (status.failed.is_empty(), status.robust.is_empty()) {
        (false, _) => "failed".into(),
        (true, true) => iterations.to_string(),
        (true, false) => format!("Newton, {iterations}"),
    };
    format!("{:.3} ({end})", 1e6 * seconds)
}

/// A row of the table.
fn row(spins: usize, exchange: f64, budget: Duration) -> Result<[String; 6]> {
    let step = Step::new(&Constant::new(0.1)?, 0, TAU)?;
    let dw = Rows::splat(&INCREMENTS)?;
    let couplings = Couplings { exchange, anisotropy: 0.5, noise: 0.8, ..Couplings::default() };
    let shape = Shape::open(&[spins])?;
    let many = SpinLattice::on_paths(shape.clone(), couplings)?;
    let one = SpinLattice::one_path(shape, couplings)?;
    let contraction = contraction(&many, step.first_decay, Weights { dt: TAU, dw: &dw })?;
    eprintln!("{spins} spins, exchange constant {exchange}: contraction {contraction:.3}");
    // A single sweep never suffices.
    let one_sweep = Solver { max_sweeps: 1, ..Solver::new(Method::FixedPoint) };
    let newton = WithSolver { formula: Sexp, solver: one_sweep };
    let mut block = Sexp.stepper(&many)?;
    let (of_block, status) = best(budget, block.as_mut(), &many, (&step, &dw));
    let block = cell(of_block / WIDTH as f64, &status);
    let mut iterated = Sexp.stepper(&one)?;
    let (seconds, status) = best(budget, iterated.as_mut(), &one, (&step, &dw));
    let path = cell(seconds, &status);
    let mut linearised = newton.stepper(&one)?;
    let (seconds, status) = best(budget, linearised.as_mut(), &one, (&step, &dw));
    let newton = cell(seconds, &status);
    let numbers = iterated.state().iter().flatten().zip(linearised.state().iter().flatten());
    let distance = numbers.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    let distance = format!("{distance:.0e}");
    Ok([(3 * spins).to_string(), format!("{contraction:.3}"), block, path, newton, distance])
}

fn main() -> Result<()> {
    let budget = if Arguments::parse().quick { Duration::ZERO } else { BUDGET };
    let one = ThreadPoolBuilder::new().num_threads(1).build()?;
    let mut measured = Vec::new();
    for spins in SPINS {
        for exchange in EXCHANGES {
            measured.push(one.install(|| row(spins, exchange, budget))?);
        }
    }
    let header = [
        "D",
        "contraction",
        "fixed point, 32 paths (sweeps)",
        "fixed point, one path (sweeps)",
        "Newton, one path (iterations)",
        "distance",
    ];
    let level = Level::current().name();
    println!("µs for one step of one path, {level}, one thread, best of many:");
    println!("{}", table(header, 0, measured));
    Ok(())
}
