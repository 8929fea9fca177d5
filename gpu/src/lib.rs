//! **Paths on a graphics card, with the bits of the processor.**
//!
//! [`Gpu`] is a [`Device`]: a ladder, a study or an expectation whose problem has one advances
//! its paths there where it can. The steps of a scheme on a system of formulas are lists of
//! operations, [`Listing`](schemes::Listing)s. They become one kernel in PTX for the whole march of
//! a path: its noise, the sums to coarser steps, sweeps of implicit equations. Operations round to
//! nearest and are never fused, elementary functions are those of `real`, and streams those of
//! `noise`. So states have the bits of the processor. It computes their statistics, and the few
//! paths on which plain iteration finds no solution.
//!
//! The way through the crate: `plan` (a task as codes and numbers) → `kernel` (its PTX, with
//! `number` and `ptx`) → a [`Machine`], such as the [`Card`].

mod card;
mod kernel;
mod number;
mod plan;
mod ptx;

use std::{
    fmt::{self, Debug, Display, Formatter},
    ops::Range,
    sync::{Mutex, PoisonError},
};

use noise::{Purpose, StreamKey};
use real::WIDTH;
use schemes::{Device, Task, Trajectories};

pub use card::Card;
use kernel::{HEAD, HEAD_OF_RUN, NO_SLOT, memory_rows};
pub use kernel::{NAME, PARAMETERS};
use plan::Plan;

/// Reason why a machine does not compute.
#[derive(Clone, Debug, PartialEq)]
pub enum Failure {
    /// There is no driver or no card.
    None(String),
    /// The card has too little memory.
    Memory(String),
    /// The card stopped the kernel.
    Stopped(String),
    /// Anything else that the driver says.
    Other(String),
}

impl Display for Failure {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::None(why) => write!(f, "no graphics card can be used: {why}"),
            Self::Memory(why) => write!(f, "the card has too little memory: {why}"),
            Self::Stopped(why) => write!(f, "the card stopped a kernel: {why}"),
            Self::Other(why) => write!(f, "the driver of the card refused: {why}"),
        }
    }
}

impl std::error::Error for Failure {}

/// Machine that runs kernels: a card, or an interpreter of PTX.
pub trait Machine: Send + Sync {
    /// Description in words.
    fn about(&self) -> String;

    /// Number of paths of which fewer are sooner done on the processor.
    fn fewest(&self) -> u64;

    /// Begins a march of `paths` paths with this memory and room for `states` numbers.
    ///
    /// # Errors
    /// [`Failure`].
    fn begin(
        &self,
        ptx: &str,
        paths: u64,
        memory: Vec<u64>,
        states: usize,
    ) -> Result<Box<dyn March + '_>, Failure>;
}

/// Paths that are on a machine.
pub trait March {
    /// Runs the kernel over `steps` finest steps after `before` ones.
    ///
    /// # Errors
    /// [`Failure`].
    fn launch(
        &mut self,
        before: u64,
        steps: u64,
        numbers: &[f64],
        slots: &[u64],
    ) -> Result<(), Failure>;

    /// The memory and the states.
    ///
    /// # Errors
    /// [`Failure`].
    fn end(self: Box<Self>) -> Result<(Vec<u64>, Vec<f64>), Failure>;
}

/// Finest steps of a launch: few enough that a watchdog and a signal wait a fraction of a second.
const STEPS: u64 = 1 << 11;

/// A graphics card for paths.
pub struct Gpu<M> {
    machine: M,
    /// Reasons why paths were left to the processor, each once.
    reasons: Mutex<Vec<String>>,
}

impl<M: Machine> Gpu<M> {
    /// Paths on this machine.
    pub fn new(machine: M) -> Self {
        Self { machine, reasons: Mutex::default() }
    }

    /// The kernel of a task.
    ///
    /// # Errors
    /// The reason why it has none.
    pub fn ptx(task: &Task<'_>) -> Result<String, String> {
        Ok(kernel::kernel(&Plan::new(task)?))
    }

