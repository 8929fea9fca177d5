//! Statistics of many paths at many times, without keeping a path.
//!
//! A [`Study`] evaluates observables φ(y) at chosen times and keeps, for each observable and time,
//! the mean with its 95 % interval, variance, quantiles with intervals, the smallest and the
//! largest value and a histogram. Memory does not grow with the number of paths. Three observables
//! at 40 of 520 steps take a tenth of the time of the steps.
//!
//! ```
//! use mc::{Observable, Setup};
//! use study::{Study, StudySettings};
//! use noise::{StreamKey, Truncation};
//! use schemes::Sexp;
//! use systems::{Constant, Problem, RigidBody};
//!
//! // A symmetric top with noise about its axis: y₂ + iy₃ turns by a normal angle of variance
//! // y₁²t, so E[y₂] = ½exp(−t/2).
//! let body = RigidBody::one_noise([1.0, 1.0, 1.0], 1.0)?;
//! let problem = Problem::new(body, Constant::new(0.0)?, [1.0, 0.5, 0.0], 1.0)?;
//! let observables = [Observable { name: "y2", function: |y: [f64; 3]| y[1] }];
//! let key = StreamKey { seed: 1, experiment: 0 };
//! // 64 steps, 4 times, 2000 paths.
//! let settings = StudySettings::new(64, 4, 2000, Truncation::new(4)?, key);
//! let result = Study::new(&Setup::of(&problem, &Sexp), &observables, &settings)?.run();
//!
//! let last = result.series("y2").unwrap().last();
//! let (lo, hi) = last.mean_interval.unwrap();
//! let exact = 0.5 * (-0.5f64).exp();
//! assert!(last.time == 1.0 && lo < exact && exact < hi);
//! assert!(last.quantiles[2].level == 0.5 && result.warnings.is_empty());
//! result.write_csv(&mut std::io::sink())?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! **Histograms.** A pilot with streams of its own chooses bins for each observable and time: its
//! range and a margin. Values beyond are counted as underflow and overflow. Counts are integers, so
//! they do not depend on the order of paths.
//!
//! **Quantiles.** The estimate is interpolated inside its bin. The interval covers the quantile of
//! the simulated law with probability 0.95 or more, for any law, see
//! [`quantile_ranks`](stats::quantile_ranks). It contains the width of the bins, so more than 10⁵
//! paths deserve more [`bins`](StudySettings::bins). A quantile outside of the grid has no estimate
//! and says so.
//!
//! **Heavy tails.** Where the values of the first 8192 paths at the last time have a heavy
//! [tail](stats::Tail), means and variances that may not exist are left out, with a note, there and
//! at all times with a large kurtosis.
//!
//! **Nothing is dropped silently.** A path that fails is left out from then on, counted and
//! described. Values that are not finite are counted apart. [`StudyResult::warnings`] has both.
//!
//! **Dependence.** Covariances, joint laws, autocorrelations and spectra of the observables that
//! are [`Wanted`].
//!
//! The intervals are those of sampling. The error of the step size is not in them: the crate
//! `expectation` bounds it.

mod dependence;
mod grid;
mod result;
mod settings;
mod summary;
mod sums;

use noise::Purpose;

use mc::{Ladder, Measured, Observe, RunError, Setup, parts::Job};
use sums::StudyStatistic;

pub use dependence::{Joint, Wanted};
pub use grid::Grid;
pub use result::{COLUMNS, Kind, Losses, Series, StudyResult, write_rows};
pub use settings::{Record, StudySettings};
pub use summary::{
    Histogram, IntervalNote, IntervalOf, Place, Quantile, STATISTICS, Summary, SummaryStatistic,
};

/// Observables of many paths of a problem by a scheme, see the [module](self). The bins are chosen
/// when it is made, the paths are simulated by [`run`](Self::run).
///
/// [`run_in`](Self::run_in) is a run that machines share.
pub struct Study<'a> {
    ladder: Ladder<'a>,
    observables: Vec<&'a dyn Observe>,
    wanted: Wanted,
    record: Record,
    /// The bins of every observable at every time, time by time.
    grids: Vec<Grid>,
}

impl<'a> Study<'a> {
    /// Checks the settings, and chooses the bins by a pilot on the current rayon pool.
    ///
    /// # Errors
    /// [`RunError`] if a setting is out of range, times are not ends of steps or not in order,
    /// observables are missing or share a name, the scheme cannot be run on the steps, or there is
    /// too little memory.
    pub fn new(
        setup: &Setup<'a>,
        observables: &'a [impl Observe],
        settings: &StudySettings,
    ) -> Result<Self, RunError> {
        settings.demand(observables.len())?;
        let observables: Vec<_> = observables.iter().map(|phi| phi as &dyn Observe).collect();
        let record = Record::new(setup, &observables, settings)?;
        let ladder = |family| {
            let &StudySettings { steps, truncation, key, pilot, .. } = settings;
            let ladder = setup.ladder(steps, 0, truncation, (key, family), pilot);
            ladder.map(|ladder| if record.start.is_some() { ladder.with_start() } else { ladder })
        };
        let pilot = ladder(Purpose::Pilot)?;
        let new = || StudyStatistic::new(&observables, &record.times, &[], &settings.wanted);
        let seen = pilot.run_until(&settings.stop, 0, settings.pilot, new).statistic.sums;
        let grids = seen
            .moments
            .iter()
            .map(|values| Grid::covering(values.range(), settings.bins))
            .collect();
        let ladder = ladder(Purpose::Paths)?;
        if let Some(device) = setup.problem.device.filter(|one| settings.paths < one.fewest()) {
            device.refuse("few paths are sooner done there");
        }
        Ok(Self { ladder, observables, wanted: settings.wanted.clone(), record, grids })
    }

    /// Calls `progress` from any thread with the number of path-steps done since its last call; the
    /// sum is paths times steps.
    #[must_use]
    pub fn telling(mut self, progress: impl Fn(u64) + Sync + 'a) -> Self {
        self.ladder = self.ladder.telling(progress);
        self
    }

    fn statistic(&self) -> StudyStatistic<'_> {
        StudyStatistic::new(&self.observables, &self.record.times, &self.grids, &self.wanted)
    }

    /// Simulates all paths in parallel on the current rayon pool. The bits do not depend on the
    /// number of threads.
    ///
    /// # Panics
    /// As [`Ladder::run`].
    pub fn run(&self) -> StudyResult {
        self.result(&self.ladder.run(self.record.paths, || self.statistic()))
    }

    /// Simulates all paths as a piece of work of a job with the name `name`: whole, in parts or
    /// merged, with the bits of [`run`](Self::run). `None` if the results are not here;
    /// [`Job::finish`] says why. Every part has the same bins, since it runs the same pilot.
    ///
    /// # Panics
    /// As [`Ladder::run`].
    pub fn run_in(&self, job: &Job, name: &str) -> Option<StudyResult> {
        let found = self.ladder.run_in(job, name, self.record.paths, || self.statistic())?;
        Some(self.result(&found))
    }

    fn result(&self, measured: &Measured<StudyStatistic<'_>>) -> StudyResult {
        StudyResult::new(&self.record, &self.grids, &self.wanted, measured)
    }
}
