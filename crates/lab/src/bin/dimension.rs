//! Time against dimension: the fixed point against Newton's method, on spin chains of up to a
//! hundred spins.
//!
//! `cargo xtask dimension` builds and runs this. For each dimension and each strength of the
//! coupling one implicit step of `sexp` is solved in three ways: by the fixed point on a block and
//! on one path, and by Newton's method on one path. Time is the best of many, per path.

use std::{
    hint::black_box,
    thread,
    time::{Duration, Instant},
};

use anyhow::{Context, Result, anyhow};
use clap::Parser;
use lab::command::table;
use noise::{BlockNoise, Noise};
use nonlin::{BlockStatus, Method, Outcome, Solver};
use real::{Block, Level, WIDTH};
use schemes::{Scheme, Sexp, Step, WithSolver};
use systems::{Constant, PoissonSystem, SpinChain};

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
/// For each number of the table.
const BUDGET: Duration = Duration::from_millis(300);
/// Bytes of stack, more than a step of 300 components needs.
const STACK: usize = 256 << 20;

/// Spins of length one, each turned against the one before.
fn spins<const D: usize>() -> [f64; D] {
    let mut y = [0.0; D];
    for (n, spin) in y.chunks_exact_mut(3).enumerate() {
        let angle = 0.7 * n as f64;
        spin.copy_from_slice(&[0.8 * angle.cos(), 0.8 * angle.sin(), 0.6]);
    }
    y
}

/// How fast the plain iteration contracts: the ratio of its changes number 9 and 8.
fn contraction<const D: usize>(system: &SpinChain<D>, start: [f64; D]) -> f64 {
    let (mut z, mut before, mut ratio) = (start, f64::NAN, f64::NAN);
    for _ in 0..9 {
        let field = system.averaged_field(start, z, TAU, INCREMENTS);
        let next: [f64; D] = std::array::from_fn(|i| start[i] + field[i]);
        let change: f64 = (0..D).map(|i| (next[i] - z[i]).abs()).sum();
        (z, ratio, before) = (next, change / before, change);
    }
    ratio
}

/// The best time of as many repetitions as fit into the budget, one at least, in seconds, and the
/// last result.
fn best<T>(budget: Duration, work: impl Fn() -> T) -> (f64, T) {
    let whole = Instant::now();
    let mut best = f64::INFINITY;
    loop {
        let start = Instant::now();
        let result = black_box(work());
        best = best.min(start.elapsed().as_secs_f64());
        if whole.elapsed() >= budget {
            return (best, result);
        }
    }
}

/// A time in microseconds, and how the solver ended.
fn cell(seconds: f64, outcome: Outcome) -> String {
    let end = match outcome {
        Outcome::Fast { iterations } => iterations.to_string(),
        Outcome::Robust { iterations, .. } => format!("rescued, {iterations}"),
        Outcome::Failed { .. } => "failed".into(),
    };
    format!("{:.3} ({end})", 1e6 * seconds)
}

/// A row of times for each exchange constant.
fn rows<const D: usize>(budget: Duration) -> Result<Vec<[String; 6]>> {
    let step = Step::new(&Constant::new(0.1)?, 0, TAU)?;
    let y = spins::<D>();
    let [fixed_point, newton] = [Method::FixedPoint, Method::Newton]
        .map(|method| WithSolver { formula: Sexp, solver: Solver::new(method) });
    let row = |exchange| {
        let system = SpinChain::<D>::new(exchange, 0.5, 0.8)?;
        let contraction = contraction(&system, y.map(|component| step.first_decay * component));
        eprintln!("D = {D}, exchange constant {exchange}: contraction {contraction:.3}");
        let noise = Noise::increments(INCREMENTS);
        let [(path, iterated), (newton, linearised)] = [&fixed_point, &newton]
            .map(|sexp| best(budget, || sexp.step(&system, &step, &noise, black_box(y))));
        // Where the paths of a block are rescued, one after the other, the time of one says it all.
        let block = if let Outcome::Fast { .. } = iterated.outcome {
            let noise = BlockNoise::increments(Block::splat(INCREMENTS));
            let (block, _) = best(budget, || {
                let (mut y, mut status) = (Block::splat(black_box(y)), BlockStatus::explicit());
                fixed_point.step_block(&system, &step, &noise, &mut y, &mut status);
                y
            });
            cell(block / WIDTH as f64, iterated.outcome)
        } else {
            "not measured".into()
        };
        let distances = (0..D).map(|i| (iterated.z[i] - linearised.z[i]).abs());
        Ok([
            D.to_string(),
            format!("{contraction:.3}"),
            block,
            cell(path, iterated.outcome),
            cell(newton, linearised.outcome),
            format!("{:.0e}", distances.fold(0.0, f64::max)),
        ])
    };
    EXCHANGES.into_iter().map(row).collect()
}

fn measure(budget: Duration) -> Result<()> {
    let mut measured = Vec::new();
    for rows in [rows::<6>, rows::<30>, rows::<90>, rows::<150>, rows::<300>] {
        measured.extend(rows(budget)?);
    }
    let header = [
        "D",
        "contraction",
        "fixed point, block (sweeps)",
        "fixed point, path (sweeps)",
        "Newton, path (iterations)",
        "distance",
    ];
    let level = Level::current().name();
    println!("µs for one step of one path, {level}, best of many:");
    println!("{}", table(header, 0, measured));
    Ok(())
}

fn main() -> Result<()> {
    let budget = if Arguments::parse().quick { Duration::ZERO } else { BUDGET };
    let thread = thread::Builder::new().stack_size(STACK).spawn(move || measure(budget));
    let measured = thread.context("cannot start a thread")?.join();
    measured.map_err(|_| anyhow!("the measurement panicked"))?
}
