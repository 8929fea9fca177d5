//! Orders, `inspect`, and what both once said falsely; `compare`. One program: its tests run side
//! by side, and what they share is compiled once. Most systems are texts, which no kernel is
//! compiled for.

mod collecting;
mod compare;
mod expansion;
mod facts;
mod false_answers;
mod friction;
mod generated;
mod inspect;
mod statistical;

use std::sync::Arc;

use ::inspect::{Applies, InspectError, InspectSettings, Inspection};
use formula::{Definition, FormulaSystem};
use systems::{Constant, Damping, PoissonSystem, Problem, run_time as at_run_time};

/// The report on a compiled system alone.
fn inspect_alone<S: PoissonSystem<D, M> + Clone, const D: usize, const M: usize>(
    system: &S,
) -> Result<Inspection, InspectError> {
    let system = at_run_time::Compiled::new(system.clone(), [1.0; D]);
    ::inspect::inspect(&system, &InspectSettings::default())
}

/// The report on a compiled system with its problem.
fn inspect_problem<S, G: Damping, const D: usize, const M: usize>(
    problem: &Problem<S, G, D>,
) -> Result<Inspection, InspectError>
where
    S: PoissonSystem<D, M> + Clone,
{
    let system = at_run_time::Compiled::new(problem.system().clone(), problem.y0());
    ::inspect::inspect(&system, &InspectSettings::of(problem))
}

/// The report on a system known at run time around an initial value.
fn inspect_around(
    system: &dyn at_run_time::System,
    y0: &[f64],
) -> Result<Inspection, InspectError> {
    let y0 = Some(y0.to_vec());
    ::inspect::inspect(system, &InspectSettings { y0, areas: false, ..InspectSettings::default() })
}

/// Whether a statement of the paper applies.
fn applies(report: &Inspection, statement: &str) -> Option<Applies> {
    Some(report.theorems.iter().find(|theorem| theorem.statement == statement)?.applies)
}

/// The formulas of the Casimirs that were found.
fn casimirs(report: &Inspection) -> Vec<&str> {
    report.casimirs.as_ref().unwrap().found.iter().map(|casimir| &casimir.formula[..]).collect()
}

/// Texts of a system, with the rows of B above its diagonal.
fn texts(state: &str, structure: &[&str], energy: &str, noises: &[&str]) -> Definition {
    let words = |text: &str| text.split_whitespace().map(String::from).collect::<Vec<_>>();
    Definition {
        name: "texts".into(),
        state: words(state),
        structure: structure.iter().map(|row| words(row)).collect::<Vec<_>>().into(),
        energy: energy.into(),
        noises: noises.iter().map(|noise| noise.to_string()).collect(),
        ..Definition::default()
    }
}

/// B of a spin.
const SPIN: [&str; 2] = ["-z y", "-x"];

fn system(definition: &Definition, y0: &[f64]) -> FormulaSystem {
    FormulaSystem::new(definition, y0).unwrap()
}

fn constant(rate: f64) -> Constant {
    Constant::new(rate).unwrap()
}

/// The problem of texts with constant damping.
fn problem(definition: &Definition, rate: f64, y0: &[f64], t_end: f64) -> at_run_time::Problem {
    let (system, damping) = (Arc::new(system(definition, y0)), Arc::new(constant(rate)));
    at_run_time::Problem::new(system, damping, y0.to_vec(), t_end).unwrap()
}

/// Kubo's oscillator: the plane turns by ω dt + σ dW.
fn kubo(omega: f64, sigma: f64) -> at_run_time::Problem {
    let [energy, noise] = [omega, sigma].map(|size| format!("{size}*(p^2 + q^2)/2"));
    problem(&texts("p q", &["-1"], &energy, &[&noise]), 0.0, &[1.0, 0.0], 1.0)
}

/// A pendulum that noise pushes.
fn pushed(t_end: f64) -> at_run_time::Problem {
    problem(&texts("q p", &["1"], "p^2/2 - cos(q)", &["0.1*q"]), 0.0, &[2.0, 0.0], t_end)
}
