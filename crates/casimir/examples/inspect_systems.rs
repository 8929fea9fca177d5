//! What `inspect` says of the five systems of the paper; with `--json`, as data.
//!
//! ```text
//! cargo run -p casimir-poisson --example inspect_systems
//! ```

use casimir::prelude::*;
use casimir::systems::{
    IntegerExponents, LotkaVolterra, MaxwellBloch, Pendulum, Poisson3, RigidBody, RigidBodyEnergy,
};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let inertia = [2.0, 1.0, 2.0 / 3.0];
    let reports = [
        inspect(&Pendulum::new(1.0)?)?,
        inspect(&RigidBody::three_noises(inertia, [1.0, 2.0, 3.0])?)?,
        inspect(&RigidBody::one_noise(inertia, 1.0)?)?,
        inspect(&RigidBodyEnergy::new(inertia, 1.0)?)?,
        inspect(&LotkaVolterra::<IntegerExponents<2, 2>>::integer(1.0)?)?,
        inspect(&MaxwellBloch)?,
        inspect(&Poisson3::new(1.0)?)?,
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
