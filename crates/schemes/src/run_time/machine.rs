//! Runs the plan of a formula on rows: stage by stage, slab by slab, tile by tile.

use std::{
    ops::Range,
    sync::{Mutex, PoisonError},
};

use real::{Row, Rows};
use systems::run_time::{Layout, MAX_INPUTS, Program, Recorded, System, Weights};

use super::{
    SchemeError,
    plan::{Computation, Plan, Source, Stage},
    record::{Operations, Recorder},
};
use crate::{Implicit, Step, built_in::PLAIN};

/// The operations of a formula on one system, and memory for them.
pub struct Machine<'a> {
    system: &'a dyn System,
    layout: Layout,
    recorder: Recorder,
    /// Whole states: inputs of the formula first.
    pub buffers: Vec<Rows>,
    plan: Plan,
    /// The formula in one piece, for systems that can compute it so, and its results.
    program: Option<Box<dyn Program>>,
    output: Rows,
    /// Memory of the tiles, for each thread.
    memories: Vec<Mutex<TileMemory>>,
    /// Rows of a slab.
    slab: usize,
}

/// Least tiles of a slab for each thread.
const SLAB_TILES: usize = 8;

/// Scratch memory for one tile.
struct TileMemory {
    slots: Vec<Rows>,
    scratch: Rows,
}

/// The most states that a stage stores.
const MAX_STORES: usize = 16;

/// The parts of buffers in which a tile stores its results; those that are not used are empty.
type Stores<'a> = [&'a mut [Row]; MAX_STORES];

/// A stage that is being executed.
struct Execution<'a> {
    system: &'a dyn System,
    stage: &'a Stage,
    factors: &'a [f64],
    h: Weights<'a>,
    buffers: &'a [Rows],
    memories: &'a [Mutex<TileMemory>],
}

impl<'a> Machine<'a> {
    /// Memory for a system, without operations and buffers yet.
    pub fn new(system: &'a dyn System) -> Self {
        let description = system.description();
        let layout = description.layout;
        let threads = if layout.is_tiled() { rayon::current_num_threads() } else { 1 };
        let memory = |_| {
            let scratch = Rows::zero(description.scratch_rows());
            Mutex::new(TileMemory { slots: Vec::new(), scratch })
        };
        Self {
            system,
            layout,
            recorder: Recorder::default(),
            buffers: Vec::new(),
            plan: Plan::default(),
            program: None,
            output: Rows::default(),
            memories: (0..threads).map(memory).collect(),
            slab: layout.tile_rows * layout.reach.max(SLAB_TILES * threads),
        }
    }

    /// Records evaluations of a formula in a row, and plans them if they are new. Returns whether
    /// they are.
    ///
    /// # Errors
    /// [`SchemeError`] if an allocation fails, or averages are to be computed tile by tile, or of
    /// an equation that has none.
    pub fn record<F: Implicit>(
        &mut self,
        formula: &F,
        step: &Step,
        evaluations: usize,
    ) -> Result<bool, SchemeError> {
        let new = self.recorder.evaluations(formula, self.system, step, evaluations);
        if new {
            self.plan()?;
        }
        Ok(new)
    }

    /// Takes operations that were recorded, and plans them if they are new.
    ///
    /// # Errors
    /// Errors of [`record`](Self::record).
    pub fn load(&mut self, mut recorded: Recorder) -> Result<(), SchemeError> {
        std::mem::swap(&mut self.recorder, &mut recorded);
        let is_new = self.recorder.operations().nodes != recorded.operations().nodes;
        if is_new { self.plan() } else { Ok(()) }
    }

    /// The operations.
    pub fn operations(&mut self) -> &Operations {
        self.recorder.operations()
    }

