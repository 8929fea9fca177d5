//! Orders of solvers that are not ours: their noise goes out, their states come back.
//!
//! A solver gets the increments of every step size, with areas joined by Chen's relation, and gives
//! y(T). Its results are judged as our schemes are: by differences of successive step sizes, by
//! single steps as τ → 0, and by a limit. This is compared with a reference of order one on the
//! finest noise, since the coefficients of the solver are not known.

mod interpretation;
mod judge;
mod noise;
mod verdicts;

use mc::{LadderError, Setup, View};
use real::WIDTH;

use super::{
    StepSizes,
    one_step::taus,
    runs::{Collected, state},
};

pub use judge::{Judged, Law, SolverStates};
pub use noise::{LevelNoise, VISITS};
pub use verdicts::{Claims, Verdict, Verdicts};

/// Number of step sizes of single steps.
const SINGLE: usize = 16;

/// Squared distance |a − b|².
fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum()
}

/// Gives noise to a solver, and judges the states that it gives back.
///
/// A solver of y₁ alone, here of dy = −½y dt + dW by Euler's method:
///
/// ```
/// use std::sync::Arc;
/// use analysis::{LevelNoise, Referee, SolverStates, StepSizes};
/// use formula::{Definition, FormulaSystem};
/// use mc::Setup;
/// use noise::{StreamKey, Truncation};
/// use schemes::Sexp;
/// use systems::{Constant, run_time::Problem};
///
/// let words = |texts: &[&str]| texts.iter().map(|text| text.to_string()).collect::<Vec<_>>();
/// let walk = Definition {
///     name: "walk".into(),
///     state: words(&["y", "z"]),
///     structure: vec![words(&["1"])].into(),
///     energy: "0".into(),
///     noises: words(&["z"]),
///     ..Definition::default()
/// };
/// let system = Arc::new(FormulaSystem::new(&walk, &[1.0, 0.0])?);
/// let problem = Problem::new(system, Arc::new(Constant::new(0.5)?), vec![1.0, 0.0], 1.0)?;
/// let key = StreamKey { seed: 1, experiment: 0 };
/// let sizes = StepSizes { refinement: 3, ..StepSizes::new(8, Truncation::new(4)?, key) };
/// let referee = Referee { setup: Setup::at_run_time(&problem, &Sexp)?, sizes };
///
/// let euler = |y0: &[f64], tau: f64, noise: &LevelNoise| -> Vec<f64> {
///     let mut y = y0.to_vec();
///     for dw in noise.increments.chunks(y0.len() / 2) {
///         for (y, dw) in y.chunks_mut(2).zip(dw) {
///             y[0] += -0.5 * tau * y[0] + dw;
///         }
///     }
///     y
/// };
/// let (noise, [start, finest, coarse]) = (referee.noise(0, 512)?, referee.reference(0, 512)?);
/// let taus = (3..).map(|n| 0.5f64.powi(n));
/// let levels = noise.iter().zip(taus).map(|(noise, tau)| euler(&start, tau, noise));
/// let single = referee.single_taus().into_iter().map(|tau| {
///     let [one, two] = referee.single_noise(tau);
///     let y0 = &[0.3, 0.0].repeat(one.increments.len());
///     [euler(y0, tau, &one), euler(y0, 0.5 * tau, &two)]
/// });
/// let (levels, single) = (levels.collect(), single.collect());
/// let reference = [finest, coarse];
/// let states = SolverStates { start, levels, reference, single, ..SolverStates::default() };
/// let found = referee.judge(&[], &states);
/// assert_eq!(found.strong.order(), Some(1.0), "{}", found.strong);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Referee<'a> {
    /// The problem, with a scheme of order one for the reference.
    pub setup: Setup<'a>,
    /// The step sizes of the solver; the reference has the finest of the refinement.
    pub sizes: StepSizes,
}

impl Referee<'_> {
    fn noises(&self) -> usize {
        self.setup.problem.noises
    }

    /// The step sizes of single steps.
    pub fn single_taus(&self) -> Vec<f64> {
        taus(self.setup.problem.t_end, &self.sizes).take(SINGLE).collect()
    }

    /// The states of paths at time 0, and at the end by the reference and by its steps of twice the
    /// size, [path, component]; NaN where it fails.
    ///
    /// # Errors
    /// [`LadderError`] as in [`Setup::ladder`].
    pub fn reference(&self, first: u64, paths: usize) -> Result<[Vec<f64>; 3], LadderError> {
        let Self { setup, sizes } = self;
        let d = setup.problem.y0.len();
        let ladder = sizes.ladder(setup, sizes.reference_steps(), 1, paths as u64)?;
        let end = |view: &View<'_>, p: usize| {
            let last = view.time == ladder.coarse_steps();
            last.then(|| (view.first_path + p as u64, [1, 0].map(|run| state(view.state(run), p))))
        };
        let new = || Collected { of: &end, found: Vec::new() };
        let ends = ladder.run_until(&sizes.stop, first, paths as u64, new).statistic.found;
        let mut found = [(); 3].map(|()| vec![f64::NAN; paths * d]);
        let mut set = |place: usize, path: usize, y: &[f64]| {
            found[place][path * d..(path + 1) * d].copy_from_slice(&y[..d]);
        };
        for first_of_block in (0..paths).step_by(WIDTH) {
            let start = setup.problem.start(sizes.key, first + first_of_block as u64);
            let of_block = 0..WIDTH.min(paths - first_of_block);
            of_block.for_each(|p| set(0, first_of_block + p, &state(&start, p)));
        }
        for (path, [finest, coarse]) in ends {
            set(1, (path - first) as usize, &finest);
            set(2, (path - first) as usize, &coarse);
        }
        Ok(found)
    }
}
