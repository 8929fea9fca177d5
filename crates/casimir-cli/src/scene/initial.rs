//! Initial values: numbers, or formulas of random numbers.

use std::{slice::from_mut, sync::Arc};

use casimir::{
    formula::Formula,
    mc::Initial,
    noise::{StreamKey, WienerRows},
    real::{Row, WIDTH, elementary},
};

use super::{
    read::Constants,
    source::{Read, Source},
    values::{At, Text},
};

/// Fewest names z1, z2, … and u1, u2, … that there are.
const LEAST_NAMES: usize = 9;

/// Initial values in formulas of independent standard normals z1, z2, … and of numbers u1, u2, …
/// that are uniform on (0, 1).
#[derive(Debug)]
struct Random {
    formulas: Vec<Formula>,
    variables: usize,
    /// The variables that are used, and which of them are uniform.
    used: Vec<(usize, bool)>,
}

impl Random {
    /// Draws the states of 32 paths. Where a lattice has more components than there are formulas,
    /// these are of each site, with random numbers of its own.
    fn draw(&self, key: StreamKey, first_path: u64, rows: &mut [Row]) {
        let mut normals = WienerRows::new(key, first_path);
        let mut point = vec![[0.0; WIDTH]; self.variables];
        for site in rows.chunks_mut(self.formulas.len()) {
            for &(k, is_uniform) in &self.used {
                normals.increments(1.0, from_mut(&mut point[k]));
                if is_uniform {
                    // The squared radius of two normals is exponential.
                    let mut second = [0.0; WIDTH];
                    normals.increments(1.0, from_mut(&mut second));
                    let uniform = |z: f64, w: f64| elementary::exp(-0.5 * (z * z + w * w));
                    point[k].iter_mut().zip(second).for_each(|(z, w)| *z = uniform(*z, w));
                }
            }
            for (formula, row) in self.formulas.iter().zip(site) {
                formula.values(&point, row);
            }
        }
    }
}

/// The initial values of a scene: one that may occur, and their law if they are random.
pub fn initial(
    source: &Source,
    texts: &[At<Text>],
    constants: &Constants,
    key: StreamKey,
) -> Read<(Vec<f64>, Option<Initial<'static>>)> {
    let (mut names, number) = (constants.names.clone(), texts.len().max(LEAST_NAMES));
    for name in ["z", "u"].iter().flat_map(|kind| (1..=number).map(move |k| format!("{kind}{k}"))) {
        // A parameter may have the name.
        _ = names.variable(&name);
    }
    let parse = |text: &At<Text>| {
        Formula::parse(&text.0, &names).map_err(|error| source.formula_error(text, &error))
    };
    let formulas = texts.iter().map(parse).collect::<Read<Vec<_>>>()?;
    let variables = names.variables().iter().enumerate();
    let used = variables.filter(|(k, _)| formulas.iter().any(|formula| formula.depends_on(*k)));
    let used: Vec<_> = used.map(|(k, name)| (k, name.starts_with('u'))).collect();
    let random = Random { formulas, variables: names.variables().len(), used };
    let mut rows = vec![[0.0; WIDTH]; texts.len()];
    random.draw(key, 0, &mut rows);
    if let Some((text, row)) = texts.iter().zip(&rows).find(|(_, row)| !row[0].is_finite()) {
        return Err(source.error(text.span(), format!("this must be finite, and is {}", row[0])));
    }
    let y0 = rows.iter().map(|row| row[0]).collect();
    let is_random = !random.used.is_empty();
    let words = texts.iter().map(|text| &*text.0).collect::<Vec<_>>().join(", ");
    let draw = move |key, first, rows: &mut [Row]| random.draw(key, first, rows);
    let law = Initial { law: format!("({words})"), draw: Arc::new(draw) };
    Ok((y0, is_random.then_some(law)))
}
