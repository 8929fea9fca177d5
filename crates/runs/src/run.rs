//! Paths and their statistics.

use std::time::Instant;

use casimir::{
    analysis::{StepCheck, block_starts, checked_paths, is_by_blocks, step_check},
    mc::{Observe, Role, RunError, Setup, Simulation, TimeSeries, parts::Job},
    schemes::BuiltIn,
    stats::Warning,
    study::{Kind, Series, Study, StudyResult, StudySettings, Summary},
    systems::Linearity,
};

use crate::{
    failure::{Done, Failure},
    large,
    output::{self, Array},
    watch::Watch,
};
use scenes::{AUTO, Combination, Observable, Quantity, Scene, Sweep, model::Known};

/// A scheme, and why it was chosen if that was left to the program, or what it loses over long
/// times: what `plan` settles, so that no part inspects the system.
pub type Settled = (String, Option<String>);

/// The scheme of a scene.
pub fn scheme(scene: &Scene) -> Settled {
    let (auto, because) = scene.model.recommended();
    let named = &scene.settings.scheme;
    if named == AUTO {
        return (auto.into(), Some(because));
    }
    let system = scene.model.system().description();
    let constant = system.linearity == Linearity::Constant;
    let explicit = BuiltIn::named(named).filter(|of| of.is_explicit(constant) && !system.plain);
    let loses = |scheme: BuiltIn| format!("{}; auto takes {auto}", scheme.long_times(constant));
    (named.clone(), explicit.map(loses))
}

/// Results of a run.
pub struct Results {
    /// Name of the scheme.
    pub scheme: String,
    /// Reason for the scheme, if it was left to the program.
    pub because: Option<String>,
    /// Facts about the system.
    pub known: Known,
    /// Tables of the first paths.
    pub tables: Vec<TimeSeries>,
    /// Statistics of all paths, if there are many.
    pub study: Option<StudyResult>,
    /// The means of a few paths in time.
    pub(crate) means: Vec<Series>,
    /// Check of the step errors.
    pub check: Option<StepCheck>,
    /// Correlations and structure factors of a large lattice.
    pub spectra: Vec<Array>,
    /// Seconds of the computation.
    pub seconds: f64,
}

/// The schemes of all combinations.
pub fn settle(sweep: &Sweep) -> Vec<Settled> {
    sweep.combinations.iter().map(|one| scheme(&one.scene)).collect()
}

/// The runs of all combinations, checked.
pub fn ready(sweep: &Sweep, settled: Vec<Settled>) -> Done<Vec<Ready<'_>>> {
    let both = sweep.combinations.iter().zip(settled);
    both.map(|(combination, settled)| Ready::new(combination, settled)).collect()
}

/// Computes runs one after the other; none where another part has it, or it was not begun.
pub fn compute<'a>(
    sweep: &'a Sweep,
    ready: Vec<Ready<'a>>,
    job: &Job,
    watch: &Watch,
) -> Done<Outcomes<'a>> {
    let is_stopped = || watch.stop.is_asked();
    let one = |ready: Ready<'_>| if is_stopped() { Ok(None) } else { ready.compute(job, watch) };
    Ok(Outcomes { sweep, results: ready.into_iter().map(one).collect::<Done<_>>()? })
}

/// Results at each combination of a sweep.
pub struct Outcomes<'a> {
    /// Scenes of the sweep.
    pub sweep: &'a Sweep,
    /// Results in the order of the combinations; none where they are not here.
    pub results: Vec<Option<Results>>,
}

impl Outcomes<'_> {
    /// Combinations with their results.
    pub fn found(&self) -> impl Iterator<Item = (&Combination, &Results)> {
        let both = self.sweep.combinations.iter().zip(&self.results);
        both.filter_map(|(combination, results)| Some((combination, results.as_ref()?)))
    }

    /// Whether there is nothing after t = 0.
    pub fn are_empty(&self) -> bool {
        self.found().all(|(_, results)| match &results.study {
            Some(study) => study.record.paths == 0,
            None => results.tables.iter().all(|table| table.times().len() < 2),
        })
    }

    /// Refuses results of which no path came to its end.
    ///
    /// # Errors
    /// The last failure.
    pub fn check(&self) -> Done {
        let failures: Option<Vec<_>> = self.found().map(|(_, found)| found.all_failed()).collect();
        if let Some(last) = failures.and_then(|mut failures| failures.pop()) {
            let words = "all paths failed: take more steps, or another scheme";
            return Err(Failure::Run(format!("{words}; {last}")));
        }
        Ok(())
    }
}

