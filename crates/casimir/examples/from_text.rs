//! A heavy top from texts: a table of one path, the quantiles of many, and an expectation.
//!
//! `cargo run --release -p casimir-poisson --example from_text`

use std::{error::Error, sync::Arc};

use casimir::{
    formula::{Definition, Formula, FormulaDamping, FormulaSystem},
    mc::{
        RowFunction, Setup, Simulation,
        multilevel::{Coupling, ExpectationSettings, expectation},
    },
    prelude::*,
    systems::run_time,
};

fn main() -> Result<(), Box<dyn Error>> {
    let words = |text: &str| text.split_whitespace().map(String::from).collect::<Vec<_>>();
    // B(M, G)v above the diagonal: se(3)*, with the Casimirs |G|² and M·G.
    let top = Definition {
        name: "heavy top".into(),
        state: words("M1 M2 M3 G1 G2 G3"),
        parameters: vec![("k".into(), 0.9), ("s".into(), 0.5)],
        structure: ["-M3 M2 0 -G3 G2", "-M1 G3 0 -G1", "-G2 G1 0", "0 0", "0"].map(words).into(),
        energy: "M1^2/2 + 0.4*M2^2 + k*M3^2 + G3".into(),
        noises: words("s*M1 0.7*G3"),
        observables: vec![],
    };
    let y0 = vec![0.2, 0.1, 1.0, 0.1, 0.2, 0.9];
    let system = Arc::new(FormulaSystem::new(&top, &y0)?);
    let damping = Arc::new(FormulaDamping::new("0.2 + 0.1*sin(t)", &[])?);
    let problem = run_time::Problem::new(system.clone(), damping, y0, 2.0)?;
    let scheme = SexpLi::at_run_time(&*system)?;

    let nutation = Formula::parse("G1*M1 + G2*M2", system.names())?;
    let nutation = RowFunction {
        name: "nutation".into(),
        function: move |y: &[_], values: &mut _| nutation.values(y, values),
    };
    let (truncation, key) = (Truncation::new(4)?, StreamKey { seed: 1, experiment: 0 });
    let settings = ExpectationSettings::new(key, truncation, 16, Coupling::Antithetic);
    let setup = Setup::at_run_time(&problem, &scheme)?;
    let found = expectation(&setup, &[&nutation], 2e-3, &settings, &|_| ())?;
    let (lo, hi) = found.estimates[0].interval();
    println!("E nutation in [{lo:.4}, {hi:.4}]");

    let simulation = Simulation::new(setup, truncation).every(32).observing(nutation);
    let path = &simulation.paths(256, key, 0..1)?[0];
    for (t, value) in path.times().iter().zip(path.column("nutation").unwrap_or_default()) {
        println!("t = {t:.2}: nutation {value:.6}");
    }
    Ok(())
}
