//! What `inspect` says of the five systems of the paper; with `--json`, as data.
//!
//! ```text
//! cargo run -p casimir-poisson --example inspect_systems
//! ```

use casimir::analysis::inspect::{InspectError, Inspection};
use casimir::prelude::*;
use casimir::systems::{
    IntegerExponents, LotkaVolterra, MaxwellBloch, Pendulum, Poisson3, RigidBody, RigidBodyEnergy,
};

/// The report on a system alone.
fn alone<S: PoissonSystem<D, M>, const D: usize, const M: usize>(
    system: S,
) -> Result<Inspection, InspectError> {
    inspect(&Compiled::new(system, [1.0; D]), &InspectSettings::default())
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let inertia = [2.0, 1.0, 2.0 / 3.0];
    let reports = [
        alone(Pendulum::new(1.0)?)?,
        alone(RigidBody::three_noises(inertia, [1.0, 2.0, 3.0])?)?,
        alone(RigidBody::one_noise(inertia, 1.0)?)?,
        alone(RigidBodyEnergy::new(inertia, 1.0)?)?,
        alone(LotkaVolterra::<IntegerExponents<2, 2>>::integer(1.0)?)?,
        alone(MaxwellBloch)?,
        alone(Poisson3::new(1.0)?)?,
    ];
    if std::env::args().any(|argument| argument == "--json") {
        println!("{}", serde_json::to_string_pretty(&reports)?);
        return Ok(());
    }
    for report in reports {
        println!("{report}\n");
    }
    Ok(())
}
