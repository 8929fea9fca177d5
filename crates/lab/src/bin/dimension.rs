//! Time against dimension: the fixed point against Newton's method, on spin chains of up to a
//! hundred spins.
//!
//! `cargo xtask dimension` builds and runs this. For each dimension and each strength of
//! the coupling one implicit step of `sexp` is solved in four ways: by the fixed point on one path
//! and on a block, by the Newton method of `nonlin`, and by a Newton method with the dense
//! elimination of the library faer. Time is the best of many, per path.

use std::hint::black_box;
use std::process::Command;
use std::thread;
use std::time::{Duration, Instant};

use anyhow::{Context, Result, anyhow, ensure};
use clap::Parser;
use faer::linalg::solvers::Solve;
use faer::{Mat, Par};
use noise::{BlockNoise, Noise};
use nonlin::{BlockStatus, Method, Outcome, Solution, Solver};
use real::{Block, Dual, Level, Real, WIDTH};
use report::Page;
use schemes::{Scheme, Sexp, Step};
use systems::{Constant, PoissonSystem, SpinChain};

/// Time against dimension.
#[derive(Parser)]
#[command(name = "cargo xtask dimension", version)]
struct Arguments {
    /// One repetition of each, to see that everything runs.
    #[arg(long)]
    quick: bool,
    /// Solve one step of dimension number D by way number WAY on a stack of so many kilobytes and
    /// say nothing; for measuring the stack.
    #[arg(long, hide = true, num_args = 3, value_names = ["D", "WAY", "KILOBYTES"])]
    probe: Option<Vec<usize>>,
}

/// How `sexp` solves a step.
#[derive(Clone, Copy)]
enum Way {
    Block,
    Path(Method),
}

const PATH: Way = Way::Path(Method::FixedPoint);
const NEWTON: Way = Way::Path(Method::Newton);
const WAYS: [Way; 3] = [Way::Block, PATH, NEWTON];

/// Step size 2⁻⁸, and increments of the size that they usually have.
const TAU: f64 = 1.0 / 256.0;
const INCREMENTS: [f64; 3] = [0.0625, -0.0625, 0.0625];
/// Exchange constants, from one that hardly contributes to ones with which the iteration hardly
/// contracts, or not at all.
const EXCHANGES: [f64; 5] = [1.0, 32.0, 64.0, 96.0, 128.0];

/// One equation z = ψ(z) of `sexp`.
struct Case<const D: usize> {
    system: SpinChain<D>,
    step: Step,
    y: [f64; D],
}

impl<const D: usize> Case<D> {
    fn new(exchange: f64) -> Result<Self> {
        let mut y = [0.0; D];
        for (n, spin) in y.chunks_exact_mut(3).enumerate() {
            let angle = 0.7 * n as f64;
            spin.copy_from_slice(&[0.8 * angle.cos(), 0.8 * angle.sin(), 0.6]);
        }
        let step = Step::new(&Constant::new(0.1)?, 0, TAU)?;
        Ok(Self { system: SpinChain::new(exchange, 0.5, 0.8)?, step, y })
    }

    fn start(&self) -> [f64; D] {
        self.y.map(|component| self.step.first_decay * component)
    }

    fn map<R: Real>(&self, start: [f64; D], z: [R; D]) -> [R; D] {
        let mut next = self.system.averaged_field(start.map(R::constant), z, TAU, INCREMENTS);
        for i in 0..D {
            next[i] = next[i] + start[i];
        }
        next
    }

    /// z − ψ(z) and I − ψ′(z), by D evaluations on dual numbers, as `nonlin` has it.
    fn linearised(
        &self,
        start: [f64; D],
        z: [f64; D],
        matrix: &mut Mat<f64>,
        defect: &mut Mat<f64>,
    ) {
        for j in 0..D {
            let mut seeded = z.map(Dual::fixed);
            seeded[j].derivative = 1.0;
            let column = self.map(start, seeded);
            for i in 0..D {
                matrix[(i, j)] = f64::from(i == j) - column[i].derivative;
                defect[(i, 0)] = z[i] - column[i].value;
            }
        }
    }

