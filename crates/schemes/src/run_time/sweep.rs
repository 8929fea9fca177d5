//! Sweeps of fixed-point iteration, for systems that compile three evaluations in a row.

use nonlin::criteria::excess;
use real::{Kernel, OutOfMemory, Row, Rows, WIDTH, dispatch};
use systems::run_time::{Program, Recorded, System, Weights};

use super::record::{Recorder, Recording};
use crate::{Implicit, Step};

/// Minus the number of sweeps of a path that has converged; positive on other paths.
pub type Pending = Row;

/// Three evaluations in a row as one program.
pub struct TripleProgram {
    recorder: Recorder,
    operations: Vec<Recorded>,
    program: Box<dyn Program>,
    /// The three iterates.
    iterates: Rows,
}

impl TripleProgram {
    /// The sweep of a formula, if the system compiles it.
    ///
    /// # Errors
    /// [`OutOfMemory`].
    pub fn new(
        formula: &impl Implicit,
        system: &dyn System,
        step: &Step,
    ) -> Result<Option<Self>, OutOfMemory> {
        let mut recorder = Recorder::default();
        let results = record(&recorder, formula, system, step);
        let operations = recorder.operations().0.to_vec();
        let Some(program) = system.compile(&operations, 2, &results) else { return Ok(None) };
        let iterates = Rows::zero(3 * system.description().layout.rows)?;
        Ok(Some(Self { recorder, operations, program, iterates }))
    }

    /// Records the formula for a step. Whether its operations are those of the program.
    pub fn record(&mut self, formula: &impl Implicit, system: &dyn System, step: &Step) -> bool {
        record(&self.recorder, formula, system, step);
        self.recorder.operations().0 == self.operations
    }

    /// Sweeps from `solution` until every path has converged or their number is reached.
    pub fn iterate(
        &mut self,
        start: &[Row],
        h: Weights<'_>,
        most_sweeps: u32,
        solution: &mut [Row],
        pending: &mut Pending,
    ) {
        let factors = self.recorder.operations().1;
        for number in 1..=most_sweeps {
            self.program.run(&[start, solution], factors, h, &mut self.iterates);
            let iterates = &self.iterates;
            if dispatch(TestSweep { number, iterates, solution, pending }) {
                break;
            }
        }
    }
}

/// Records three evaluations in a row; the numbers of their results.
fn record(
    recorder: &Recorder,
    formula: &impl Implicit,
    system: &dyn System,
    step: &Step,
) -> [usize; 3] {
    let [start, mut z] = recorder.restart();
    [(); 3].map(|()| {
        z = formula.psi(Recording { system, step, recorder }, start, z);
        z.number
    })
}

/// The end of a sweep: the test of every path, and the solutions of those that were not frozen.
/// Whether all have converged.
struct TestSweep<'a> {
    number: u32,
    iterates: &'a [Row],
    solution: &'a mut [Row],
    pending: &'a mut Pending,
}

impl Kernel for TestSweep<'_> {
    type Output = bool;
    #[inline(always)]
    fn run(self) -> bool {
        let Self { number, iterates, solution, pending } = self;
        let number = f64::from(number);
        let (previous, rest) = iterates.split_at(solution.len());
        let (before, next) = rest.split_at(solution.len());
        let (mut change, mut change_before, mut size) = ([0.0; WIDTH], [0.0; WIDTH], [0.0; WIDTH]);
        for ((previous, before), next) in previous.iter().zip(before).zip(next) {
            for p in 0..WIDTH {
                change[p] += (next[p] - before[p]).abs();
                change_before[p] += (before[p] - previous[p]).abs();
                size[p] += next[p].abs();
            }
        }
        let frozen = *pending;
        let mut now = frozen;
        let mut unfinished = 0u64;
        for p in 0..WIDTH {
            let excess = excess(change[p], change_before[p], size[p]);
            let tested = if excess <= 0.0 { -number } else { 1.0 };
            now[p] = if frozen[p] <= 0.0 { frozen[p] } else { tested };
            unfinished = unfinished.wrapping_add(if now[p] <= 0.0 { 0 } else { 1 });
        }
        *pending = now;
        for (solution, next) in solution.iter_mut().zip(next) {
            let (mut row, next) = (*solution, *next);
            for p in 0..WIDTH {
                row[p] = if frozen[p] <= 0.0 { row[p] } else { next[p] };
            }
            *solution = row;
        }
        unfinished == 0
    }
}
