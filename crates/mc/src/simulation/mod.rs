//! Paths with what was observed along them, as tables.

mod error;
mod series;
mod write;

use std::collections::BTreeMap;
use std::ops::Range;

use noise::{StreamKey, Truncation};
use schemes::{Scheme, Step};
use systems::{Damping, PoissonSystem, Problem};

use crate::recording::TIME_AGREEMENT;
use crate::{Ladder, LadderError, PathFailure, Recording, Run, Statistic, View};
use series::InvariantColumn;

pub use error::SimulationError;
pub use series::{Column, NoiseOrigin, TimeSeries};
pub use write::{write_csv, write_json};

/// φ(y), observed along a path.
type Observed<'a, const D: usize> = Box<dyn Fn([f64; D]) -> f64 + Sync + 'a>;

/// A problem, a scheme, and what is kept of each path: time, state, observables, and every
/// invariant of the system with its relative defect from the conformal law. Keeps everything in
/// memory.
///
/// ```
/// use mc::{Simulation, write_csv};
/// use noise::{StreamKey, Truncation};
/// use schemes::Sexp;
/// use systems::{Constant, MaxwellBloch, Problem};
///
/// let problem = Problem::new(MaxwellBloch, Constant::new(0.1)?, [1.0, 2.0, 3.0], 5.0)?;
/// let sexp = Sexp::default();
/// let simulation =
///     Simulation::new(&problem, &sexp, Truncation::new(4)?).every(100).observing("intensity", |y| y[0] * y[0]);
/// let paths = simulation.paths(500, StreamKey { seed: 1, experiment: 0 }, 0..4)?;
/// assert_eq!(paths[3].times(), [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]);
/// assert!(paths[3].column("C defect").unwrap().iter().all(|defect| defect.abs() < 1e-13));
///
/// let mut csv = Vec::new();
/// write_csv(&paths, &mut csv)?;
/// assert!(csv.starts_with(b"scheme,path,t,y1,y2,y3,intensity,C,C defect\nsexp,0,0.0,1.0,2.0,3.0,1.0,6.5,0.0\n"));
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
    /// Keeps every step, and no observable yet.
    #[must_use]
    pub fn new(
        problem: &'a Problem<S, G, D>,
        scheme: &'a dyn Scheme<S, D, M>,
        truncation: Truncation,
    ) -> Self {
        Self { problem, scheme, truncation, every: 1, observables: Vec::new() }
    }

    /// Keeps every `every`-th step only; the start and the last step are kept in any case.
    #[must_use]
    pub fn every(mut self, every: u64) -> Self {
        self.every = every;
        self
    }

    /// Keeps φ(y) in a column of this name.
    #[must_use]
    pub fn observing(
        mut self,
        name: impl Into<String>,
        phi: impl Fn([f64; D]) -> f64 + Sync + 'a,
    ) -> Self {
        self.observables.push((name.into(), Box::new(phi)));
        self
    }

    /// Path number `path`, in `steps` steps to the final time: the states of
    /// [`trajectory`](crate::trajectory).
    ///
    /// # Errors
    /// [`SimulationError`] when there is no step, when every zeroth step is to be kept, when two
    /// columns have one name, when the truncation is not defined at T/steps, or when no number of
    /// terms is large enough for the scheme's Lévy areas.
    pub fn path(
        &self,
        steps: u64,
        key: StreamKey,
        path: u64,
    ) -> Result<TimeSeries, SimulationError> {
        let mut series = self.paths(steps, key, path..path + 1)?;
        Ok(series.swap_remove(0))
    }

    /// Many paths, in parallel on the current rayon pool and in the order of their numbers.
    ///
    /// # Errors
    /// As for [`path`](Self::path).
    pub fn paths(
        &self,
        steps: u64,
        key: StreamKey,
        paths: Range<u64>,
    ) -> Result<Vec<TimeSeries>, SimulationError> {
        let run = Run::new(self.scheme, 0);
        let ladder = Ladder::new(self.problem, steps, 0, self.truncation, key, vec![run])?;
        let StreamKey { seed, experiment } = key;
        self.run(ladder, paths, &|path| NoiseOrigin::Drawn { seed, experiment, path })
    }

    /// The path that recorded increments drive. They are truncated like drawn ones; with
    /// [`Truncation::none`] they are used as they are.
    ///
    /// # Errors
    /// As for [`path`](Self::path); and [`SimulationError::Duration`] when the recording does not
    /// end at the final time, [`SimulationError::NoAreas`] when the scheme reads Lévy areas and the
    /// recording has none.
    pub fn recorded(&self, recording: &Recording<M>) -> Result<TimeSeries, SimulationError> {
        let steps = recording.increments().len();
        let (recorded, t_end) = (recording.tau() * steps as f64, self.problem.t_end);
        let agree = (recorded - t_end).abs() <= TIME_AGREEMENT * t_end;
        if !agree {
            return Err(SimulationError::Duration { recorded, t_end });
        }
        if self.scheme.reads_areas() && recording.areas().is_none() {
            return Err(SimulationError::NoAreas { scheme: self.scheme.id() });
        }
        let (key, run) = (StreamKey { seed: 0, experiment: 0 }, Run::new(self.scheme, 0));
        let ladder = Ladder::new(self.problem, steps as u64, 0, self.truncation, key, vec![run])?
            .with_noise(recording);
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
        let invariants = InvariantColumn::of(&problem.system, problem.y0);
        let mut template = TimeSeries {
            system: problem.system.name().to_owned(),
            damping: problem.damping.describe(),
            scheme: self.scheme.id().to_owned(),
            tau,
            noise: NoiseOrigin::Recorded,
            halted: None,
            columns: Vec::new(),
        };
        for name in ["t".to_owned()].into_iter().chain((1..=D).map(|i| format!("y{i}"))) {
            template.add_column(name)?;
        }
        for (name, _) in &self.observables {
            template.add_column(name.clone())?;
        }
        for invariant in &invariants {
            template.add_column(invariant.name.clone())?;
            template.add_column(format!("{} defect", invariant.name))?;
        }
        // What is kept of step n, at which the damping has reached the integral `damped`.
        let row = |n: u64, damped: f64, y: [f64; D]| {
            let mut row = Vec::with_capacity(template.columns.len());
            row.push(n as f64 * tau);
            row.extend(y);
            row.extend(self.observables.iter().map(|(_, phi)| phi(y)));
            for (index, invariant) in invariants.iter().enumerate() {
                let value = problem.system.invariant(index, y);
                row.extend([value, invariant.defect(value, damped)]);
            }
            row
        };
        let steps = ladder.coarse_steps();
        let kept = |n: u64| n.is_multiple_of(self.every) || n == steps;
        let damped = damping_integrals(&problem.damping, steps, tau, &kept)?;
        let observe = |n: u64, y: [f64; D]| {
            kept(n).then(|| row(n, damped[damped.partition_point(|&(m, _)| m < n)].1, y))
        };
        let count = paths.end.saturating_sub(paths.start);
        let ladder = ladder.describing(count as usize);
        let new = || Rows { observe: &observe, of_path: BTreeMap::new() };
        let measured = ladder.run_from(paths.start, count, new, &|_| ());
        let mut of_path = measured.statistic.of_path;
        let series = paths.map(|path| {
            let mut series = template.clone();
            series.noise = origin(path);
            let failure = measured.failures.iter().find(|failure| failure.path == path);
            series.halted = failure.map(|&PathFailure { step, cause, .. }| {
                format!("step {step} of size {tau}, at t = {}: {cause}", step as f64 * tau)
            });
            let rows = of_path.remove(&path).unwrap_or_default();
            for row in [row(0, 0.0, problem.y0)].into_iter().chain(rows) {
                for (column, value) in series.columns.iter_mut().zip(row) {
                    column.values.push(value);
                }
            }
            series
        });
        Ok(series.collect())
    }
}