    /// Plans the operations and provides the memory that they need. The input of an explicit
    /// formula, which has one, may be overwritten.
    fn plan(&mut self) -> Result<(), SchemeError> {
        // If that fails they count as new the next time.
        let mut recorder = std::mem::take(&mut self.recorder);
        let Operations { nodes, results, .. } = recorder.operations();
        let is_average = |node: &Recorded| matches!(node, Recorded::Of(op) if op.is_average());
        let (description, layout) = (self.system.description(), self.layout);
        let name = &description.name;
        if description.plain && nodes.iter().any(is_average) {
            return Err(SchemeError::not_for("the scheme", name, PLAIN));
        }
        if layout.is_tiled() && nodes.iter().any(is_average) {
            return Err(SchemeError(format!(
                "∇̄h of `{name}`, whose h is not quadratic, cannot be computed in tiles: take \
                 midpoint, or one tile"
            )));
        }
        let inputs = nodes.iter().filter(|node| matches!(node, Recorded::Input(_))).count();
        self.program = self.system.compile(nodes, inputs, results);
        self.plan = Plan { buffers: inputs, ..Plan::default() };
        match self.program {
            Some(_) => self.output = Rows::zero(results.len() * layout.rows),
            None => self.plan = Plan::new(nodes, results, inputs == 1),
        }
        if self.plan.stages.iter().any(|stage| stage.stores.len() > MAX_STORES) {
            let message = format!("the formula stores more than {MAX_STORES} states at a time");
            return Err(SchemeError(message));
        }
        for memory in &mut self.memories {
            let memory = memory.get_mut().unwrap_or_else(PoisonError::into_inner);
            while memory.slots.len() < self.plan.slots {
                memory.slots.push(Rows::zero(layout.tile_rows.min(layout.rows)));
            }
        }
        while self.buffers.len() < self.plan.buffers {
            self.buffers.push(Rows::zero(layout.rows));
        }
        self.recorder = recorder;
        Ok(())
    }

    /// The formula in one piece, if it is one, and the factors of its operations.
    pub fn program(&mut self) -> Option<(&mut dyn Program, &[f64])> {
        Some((self.program.as_deref_mut()?, &self.recorder.operations().factors))
    }

    /// Result number n.
    pub fn result(&self, n: usize) -> &[Row] {
        match self.program {
            Some(_) => &self.output[n * self.layout.rows..][..self.layout.rows],
            None => &self.buffers[self.plan.results[n]],
        }
    }

    /// Makes the only result the input number `input`, whose former content is lost.
    pub fn feed_back(&mut self, input: usize) {
        match self.program {
            Some(_) => std::mem::swap(&mut self.buffers[input], &mut self.output),
            None => self.buffers.swap(input, self.plan.results[0]),
        }
    }

    /// Executes the operations on the inputs in the first buffers.
    pub fn execute(&mut self, h: Weights<'_>) {
        let Self { system, layout, recorder, buffers, plan, memories, slab, .. } = self;
        let factors = &recorder.operations().factors;
        if let Some(program) = &mut self.program {
            let mut states: [&[Row]; MAX_INPUTS] = [&[]; MAX_INPUTS];
            buffers.iter().zip(&mut states).for_each(|(input, state)| *state = input);
            return program.run(&states[..plan.buffers], factors, h, &mut self.output);
        }
        let (stages, slabs) = (plan.stages.len(), (layout.rows / *slab).max(1));
        for time in 0..slabs + 2 * (stages - 1) {
            for number in (0..stages).filter(|s| (2 * s..2 * s + slabs).contains(&time)) {
                let k = (time - number) % slabs;
                let rows = k * *slab..if k + 1 < slabs { (k + 1) * *slab } else { layout.rows };
                let stage = &plan.stages[number];
                // The buffers in which the stage stores are taken out while the others are read.
                let mut taken: [Rows; MAX_STORES] = Default::default();
                let mut stores: Stores<'_> = Default::default();
                let places = taken.iter_mut().zip(&mut stores).zip(&stage.stores);
                for ((taken, store), &(_, buffer)) in places {
                    *taken = std::mem::take(&mut buffers[buffer]);
                    *store = &mut taken[rows.clone()];
                }
                Execution { system: *system, stage, factors, h, buffers, memories }
                    .on_rows(rows, stores);
                for (taken, &(_, buffer)) in taken.into_iter().zip(&stage.stores) {
                    buffers[buffer] = taken;
                }
            }
        }
    }
}

