//! Heat baths: what they do to the equation, exact steps for friction and noise, and samplers whose
//! steps have no bias, beside wrong ones.

mod baoab;
mod baths;
mod statistical;

use std::sync::Arc;

use formula::{Bath, Definition, FormulaSystem};
use systems::{Constant, run_time::Problem};

/// Texts of a system in baths through functions, each at a temperature.
fn texts(state: &str, structure: &[&str], energy: &str, baths: &[(&str, f64)]) -> Definition {
    let words = |text: &str| text.split_whitespace().map(String::from).collect::<Vec<_>>();
    let bath = |(through, kt): &(&str, f64)| Bath {
        through: (*through).into(),
        temperature: kt.to_string(),
    };
    Definition {
        name: "texts".into(),
        state: words(state),
        structure: structure.iter().map(|row| words(row)).collect::<Vec<_>>().into(),
        energy: energy.into(),
        baths: baths.iter().map(bath).collect(),
        ..Definition::default()
    }
}

/// B of a body, and the energy of one with moments of inertia 2, 1, ⅔.
const BODY: [&str; 2] = ["-z y", "-x"];
const ENERGY: &str = "x^2/4 + y^2/2 + 0.75*z^2";
/// An initial value of length one.
const UNIT: [f64; 3] = [0.6, 0.0, 0.8];

fn system(definition: &Definition, y0: &[f64]) -> FormulaSystem {
    FormulaSystem::new(definition, y0).unwrap()
}

/// The problem of texts without damping.
fn problem(definition: &Definition, y0: &[f64], t_end: f64) -> Problem {
    let damping = Arc::new(Constant::new(0.0).unwrap());
    Problem::new(Arc::new(system(definition, y0)), damping, y0.to_vec(), t_end).unwrap()
}