/// ∫γ from 0 to the end of every step n that is kept, with n. The sum of the integrals over the
/// steps is compensated (Kahan 1965), so that the law itself does not drift.
fn damping_integrals(
    damping: &dyn Damping,
    steps: u64,
    tau: f64,
    kept: &dyn Fn(u64) -> bool,
) -> Result<Vec<(u64, f64)>, LadderError> {
    let (mut damped, mut lost) = (0.0, 0.0);
    let mut integrals = Vec::new();
    for n in 1..=steps {
        let term = Step::new(damping, n - 1, tau)?.damping_integral() - lost;
        let sum = damped + term;
        lost = (sum - damped) - term;
        damped = sum;
        if kept(n) {
            integrals.push((n, damped));
        }
    }
    Ok(integrals)
}

/// What is kept of step n in the state y, if anything is.
type ObserveState<'a, const D: usize> = dyn Fn(u64, [f64; D]) -> Option<Vec<f64>> + Sync + 'a;

/// The rows of every path.
struct Rows<'a, const D: usize> {
    observe: &'a ObserveState<'a, D>,
    of_path: BTreeMap<u64, Vec<Vec<f64>>>,
}

impl<const D: usize> Statistic<D> for Rows<'_, D> {
    fn observe(&mut self, view: &View<'_, D>) {
        for p in view.live.paths() {
            if let Some(row) = (self.observe)(view.time, view.states[0].path(p)) {
                self.of_path.entry(view.first_path + p as u64).or_default().push(row);
            }
        }
    }

    fn merge(&mut self, later: Self) {
        self.of_path.extend(later.of_path);
    }
}
