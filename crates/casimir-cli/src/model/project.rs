//! The systems of the project by name.

use std::sync::Arc;

use casimir::{
    formula::Names,
    real::Row,
    systems::{LotkaVolterra, MaxwellBloch, Pendulum, Poisson3, Problem, RigidBody, SystemError},
};

use kernels::Tuned;

use super::{Built, compiled::Compiled, damping::damping, lattice};
use crate::scene::{At, Further, Parameters, Quantity, Read, Reading, among, refuse};

/// Name, parameters with their defaults, and what it is.
pub const PROJECT: [(&str, &str, &str); 6] = [
    ("pendulum", "c = 1", "H₀ = y1²/2 − cos y2, one noise c·H₀"),
    (
        "rigid-body",
        "inertia = [2, 1, 2/3], noise = [1, 2, 3]",
        "Euler's equations; three noises about the axes, or one with a single number `noise`",
    ),
    ("lotka-volterra", "c = 1", "three species with a quadratic B, one noise"),
    ("maxwell-bloch", "", "laser–matter equations, one noise"),
    ("poisson3", "c = 1", "H₀ = Σ sin yᵢ with a constant B, one noise"),
    (
        "spin-lattice",
        lattice::PARAMETERS,
        "classical spins on a chain, a square or a cubic lattice",
    ),
];

/// The model of a system of the project.
pub fn build(reading: &Reading<'_>, name: &At<String>) -> Read<Built> {
    let (source, table) = (reading.source, &reading.file.system);
    let formulas = [
        ("state", table.state.as_ref().map(At::span)),
        ("B", table.structure.as_ref().map(At::span)),
        ("H0", table.energy.as_ref().map(At::span)),
        ("H", table.noises.as_ref().map(At::span)),
        ("calculus", table.calculus.as_ref().map(At::span)),
        ("drift", table.drift.as_ref().map(At::span)),
        ("noise", table.noise.iter().flatten().next().map(At::span)),
    ];
    if let Some((key, place)) = formulas.into_iter().find(|(_, place)| place.is_some()) {
        let name = name.as_str();
        refuse!(source, place, "`{key}` is for formulas: remove it, or `name = \"{name}\"`");
    }
    let parameters = |known: &[&str]| Parameters::new(reading, known);
    match name.as_str() {
        "pendulum" => built(reading, with_c(reading, Pendulum::new)?),
        "rigid-body" => {
            let p = parameters(&["inertia", "noise"])?;
            let inertia = p.three("inertia", [2.0, 1.0, 2.0 / 3.0])?;
            let wrong = |error: SystemError| p.error("inertia", error);
            match p.list("noise", &[1.0, 2.0, 3.0])?[..] {
                [noise] => built(reading, RigidBody::one_noise(inertia, noise).map_err(wrong)?),
                [a, b, c] => {
                    built(reading, RigidBody::three_noises(inertia, [a, b, c]).map_err(wrong)?)
                }
                ref list => {
                    refuse!(p, "noise", "`noise` has one or three numbers, got {}", list.len());
                }
            }
        }
        "lotka-volterra" => built(reading, with_c(reading, LotkaVolterra::<1, 1>::new)?),
        "maxwell-bloch" => {
            parameters(&[])?;
            built(reading, MaxwellBloch)
        }
        "poisson3" => built(reading, with_c(reading, Poisson3::new)?),
        "spin-lattice" => lattice::build(reading),
        unknown => {
            let known = among(unknown, &PROJECT.map(|(known, ..)| known));
            refuse!(source, name.span(), "unknown system `{unknown}`{known}")
        }
    }
}

/// The system with the size `c` of its noise.
fn with_c<S>(reading: &Reading<'_>, new: fn(f64) -> Result<S, SystemError>) -> Read<S> {
    let c = Parameters::new(reading, &["c"])?;
    new(c.number("c", 1.0)?).map_err(|error| c.error("c", error))
}

/// The model with the names y1, …, yD.
fn built<S, const D: usize, const M: usize>(reading: &Reading<'_>, system: S) -> Read<Built>
where
    S: Tuned<D, M> + Copy + 'static,
{
    let initial = &reading.settings.initial;
    let y0: [f64; D] = initial[..].try_into().map_err(|_| {
        let components = initial.len();
        let message = format!("the initial value must have {D} components, got {components}");
        reading.initial_error(message)
    })?;
    let components: Vec<String> = (1..=D).map(|i| format!("y{i}")).collect();
    let names = numbered(&components);
    let (damping, friction) = damping(reading, &components, &[])?;
    let problem = Problem::new(system, damping, y0, reading.settings.until)
        .map_err(|error| reading.initial_error(error))?;
    let energy = move |y: &[Row], values: &mut Row| {
        for (p, value) in values.iter_mut().enumerate() {
            *value = system.energy(std::array::from_fn(|i| y[i][p]), 1.0, [0.0; M]);
        }
    };
    Ok(Built {
        sizes: Vec::new(),
        model: Box::new(Compiled::new(problem, friction)),
        names,
        components,
        energy: Further::Quantity(Quantity::Function(Arc::new(energy))),
        quantities: Vec::new(),
    })
}

/// Names that cannot be wrong.
pub fn numbered(components: &[String]) -> Names {
    Names::with_variables(components).unwrap_or_else(|error| unreachable!("{error}"))
}