impl Execution<'_> {
    /// Executes the stage on some rows: halves in parallel, down to single tiles.
    fn on_rows(&self, rows: Range<usize>, mut earlier: Stores<'_>) {
        let tile = self.system.description().layout.tile_rows;
        let tiles = rows.len().div_ceil(tile);
        if tiles <= 1 {
            let thread = match self.memories.len() {
                1 => 0,
                threads => rayon::current_thread_index().unwrap_or(0) % threads,
            };
            let mut memory = self.memories[thread].lock().unwrap_or_else(PoisonError::into_inner);
            return self.on_tile(rows, earlier, &mut memory);
        }
        let half = tiles / 2 * tile;
        let mut later: Stores<'_> = Default::default();
        for (earlier, later) in earlier.iter_mut().zip(&mut later) {
            let whole = std::mem::take(earlier);
            (*earlier, *later) = whole.split_at_mut(half.min(whole.len()));
        }
        let middle = rows.start + half;
        rayon::join(
            || self.on_rows(rows.start..middle, earlier),
            || self.on_rows(middle..rows.end, later),
        );
    }

    /// Executes the stage on one tile.
    fn on_tile(&self, tile: Range<usize>, stores: Stores<'_>, memory: &mut TileMemory) {
        let TileMemory { slots, scratch } = memory;
        for &(computation, slot) in &self.stage.instructions {
            let mut result = std::mem::take(&mut slots[slot]);
            let local = |source: Source| match source {
                Source::Slot(slot) => &slots[slot][..tile.len()],
                Source::Buffer(buffer) => {
                    match self.stage.stores.iter().position(|&(_, stored)| stored == buffer) {
                        Some(n) => &*stores[n],
                        None => &self.buffers[buffer][tile.clone()],
                    }
                }
            };
            let out = &mut result[..tile.len()];
            match computation {
                Computation::Multiple(x, factor) => {
                    multiple(local(x), self.factors[factor], out);
                }
                Computation::Combination { terms, minus } => {
                    let [(x, fx), (y, fy)] = terms.map(|(source, node)| {
                        (local(source), node.map_or(1.0, |node| self.factors[node]))
                    });
                    // a − fb = a + (−f)b to the bit.
                    combination(x, fx, y, if minus { -fy } else { fy }, out);
                }
                Computation::Of(op) => {
                    let is_local = op.is_local();
                    let state = |source: Source| match source {
                        Source::Buffer(buffer) if !is_local => &self.buffers[buffer][..],
                        source => local(source),
                    };
                    self.system.apply(op.map(state), tile.clone(), self.h, out, scratch);
                }
            }
            slots[slot] = result;
        }
        for (store, &(slot, _)) in stores.into_iter().zip(&self.stage.stores) {
            store.copy_from_slice(&slots[slot][..tile.len()]);
        }
    }
}

real::kernel! {
    /// out = factor·x.
    pub fn multiple(x: &'a [Row], factor: f64, out: &'a mut [Row]) {
        // One loop over all numbers: one over rows makes gathered loads of them.
        for (out, x) in out.as_flattened_mut().iter_mut().zip(x.as_flattened()) {
            *out = x * factor;
        }
    }
}

real::kernel! {
    /// out = fx·x + fy·y. Multiplication by one is exact.
    fn combination(x: &'a [Row], fx: f64, y: &'a [Row], fy: f64, out: &'a mut [Row]) {
        let out = out.as_flattened_mut().iter_mut();
        for ((out, x), y) in out.zip(x.as_flattened()).zip(y.as_flattened()) {
            *out = x * fx + y * fy;
        }
    }
}
