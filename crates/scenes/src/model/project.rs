//! The systems of the project by name, on their tuned kernels.

use std::sync::Arc;

use casimir::{
    expectation::Expect,
    formula::Names,
    mc::{self, Friction, bind_owned},
    schemes::{BuiltIn, Method, SchemeError, SexpH},
    systems::{
        Damping, LotkaVolterra, MaxwellBloch, Pendulum, Poisson3, Problem, RigidBody, SystemError,
        run_time::{self, System},
    },
};
use kernels::Tuned;
use keys::*;

use super::{Built, Model, damping::damping, lattice, matrices};

/// A function that builds the model of a system.
type Build = fn(&Reading) -> Read<Built>;

/// Name, parameters with their defaults, description and model of every system.
pub const PROJECT: [(&str, &str, &str, Build); 9] = [
    ("pendulum", "c = 1", "H₀ = y1²/2 − cos y2, one noise c·H₀", |reading| {
        built(reading, "c", Pendulum::new(reading.number("c", 1.0)?))
    }),
    (
        "rigid-body",
        "inertia = [2, 1, 2/3], noise = [1, 2, 3]",
        "Euler's equations; three noises about the axes, or one with a single number `noise`",
        rigid_body,
    ),
    ("lotka-volterra", "c = 1", "three species with a quadratic B, one noise", |reading| {
        built(reading, "c", LotkaVolterra::<1, 1>::new(reading.number("c", 1.0)?))
    }),
    ("maxwell-bloch", "", "laser–matter equations, one noise", |reading| {
        built(reading, "", Ok(MaxwellBloch))
    }),
    ("poisson3", "c = 1", "H₀ = Σ sin yᵢ with a constant B, one noise", |reading| {
        built(reading, "c", Poisson3::new(reading.number("c", 1.0)?))
    }),
    ("spin-lattice", lattice::PARAMETERS, "classical spins on a lattice", lattice::build),
    ("sphere-euler", matrices::FLUID, "Euler's equations on a sphere by matrices", matrices::fluid),
    ("su-spins", matrices::SPINS, "spins with N levels on a lattice", matrices::spins),
    (
        "quantum",
        matrices::QUANTUM,
        "a density matrix with a Hamiltonian and Hermitian operators of noises",
        matrices::quantum,
    ),
];

/// Builds the model of a system of the project.
pub fn build(reading: &Reading, name: &Name) -> Read<Built> {
    let table = &reading.file.system;
    let formulas = [
        ("state", place(&table.state)),
        ("B", place(&table.structure)),
        ("H0", place(&table.energy)),
        ("H", place(&table.noises)),
        ("calculus", place(&table.calculus)),
        ("drift", place(&table.drift)),
        ("noise", table.noise.iter().flatten().next().map(At::span)),
    ];
    let has_bath = ["spin-lattice", "su-spins"].contains(&name.as_str());
    if let Some(bath) = reading.file.bath.first().filter(|_| !has_bath) {
        refuse!(&bath.temperature, "a bath is for formulas, and for `spin-lattice` and `su-spins`");
    }
    if let Some((key, place)) = formulas.into_iter().find(|(_, place)| place.is_some()) {
        refuse!(place, "`{key}` is for formulas: remove it, or `name = \"{}\"`", **name);
    }
    let Some((name, parameters, _, build)) = PROJECT.iter().find(|of| *of.0 == **name) else {
        let known = among(name, &PROJECT.map(|(known, ..)| known));
        refuse!(name, "unknown system `{}`{known}", **name)
    };
    if let ("spin-lattice", Some(at)) = (*name, reading.get("dipolar")) {
        refuse!(
            at,
            "dipolar fields are not computed: each spin acts on all others, which takes a Fourier \
             transform for each evaluation and leaves no flow of a bond"
        );
    }
    // Entries of the operators of a quantum system are formulas of any parameters.
    if *name != "quantum" {
        reading.know(parameters)?;
    }
    build(reading)
}

