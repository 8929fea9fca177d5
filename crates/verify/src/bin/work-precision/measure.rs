//! Errors and times of every scheme on every problem.

use analysis::{
    Progress, Settings, StepSizes,
    compare::{Grid, Strong, Weak, path_times},
};
use anyhow::Result;
use mc::{Observe, bind, parts::Stop};
use systems::{Damping, PoissonSystem};
use verify::{
    TRUNCATED, set_up,
    setups::{Kind, Setup, Visit, visit_paper},
    truncation,
};

use crate::{
    results::{Case, Costs},
    sizes::Sizes,
};

/// Measures the cases named by `only`, or all where it is empty: errors on the current rayon pool,
/// times on one thread.
///
/// Everything but the times is the same bits for the same seed and mode.
pub fn measure(settings: Settings, only: &[String], progress: &dyn Progress) -> Result<Vec<Case>> {
    let mut cases = Cases { settings, only, progress, number: 0, measured: Vec::new() };
    visit_paper(&mut cases)?;
    Ok(cases.measured)
}

struct Cases<'a> {
    settings: Settings,
    only: &'a [String],
    progress: &'a dyn Progress,
    number: u64,
    measured: Vec<Case>,
}

impl Visit for Cases<'_> {
    fn visit<S: PoissonSystem<D, M>, G: Damping, const D: usize, const M: usize>(
        &mut self,
        setup: Setup<S, G, D, M>,
    ) -> Result<()> {
        self.number += 1;
        if !self.only.is_empty() && self.only.iter().all(|id| id != setup.id) {
            return Ok(());
        }
        let Setup { id, title, system, ref problem, ref observables, .. } = setup;
        let schemes: Vec<_> =
            setup.schemes.iter().map(|(_, scheme)| bind(problem, scheme.as_ref())).collect();
        let levy = schemes.iter().find(|scheme| scheme.reads_areas());
        let (driven, stop) = (mc::Problem::of(problem), Stop::default());
        let Sizes { strong, weak, timed, repetitions } =
            Sizes::new(self.settings, self.number, levy.is_some());
        let progress = self.progress;
        let done = |work| progress.advance(work);
        let grid = |sizes: &StepSizes| {
            let finest = sizes.refinement as usize;
            let grid = Grid {
                problem: &driven,
                schemes: schemes.clone(),
                levels: vec![finest..finest + sizes.levels; schemes.len()],
                reference: levy.unwrap_or(&schemes[0]).clone(),
                reference_level: 0,
                finest_steps: sizes.reference_steps(),
                samples: sizes.samples,
                truncation: sizes.truncation,
                key: sizes.key,
                stop: stop.clone(),
            };
            progress.begin(&format!("{id}: errors"), grid.work());
            grid
        };
        let steps = vec![Sizes::timed_steps(&strong, &weak); schemes.len()];
        progress.begin(&format!("{id}: times"), repetitions.work(&steps));
        let often = (repetitions, &stop);
        let times = path_times(&schemes, &driven, &steps, truncation(), timed, often, &done)?;
        progress.end();
        let heun = setup.schemes.iter().position(|(kind, _)| *kind == Kind::Heun);
        let mut strong = Strong::measure(&grid(&strong), &[], heun, &done)?;
        progress.end();
        let phi: Vec<&dyn Observe> = observables.iter().map(|phi| phi as _).collect();
        let mut weak = Weak::measure(&grid(&weak), &phi, &done)?;
        progress.end();
        let exact = setup.expectations.map(|exact| exact(problem, observables));
        for (f, observable) in weak.observables.iter_mut().enumerate() {
            observable.exact = exact.as_ref().map(|exact| exact[f]);
        }
        for (s, times) in times.iter().enumerate() {
            strong.series[s].add_times(times);
            weak.observables.iter_mut().for_each(|phi| phi.series[s].add_times(times));
        }
        self.measured.push(Case {
            id,
            title,
            setup: set_up(system, problem, TRUNCATED),
            kinds: setup.schemes.iter().map(|(kind, _)| *kind).collect(),
            invariants: problem.system().invariants().iter().map(|f| f.name).collect(),
            costs: weak
                .observables
                .iter()
                .map(|phi| phi.series.iter().map(Costs::of).collect())
                .collect(),
            strong,
            weak,
        });
        Ok(())
    }
}
