//! The samples of one level, and how more are drawn.

use real::WIDTH;
use schemes::Scheme;
use systems::{Damping, PoissonSystem, Problem};

use super::central::Central;
use super::settings::MAX_ROUNDS;
use super::{Coupling, MultilevelError, Settings};
use crate::{Ladder, LadderError, Observable, Run, Statistic, View};

/// One test function on one level.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Values {
    /// What the level contributes: φ or a difference.
    pub(crate) sample: Central,
    /// φ on the fine path; of fine and swapped path the average.
    pub(crate) fine: Central,
    /// φ on the coarse path.
    pub(crate) coarse: Central,
}

impl Values {
    fn merge(&mut self, later: &Self) {
        self.sample.merge(&later.sample);
        self.fine.merge(&later.fine);
        self.coarse.merge(&later.coarse);
    }

    /// Whether the samples vary by more than round-off.
    pub(crate) fn varies(&self) -> bool {
        self.sample.is_spread(self.fine.mean().abs() + self.fine.variance().sqrt())
    }
}

/// The values of all test functions at the final time. The runs are fine, coarse, swapped, as many
/// as there are.
struct Samples<'a, const D: usize> {
    observables: &'a [Observable<D>],
    last_time: u64,
    values: Vec<Values>,
}

impl<const D: usize> Statistic<D> for Samples<'_, D> {
    fn observe(&mut self, view: &View<'_, D>) {
        if view.time != self.last_time {
            return;
        }
        for (observable, values) in self.observables.iter().zip(&mut self.values) {
            let phi = |run: usize, p: usize| (observable.function)(view.states[run].path(p));
            for p in view.live.paths() {
                let fine =
                    if view.states.len() == 3 { 0.5 * (phi(0, p) + phi(2, p)) } else { phi(0, p) };
                values.fine.add(fine);
                if view.states.len() == 1 {
                    values.sample.add(fine);
                } else {
                    let coarse = phi(1, p);
                    values.coarse.add(coarse);
                    values.sample.add(fine - coarse);
                }
            }
        }
    }

    fn merge(&mut self, later: Self) {
        for (sum, more) in self.values.iter_mut().zip(&later.values) {
            sum.merge(more);
        }
    }
}

/// The samples of one level so far.
#[derive(Clone, Debug)]
pub(crate) struct Row {
    pub(crate) level: usize,
    /// `None` for single paths.
    pub(crate) coupling: Option<Coupling>,
    pub(crate) cost_per_path: u64,
    pub(crate) values: Vec<Values>,
    /// Paths drawn, failed ones included.
    pub(crate) paths: u64,
    pub(crate) failed: u64,
    rounds: u64,
}

impl Row {
    /// Paths that count.
    pub(crate) fn samples(&self) -> u64 {
        self.paths - self.failed
    }
}

/// Draws samples, and counts what they cost.
pub(crate) struct Sampler<'a, S, G, const D: usize, const M: usize> {
    pub(crate) scheme: &'a dyn Scheme<S, D, M>,
    pub(crate) problem: &'a Problem<S, G, D>,
    pub(crate) observables: &'a [Observable<D>],
    pub(crate) settings: &'a Settings,
    pub(crate) progress: &'a (dyn Fn(u64) + Sync),
    /// Path-steps so far.
    pub(crate) cost: u64,
    /// Path-steps that are kept for something else.
    pub(crate) reserve: u64,
}