    /// Newton's method with faer's elimination, to the tolerance of `nonlin`: the iterations, or
    /// `None` after fifty.
    fn newton_by_library(
        &self,
        matrix: &mut Mat<f64>,
        defect: &mut Mat<f64>,
    ) -> (Option<u32>, [f64; D]) {
        let start = self.start();
        let mut z = start;
        for iteration in 1..=50 {
            self.linearised(start, z, matrix, defect);
            let change = matrix.partial_piv_lu().solve(&*defect);
            let (mut length, mut size) = (0.0, 0.0);
            for i in 0..D {
                z[i] -= change[(i, 0)];
                length += change[(i, 0)].abs();
                size += z[i].abs();
            }
            if length <= size / (1u64 << 32) as f64 {
                return (Some(iteration), z.map(|component| self.step.second_decay * component));
            }
        }
        (None, z)
    }

    /// The step by `sexp`; of a block its first path, and no outcome of its own.
    #[inline(never)]
    fn solve(&self, way: Way) -> Solution<D> {
        let (system, step, y) = (&self.system, &self.step, black_box(self.y));
        match way {
            Way::Path(method) => {
                let sexp = Sexp { solver: Solver::new(method) };
                sexp.step(system, step, &Noise::increments(INCREMENTS), y)
            }
            Way::Block => {
                let (mut y, mut status) = (Block::splat(y), BlockStatus::explicit());
                let noise = BlockNoise::increments(Block::splat(INCREMENTS));
                let sexp = Sexp { solver: Solver::new(Method::FixedPoint) };
                sexp.step_block(system, step, &noise, &mut y, &mut status);
                let outcome = Outcome::Fast { iterations: 0 };
                Solution { z: black_box(y).path(0), outcome }
            }
        }
    }

    /// How fast the plain iteration contracts: the ratio of its changes number 9 and 8.
    fn contraction(&self) -> f64 {
        let start = self.start();
        let (mut z, mut before, mut ratio) = (start, f64::NAN, f64::NAN);
        for _ in 0..9 {
            let next = self.map(start, z);
            let change: f64 = (0..D).map(|i| (next[i] - z[i]).abs()).sum();
            (z, ratio, before) = (next, change / before, change);
        }
        ratio
    }
}

