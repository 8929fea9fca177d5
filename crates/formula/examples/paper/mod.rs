//! The systems of the paper as texts.

use formula::Definition;

fn words(texts: &[&str]) -> Vec<String> {
    texts.iter().map(|&text| text.to_owned()).collect()
}

fn definition(
    name: &str,
    structure: &[&[&str]],
    energy: &str,
    noises: &[&str],
    parameters: &[(&str, f64)],
) -> Definition {
    let dimension = structure.len() + 1;
    Definition {
        name: name.to_owned(),
        state: (1..=dimension).map(|i| format!("y{i}")).collect(),
        parameters: parameters.iter().map(|&(name, value)| (name.to_owned(), value)).collect(),
        structure: structure.iter().map(|row| words(row)).collect::<Vec<_>>().into(),
        energy: energy.to_owned(),
        noises: words(noises),
        ..Definition::default()
    }
}

/// The pendulum with noise of size c.
pub fn pendulum(c: f64) -> Definition {
    let energy = "y1^2/2 - cos(y2)";
    definition("pendulum", &[&["-1"]], energy, &["c*(y1^2/2 - cos(y2))"], &[("c", c)])
}

/// The rigid body with three noises.
pub fn rigid_body(inertia: [f64; 3], noise: [f64; 3]) -> Definition {
    let [a, b, c] = inertia;
    let [d, e, f] = noise;
    definition(
        "rigid-body",
        &[&["-y3", "y2"], &["-y1"]],
        "(y1^2/I1 + y2^2/I2 + y3^2/I3)/2",
        &["y1^2/(2*J1)", "y2^2/(2*J2)", "y3^2/(2*J3)"],
        &[("I1", a), ("I2", b), ("I3", c), ("J1", d), ("J2", e), ("J3", f)],
    )
}

/// The Lotka–Volterra system with p = q = 2.
pub fn lotka_volterra(c: f64) -> Definition {
    let energy = "y1^2*y2^2*y3";
    definition(
        "lotka-volterra",
        &[&["-c/(y1*y2)", "c/(y1*y2)"], &["-2*c/(y1*y2)"]],
        energy,
        &[energy],
        &[("c", c)],
    )
}

/// The Maxwell–Bloch system.
pub fn maxwell_bloch() -> Definition {
    let energy = "y1^2/2 + y3";
    definition("maxwell-bloch", &[&["-y3", "y2"], &["0"]], energy, &["y3"], &[])
}

/// The system in three dimensions with constant B.
pub fn poisson3(c: f64) -> Definition {
    let energy = "sin(y1) + sin(y2) + sin(y3)";
    let noise = "c*(sin(y1) + sin(y2) + sin(y3))";
    definition("poisson3", &[&["1", "-1"], &["1"]], energy, &[noise], &[("c", c)])
}