impl<'a, S: PoissonSystem<D, M>, G: Damping, const D: usize, const M: usize>
    Sampler<'a, S, G, D, M>
{
    /// A level without samples.
    ///
    /// # Errors
    /// [`LadderError`] when it cannot be run.
    pub(crate) fn row(&self, level: usize, coupling: Option<Coupling>) -> Result<Row, LadderError> {
        let mut row = Row {
            level,
            coupling,
            cost_per_path: 0,
            values: vec![Values::default(); self.observables.len()],
            paths: 0,
            failed: 0,
            rounds: 0,
        };
        row.cost_per_path = self.ladder(&row)?.steps_per_path();
        Ok(row)
    }

    fn ladder(&self, row: &Row) -> Result<Ladder<'a, D, M>, LadderError> {
        let scheme = self.scheme;
        let runs = match row.coupling {
            None => vec![Run::new(scheme, 0)],
            Some(Coupling::Plain) => vec![Run::new(scheme, 0), Run::new(scheme, 1)],
            Some(Coupling::Antithetic) => {
                vec![Run::new(scheme, 0), Run::new(scheme, 1), Run::swapped(scheme, 0)]
            }
        };
        let levels = usize::from(row.coupling.is_some());
        // Single paths have families of their own, that of level 0, whatever their step size.
        let family = if row.coupling.is_some() { row.level } else { 0 };
        let key = self.settings.stream(family, row.rounds);
        Ladder::new(
            self.problem,
            self.settings.steps(row.level),
            levels,
            self.settings.truncation,
            key,
            runs,
        )
    }

    /// Path-steps that may be spent now.
    pub(crate) fn budget(&self) -> u64 {
        self.settings.max_cost.saturating_sub(self.cost).saturating_sub(self.reserve)
    }

    /// Draws `paths` more samples of a level, from a family of streams that no other round uses.
    ///
    /// # Errors
    /// [`MultilevelError::NoPaths`] or [`MultilevelError::NotFinite`].
    pub(crate) fn sample(&mut self, row: &mut Row, paths: u64) -> Result<(), MultilevelError> {
        let ladder = self.ladder(row)?;
        let new = || Samples {
            observables: self.observables,
            last_time: ladder.coarse_steps(),
            values: vec![Values::default(); self.observables.len()],
        };
        let outcome = ladder.run(paths, new, self.progress);
        for (values, more) in row.values.iter_mut().zip(&outcome.statistic.values) {
            values.merge(more);
        }
        row.paths += paths;
        row.failed += outcome.failed;
        row.rounds += 1;
        self.cost += paths * row.cost_per_path;
        if row.samples() < 2 {
            let first = outcome.failures.first().copied();
            return Err(MultilevelError::NoPaths { level: row.level, failed: row.failed, first });
        }
        for (observable, values) in self.observables.iter().zip(&row.values) {
            if !values.sample.variance().is_finite() {
                return Err(MultilevelError::NotFinite {
                    observable: observable.name,
                    level: row.level,
                });
            }
        }
        Ok(())
    }

    /// Draws the samples wanted of each level, or in proportion as many as may still be paid for;
    /// whether it was all of them.
    pub(crate) fn sample_up_to(
        &mut self,
        rows: &mut [Row],
        wanted: &[u64],
    ) -> Result<bool, MultilevelError> {
        let more: Vec<u64> =
            rows.iter().zip(wanted).map(|(row, &wanted)| additional(row, wanted)).collect();
        let cost: u128 = rows
            .iter()
            .zip(&more)
            .map(|(row, &paths)| u128::from(row.cost_per_path) * u128::from(paths))
            .sum();
        let budget = u128::from(self.budget());
        let rounds_left = rows.iter().all(|row| row.rounds < MAX_ROUNDS);
        let all = cost <= budget && rounds_left;
        for (row, paths) in rows.iter_mut().zip(more) {
            let paths = if cost <= budget {
                paths
            } else {
                // Whole blocks, rounded down.
                (u128::from(paths) * budget / cost) as u64 / WIDTH as u64 * WIDTH as u64
            };
            if paths > 0 && rounds_left {
                self.sample(row, paths)?;
            }
        }
        Ok(all)
    }
}

/// How many paths to add: whole blocks, and none or at least a 32nd of those there are, so that the
/// rounds are few.
fn additional(row: &Row, wanted: u64) -> u64 {
    match wanted.saturating_sub(row.samples()) {
        0 => 0,
        missing => {
            missing.max(row.samples() / 32).div_ceil(WIDTH as u64).saturating_mul(WIDTH as u64)
        }
    }
}
