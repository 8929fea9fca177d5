//! Tables of paths with observables and invariants.

mod series;

use std::{collections::BTreeMap, ops::Range};

use noise::{Purpose, StreamKey, Truncation};
use schemes::Step;

use crate::{
    ConformalLaw, LadderError, NextNoise, NoiseSource, Observe, PathFailure, Problem, RunError,
    Setup, Statistic, View, demand, parts::Stop,
};

pub use series::{Column, NoiseOrigin, Role, TimeSeries, quoted, write_csv};

/// Simulation of paths of a problem by a scheme. The table of each path contains time, state,
/// observables, and every invariant of the system with its relative defect from the conformal law.
/// All tables are kept in memory.
///
/// ```
/// use mc::{Setup, Simulation, StateFunction, write_csv};
/// use noise::{StreamKey, Truncation};
/// use schemes::Sexp;
/// use systems::{Constant, MaxwellBloch, Problem};
///
/// let problem = Problem::new(MaxwellBloch, Constant::new(0.1)?, [1.0, 2.0, 3.0], 5.0)?;
/// let sexp = Sexp;
/// let simulation = Simulation::new(Setup::of(&problem, &sexp), Truncation::new(4)?)
///     .every(100)
///     .observing(StateFunction::new("intensity", |y: [f64; 3]| y[0] * y[0]));
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
pub struct Simulation<'a> {
    setup: Setup<'a>,
    truncation: Truncation,
    every: u64,
    observables: Vec<Box<dyn Observe + 'a>>,
    noise: Option<NoiseSource<'a>>,
    /// Names of the columns of the state, one for each component; `y1` … `yD` unless set.
    pub components: Vec<String>,
    /// Flag that ends all tables early; [`TimeSeries::halted`] says so.
    pub stop: Stop,
    /// Callback, from any thread, with the number of path-steps done since its last call.
    pub told: Box<dyn Fn(u64) + Sync + 'a>,
}

impl<'a> Simulation<'a> {
    /// A simulation that saves every step and has no observables.
    pub fn new(setup: Setup<'a>, truncation: Truncation) -> Self {
        Self {
            truncation,
            every: 1,
            observables: Vec::new(),
            noise: None,
            components: (1..=setup.problem.y0.len()).map(|i| format!("y{i}")).collect(),
            stop: Stop::default(),
            told: Box::new(|_| ()),
            setup,
        }
    }

    /// Saves only every `every`-th step, the initial state and the last step.
    #[must_use]
    pub fn every(mut self, every: u64) -> Self {
        self.every = every;
        self
    }

    /// Adds a column with an observable φ(y), for example a
    /// [`StateFunction`](crate::StateFunction).
    #[must_use]
    pub fn observing(mut self, observable: impl Observe + 'a) -> Self {
        self.observables.push(Box::new(observable));
        self
    }

