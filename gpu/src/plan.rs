//! Tasks as codes and numbers: the instructions of the steps of each run, and the numbers of every
//! step in the order in which a kernel reads them.

use std::any::Any;

use expression::Instruction;
use formula::FormulaProgram;
use real::WIDTH;
use schemes::{Listing, Step, Stepper, Task};
use systems::run_time::Program;

/// A program of a step: instructions, and where their numbers are.
pub struct Code {
    /// The instructions.
    pub instructions: Vec<Instruction>,
    /// Number of results.
    pub outputs: usize,
    /// The numbers, as far as they are constant.
    pub constants: Vec<f64>,
    /// The places of the numbers that change from step to step, with their columns.
    pub columns: Vec<(usize, usize)>,
}

/// The steps of a run.
pub struct RunPlan {
    /// The level of its steps.
    pub level: usize,
    /// Whether increments are clipped.
    pub clips: bool,
    /// The programs that steps take in turn: one or two, no more than there are steps.
    pub programs: Vec<Code>,
    /// Most sweeps of an implicit step and whether one more follows, with the columns of the
    /// factors before and after.
    pub sweeps: Option<(u32, bool, [usize; 2])>,
    /// The columns of the factors of increments; none without.
    pub noise: Vec<usize>,
    /// Whether space-time areas are read after increments.
    pub reads_space_time: bool,
    /// Components with the columns of their factors, before the program.
    pub before: Vec<(usize, usize)>,
    /// Components with the columns of their factors, after the program.
    pub after: Vec<(usize, usize)>,
    /// The program that is finite in the domain.
    pub guard: Option<Code>,
    /// Number of columns.
    pub columns: usize,
}

/// All runs of a task, with the steppers that give the numbers of their steps.
pub struct Plan<'a> {
    /// The runs.
    pub runs: Vec<RunPlan>,
    /// Number of components.
    pub dimension: usize,
    /// Number of noises.
    pub noises: usize,
    /// Whether space-time areas are drawn.
    pub space_time: bool,
    /// Number of levels above the finest.
    pub levels: usize,
    steppers: Vec<Box<dyn Stepper + 'a>>,
}

/// Columns, of which the next one is given out.
#[derive(Default)]
struct Columns(usize);

impl Columns {
    fn next(&mut self) -> usize {
        self.0 += 1;
        self.0 - 1
    }
}

fn program(program: &mut dyn Program) -> Option<&mut FormulaProgram> {
    (program as &mut dyn Any).downcast_mut()
}

impl Code {
    fn new(program: &mut FormulaProgram, columns: &mut Columns) -> Option<Self> {
        let (_, reads_areas) = program.noise();
        let tape = program.tape();
        let varying = (0..tape.numbers.values().len()).step_by(2);
        let varying = varying.filter(|&place| tape.numbers.varies(place));
        let columns = varying.map(|place| (place, columns.next())).collect();
        (!reads_areas).then(|| Self {
            instructions: tape.instructions().to_vec(),
            outputs: tape.outputs(),
            constants: tape.numbers.values().to_vec(),
            columns,
        })
    }
}

/// The reason why a scheme cannot be listed.
pub const NO_LISTING: &str = "its steps are no list of operations: systems of the project, \
    lattices, matrices, integrals and events, and schemes with parts that have no flow";

impl<'a> Plan<'a> {
    /// The plan of a task.
    ///
    /// # Errors
    /// The reason why it has none.
    pub fn new(task: &'a Task<'_>) -> Result<Self, &'static str> {
        let start = vec![[0.0; WIDTH]; task.dimension];
        let mut steppers: Vec<_> = task.runs.iter().map(|run| run.method.start(&start)).collect();
        let mut runs = Vec::new();
        for (run, stepper) in task.runs.iter().zip(&mut steppers) {
            let step = |n| (task.step)(run.level, n);
            let steps = task.finest_steps >> run.level;
            let plan = RunPlan::new(&mut **stepper, steps, step).ok_or(NO_LISTING)?;
            runs.push(RunPlan { level: run.level, clips: run.bound < f64::INFINITY, ..plan });
        }
        let &Task { dimension, noises, space_time, levels, .. } = task;
        Ok(Self { runs, dimension, noises, space_time, levels, steppers })
    }

    /// Writes the numbers of step number `n` of a run.
    pub fn numbers(&mut self, run: usize, step: &Step, row: &mut [f64]) -> Option<()> {
        let plan = &self.runs[run];
        let listing = self.steppers[run].listing(step)?;
        let Listing { turn: (number, _), factors, dt, t, .. } = listing;
        let mut write = |code: &Code, values: &[f64]| {
            code.columns.iter().for_each(|&(place, column)| row[column] = values[place]);
        };
        let code = plan.programs.get(number)?;
        write(code, program(listing.program)?.numbers(factors, dt, t).values());
        if let (Some(code), Some((guard, t))) = (&plan.guard, listing.guard) {
            write(code, program(guard)?.numbers(&[], 0.0, t).values());
        }
        if let (Some((_, _, columns)), Some(sweeps)) = (plan.sweeps, listing.sweeps) {
            columns.iter().zip(sweeps.factors).for_each(|(&column, factor)| row[column] = factor);
        }
        plan.noise.iter().zip(listing.noise).for_each(|(&column, factor)| row[column] = factor);
        let all = [(&plan.before, &listing.before), (&plan.after, &listing.after)];
        for (columns, factors) in all {
            columns.iter().zip(factors).for_each(|(&(_, at), &(_, factor))| row[at] = factor);
        }
        Some(())
    }
}

impl RunPlan {
    fn new(stepper: &mut dyn Stepper, steps: u64, step: impl Fn(u64) -> Step) -> Option<Self> {
        let mut columns = Columns::default();
        let mut programs = Vec::new();
        // Steps take their programs in turn.
        let count = stepper.listing(&step(0))?.turn.1 as u64;
        for n in 0..count.min(steps) {
            let listing = stepper.listing(&step(n))?;
            programs.push(Code::new(program(listing.program)?, &mut columns)?);
        }
        let listing = stepper.listing(&step(0))?;
        let mut placed = |of: &[(usize, f64)]| -> Vec<_> {
            of.iter().map(|&(component, _)| (component, columns.next())).collect()
        };
        let (before, after) = (placed(&listing.before), placed(&listing.after));
        let noise = listing.noise.iter().map(|_| columns.next()).collect();
        let sweeps = listing
            .sweeps
            .map(|sweeps| (sweeps.most, sweeps.settle, sweeps.factors.map(|_| columns.next())));
        let reads_space_time = listing.reads_space_time;
        let guard = match listing.guard {
            Some((guard, _)) => Some(Code::new(program(guard)?, &mut columns)?),
            None => None,
        };
        Some(Self {
            level: 0,
            clips: false,
            programs,
            sweeps,
            noise,
            reads_space_time,
            before,
            after,
            guard,
            columns: columns.0,
        })
    }
}
