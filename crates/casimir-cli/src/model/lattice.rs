//! Spins on a lattice.

use std::sync::Arc;

use casimir::{
    analysis::{
        Candidates, inspect,
        inspect::{InspectError, InspectSettings, Inspection},
    },
    formula::Names,
    mc::{self, Expect, Setup},
    real::Row,
    schemes::{BuiltIn, Method, SchemeError},
    systems::{
        Damping,
        lattice::{Couplings, Shape, SpinLattice, noise_at_temperature},
        run_time::{Problem, System, Weights},
    },
};

use super::{Built, Model};
use crate::scene::{Observable, Parameters, Quantity, Read, Settings, Source, SystemTable};

/// The parameters of a lattice.
pub const PARAMETERS: [&str; 9] = [
    "sizes",
    "periodic",
    "exchange",
    "anisotropy",
    "field",
    "noise",
    "local",
    "transverse",
    "temperature",
];

struct Lattice {
    problem: Problem,
}

impl Model for Lattice {
    fn problem(&self) -> mc::Problem<'_> {
        mc::Problem::at_run_time(&self.problem)
    }

    fn scheme(&self, scheme: BuiltIn) -> Result<Arc<dyn Method + '_>, SchemeError> {
        let scheme = scheme.at_run_time(self.problem.system())?;
        Ok(Setup::owning(&self.problem, scheme)?.scheme)
    }

    fn candidates(&self) -> Result<Candidates<'_>, SchemeError> {
        Candidates::at_run_time(&self.problem)
    }

    fn recommended(&self) -> (&'static str, String) {
        let system = self.problem.system().description();
        match &system.parts {
            Ok(_) => {
                ("split", "it keeps the length of each spin, and the energy stays near".into())
            }
            Err(_) if system.is_transverse => {
                let because =
                    "it keeps the length of each spin; transverse damping governs the energy";
                ("sexp-li", because.into())
            }
            Err(reason) => {
                ("sexp", format!("it keeps the length of each spin; split would not do: {reason}"))
            }
        }
    }

    /// None: a point has as many dimensions as spins, steps and noises together.
    fn expect(&self) -> Option<Expect<'_>> {
        None
    }

    fn findings(&self) -> Result<Inspection, InspectError> {
        inspect(self.problem.system(), &InspectSettings::at_run_time(&self.problem))
    }
}

/// The model of a lattice.
pub fn build(
    source: &Source,
    table: &SystemTable,
    damping: Arc<dyn Damping>,
    settings: &Settings,
) -> Read<Built> {
    let parameters = Parameters::new(source, table, &PARAMETERS)?;
    let sizes = parameters.list("sizes")?.unwrap_or(vec![8.0]);
    let mut whole = Vec::new();
    for size in sizes {
        if size.fract() != 0.0 || !(1.0..=1e6).contains(&size) {
            let message = format!("a size is a whole number of at least 1, got {size}");
            return Err(parameters.error("sizes", message));
        }
        whole.push(size as usize);
    }
    let shape = match parameters.switch("periodic", false)? {
        true => Shape::periodic(&whole),
        false => Shape::open(&whole),
    };
    let shape = shape.map_err(|error| parameters.error("sizes", error))?;
    let transverse = parameters.number("transverse", 0.0)?;
    let noise = match parameters.has("temperature") {
        false => parameters.number("noise", 0.0)?,
        true if parameters.has("noise") => {
            let message = "the noise follows from the temperature: give one of them";
            return Err(parameters.error("temperature", message));
        }
        true => {
            let temperature = parameters.number("temperature", 0.0)?;
            if temperature < 0.0 || transverse <= 0.0 {
                let message = format!(
                    "a temperature of at least 0 needs `transverse` damping above 0, got \
                     {temperature} and {transverse}"
                );
                return Err(parameters.error("temperature", message));
            }
            noise_at_temperature(transverse, temperature)
        }
    };
    let couplings = Couplings {
        exchange: parameters.number("exchange", 1.0)?,
        anisotropy: parameters.number("anisotropy", 0.0)?,
        field: parameters.three("field", [0.0; 3])?,
        noise,
        local: parameters.switch("local", true)?,
        damping: transverse,
    };
    let lattice = SpinLattice::on_paths(shape, couplings);
    let lattice = lattice.map_err(|error| parameters.error("sizes", error))?;
    let sites = lattice.shape().sites();
    let y0 = match settings.initial[..] {
        [x, y, z] => [x, y, z].repeat(sites),
        ref all => all.to_vec(),
    };
    let components: Vec<String> =
        (1..=sites).flat_map(|site| ["x", "y", "z"].map(|axis| format!("s{site}{axis}"))).collect();
    let names = Names::with_variables(&components);
    let names = names.unwrap_or_else(|error| unreachable!("{error}"));
    let energy = energy(lattice.clone());
    let problem = Problem::new(Arc::new(lattice), damping, y0, settings.until)
        .map_err(|error| settings.initial_error(source, error))?;
    let per_spin = move |y: &[Row], values: &mut Row| {
        energy(y, values);
        values.iter_mut().for_each(|value| *value /= sites as f64);
    };
    let energy = Quantity::Function(Arc::new(per_spin));
    let mean = |axis: usize| {
        let mean = move |y: &[Row], values: &mut Row| {
            *values = [0.0; casimir::real::WIDTH];
            for spin in y.chunks(3) {
                values.iter_mut().zip(&spin[axis]).for_each(|(sum, s)| *sum += s / sites as f64);
            }
        };
        Observable::new(["mx", "my", "mz"][axis], Quantity::Function(Arc::new(mean)))
    };
    let mut quantities: Vec<Observable> = (0..3).map(mean).collect();
    quantities.push(Observable::new("energy", energy.clone()));
    Ok(Built { model: Box::new(Lattice { problem }), components, names, energy, quantities })
}

/// H₀ of 32 paths.
fn energy(lattice: SpinLattice) -> impl Fn(&[Row], &mut Row) + Send + Sync {
    let noises = lattice.description().noises;
    move |y, values| {
        let dw = vec![[0.0; casimir::real::WIDTH]; noises];
        let mut scratch = vec![[0.0; casimir::real::WIDTH]; lattice.description().scratch_rows()];
        lattice.energy(y, Weights { dt: 1.0, dw: &dw, areas: &[] }, values, &mut scratch);
    }
}
