//! Steps as programs, for machines that run many paths in a way of their own.

use systems::run_time::Program;

/// One step of a path as a program of the system, with its numbers.
///
/// The state is multiplied by the factors `before`, goes through the program, once or until its
/// results are a fixed point, and is multiplied by the factors `after`. These operations in their
/// order give the bits of [`Stepper::step`](crate::Stepper::step) on paths that do not fail.
pub struct Listing<'a> {
    /// The program of the step.
    pub program: &'a mut dyn Program,
    /// Number of the program among those that steps take in turn, and how many these are.
    pub turn: (usize, usize),
    /// A number for every operation of the program.
    pub factors: &'a [f64],
    /// Size of the step.
    pub dt: f64,
    /// Middle of the step.
    pub t: f64,
    /// Factors of the increments of the noises; none if these are taken as they are.
    pub noise: Vec<f64>,
    /// Whether rows of space-time areas come after those of the increments.
    pub reads_space_time: bool,
    /// Components with their factors, before the program.
    pub before: Vec<(usize, f64)>,
    /// Components with their factors, after the program.
    pub after: Vec<(usize, f64)>,
    /// How an implicit step is solved; none for an explicit one.
    pub sweeps: Option<Sweeps>,
    /// A program that is finite where the state at the end is in the domain, and the time there.
    pub guard: Option<(&'a mut dyn Program, f64)>,
}

/// Fixed-point iteration of an implicit step z = ψ(ẑ, z) with ẑ the first factor times the state.
/// The program has the inputs ẑ and z and the next iterate as result; it starts with z = ẑ. The
/// last two changes of each sweep are tested: without convergence by
/// [`excess`](nonlin::criteria::excess) the step is not solved here.
#[derive(Clone, Copy, Debug)]
pub struct Sweeps {
    /// Largest number of sweeps.
    pub most: u32,
    /// Whether one more follows.
    pub settle: bool,
    /// The factor of the state before, and that of the solution.
    pub factors: [f64; 2],
}

impl Sweeps {
    /// Evaluations of a sweep.
    pub const EVALUATIONS: usize = 3;
}

impl<'a> Listing<'a> {
    /// An explicit step by one program.
    pub(crate) fn new(program: &'a mut dyn Program, factors: &'a [f64], dt: f64, t: f64) -> Self {
        Self {
            program,
            turn: (0, 1),
            factors,
            dt,
            t,
            noise: Vec::new(),
            reads_space_time: false,
            before: Vec::new(),
            after: Vec::new(),
            sweeps: None,
            guard: None,
        }
    }
}