    /// Takes the increments from `source` instead of drawing them, for example those of another
    /// program: a [`NoiseSource`]. They are truncated like drawn increments, unless the simulation
    /// has [`Truncation::none`].
    ///
    /// ```
    /// use mc::{NextNoise, Setup, Simulation};
    /// use noise::{StreamKey, Truncation, WienerPath};
    /// use schemes::Sexp;
    /// use systems::{Constant, Pendulum, Problem};
    ///
    /// let problem = Problem::new(Pendulum::new(1.0)?, Constant::new(2.0)?, [0.2, 1.0], 1.0)?;
    /// let drawn = Simulation::new(Setup::of(&problem, &Sexp), Truncation::new(4)?);
    /// let key = StreamKey { seed: 1, experiment: 0 };
    /// // Those of path 7, on every path.
    /// let source = |_first_path| -> NextNoise {
    ///     let mut wiener = WienerPath::<1>::new(key, 7);
    ///     Box::new(move |noise| noise.increments[0].fill(wiener.increments(0.125)[0]))
    /// };
    /// let given = Simulation::new(Setup::of(&problem, &Sexp), Truncation::new(4)?);
    /// let given = given.with_noise(source);
    /// assert_eq!(given.path(64, key, 0)?.columns, drawn.path(64, key, 7)?.columns);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn with_noise(mut self, source: impl Fn(u64) -> NextNoise + Sync + 'a) -> Self {
        self.noise = Some(Box::new(source));
        self
    }

    /// The table of path number `path` in `steps` steps to the final time.
    ///
    /// # Errors
    /// [`RunError::Ladder`] as in [`Setup::ladder`]. [`RunError::Setting`] if `every` is zero, or
    /// two columns have the same name.
    pub fn path(&self, steps: u64, key: StreamKey, path: u64) -> Result<TimeSeries, RunError> {
        Ok(self.paths(steps, key, path..path + 1)?.swap_remove(0))
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
    ) -> Result<Vec<TimeSeries>, RunError> {
        let every = self.every as f64;
        RunError::unmet([(
            every > 0.0,
            "number of steps between saved ones",
            "at least 1",
            every,
        )])?;
        let (Setup { problem, scheme }, count) =
            (&self.setup, paths.end.saturating_sub(paths.start));
        let ladder = self.setup.ladder(steps, 0, self.truncation, (key, Purpose::Paths), count)?;
        let mut ladder = ladder.describing(count as usize).with_start().telling(&self.told);
        if let Some(source) = &self.noise {
            ladder = ladder.with_noise(source);
        }
        let (empty, tau) = (self.columns()?, ladder.tau(0));
        self.demand(steps, count)?;
        let decays = self.decays(steps, tau)?;
        let components = problem.y0.len();
        let none = || {
            let mut columns = empty.clone();
            columns.iter_mut().for_each(|column| column.values.reserve_exact(decays.len()));
            columns
        };
        let save = |view: &View<'_>, of_path: &mut Columns| {
            let Some(decays) = decays.get(&view.time) else { return };
            let observed = self.observables.iter().map(|phi| phi.values(view.state(0), view.live));
            let observed: Vec<_> = observed.collect();
            for p in view.live.paths() {
                let columns = of_path.entry(view.first_path + p as u64).or_insert_with(none);
                let state = &view.state(0)[..components];
                let y: Vec<f64> = state.iter().map(|row| row[p]).collect();
                let observed = observed.iter().map(|values| values[p]);
                let row = [view.time as f64 * tau].into_iter().chain(y.iter().copied());
                let (plain, of_laws) = columns.split_at_mut(1 + components + observed.len());
                plain.iter_mut().zip(row.chain(observed)).for_each(|(of, x)| of.values.push(x));
                let of_laws = of_laws.as_chunks_mut().0.iter_mut().zip(&problem.laws);
                for (([function, defect], conformal), decay) in of_laws.zip(decays) {
                    let value = (conformal.value)(&y);
                    function.values.push(value);
                    let initial = function.values[0];
                    let exact = decay * initial;
                    let relative = (value - exact) / exact.abs();
                    defect.values.push(if initial == 0.0 { value } else { relative });
                    if let Role::Defect { law, .. } = &mut defect.role {
                        law.push(exact);
                    }
                }
            }
        };
        let new = || PathColumns { save: &save, of_path: BTreeMap::new() };
        let measured = ladder.run_until(&self.stop, paths.start, count, new);
        let mut of_path = measured.statistic.of_path;
        let series = paths.map(|path| {
            let columns = of_path.remove(&path).unwrap_or_else(none);
            let end = columns[0].values.last().map_or(0.0, |t| *t);
            let failure = measured.failures.iter().find(|failure| failure.path == path);
            let halted = failure.map(|&PathFailure { step, cause, .. }| {
                format!("step {step} of size {tau}, at t = {}: {cause}", step as f64 * tau)
            });
            let stopped = (self.stop.is_asked() && end < steps as f64 * tau)
                .then(|| format!("stopped after t = {end}"));
            TimeSeries {
                system: problem.name.clone(),
                damping: problem.describe_damping(),
                scheme: scheme.about().id.into(),
                tau,
                noise: NoiseOrigin { seed: key.seed, experiment: key.experiment, path },
                halted: halted.or(stopped),
                columns,
            }
        });
        Ok(series.collect())
    }

    /// Refuses tables of `paths` paths that need more memory than is free: twice that of their
    /// numbers, which are gathered before they are given.
    ///
    /// # Errors
    /// [`RunError::Memory`], or [`RunError::Setting`] if two columns have the same name.
    pub fn demand(&self, steps: u64, paths: u64) -> Result<(), RunError> {
        let (columns, times) = (self.columns()?.len(), steps / self.every.max(1) + 1);
        let what = format!("tables of {paths} paths, {columns} columns and {times} times");
        let numbers = (columns + self.setup.problem.laws.len()) as f64 * times as f64;
        Ok(demand(what, 16.0 * numbers * (paths + 1) as f64)?)
    }

    /// The columns, without values.
    fn columns(&self) -> Result<Vec<Column>, RunError> {
        let problem = &self.setup.problem;
        let named = self.components.len();
        let all = named == problem.y0.len();
        RunError::unmet([(all, "number of names", "that of components", named as f64)])?;
        let column = |name: &str, role| Column { name: name.into(), role, values: Vec::new() };
        let mut columns = vec![column("t", Role::Time)];
        columns.extend(self.components.iter().map(|name| column(name, Role::Component)));
        columns.extend(self.observables.iter().map(|phi| column(phi.name(), Role::Observable)));
        for (index, ConformalLaw { name, .. }) in problem.laws.iter().enumerate() {
            let same = |among: &[ConformalLaw]| among.iter().filter(|i| i.name == *name).count();
            let of = match same(&problem.laws) {
                1 => name.clone(),
                _ => format!("{name}{}", 1 + same(&problem.laws[..index])),
            };
            columns.push(column(&of, Role::Conserved));
            let defect = format!("{of} defect");
            columns.push(column(&defect, Role::Defect { of, law: Vec::new() }));
        }
        let names: Vec<&String> = columns.iter().map(|column| &column.name).collect();
        RunError::twice("columns", &names)?;
        Ok(columns)
    }

    /// Factor of each law from 0 to time 0 and to the end of every saved step, by the number of
    /// steps. Compensated summation (Kahan 1965) of the integrals of the dampings over the steps
    /// prevents rounding errors from accumulating in the conformal law.
    fn decays(&self, steps: u64, tau: f64) -> Result<BTreeMap<u64, Vec<f64>>, LadderError> {
        let problem @ Problem { laws, .. } = &self.setup.problem;
        let none = if laws.is_empty() { 0 } else { usize::MAX };
        let dampings: Vec<_> = problem.dampings().take(none).collect();
        let decays = |damped: &[f64]| laws.iter().map(|law| law.decay(damped)).collect();
        let (mut damped, mut lost) = (vec![0.0; dampings.len()], vec![0.0; dampings.len()]);
        let mut at = BTreeMap::from([(0, decays(&damped))]);
        for n in (1..=steps).take_while(|_| !self.stop.is_asked()) {
            for (k, damping) in dampings.iter().enumerate() {
                let term = Step::new(*damping, n - 1, tau)?.damping_integral() - lost[k];
                let sum = damped[k] + term;
                lost[k] = (sum - damped[k]) - term;
                damped[k] = sum;
            }
            if n.is_multiple_of(self.every) || n == steps {
                at.insert(n, decays(&damped));
            }
        }
        Ok(at)
    }
}

/// The columns of every path.
type Columns = BTreeMap<u64, Vec<Column>>;

/// The saved columns, and the function that adds a row of a block to those of its paths.
struct PathColumns<F> {
    save: F,
    of_path: Columns,
}

impl<F: Fn(&View<'_>, &mut Columns) + Send> Statistic for PathColumns<F> {
    fn observe(&mut self, view: &View<'_>) {
        (self.save)(view, &mut self.of_path);
    }

    fn merge(&mut self, later: Self) {
        self.of_path.extend(later.of_path);
    }
}
