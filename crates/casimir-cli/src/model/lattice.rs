//! Spins on a lattice.

use std::sync::Arc;

use casimir::{
    real::{Row, WIDTH},
    systems::{
        lattice::{Couplings, Shape, SpinLattice, noise_at_temperature},
        run_time::{Problem, System, Weights},
    },
};

use super::{Built, at_run_time::AtRunTime, damping, project::numbered};
use crate::scene::{Further, Observable, Parameters, Quantity, Read, Reading, Settings, refuse};

/// The parameters of a lattice.
const PARAMETERS: [&str; 9] = [
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

/// What lengths of spins may differ by, relative.
const ROUNDING: f64 = 1e-9;

/// The model of a lattice.
pub fn build(reading: &Reading<'_>) -> Read<Built> {
    let parameters = Parameters::new(reading, &PARAMETERS)?;
    let sizes = parameters.list("sizes", &[8.0])?;
    let mut whole = Vec::new();
    for size in sizes {
        if size.fract() != 0.0 || !(1.0..=1e6).contains(&size) {
            refuse!(parameters, "sizes", "a size is a whole number of at least 1, got {size}");
        }
        whole.push(size as usize);
    }
    let shape = match parameters.switch("periodic", false)? {
        true => Shape::periodic(&whole),
        false => Shape::open(&whole),
    };
    let shape = shape.map_err(|error| parameters.error("sizes", error))?;
    let sites = shape.sites();
    let Settings { initial, until, .. } = reading.settings;
    let y0 = match initial[..] {
        [x, y, z] => [x, y, z].repeat(sites),
        ref all => all.to_vec(),
    };
    let transverse = parameters.number("transverse", 0.0)?;
    let local = parameters.switch("local", true)?;
    let given = |name| parameters.get(name).is_some();
    let noise = match given("temperature") {
        false => parameters.number("noise", 0.0)?,
        true if given("noise") => {
            refuse!(parameters, "temperature", "the noise follows from the temperature: give one of them");
        }
        true => {
            let temperature = parameters.number("temperature", 0.0)?;
            if temperature < 0.0 || transverse <= 0.0 {
                refuse!(parameters, "temperature", "a temperature of at least 0 needs `transverse` damping above 0, got \
                     {temperature} and {transverse}");
            }
            if sites > 1 && !local || reading.file.damping.is_some() {
                refuse!(parameters, "temperature", "a temperature takes a noise for each spin, `local`, and no \
                               [damping]: give `noise`");
            }
            // Of random initial values those of the first 32 paths are looked at.
            let mut rows: Vec<Row> = y0.iter().map(|y| [*y; WIDTH]).collect();
            reading
                .settings
                .random
                .iter()
                .for_each(|law| (law.draw)(reading.settings.key, 0, &mut rows));
            let norm = |s: &[f64]| s.iter().map(|s| s * s).sum::<f64>().sqrt();
            let lengths = rows
                .chunks_exact(3)
                .flat_map(|s| (0..WIDTH).map(move |p| norm(&[s[0][p], s[1][p], s[2][p]])));
            let (least, most) =
                lengths.fold((f64::INFINITY, 0.0f64), |(a, b), s| (a.min(s), b.max(s)));
            if most - least > ROUNDING * most {
                refuse!(parameters, "temperature", "spins have lengths from {least} to {most}: give `noise`");
            }
            let most = y0.chunks_exact(3).map(norm).fold(0.0, f64::max);
            // σ² = 2α kT/|s|. A length of one is not exactly one.
            let length = if most == 0.0 || (most - 1.0).abs() < ROUNDING { 1.0 } else { most };
            noise_at_temperature(transverse, temperature / length)
        }
    };
    let couplings = Couplings {
        exchange: parameters.number("exchange", 1.0)?,
        anisotropy: parameters.number("anisotropy", 0.0)?,
        field: parameters.three("field", [0.0; 3])?,
        noise,
        local,
        damping: transverse,
    };
    let lattice = SpinLattice::on_paths(shape, couplings);
    let lattice = lattice.map_err(|error| parameters.error("sizes", error))?;
    let components: Vec<String> =
        (1..=sites).flat_map(|site| ["x", "y", "z"].map(|axis| format!("s{site}{axis}"))).collect();
    let system = lattice.clone();
    let per_spin = move |y: &[Row], values: &mut Row| {
        let dw = vec![[0.0; WIDTH]; system.description().noises];
        let mut scratch = vec![[0.0; WIDTH]; system.description().scratch_rows()];
        system.energy(&y[..3 * sites], Weights { dt: 1.0, dw: &dw, ..Weights::NONE }, values, &mut scratch);
        values.iter_mut().for_each(|value| *value /= sites as f64);
    };
    let energy = Quantity::Function(Arc::new(per_spin));
    let names = numbered(&components);
    let rates = damping::rates(reading, &components, &[])?;
    let (damping, friction) = damping::damping(reading, &rates, components.len())?;
    let problem = Problem::new(Arc::new(lattice), damping, y0, *until)
        .map_err(|error| reading.initial_error(error))?;
    let mean = |axis: usize| {
        let mean = move |y: &[Row], values: &mut Row| {
            *values = [0.0; WIDTH];
            for spin in y[..3 * sites].chunks(3) {
                values.iter_mut().zip(&spin[axis]).for_each(|(sum, s)| *sum += s / sites as f64);
            }
        };
        Observable::new(["mx", "my", "mz"][axis], Quantity::Function(Arc::new(mean)))
    };
    let mut quantities: Vec<Observable> = (0..3).map(mean).collect();
    quantities.push(Observable::new("energy", energy.clone()));
    Ok(Built {
        sizes: whole,
        model: Box::new(AtRunTime::new(problem, friction, None)),
        names,
        components,
        energy: Further::Quantity(energy),
        quantities,
    })
}
