//! Orders, `inspect`, and what both once said falsely; `compare`. One program: its tests run side
//! by side, and what they share is compiled once.

mod compare;
mod facts;
mod false_answers;
mod generated;
mod inspect;
mod orders;
mod run_time;
mod run_time_compare;

use analysis::inspect::{InspectError, InspectSettings, Inspection};
use systems::{Damping, PoissonSystem, Problem, run_time::Compiled};

/// The report on a compiled system alone.
fn inspect_alone<S: PoissonSystem<D, M>, const D: usize, const M: usize>(
    system: &S,
) -> Result<Inspection, InspectError> {
    analysis::inspect(&Compiled::new(system, [1.0; D]), &InspectSettings::default())
}

/// The report on a compiled system with its problem.
fn inspect_problem<S, G: Damping, const D: usize, const M: usize>(
    problem: &Problem<S, G, D>,
) -> Result<Inspection, InspectError>
where
    S: PoissonSystem<D, M>,
{
    let system = Compiled::new(problem.system(), problem.y0());
    analysis::inspect(&system, &InspectSettings::of(problem))
}

/// The report on formulas around an initial value.
fn inspect_formulas(
    system: &formula::FormulaSystem,
    y0: &[f64],
) -> Result<Inspection, InspectError> {
    let y0 = Some(y0.to_vec());
    analysis::inspect(system, &InspectSettings { y0, damping: None, areas: false })
}
