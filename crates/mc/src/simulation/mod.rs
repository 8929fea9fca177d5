//! Tables of paths with observables and invariants.

mod error;
mod series;
mod write;

use std::{collections::BTreeMap, ops::Range};

use noise::{StreamKey, Truncation};
use schemes::{Scheme, Step};
use systems::{Damping, Invariant, PoissonSystem, Problem};

use crate::{Ladder, LadderError, PathFailure, Recording, Run, trajectory::PathRecords};

pub use error::SimulationError;
pub use series::{Column, NoiseOrigin, TimeSeries};
pub(crate) use write::quoted;
pub use write::{write_csv, write_json};

/// An observable φ(y).
type Observed<'a, const D: usize> = Box<dyn Fn([f64; D]) -> f64 + Sync + 'a>;

/// Simulation of paths of a problem by a scheme. The table of each path contains time, state,
/// observables, and every invariant of the system with its relative defect from the conformal law.
/// All tables are kept in memory.
///
/// ```
/// use mc::{Simulation, write_csv};
/// use noise::{StreamKey, Truncation};
/// use schemes::Sexp;
/// use systems::{Constant, MaxwellBloch, Problem};
///
/// let problem = Problem::new(MaxwellBloch, Constant::new(0.1)?, [1.0, 2.0, 3.0], 5.0)?;
/// let sexp = Sexp;
/// let simulation = Simulation::new(&problem, &sexp, Truncation::new(4)?)
///     .every(100)
///     .observing("intensity", |y| y[0] * y[0]);
/// let paths = simulation.paths(500, StreamKey { seed: 1, experiment: 0 }, 0..4)?;
/// assert_eq!(paths[3].times(), [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]);
/// assert!(paths[3].column("C defect").unwrap().iter().all(|defect| defect.abs() < 1e-13));
///
/// let mut csv = Vec::new();
/// write_csv(&paths, &mut csv)?;
/// let csv = String::from_utf8(csv)?;
/// let mut lines = csv.lines();
/// assert_eq!(lines.next(), Some("scheme,path,t,y1,y2,y3,intensity,C,C defect"));
/// assert_eq!(lines.next(), Some("sexp,0,0.0,1.0,2.0,3.0,1.0,6.5,0.0"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Simulation<'a, S, G, const D: usize, const M: usize> {
    problem: &'a Problem<S, G, D>,
    scheme: &'a dyn Scheme<S, D, M>,
    truncation: Truncation,
    every: u64,
    observables: Vec<(String, Observed<'a, D>)>,
}

