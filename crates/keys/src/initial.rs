//! Initial values: numbers, formulas of random numbers, or a file of states.

use std::{collections::BTreeSet, fs, path::Path, slice::from_mut, sync::Arc};

use casimir::{
    expectation::is_level,
    formula::Formula,
    mc::{Initial, parts::hash},
    noise::{StreamKey, WienerRows},
    real::{Row, WIDTH, elementary},
};

use crate::{At, Constants, Listed, Read, Source, Start, Text, Wrong, refuse};

/// Least number of names z1, z2, … and of names u1, u2, …
const MIN_NAMES: usize = 9;

/// Functions of other programs, and what is here.
const LAWS: [&str; 8] = ["N", "U", "normal", "gauss", "randn", "rand", "random", "uniform"];
const RANDOM: &str = "unknown function: z1, z2, … are standard normals, u1, u2, … uniform on \
                      (0, 1); 2 + 3*z1 has mean 2 and deviation 3";

/// Standard normals.
fn normal(normals: &mut WienerRows) -> Row {
    let mut row = [0.0; WIDTH];
    normals.increments(1.0, from_mut(&mut row));
    row
}

/// Numbers on (0, 1): the squared radius of two normals is exponential.
fn uniform(normals: &mut WienerRows) -> Row {
    let (z, w) = (normal(normals), normal(normals));
    std::array::from_fn(|p| elementary::exp(-0.5 * (z[p] * z[p] + w[p] * w[p])))
}

/// A possible initial value, and the law of initial values if they are random.
pub type Begun = (Vec<f64>, Option<Initial<'static>>);

/// The states of a file, one in a line: numbers with blanks or commas between them. Lines that
/// begin with # and a first line of names do not count.
fn states(source: &Source, file: &str, at: &At<Start>) -> Read<Arc<Vec<Vec<f64>>>> {
    if let Some(states) = &source.states {
        return Ok(states.clone());
    }
    let path = Path::new(&source.name).with_file_name(file);
    let text = match fs::read_to_string(path) {
        Ok(text) => text,
        Err(error) => refuse!(at, "cannot read the states {file}: {error}"),
    };
    let mut states: Vec<Vec<f64>> = Vec::new();
    for (number, line) in text.lines().enumerate() {
        let words = line.split([',', ' ', '\t']).filter(|word| !word.is_empty());
        let state: Result<Vec<f64>, _> = words.map(str::parse).collect();
        match state.ok().filter(|state| state.iter().all(|x| x.is_finite())) {
            _ if line.trim().is_empty() || line.starts_with('#') => {}
            Some(state) if states.first().is_none_or(|first| first.len() == state.len()) => {
                states.push(state);
            }
            None if number == 0 => {}
            _ => refuse!(at, "line {} of {file} is no state: {line}", number + 1),
        }
    }
    if states.is_empty() {
        refuse!(at, "{file} has no state");
    }
    Ok(Arc::new(states))
}

/// The initial values that a file has: in turn, or at random for points that have an order of their
/// own.
fn of_file(source: &Source, file: &str, at: &At<Start>) -> Read<Begun> {
    let states = states(source, file, at)?;
    let (number, y0) = (states.len(), states[0].clone());
    let law = format!("the {number} states of {file}, SHA-256 {}", hash(&*states));
    let draw = move |key, first, rows: &mut [Row]| {
        let places = uniform(&mut WienerRows::new(key, first));
        for p in 0..WIDTH {
            let place = if is_level(key) {
                ((places[p] * number as f64) as usize).min(number - 1)
            } else {
                ((first + p as u64) % number as u64) as usize
            };
            rows.iter_mut().zip(&states[place]).for_each(|(row, y)| row[p] = *y);
        }
    };
    Ok((y0, Some(Initial { law, draw: Arc::new(draw) })))
}

/// The initial values of a scene: of formulas of independent standard normals z1, z2, … and of
/// numbers u1, u2, … that are uniform on (0, 1), or of a file. Sites that have places give them in
/// the rows that the law fills.
pub fn initial(
    source: &Source,
    at: &At<Start>,
    constants: &Constants,
    key: StreamKey,
    has_places: bool,
) -> Read<Begun> {
    let texts = match &**at {
        Listed::List(none) if none.is_empty() => {
            refuse!(at, "the initial value has no component");
        }
        Listed::List(texts) => texts,
        Listed::Text(file) => return of_file(source, file, at),
    };
    let (mut names, number) = (constants.names.clone(), texts.len().max(MIN_NAMES));
    for name in ["z", "u"].iter().flat_map(|kind| (1..=number).map(move |k| format!("{kind}{k}"))) {
        // A parameter may have the name.
        _ = names.variable(&name);
    }
    const PLACES: [&str; 3] = ["x", "y", "z"];
    if has_places {
        PLACES.iter().for_each(|name| _ = names.variable(name));
    }
    let parse =
        |text: &At<Text>| text.formula(&names).map_err(|wrong: Wrong| wrong.instead(&LAWS, RANDOM));
    let formulas = texts.iter().map(parse).collect::<Read<Vec<_>>>()?;
    // The variables that are used, and which of them are uniform, or components of a place.
    let used: BTreeSet<usize> = formulas.iter().flat_map(Formula::reads).collect();
    let kind = |k: usize| {
        let name = &names.variables()[k];
        (k, name.starts_with('u'), PLACES.iter().position(|place| place == name))
    };
    let used: Vec<_> = used.into_iter().map(kind).collect();
    let (variables, is_random) = (names.variables().len(), !used.is_empty());
    // Where a lattice has more components than there are formulas, these are of each site, with
    // random numbers of its own.
    let draw = move |key: StreamKey, first_path: u64, rows: &mut [Row]| {
        let mut normals = WienerRows::new(key, first_path);
        let mut point = vec![[0.0; WIDTH]; variables];
        for site in rows.chunks_mut(formulas.len()) {
            for &(k, is_uniform, of_place) in &used {
                point[k] = match of_place {
                    Some(c) => site[c],
                    None if is_uniform => uniform(&mut normals),
                    None => normal(&mut normals),
                };
            }
            for (formula, row) in formulas.iter().zip(site) {
                *row = formula.values(&point);
            }
        }
    };
    let mut rows = vec![[0.0; WIDTH]; texts.len()];
    draw(key, 0, &mut rows);
    if let Some((text, row)) = texts.iter().zip(&rows).find(|(_, row)| !row[0].is_finite()) {
        refuse!(text, "this must be finite, and is {}", row[0]);
    }
    let y0 = rows.iter().map(|row| row[0]).collect();
    let words = texts.iter().map(|text| &*text.0).collect::<Vec<_>>().join(", ");
    let law = Initial { law: format!("({words})"), draw: Arc::new(draw) };
    Ok((y0, is_random.then_some(law)))
}