    fn march(&self, task: &Task<'_>) -> Result<Option<Trajectories>, String> {
        let mut plan = Plan::new(task)?;
        let paths = task.paths.end - task.paths.start;
        let (count, rows) = (paths as usize, plan.runs.len() * (task.dimension + 1));
        let memory = memory(&plan, task);
        let words = |error: Failure| error.to_string();
        let states = task.times.len() * rows * count;
        let ptx = kernel::kernel(&plan);
        let mut march = self.machine.begin(&ptx, paths, memory, states).map_err(words)?;
        let whole = 1 << task.levels;
        let (mut before, most) = (0, STEPS.max(whole) / whole * whole);
        while before < task.finest_steps {
            if (task.stopped)() {
                return Ok(None);
            }
            let steps = most.min(task.finest_steps - before);
            let numbers = numbers(&mut plan, task, before, steps).ok_or("a step has no list")?;
            let slot = |time: u64| task.times.binary_search(&time).map_or(NO_SLOT, |k| k as u64);
            let coarse = before / whole..(before + steps) / whole;
            let slots: Vec<u64> = coarse.map(|k| slot(k + 1)).collect();
            march.launch(before, steps, &numbers, &slots).map_err(words)?;
            before += steps;
        }
        let (memory, values) = march.end().map_err(words)?;
        let last = |rows: usize| &memory[memory.len() - rows * count..][..count];
        let runs = plan.runs.len();
        let clipped = (0..runs).flat_map(|run| last(1 + runs - run)).map(|&n| n as f64).collect();
        let solved = last(1).iter().map(|&mark| mark == 0).collect();
        Ok(Some(Trajectories { paths: task.paths.clone(), values, clipped, solved }))
    }
}

impl<M: Machine> Debug for Gpu<M> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_str(&self.machine.about())
    }
}

impl<M: Machine> Device for Gpu<M> {
    fn advance(&self, task: &Task<'_>) -> Option<Trajectories> {
        self.march(task).unwrap_or_else(|why| {
            self.refuse(&why);
            None
        })
    }

    fn refuse(&self, why: &str) {
        let mut reasons = self.reasons.lock().unwrap_or_else(PoisonError::into_inner);
        if !reasons.iter().any(|known| known == why) {
            reasons.push(why.into());
        }
    }

    fn fewest(&self) -> u64 {
        self.machine.fewest()
    }

    fn refused(&self) -> Vec<String> {
        self.reasons.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
}

/// The memory of all paths at time 0, row by row.
fn memory(plan: &Plan<'_>, task: &Task<'_>) -> Vec<u64> {
    let count = (task.paths.end - task.paths.start) as usize;
    let mut memory = Vec::with_capacity(memory_rows(plan) * count);
    for run in 0..plan.runs.len() {
        let mut rows = vec![Vec::with_capacity(count); plan.dimension];
        for first in task.paths.clone().step_by(WIDTH) {
            let states = (task.start)(run, first);
            rows.iter_mut().zip(&states).for_each(|(to, row)| to.extend(row.map(f64::to_bits)));
        }
        memory.extend(rows.into_iter().flatten());
    }
    let beside = plan.space_time.then(|| task.key.beside(Purpose::SpaceTimeAreas));
    for key in [task.key].into_iter().chain(beside) {
        memory.extend(streams(key, task.paths.clone()));
        // The normal that is left over.
        memory.resize(memory.len() + plan.noises % 2 * count, 0);
    }
    memory.resize(memory_rows(plan) * count, 0);
    memory
}

/// The states of streams, word by word.
fn streams(key: StreamKey, paths: Range<u64>) -> impl Iterator<Item = u64> {
    let states: Vec<[u64; 4]> = paths.map(|path| key.state(path)).collect();
    (0..4).flat_map(move |k| states.clone().into_iter().map(move |state| state[k]))
}

/// The numbers of a launch: the head, and the table of each run.
fn numbers(plan: &mut Plan<'_>, task: &Task<'_>, before: u64, steps: u64) -> Option<Vec<f64>> {
    let mut numbers = vec![task.tau.sqrt(), (task.tau / 12.0).sqrt()];
    numbers.resize(HEAD + HEAD_OF_RUN * plan.runs.len(), 0.0);
    for run in 0..plan.runs.len() {
        let (level, columns) = (plan.runs[run].level, plan.runs[run].columns);
        let head = HEAD + HEAD_OF_RUN * run;
        numbers[head] = task.runs[run].bound;
        numbers[head + 1] = f64::from_bits(numbers.len() as u64);
        let mut row = vec![0.0; columns];
        for n in before >> level..(before + steps) >> level {
            plan.numbers(run, &(task.step)(level, n), &mut row)?;
            numbers.extend_from_slice(&row);
        }
    }
    Some(numbers)
}
