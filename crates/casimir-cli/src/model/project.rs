//! The systems of the project by name.

use std::sync::Arc;

use casimir::{
    formula::Names,
    real::Row,
    systems::{
        Damping, LotkaVolterra, MaxwellBloch, Pendulum, Poisson3, PoissonSystem, Problem,
        RigidBody, SystemError,
    },
};
use toml::Spanned;

use super::{Built, compiled::Compiled, lattice};
use crate::scene::{Parameters, Quantity, Read, Settings, Source, SystemTable};

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
        "sizes, periodic, exchange, anisotropy, field, noise, local, transverse, temperature",
        "classical spins on a chain, a square or a cubic lattice",
    ),
];

/// The model of a system of the project.
pub fn build(
    source: &Source,
    table: &SystemTable,
    name: &Spanned<String>,
    damping: Arc<dyn Damping>,
    settings: &Settings,
) -> Read<Built> {
    let formulas = [
        table.state.as_ref().map(|key| ("state", key.span())),
        table.structure.as_ref().map(|key| ("B", key.span())),
        table.energy.as_ref().map(|key| ("H0", key.span())),
        table.noises.as_ref().map(|key| ("H", key.span())),
    ];
    if let Some((key, place)) = formulas.into_iter().flatten().next() {
        let name = name.get_ref();
        let message = format!("`{key}` is for formulas: remove it, or `name = \"{name}\"`");
        return Err(source.error(place, message));
    }
    let parameters = |known: &[&str]| Parameters::new(source, table, known);
    let (damping, run) = (&damping, Run { source, settings });
    match name.get_ref().as_str() {
        "pendulum" => {
            let c = parameters(&["c"])?;
            let system = Pendulum::new(c.number("c", 1.0)?).map_err(|e| c.error("c", e))?;
            built(Compiled::by_parts(run.problem(system, damping)?), system)
        }
        "rigid-body" => {
            let p = parameters(&["inertia", "noise"])?;
            let inertia = p.three("inertia", [2.0, 1.0, 2.0 / 3.0])?;
            match p.list("noise")?.unwrap_or(vec![1.0, 2.0, 3.0])[..] {
                [noise] => {
                    let system = RigidBody::one_noise(inertia, noise);
                    let system = system.map_err(|e| p.error("inertia", e))?;
                    built(Compiled::by_parts(run.problem(system, damping)?), system)
                }
                [a, b, c] => {
                    let system = RigidBody::three_noises(inertia, [a, b, c]);
                    let system = system.map_err(|e| p.error("inertia", e))?;
                    let model = Compiled::by_parts(run.problem(system, damping)?);
                    built(model, system)
                }
                ref list => {
                    let message = format!("`noise` has one or three numbers, got {}", list.len());
                    Err(p.error("noise", message))
                }
            }
        }
        "lotka-volterra" => {
            let c = parameters(&["c"])?;
            let system = LotkaVolterra::<casimir::systems::IntegerExponents<1, 1>>::integer(
                c.number("c", 1.0)?,
            );
            let system = system.map_err(|e| c.error("c", e))?;
            built(Compiled::new(run.problem(system, damping)?), system)
        }
        "maxwell-bloch" => {
            parameters(&[])?;
            let model = Compiled::by_parts(run.problem(MaxwellBloch, damping)?);
            built(model, MaxwellBloch)
        }
        "poisson3" => {
            let c = parameters(&["c"])?;
            let system = Poisson3::new(c.number("c", 1.0)?).map_err(|e| c.error("c", e))?;
            built(Compiled::by_parts(run.problem(system, damping)?), system)
        }
        "spin-lattice" => lattice::build(source, table, damping.clone(), settings),
        unknown => Err(source.error(name.span(), unknown_system(unknown))),
    }
}

fn unknown_system(name: &str) -> String {
    let known = PROJECT.map(|(known, ..)| known);
    let hint = super::nearest(name, &known);
    format!("unknown system `{name}`; there are {}{hint}", known.join(", "))
}

/// The model with the names y1, …, yD.
fn built<S, const D: usize, const M: usize>(model: Compiled<S, D, M>, system: S) -> Read<Built>
where
    S: PoissonSystem<D, M> + 'static,
{
    let components: Vec<String> = (1..=D).map(|i| format!("y{i}")).collect();
    let names = Names::with_variables(&components);
    let names = names.unwrap_or_else(|error| unreachable!("{error}"));
    let energy = move |y: &[Row], values: &mut Row| {
        for (p, value) in values.iter_mut().enumerate() {
            *value = system.energy(std::array::from_fn(|i| y[i][p]), 1.0, [0.0; M]);
        }
    };
    Ok(Built {
        model: Box::new(model),
        components,
        names,
        energy: Quantity::Function(Arc::new(energy)),
        quantities: Vec::new(),
    })
}

struct Run<'a> {
    source: &'a Source,
    settings: &'a Settings,
}

impl Run<'_> {
    fn problem<S: PoissonSystem<D, M>, const D: usize, const M: usize>(
        &self,
        system: S,
        damping: &Arc<dyn Damping>,
    ) -> Read<Problem<S, Arc<dyn Damping>, D>> {
        let Self { source, settings } = *self;
        let wrong = |error: &dyn std::fmt::Display| settings.initial_error(source, error);
        let components = settings.initial.len();
        let y0: [f64; D] = settings.initial[..].try_into().map_err(|_| {
            wrong(&format!("the initial value must have {D} components, got {components}"))
        })?;
        Problem::new(system, damping.clone(), y0, settings.until)
            .map_err(|error: SystemError| wrong(&error))
    }
}