fn rigid_body(reading: &Reading) -> Read<Built> {
    let inertia = reading.three("inertia", [2.0, 1.0, 2.0 / 3.0])?;
    let noise = reading.list("noise", &[1.0, 2.0, 3.0])?;
    if let Some(b) = noise.iter().find(|b| !(**b > 0.0 && b.is_finite())) {
        refuse!(reading.place("noise"), "`noise` must be positive and finite, got {b}");
    }
    match noise[..] {
        [noise] => built(reading, "inertia", RigidBody::one_noise(inertia, noise)),
        [a, b, c] => built(reading, "inertia", RigidBody::three_noises(inertia, [a, b, c])),
        _ => {
            let number = noise.len();
            refuse!(reading.place("noise"), "`noise` has one or three numbers, got {number}");
        }
    }
}

/// The model with the names y1, …, yD of a system, whose error is about a parameter.
fn built<S, const D: usize, const M: usize>(
    reading: &Reading,
    parameter: &str,
    system: Result<S, SystemError>,
) -> Read<Built>
where
    S: Tuned<D, M> + Copy + 'static,
{
    let system = reading.checked(parameter, system)?;
    let initial = &reading.settings.initial;
    let Ok(y0) = <[f64; D]>::try_from(&initial[..]) else {
        let components = initial.len();
        refuse!(initial, "the initial value must have {D} components, got {components}");
    };
    let names = numbered(D);
    let (damping, friction) = damping(reading, names.variables(), &[])?;
    let problem = Problem::new(system, damping, y0, reading.settings.until)
        .map_err(|error| Wrong::new(initial, error))?;
    let energy = Quantity::smooth(move |y, values| {
        for (p, value) in values.iter_mut().enumerate() {
            *value = system.energy(std::array::from_fn(|i| y[i][p]), 1.0, [0.0; M]);
        }
    });
    let at_run_time = run_time::Compiled::new(system, problem.y0());
    let model = Compiled { problem, friction, at_run_time };
    Ok(Built::new(model, names, Some(Further::Quantity(energy))))
}

/// A problem whose schemes are compiled for it.
struct Compiled<S, const D: usize, const M: usize> {
    problem: Problem<S, Arc<dyn Damping>, D>,
    friction: Vec<Friction>,
    at_run_time: run_time::Compiled<S, D, M>,
}

impl<S: Tuned<D, M> + Copy + 'static, const D: usize, const M: usize> Model for Compiled<S, D, M> {
    fn problem(&self) -> mc::Problem<'_> {
        mc::Problem::of(&self.problem).with_friction(&self.friction)
    }

    fn scheme(&self, scheme: BuiltIn) -> Result<Arc<dyn Method + '_>, SchemeError> {
        let (system, y0) = (self.problem.system(), self.problem.y0());
        match scheme {
            BuiltIn::SexpH => {
                let scheme = SexpH::of(&self.at_run_time, Friction::inside(&self.friction));
                mc::bind_at_run_time(&self.at_run_time, Box::new(scheme))
            }
            BuiltIn::SplitH if !self.friction.is_empty() => {
                let reason = "friction on components costs it its order here; write formulas";
                Err(SchemeError::not_for(scheme.id(), system.name(), reason))
            }
            _ => {
                let scheme = bind_owned(&self.problem, S::scheme(scheme, system, y0)?);
                Ok(Friction::around(scheme, &self.friction))
            }
        }
    }

    fn expect(&self) -> Option<Expect<'_>> {
        Some(Expect::compiled(&self.problem, S::scheme).with_friction(&self.friction))
    }

    fn system(&self) -> &dyn System {
        &self.at_run_time
    }
}

/// The names y1, …, yD of components.
pub fn numbered(d: usize) -> Names {
    valid((1..=d).map(|i| format!("y{i}")))
}

/// Names of components that are known to be valid.
pub fn valid(components: impl IntoIterator<Item = impl AsRef<str>>) -> Names {
    let components: Vec<_> = components.into_iter().collect();
    Names::with_variables(&components).expect("these are names")
}
