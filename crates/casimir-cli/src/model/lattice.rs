//! Spins on a lattice.

use std::{error::Error, sync::Arc};

use casimir::{
    analysis::{Candidates, CompareSettings, Comparison, compare, inspect_large},
    formula::Names,
    mc::{self, Expect, Setup},
    real::Row,
    schemes::Split,
    systems::{
        Damping,
        run_time::{Couplings, Problem, Shape, SpinLattice, System, Weights, noise_at_temperature},
    },
};

use super::{Built, Findings, Model, row_schemes::RowSchemes};
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
    schemes: RowSchemes,
}

impl Model for Lattice {
    fn setup(&self, scheme: &str) -> Result<Setup<'_>, String> {
        let scheme = self.schemes.get(scheme)?;
        Setup::at_run_time(&self.problem, scheme).map_err(|error| error.to_string())
    }

    fn recommended(&self) -> (&'static str, String) {
        let system = self.problem.system();
        match system.parts() {
            Ok(_) => {
                ("split", "it keeps the length of each spin, and the energy stays near".into())
            }
            Err(_) if system.is_transverse() => {
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

    fn compare(&self, settings: &CompareSettings<'_>) -> Result<Comparison, Box<dyn Error>> {
        let candidates = Candidates::at_run_time(&self.problem)?;
        Ok(compare(&mc::Problem::at_run_time(&self.problem), &candidates, settings)?)
    }

    fn findings(&self) -> Result<Findings, Box<dyn Error>> {
        Ok(Findings::Large(inspect_large(self.problem.system(), self.problem.y0())?))
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
    let mut schemes = RowSchemes::new(&lattice);
    schemes.add("split", Ok(Box::new(Split)));
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
    Ok(Built {
        model: Box::new(Lattice { problem, schemes }),
        components,
        names,
        energy,
        quantities,
    })
}

/// H₀ of 32 paths.
fn energy(lattice: SpinLattice) -> impl Fn(&[Row], &mut Row) + Send + Sync {
    let noises = lattice.noises();
    move |y, values| {
        let dw = vec![[0.0; casimir::real::WIDTH]; noises];
        let mut scratch = vec![[0.0; casimir::real::WIDTH]; lattice.scratch_rows()];
        lattice.energy(y, Weights { dt: 1.0, dw: &dw }, values, &mut scratch);
    }
}
