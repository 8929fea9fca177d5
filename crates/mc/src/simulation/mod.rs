//! Paths with what was observed along them, as tables.

mod error;
mod series;
mod write;

use std::ops::Range;

use noise::{StreamKey, Truncation};
use schemes::Scheme;
use systems::{Damping, PoissonSystem, Problem};

use crate::follow::{Drawn, NoiseSource, follow};
use crate::parallel::in_parallel;
use crate::recording::{Played, TIME_AGREEMENT};
use crate::{LadderError, Recording};
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
        if steps == 0 {
            return Err(LadderError::Steps { steps, multiple_of: 1 }.into());
        }
        let tau = self.problem.t_end / steps as f64;
        let mut noise = Drawn::new(key, path, tau, self.scheme.needs_areas())?;
        let origin = NoiseOrigin::Drawn { seed: key.seed, experiment: key.experiment, path };
        self.run(steps, &mut noise, origin)
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
        in_parallel(paths, &|path| self.path(steps, key, path)).into_iter().collect()
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
        if self.scheme.needs_areas() && recording.areas().is_none() {
            return Err(SimulationError::NoAreas { scheme: self.scheme.id() });
        }
        self.run(steps as u64, &mut Played { recording, n: 0 }, NoiseOrigin::Recorded)
    }

    fn run(
        &self,
        steps: u64,
        noise: &mut dyn NoiseSource<M>,
        origin: NoiseOrigin,
    ) -> Result<TimeSeries, SimulationError> {
        if self.every == 0 {
            return Err(SimulationError::Every);
        }
        let (problem, tau) = (self.problem, self.problem.t_end / steps as f64);
        let mut series = TimeSeries {
            system: problem.system.name().to_owned(),
            damping: problem.damping.describe(),
            scheme: self.scheme.id().to_owned(),
            tau,
            noise: origin,
            halted: None,
            columns: Vec::new(),
        };
        for name in ["t".to_owned()].into_iter().chain((1..=D).map(|i| format!("y{i}"))) {
            series.add_column(name)?;
        }
        for (name, _) in &self.observables {
            series.add_column(name.clone())?;
        }
        let invariants = InvariantColumn::of(&problem.system, problem.y0);
        for invariant in &invariants {
            series.add_column(invariant.name.clone())?;
            series.add_column(format!("{} defect", invariant.name))?;
        }
        let mut damped = 0.0;
        // What the sum of the step integrals has lost to rounding (Kahan), so that the law is not
        // what drifts.
        let mut lost = 0.0;
        let mut row = Vec::with_capacity(series.columns.len());
        let mut keep = |n: u64, integral: f64, y: [f64; D]| {
            let term = integral - lost;
            let sum = damped + term;
            lost = (sum - damped) - term;
            damped = sum;
            if n.is_multiple_of(self.every) || n == steps {
                row.clear();
                row.push(n as f64 * tau);
                row.extend(y);
                row.extend(self.observables.iter().map(|(_, phi)| phi(y)));
                for (index, invariant) in invariants.iter().enumerate() {
                    let value = problem.system.invariant(index, y);
                    row.extend([value, invariant.defect(value, damped)]);
                }
                for (column, &value) in series.columns.iter_mut().zip(&row) {
                    column.values.push(value);
                }
            }
        };
        keep(0, 0.0, problem.y0);
        let halt = follow(problem, self.scheme, steps, self.truncation, noise, keep)?;
        series.halted = halt.map(|(step, cause)| {
            format!("step {step} of size {tau}, at t = {}: {cause}", step as f64 * tau)
        });
        Ok(series)
    }
}