impl Results {
    /// Number of paths.
    pub fn paths(&self) -> u64 {
        self.study.as_ref().map_or(self.tables.len() as u64, |study| study.record.paths)
    }

    /// Observables in time: statistics of many paths, the mean of a few.
    pub fn series(&self) -> &[Series] {
        self.study.as_ref().map_or(&self.means, |study| &study.series)
    }

    /// Autocorrelations and spectra.
    pub fn lagged(&self) -> &[Series] {
        self.study.as_ref().map_or(&[], |study| &study.lagged)
    }

    /// The first failure, if no path came to its end.
    fn all_failed(&self) -> Option<String> {
        match &self.study {
            Some(study) if study.losses.failed < study.record.paths => None,
            Some(study) => study.losses.failures.first().cloned(),
            None => self.tables.iter().map(|table| table.halted.clone()).min()?,
        }
    }

    /// Whether the study was stopped, and so the tables, which come last.
    fn lacks_tables(&self, scene: &Scene) -> bool {
        self.study.as_ref().is_some_and(|study| study.record.paths < scene.settings.paths)
    }

    /// The paths of the tables that ended early, and why.
    pub fn halted(&self, scene: &Scene) -> impl Iterator<Item = (usize, &String)> {
        let tables = if self.lacks_tables(scene) { &[] } else { &self.tables[..] };
        let all = tables.iter().enumerate();
        all.filter_map(|(path, table)| Some((path, table.halted.as_ref()?)))
    }

    /// Warnings about single paths, the steps and the statistics.
    pub fn warnings(&self, scene: &Scene) -> Vec<Warning> {
        let Self { study, known, .. } = self;
        let mut all = Vec::from_iter(known.mistake.clone().map(Warning::new));
        all.extend(output::step_lines(self, scene));
        all.extend(study.iter().flat_map(|study| study.warnings.clone()));
        let of_path = |(path, halted)| Warning::new(format!("path {path}: {halted}"));
        all.extend(self.halted(scene).map(of_path));
        if self.lacks_tables(scene) {
            all.push(Warning::new("stopped before the tables of single paths, which come last"));
        }
        if study.is_none() && !(scene.wanted.pairs.is_empty() && scene.wanted.lagged.is_empty()) {
            let few = Warning::new("pairs and autocorrelations are of 100 paths or more");
            all.push(few.with_remedy("take more `paths`"));
        }
        all
    }
}

/// The means of the observables of a few paths in time.
pub fn means(scene: &Scene, tables: &[TimeSeries]) -> Vec<Series> {
    let longest = tables.iter().map(|table| table.times()).max_by_key(|times| times.len());
    let series = |Observable { name, .. }: &Observable| {
        let columns: Vec<&[f64]> = tables.iter().filter_map(|table| table.column(name)).collect();
        let point = |(k, &time): (usize, &f64)| {
            let values = columns.iter().filter_map(|values| values.get(k));
            let (sum, count) = values.fold((0.0, 0), |(sum, n), value| (sum + value, n + 1));
            Summary { time, count, mean: Some(sum / count as f64), ..Summary::default() }
        };
        let points = longest.unwrap_or_default().iter().enumerate().map(point).collect();
        Series { observable: name.clone(), kind: Kind::Observable, points }
    };
    scene.observables.iter().map(series).collect()
}

/// A checked run.
pub struct Ready<'a> {
    combination: &'a Combination,
    /// None of a large lattice.
    setup: Option<Setup<'a>>,
    settled: Settled,
}

impl<'a> Ready<'a> {
    /// Checks that the scheme can be run.
    pub fn new(combination: &'a Combination, settled: Settled) -> Done<Self> {
        let scene = &combination.scene;
        if let Some(large) = scene.model.large() {
            large::check(scene, large, &settled.0)?;
            return Ok(Self { combination, setup: None, settled });
        }
        let setup = scene.collecting(scene.setup(&settled.0)?);
        let settings = &scene.settings;
        if setup.scheme.about().clips_increments
            && let Err(error) = settings.truncation.bound(settings.until / settings.steps as f64)
        {
            let least = settings.until.floor() as u64 + 1;
            return Err(scene.steps_error(format_args!(
                "{} truncates increments: {error}. Take at least {least} steps, or leave out \
                 `truncation`",
                setup.scheme.about().id
            )))?;
        }
        Ok(Self { combination, setup: Some(setup), settled })
    }