/// The best time of as many repetitions as fit into the budget, one at least, in seconds, and the
/// last result.
fn best<T>(budget: Duration, mut work: impl FnMut() -> T) -> (f64, T) {
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

/// A time in microseconds, and how it ended.
fn cell(seconds: f64, end: &str) -> String {
    format!("{:.3} ({end})", 1e6 * seconds)
}

fn ended(outcome: Outcome) -> String {
    match outcome {
        Outcome::Fast { iterations } => format!("{iterations}"),
        Outcome::Robust { iterations, .. } => format!("rescued, {iterations}"),
        Outcome::Failed { .. } => "failed".to_owned(),
    }
}

/// Beyond this contraction a block is not measured: from about 0.8 on its paths are rescued, one
/// after the other, which the column of the single path shows.
const CONTRACTS: f64 = 0.75;

fn rows<const D: usize>(rows: &mut Vec<[String; 8]>, budget: Duration) -> Result<()> {
    for exchange in EXCHANGES {
        let case = Case::<D>::new(exchange)?;
        let (mut matrix, mut defect) = (Mat::zeros(D, D), Mat::zeros(D, 1));
        let contraction = case.contraction();
        eprintln!("D = {D}, exchange constant {exchange}: contraction {contraction:.3}");
        let (library, (iterations, solution)) =
            best(budget, || case.newton_by_library(&mut matrix, &mut defect));
        let (assembly, ()) =
            best(budget, || case.linearised(case.start(), case.y, &mut matrix, &mut defect));
        let (newton, own) = best(budget, || case.solve(NEWTON));
        let (path, fixed) = best(budget, || case.solve(PATH));
        let block = if contraction < CONTRACTS {
            let (block, _) = best(budget, || case.solve(Way::Block));
            cell(block / WIDTH as f64, &ended(fixed.outcome))
        } else {
            "not measured".to_owned()
        };
        let distance = (0..D).map(|i| (fixed.z[i] - solution[i]).abs()).fold(0.0, f64::max);
        rows.push([
            D.to_string(),
            format!("{contraction:.3}"),
            block,
            cell(path, &ended(fixed.outcome)),
            cell(newton, &ended(own.outcome)),
            cell(library, &iterations.map_or_else(|| "none".to_owned(), |n| n.to_string())),
            format!("{:.3}", 1e6 * assembly),
            format!("{distance:.0e}"),
        ]);
    }
    Ok(())
}

/// One step in D dimensions.
fn solve_once<const D: usize>(way: Way) -> Result<()> {
    black_box(Case::<D>::new(1.0)?.solve(way));
    Ok(())
}

/// A dimension that is measured: its row of times, and a step in it.
struct Dimension {
    number: usize,
    rows: fn(&mut Vec<[String; 8]>, Duration) -> Result<()>,
    solve_once: fn(Way) -> Result<()>,
}

const fn dimension<const D: usize>() -> Dimension {
    Dimension { number: D, rows: rows::<D>, solve_once: solve_once::<D> }
}

const DIMENSIONS: [Dimension; 5] = [
    dimension::<6>(),
    dimension::<30>(),
    dimension::<90>(),
    dimension::<150>(),
    dimension::<300>(),
];

/// Does the work on a thread with a stack of so many kilobytes.
fn on_stack(kilobytes: usize, work: impl FnOnce() -> Result<()> + Send + 'static) -> Result<()> {
    let thread = thread::Builder::new().stack_size(kilobytes << 10).spawn(work);
    let done = thread.context("cannot start a thread")?.join();
    done.map_err(|_| anyhow!("the measurement panicked"))?
}

/// The least stack in kilobytes on which a step succeeds, to a sixteenth. A stack that overflows
/// ends the process, hence one for each attempt.
fn least_stack(dimension: usize, way: usize) -> Result<usize> {
    let program = std::env::current_exe().context("this program has no path")?;
    let succeeds = |kilobytes: usize| -> Result<bool> {
        let numbers = [dimension, way, kilobytes].map(|number| number.to_string());
        let output = Command::new(&program).arg("--probe").args(numbers).output();
        Ok(output.context("cannot run this program again")?.status.success())
    };
    let mut above = 16;
    while !succeeds(above)? {
        above *= 2;
        ensure!(above <= 1 << 20, "no stack of a gigabyte is enough");
    }
    let mut below = above / 2;
    while above - below > (above / 16).max(1) {
        let middle = below.midpoint(above);
        if succeeds(middle)? { above = middle } else { below = middle }
    }
    Ok(above)
}

/// For each number of the table.
const BUDGET: Duration = Duration::from_millis(300);

/// Kilobytes of the stack on which the times are measured, more than the largest case needs.
const STACK: usize = 256 << 10;

fn times(budget: Duration) -> Result<()> {
    faer::set_global_parallelism(Par::Seq);
    let mut rows = Vec::new();
    for dimension in &DIMENSIONS {
        (dimension.rows)(&mut rows, budget)?;
    }
    let mut page = Page::new("Time against dimension");
    page.paragraph(format!(
        "µs for one step of one path, {}, best of many.",
        Level::current().name()
    ));
    let head = [
        "D",
        "contraction",
        "fixed point, block (sweeps)",
        "fixed point, path (sweeps)",
        "own Newton, path (iterations)",
        "faer Newton, path (iterations)",
        "of which one Jacobian",
        "distance",
    ];
    page.table(head, rows);
    println!("{}", page.text());
    Ok(())
}

fn main() -> Result<()> {
    let arguments = Arguments::parse();
    if let Some([dimension, way, kilobytes]) = arguments.probe.as_deref() {
        let dimension = DIMENSIONS.get(*dimension).context("no such dimension")?;
        let way = *WAYS.get(*way).context("no such way")?;
        return on_stack(*kilobytes, move || (dimension.solve_once)(way));
    }
    let budget = if arguments.quick { Duration::ZERO } else { BUDGET };
    on_stack(STACK, move || times(budget))?;
    let mut stacks = Vec::new();
    for (n, dimension) in DIMENSIONS.iter().enumerate() {
        let mut row = vec![dimension.number.to_string()];
        for way in 0..WAYS.len() {
            row.push(least_stack(n, way)?.to_string());
        }
        stacks.push(row);
    }
    let mut page = Page::new("Stack in kB that one step needs at least, to a sixteenth");
    page.table(["D", "block-fixed-point", "path-fixed-point", "path-newton"], stacks);
    println!("{}", page.text());
    Ok(())
}
