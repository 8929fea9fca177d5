//! Spins on a lattice.

use std::sync::{Arc, OnceLock};

use casimir::{
    mc::demand,
    real::{Row, Rows, WIDTH},
    systems::{
        lattice::{Couplings, Shape, SpinLattice, noise_at_temperature},
        run_time::{Problem, System, Weights},
    },
};

use super::{AtRunTime, Built, damping::damping, project::numbered};
use crate::{BathTable, Further, Observable, Quantity, Read, Reading, Settings, refuse};

/// The parameters of a lattice.
pub const PARAMETERS: &str =
    "sizes, periodic, exchange, anisotropy, field, noise, local, transverse";

/// Bytes that a site takes where it is simulated or inspected.
const SITE: f64 = 1.5e4;
/// Relative tolerance for the lengths of spins.
const ROUNDING: f64 = 1e-9;

/// Sizes and shape of a lattice, `default` if none are given, whose sites take `bytes` each.
pub fn shape(reading: &Reading<'_>, default: f64, bytes: f64) -> Read<(Vec<usize>, Shape)> {
    let sizes = reading.list("sizes", &[default])?;
    if let Some(size) = sizes.iter().find(|n| n.fract() != 0.0 || !(1.0..=1e6).contains(*n)) {
        refuse!(reading.place("sizes"), "a size is a whole number of at least 1, got {size}");
    }
    let sizes: Vec<usize> = sizes.iter().map(|size| *size as usize).collect();
    let shape = Shape::new(&sizes, reading.switch("periodic", false)?)
        .map_err(|error| reading.error("sizes", error))?;
    let sites = shape.sites();
    demand(format!("a lattice of {sites} sites"), bytes * sites as f64)
        .map_err(|error| reading.error("sizes", error))?;
    Ok((sizes, shape))
}

/// Damping α and temperature kT of the one bath of all spins of a lattice.
pub fn bath(reading: &Reading<'_>) -> Read<Option<[f64; 2]>> {
    let [BathTable { temperature, through, friction, transverse }, more @ ..] = &*reading.file.bath
    else {
        return Ok(None);
    };
    let alone = through.len() + friction.len() + more.len() == 0 && transverse.len() == 1;
    let Some((_, alpha)) = transverse.first().filter(|(s, _)| alone && s.as_str() == "s") else {
        refuse!(
            temperature,
            "a lattice has one bath, by transverse damping of all its spins: \
             `transverse = {{ s = 0.1 }}`"
        );
    };
    // The same at all times: t is no name here.
    let [alpha, kt] = [reading.constants.value(alpha)?, reading.constants.value(temperature)?];
    if kt < 0.0 || alpha <= 0.0 {
        refuse!(
            temperature,
            "a temperature of at least 0 needs `transverse` damping above 0, got {kt} and {alpha}"
        );
    }
    Ok(Some([alpha, kt]))
}

/// Builds the model of a lattice.
pub fn build(reading: &Reading<'_>) -> Read<Built> {
    reading.know(&PARAMETERS.split(", ").collect::<Vec<_>>())?;
    let (sizes, shape) = shape(reading, 8.0, SITE)?;
    let sites = shape.sites();
    let Settings { initial, until, .. } = reading.settings;
    let y0 = match initial[..] {
        [x, y, z] => [x, y, z].repeat(sites),
        ref all => all.to_vec(),
    };
    let local = reading.switch("local", true)?;
    let (transverse, noise) = match (bath(reading)?, reading.file.bath.first()) {
        (Some([transverse, kt]), Some(BathTable { temperature, .. })) => {
            if let Some(place) = reading.place("transverse").or(reading.place("noise")) {
                refuse!(place, "damping and noise follow from the bath: leave this out");
            }
            if sites > 1 && !local || reading.file.damping.is_some() {
                refuse!(
                    temperature,
                    "a bath takes a noise for each spin, `local`, and no [damping]: give `noise`"
                );
            }
            // Of random initial values those of the first 32 paths are looked at.
            let mut rows: Vec<Row> = y0.iter().map(|y| [*y; WIDTH]).collect();
            if let Some(law) = &reading.settings.random {
                (law.draw)(reading.settings.key, 0, &mut rows);
            }
            let norm = |s: [f64; 3]| s.iter().map(|s| s * s).sum::<f64>().sqrt();
            let (mut least, mut most) = (f64::INFINITY, 0.0f64);
            for spin in rows.chunks_exact(3) {
                for p in 0..WIDTH {
                    let length = norm([spin[0][p], spin[1][p], spin[2][p]]);
                    (least, most) = (least.min(length), most.max(length));
                }
            }
            if most - least > ROUNDING * most {
                refuse!(temperature, "spins have lengths from {least} to {most}: give `noise`");
            }
            let most = y0.chunks_exact(3).map(|s| norm([s[0], s[1], s[2]])).fold(0.0, f64::max);
            // σ² = 2α kT/|s|. A length of one is not exactly one.
            let length = if most == 0.0 || (most - 1.0).abs() < ROUNDING { 1.0 } else { most };
            (transverse, noise_at_temperature(transverse, kt / length))
        }
        _ => (reading.number("transverse", 0.0)?, reading.number("noise", 0.0)?),
    };
    let couplings = Couplings {
        exchange: reading.number("exchange", 1.0)?,
        anisotropy: reading.number("anisotropy", 0.0)?,
        field: reading.three("field", [0.0; 3])?,
        noise,
        local,
        damping: transverse,
    };
    let lattice =
        SpinLattice::on_paths(shape, couplings).map_err(|error| reading.error("sizes", error))?;
    let components: Vec<String> =
        (1..=sites).flat_map(|site| ["x", "y", "z"].map(|axis| format!("s{site}{axis}"))).collect();
    let system = lattice.clone();
    let per_spin = move |y: &[Row], values: &mut Row| {
        let description = system.description();
        let [dw, mut scratch] = [description.noises, description.scratch_rows()].map(Rows::zero);
        system.energy(
            &y[..3 * sites],
            Weights { dt: 1.0, dw: &dw, ..Weights::NONE },
            values,
            &mut scratch,
        );
        values.iter_mut().for_each(|value| *value /= sites as f64);
    };
    let energy = Quantity::Function(Arc::new(per_spin));
    let names = numbered(&components);
    let (damping, friction) = damping(reading, &components, &[])?;
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
        sizes,
        model: Box::new(AtRunTime {
            problem,
            friction,
            formulas: None,
            facts: OnceLock::new(),
            flows: OnceLock::new(),
        }),
        names,
        components,
        energy: Some(Further::Quantity(energy)),
        quantities,
    })
}
