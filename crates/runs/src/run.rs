//! Paths and their statistics.

use std::{iter::zip, time::Instant};

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
use scenes::{AUTO, Combination, Observable, Quantity, Scene, Sweep};

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
    (
        named.clone(),
        BuiltIn::named(named)
            .filter(|scheme| scheme.is_explicit(constant) && !system.plain)
            .map(|scheme| format!("{}; auto takes {auto}", scheme.long_times(constant))),
    )
}

/// Results of a run.
pub struct Results {
    /// Name of the scheme.
    pub scheme: String,
    /// Reason for the scheme, if it was left to the program.
    pub because: Option<String>,

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
    zip(&sweep.combinations, settled).map(|(one, settled)| Ready::new(one, settled)).collect()
}

/// Computes runs one after the other; none where another part has it, or it was not begun.
pub fn compute<'a>(
    sweep: &'a Sweep,
    ready: Vec<Ready<'a>>,
    job: &Job,
    watch: &Watch,
) -> Done<Outcomes<'a>> {
    Ok(Outcomes {
        sweep,
        results: ready
            .into_iter()
            .map(|ready| if watch.stop.is_asked() { Ok(None) } else { ready.compute(job, watch) })
            .collect::<Done<_>>()?,
    })
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
        zip(&self.sweep.combinations, &self.results)
            .filter_map(|(combination, results)| Some((combination, results.as_ref()?)))
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
        tables.iter().enumerate().filter_map(|(path, table)| Some((path, table.halted.as_ref()?)))
    }

    /// Warnings about single paths, the steps and the statistics.
    pub fn warnings(&self, scene: &Scene) -> Vec<Warning> {
        let Self { study, .. } = self;
        let mut all = Vec::from_iter(scene.model.known().warnings());
        all.extend(output::step_lines(self, scene));
        all.extend(study.iter().flat_map(|study| study.warnings.clone()));
        all.extend(
            self.halted(scene).map(|(path, why)| Warning::new(format!("path {path}: {why}"))),
        );
        if self.lacks_tables(scene) {
            all.push(Warning::new("stopped before the tables of single paths, which come last"));
        }
        if study.is_none() && !(scene.wanted.pairs.is_empty() && scene.wanted.lagged.is_empty()) {
            all.push(
                Warning::new("pairs and autocorrelations are of 100 paths or more")
                    .with_remedy("take more `paths`"),
            );
        }
        all
    }
}

/// The means of the observables of a few paths in time.
pub fn means(scene: &Scene, tables: &[TimeSeries]) -> Vec<Series> {
    let longest = tables.iter().map(TimeSeries::times).max_by_key(|times| times.len());
    scene
        .observables
        .iter()
        .map(|Observable { name, .. }| {
            let columns: Vec<&[f64]> =
                tables.iter().filter_map(|table| table.column(name)).collect();
            Series {
                observable: name.clone(),
                kind: Kind::Observable,
                points: longest
                    .unwrap_or_default()
                    .iter()
                    .enumerate()
                    .map(|(k, &time)| {
                        let (sum, count) = columns
                            .iter()
                            .filter_map(|values| values.get(k))
                            .fold((0.0, 0), |(sum, n), value| (sum + value, n + 1));
                        Summary {
                            time,
                            count,
                            mean: Some(sum / count as f64),
                            ..Summary::default()
                        }
                    })
                    .collect(),
            }
        })
        .collect()
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
    fn new(combination: &'a Combination, settled: Settled) -> Done<Self> {
        let scene = &combination.scene;
        if let Some(large) = scene.model.large() {
            large::check(scene, large, &settled.0)?;
            return Ok(Self { combination, setup: None, settled });
        }
        let setup = scene.collecting(scene.setup(&settled.0)?);
        let (about, settings) = (setup.scheme.about(), &scene.settings);
        if about.clips_increments
            && let Err(error) = settings.truncation.bound(settings.until / settings.steps as f64)
        {
            let least = settings.until.floor() as u64 + 1;
            return Err(scene.steps_error(format_args!(
                "{} truncates increments: {error}. Take at least {least} steps, or leave out \
                 `truncation`",
                about.id
            )))?;
        }
        Ok(Self { combination, setup: Some(setup), settled })
    }

    /// Computes tables and statistics; none if another part has them.
    fn compute(self, job: &Job, watch: &Watch) -> Done<Option<Results>> {
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
        let mut simulation =
            Simulation::new(setup.clone(), truncation).every(steps / settings.times);
        (simulation.components, simulation.stop) = (components.clone(), watch.stop.clone());
        for observable in observables {
            if !matches!(observable.quantity, Quantity::Component(_)) {
                simulation = simulation.observing(observable.clone());
            }
        }
        simulation.demand(steps, settings.tables).map_err(wrong)?;
        let mut study = None;
        if settings.is_study() {
            let wanted = StudySettings {
                wanted: scene.wanted.clone(),
                stop: watch.stop.clone(),
                ..StudySettings::new(steps, settings.times, settings.paths, truncation, key)
            };
            let of_all = watch
                .under(&format!("{prefix}bins"), 0, |_| Study::new(&setup, observables, &wanted))
                .map_err(wrong)?;
            if watch.stop.is_asked() {
                return Ok(None);
            }
            study = watch.under(
                &format!("{prefix}paths"),
                settings.paths.saturating_mul(steps),
                |told| of_all.telling(told).run_in(job, "study"),
            );
        }
        let tables_of = |simulation: Simulation<'_>| {
            watch
                .under(&format!("{prefix}tables"), settings.tables.saturating_mul(steps), |told| {
                    let mut simulation = simulation;
                    simulation.told = Box::new(told);
                    simulation.paths(steps, key, 0..settings.tables)
                })
                .map_err(wrong)
        };
        // Blocks of time begin at the states of path 0.
        let by_blocks = !scene.collects() && is_by_blocks(settings.paths, steps, &setup.problem);
        let (tables, simulation) =
            if by_blocks { (tables_of(simulation)?, None) } else { (Vec::new(), Some(simulation)) };
        let starts = tables.first().filter(|_| !watch.stop.is_asked()).map(|table| {
            block_starts(
                &table
                    .columns
                    .iter()
                    .filter(|column| column.role == Role::Component)
                    .map(|column| &*column.values)
                    .collect::<Vec<_>>(),
            )
        });
        let checked = checked_paths(settings.paths, &setup.problem);
        let phi: Vec<&dyn Observe> = observables.iter().map(|phi| phi as _).collect();
        let check = watch
            .under(&format!("{prefix}step errors"), steps.saturating_mul(3 * checked), |told| {
                step_check(
                    &setup,
                    &phi,
                    (steps, checked, starts.as_deref()),
                    model.fastest(),
                    (truncation, key),
                    (job, told),
                )
            })
            .map_err(|error| scene.steps_error(error))?;
        if settings.is_study() && study.is_none() {
            return Ok(None);
        }
        let tables = simulation.map_or(Ok(tables), tables_of)?;
        let means = if study.is_none() { means(scene, &tables) } else { Vec::new() };
        let seconds = start.elapsed().as_secs_f64();
        let found =
            Results { scheme, because, tables, study, means, check, spectra: Vec::new(), seconds };
        Ok(Some(found))
    }
}