    /// Computes tables and statistics; none if another part has them.
    pub fn compute(self, job: &Job, watch: &Watch) -> Done<Option<Results>> {
        let start = Instant::now();
        let Self { combination, setup, settled } = self;
        let Some(setup) = setup else {
            let Some(large) = combination.scene.model.large() else { return Ok(None) };
            return large::compute(combination, large, settled, job, watch);
        };
        let (scheme, because) = settled;
        let (scene, prefix) = (&combination.scene, combination.prefix());
        job.section(&prefix);
        let Scene { components, observables, settings, model, .. } = scene;
        let (steps, truncation, key) = (settings.steps, settings.truncation, settings.key);
        let wrong = |error| match error {
            RunError::Memory(_) => Failure::from(error),
            error => scene.steps_error(error).into(),
        };
        let simulation = Simulation::new(setup.clone(), truncation);
        let mut simulation = simulation.every(steps / settings.times);
        (simulation.components, simulation.stop) = (components.clone(), watch.stop.clone());
        let is_component = |phi: &&Observable| matches!(phi.quantity, Quantity::Component(_));
        for observable in observables.iter().filter(|phi| !is_component(phi)) {
            simulation = simulation.observing(observable.clone());
        }
        simulation.demand(steps, settings.tables).map_err(wrong)?;
        let mut study = None;
        if settings.is_study() {
            let wanted = StudySettings {
                wanted: scene.wanted.clone(),
                stop: watch.stop.clone(),
                ..StudySettings::new(steps, settings.times, settings.paths, truncation, key)
            };
            let new = || Study::new(&setup, observables, &wanted);
            let of_all = watch.under(&format!("{prefix}bins"), 0, |_| new()).map_err(wrong)?;
            if watch.stop.is_asked() {
                return Ok(None);
            }
            let (what, cost) = (format!("{prefix}paths"), settings.paths.saturating_mul(steps));
            study = watch.under(&what, cost, |told| of_all.telling(told).run_in(job, "study"));
        }
        let tables_of = |simulation: Simulation<'_>| {
            let (what, cost) = (format!("{prefix}tables"), settings.tables.saturating_mul(steps));
            let paths = |told: &(dyn Fn(u64) + Sync)| {
                let mut simulation = simulation;
                simulation.told = Box::new(told);
                simulation.paths(steps, key, 0..settings.tables)
            };
            watch.under(&what, cost, paths).map_err(wrong)
        };
        // Blocks of time begin at the states of path 0.
        let by_blocks = !scene.collects() && is_by_blocks(settings.paths, steps, &setup.problem);
        let (tables, simulation) = match by_blocks {
            true => (tables_of(simulation)?, None),
            false => (Vec::new(), Some(simulation)),
        };
        let columns = tables.first().map(|table| table.columns.iter());
        let columns = columns.map(|all| all.filter(|column| column.role == Role::Component));
        let starts = columns.map(|all| all.map(|column| &column.values[..]).collect::<Vec<_>>());
        let starts = starts.filter(|_| !watch.stop.is_asked()).map(|all| block_starts(&all));
        let checked = checked_paths(settings.paths, &setup.problem);
        let phi: Vec<&dyn Observe> = observables.iter().map(|phi| phi as _).collect();
        let (what, cost) = (format!("{prefix}step errors"), steps.saturating_mul(3 * checked));
        let check = watch.under(&what, cost, |told| {
            let fastest = model.fastest();
            let of = (steps, checked, starts.as_deref());
            step_check(&setup, &phi, of, fastest, (truncation, key), (job, told))
        });
        let check = check.map_err(|error| scene.steps_error(error))?;
        if settings.is_study() && study.is_none() {
            return Ok(None);
        }
        let tables = match simulation {
            Some(simulation) => tables_of(simulation)?,
            None => tables,
        };
        let means = if study.is_none() { means(scene, &tables) } else { Vec::new() };
        let (known, seconds) = (model.known(), start.elapsed().as_secs_f64());
        let spectra = Vec::new();
        let found =
            Results { scheme, because, known, tables, study, means, check, spectra, seconds };
        Ok(Some(found))
    }
}