impl<'a, S, G, const D: usize, const M: usize> Simulation<'a, S, G, D, M>
where
    S: PoissonSystem<D, M>,
    G: Damping,
{
    /// A simulation that saves every step and has no observables.
    pub fn new(
        problem: &'a Problem<S, G, D>,
        scheme: &'a dyn Scheme<S, D, M>,
        truncation: Truncation,
    ) -> Self {
        Self { problem, scheme, truncation, every: 1, observables: Vec::new() }
    }

    /// Saves only every `every`-th step, the initial state and the last step.
    #[must_use]
    pub fn every(mut self, every: u64) -> Self {
        self.every = every;
        self
    }

    /// Adds a column with the observable φ(y).
    #[must_use]
    pub fn observing(
        mut self,
        name: impl Into<String>,
        phi: impl Fn([f64; D]) -> f64 + Sync + 'a,
    ) -> Self {
        self.observables.push((name.into(), Box::new(phi)));
        self
    }

    /// The table of path number `path` in `steps` steps to the final time, with the same states as
    /// [`trajectory`](crate::trajectory).
    ///
    /// # Errors
    /// - [`SimulationError::Ladder`] as in [`Ladder::new`].
    /// - [`SimulationError::Every`] if `every` is zero.
    /// - [`SimulationError::Column`] if two columns have the same name.
    pub fn path(
        &self,
        steps: u64,
        key: StreamKey,
        path: u64,
    ) -> Result<TimeSeries, SimulationError> {
        let mut series = self.paths(steps, key, path..path + 1)?;
        Ok(series.swap_remove(0))
    }

    /// The tables of many paths in the order of their numbers, computed in parallel on the current
    /// rayon pool.
    ///
    /// # Errors
    /// As for [`path`](Self::path).
    pub fn paths(
        &self,
        steps: u64,
        key: StreamKey,
        paths: Range<u64>,
    ) -> Result<Vec<TimeSeries>, SimulationError> {
        let StreamKey { seed, experiment } = key;
        let drawn = |path| NoiseOrigin::Drawn { seed, experiment, path };
        self.run(self.ladder(steps, key)?, paths, &drawn)
    }

    fn ladder(&self, steps: u64, key: StreamKey) -> Result<Ladder<'a, D, M>, LadderError> {
        let runs = vec![Run::new(self.scheme, 0)];
        Ladder::new(self.problem, steps, 0, self.truncation, key, runs)
    }

    /// The table of the path with recorded increments. They are truncated like drawn increments,
    /// unless the simulation has [`Truncation::none`].
    ///
    /// # Errors
    /// As for [`path`](Self::path), and those of [`Ladder::with_noise`].
    pub fn recorded(&self, recording: &Recording<M>) -> Result<TimeSeries, SimulationError> {
        let steps = recording.increments().len() as u64;
        let ladder = self.ladder(steps, StreamKey { seed: 0, experiment: 0 })?;
        let ladder = ladder.with_noise(recording)?;
        let mut series = self.run(ladder, 0..1, &|_| NoiseOrigin::Recorded)?;
        Ok(series.swap_remove(0))
    }

    fn run(
        &self,
        ladder: Ladder<'_, D, M>,
        paths: Range<u64>,
        origin: &dyn Fn(u64) -> NoiseOrigin,
    ) -> Result<Vec<TimeSeries>, SimulationError> {
        if self.every == 0 {
            return Err(SimulationError::Every);
        }
        let (problem, tau) = (self.problem, ladder.tau(0));
        let (system, y0) = (problem.system(), problem.y0());
        let invariants = system.invariants();
        let mut names = vec!["t".into()];
        names.extend((1..=D).map(|i| format!("y{i}")));
        names.extend(self.observables.iter().map(|(name, _)| name.clone()));
        for (index, Invariant { name, .. }) in invariants.iter().enumerate() {
            let same = |among: &[Invariant]| among.iter().filter(|i| i.name == *name).count();
            let name = match same(&invariants) {
                1 => name.to_string(),
                _ => format!("{name}{}", 1 + same(&invariants[..index])),
            };
            names.extend([name.clone(), format!("{name} defect")]);
        }
        if let Some(n) = (0..names.len()).find(|&n| names[..n].contains(&names[n])) {
            return Err(SimulationError::Column { name: names.swap_remove(n) });
        }
        // The row of step n, where `damped` is ∫γ up to its end.
        let row = |n: u64, damped: f64, y: [f64; D]| {
            let mut row = vec![n as f64 * tau];
            row.extend(y);
            row.extend(self.observables.iter().map(|(_, phi)| phi(y)));
            for (index, Invariant { degree, .. }) in invariants.iter().enumerate() {
                let (value, initial) = (system.invariant(index, y), system.invariant(index, y0));
                let law = (-degree * damped).exp() * initial;
                row.extend([value, if initial == 0.0 { value } else { (value - law) / law.abs() }]);
            }
            row
        };
        let steps = ladder.coarse_steps();
        let saved = |n: u64| n.is_multiple_of(self.every) || n == steps;
        let damped = damping_integrals(problem.damping(), steps, tau, &saved)?;
        let saved_row = |n: u64, y: [f64; D]| saved(n).then(|| row(n, damped[&n], y));
        let count = paths.end.saturating_sub(paths.start);
        let ladder = ladder.describing(count as usize);
        let measured =
            ladder.run_from(paths.start, count, || PathRecords::new(&saved_row), &|_| ());
        let mut of_path = measured.statistic.of_path;
        let series = paths.map(|path| {
            let mut rows = vec![row(0, 0.0, y0)];
            rows.extend(of_path.remove(&path).unwrap_or_default());
            let columns = names.iter().enumerate().map(|(number, name)| Column {
                name: name.clone(),
                values: rows.iter().map(|row| row[number]).collect(),
            });
            let failure = measured.failures.iter().find(|failure| failure.path == path);
            TimeSeries {
                system: system.name().into(),
                damping: problem.damping().describe(),
                scheme: self.scheme.id().into(),
                tau,
                noise: origin(path),
                halted: failure.map(|&PathFailure { step, cause, .. }| {
                    format!("step {step} of size {tau}, at t = {}: {cause}", step as f64 * tau)
                }),
                columns: columns.collect(),
            }
        });
        Ok(series.collect())
    }
}

/// ∫γ from 0 to the end of every saved step. Compensated summation (Kahan 1965)
/// of the integrals over the steps keeps rounding errors from accumulating in the conformal law.
fn damping_integrals(
    damping: &dyn Damping,
    steps: u64,
    tau: f64,
    saved: &dyn Fn(u64) -> bool,
) -> Result<BTreeMap<u64, f64>, LadderError> {
    let (mut damped, mut lost) = (0.0, 0.0);
    let mut integrals = BTreeMap::new();
    for n in 1..=steps {
        let term = Step::new(damping, n - 1, tau)?.damping_integral() - lost;
        let sum = damped + term;
        lost = (sum - damped) - term;
        damped = sum;
        if saved(n) {
            integrals.insert(n, damped);
        }
    }
    Ok(integrals)
}
