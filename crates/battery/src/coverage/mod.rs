//! How often the intervals of `stats` cover the truth, measured on data whose law is known.
//!
//! Every data set is drawn from a law with a known order, mean-square error or weak error. An
//! interval is computed as for any experiment, and it is counted whether the truth lies inside.
//! Warnings are counted likewise: where a few paths carry an error, or a model does not fit, they
//! have to be raised, elsewhere not. Beside the intervals in use stand some that ignore something
//! (the covariance between levels, the error of a reference, heavy tails) and have to miscover, or
//! the measurement could not tell. More `--replications` of `cargo xtask verify` narrow the shares.

mod motion;
mod synthetic;

use mc::parts::Job;
use noise::StreamKey;
use stats::{Bend, Coverage, CrossMoments, Expected, LogMeanSquares, Point, Rate, normal_covers};

use verify::streams;

/// Measures the coverage of every kind of interval on `replications` data sets each, as work of
/// `job`: `None` where that gives no results.
///
/// The rows are functions of the other arguments alone.
pub fn coverage(replications: u64, seed: u64, job: &Job) -> Option<Vec<Coverage>> {
    let mut tally = Tally { rows: Vec::new(), replications, seed, job, case: 0 };
    synthetic::rows(&mut tally);
    tally.case = MOTION;
    motion::rows(&mut tally);
    job.gives_results().then_some(tally.rows)
}

/// Data sets of a task.
const BLOCK: u64 = 50;

/// Number of the first case of geometric Brownian motion, so that no two cases share noise.
const MOTION: u64 = 100;

/// An interval or a warning, what is required of it, and whether it covers the truth or is raised
/// on one data set.
type Check = (&'static str, Expected, bool);

/// Counts, case by case.
struct Tally<'a> {
    rows: Vec<Coverage>,
    replications: u64,
    seed: u64,
    job: &'a Job,
    case: u64,
}

impl Tally<'_> {
    /// One case: `checks` draws a data set and checks its intervals, always the same ones.
    fn add(&mut self, case: &'static str, checks: impl Fn(StreamKey) -> Vec<Check> + Sync) {
        self.case += 1;
        let (seed, first) = (self.seed, self.case * streams::COVERAGE);
        let key = |replication| StreamKey { seed, experiment: first + replication };
        let replications = self.replications;
        // How many data sets of a block each interval covers.
        let count = |block: u64| {
            let numbers = block * BLOCK..replications.min((block + 1) * BLOCK);
            let sets: Vec<Vec<Check>> = numbers.map(|number| checks(key(number))).collect();
            let covers = |n: usize| sets.iter().filter(|checks| checks[n].2).count() as u64;
            Some((0..sets[0].len()).map(covers).collect::<Vec<u64>>())
        };
        let (name, of) = (format!("coverage/{case}"), format!("{replications} of seed {seed}"));
        let blocks = self.job.tasks(&name, &of, replications.div_ceil(BLOCK), count);
        let Some(blocks) = blocks else { return };
        for (n, (interval, expected, _)) in checks(key(0)).into_iter().enumerate() {
            let covered = blocks.iter().map(|covered| covered[n]).sum();
            self.rows.push(Coverage { case, interval, covered, replications, expected });
        }
    }
}

/// The intervals of a rate.
fn rate_checks(rate: Option<&Rate>, order: f64, expected: Expected) -> Vec<Check> {
    vec![
        ("rate", expected, rate.is_some_and(|rate| rate.covers(order))),
        ("rate, bootstrap-t", expected, rate.is_some_and(|rate| rate.bootstrap_covers(order))),
    ]
}

/// Whether there is a rate with a warning.
fn warns(rate: Option<&Rate>) -> bool {
    rate.is_some_and(|rate| rate.warning.is_some())
}

/// Whether the interval of a point covers the truth, whether value ± 1.96 se does, and whether the
/// point has a warning.
fn point_checks(point: Option<&Point>, truth: f64) -> [bool; 3] {
    point.map_or([false; 3], |p| [p.covers(truth), p.normal_covers(truth), p.warns()])
}

/// Whether a normal interval that ignores something covers the order: heavy tails, terms of the
/// model, and with `independent` the covariance between levels.
fn naive(
    taus: &[f64],
    squares: &CrossMoments,
    bend: Option<Bend>,
    independent: bool,
    order: f64,
) -> bool {
    LogMeanSquares::new(taus, squares, (0..taus.len()).collect())
        .map(|levels| if independent { levels.independent() } else { levels })
        .and_then(|levels| levels.fit(bend))
        .is_some_and(|estimate| normal_covers(estimate.rate.estimate, estimate.se, order))
}
