//! States that paths visit, and their times.

use mc::{Ladder, LadderError, Run, Statistic, View};
use schemes::Scheme;
use systems::{Damping, PoissonSystem, Problem};

use super::StepSizes;

/// A state of a path.
#[derive(Clone, Copy, Debug)]
pub struct Visit<const D: usize> {
    pub t: f64,
    pub state: [f64; D],
}

/// Paths, each of which gives one state.
const PATHS: u64 = 256;

/// States of some paths of the scheme, each at a time of its own, or y₀ if none survives.
pub fn visits<S, G, const D: usize, const M: usize>(
    scheme: &dyn Scheme<S, D, M>,
    problem: &Problem<S, G, D>,
    sizes: &StepSizes,
) -> Result<Vec<Visit<D>>, LadderError>
where
    S: PoissonSystem<D, M>,
    G: Damping,
{
    let steps = sizes.coarsest_steps << (sizes.levels - 1);
    let runs = vec![Run::new(scheme, 0)];
    let ladder = Ladder::new(problem, steps, 0, sizes.truncation, sizes.key, runs)?;
    let tau = problem.t_end() / steps as f64;
    let none = || Visits { steps, tau, visits: Vec::new() };
    let mut visits = ladder.run(PATHS, none, &|_| ()).statistic.visits;
    if visits.is_empty() {
        visits.push(Visit { t: 0.0, state: problem.y0() });
    }
    Ok(visits)
}

/// Collects states.
struct Visits<const D: usize> {
    steps: u64,
    tau: f64,
    visits: Vec<Visit<D>>,
}

impl<const D: usize> Statistic for Visits<D> {
    fn observe(&mut self, view: &View<'_>) {
        // Multiples of the golden ratio, modulo one, are spread evenly.
        let fraction = |path: u64| (path as f64 * 0.618_033_988_749_894_8).fract();
        for p in view.live.paths() {
            let time = 1 + (fraction(view.first_path + p as u64) * self.steps as f64) as u64;
            if time.min(self.steps) == view.time {
                let (t, state) = (view.time as f64 * self.tau, view.path(0, p));
                self.visits.push(Visit { t, state });
            }
        }
    }

    fn merge(&mut self, later: Self) {
        self.visits.extend(later.visits);
    }
}
