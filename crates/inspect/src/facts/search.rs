//! The search for linear and quadratic Casimirs, from B alone; or for functions that an equation
//! without B keeps, from its fields.

use real::elementary::sin;
use systems::Linearity;

use super::{
    Batch, Form, Matrix, Probe, axis, dot, largest, moved, norm, null_space, places, readable,
    without_own,
};

/// Relative tolerance: a value below this part of its terms counts as zero.
pub const ZERO: f64 = 1e-9;
/// Rows of B below this part of the largest entry are round-off and are skipped.
const NOISE: f64 = 32.0 * f64::EPSILON;
/// Smallest pivot that is clearly not zero.
const CLEAR: f64 = 1e-6;
/// Largest number of unknowns of a quadratic Casimir: their elimination takes a tenth of a second.
pub const UNKNOWNS: usize = 300;
/// Largest number of components of a part in which sums of logarithms are sought.
const LOGARITHMS: usize = 64;
/// Equations for each unknown; a matrix of low rank has few at a point.
const SURPLUS: usize = 2;

/// Functions that may be Casimirs.
#[derive(Default)]
pub struct Candidates {
    /// Linear forms, then quadratic ones that are not products of these, then sums of logarithms.
    pub forms: Vec<Form>,
    /// Whether other linear or quadratic Casimirs are excluded.
    pub complete: bool,
}

/// Largest number of components of a system whose Casimirs are searched: a form has D² numbers.
pub const MAX_SEARCHED: usize = 512;

/// Point y with the blocks of B(y) on the parts of the state.
type AtPoint = (Vec<f64>, Vec<Matrix>);

/// Solves B(y)∇C(y) = 0 for the coefficients of C in each part of the state that B does not join
/// with others. `points` gives more points with each call, if it has any.
pub fn casimirs(
    probe: &mut Probe<'_>,
    mut points: impl FnMut(&mut Probe<'_>) -> Batch,
) -> Candidates {
    let d = probe.dimension();
    if d > MAX_SEARCHED {
        return Candidates::default();
    }
    let y = points(probe);
    let parts = match &probe.description.joined[..] {
        [] => parts(probe, &y),
        joined => joined.to_vec(),
    };
    let first = with_blocks(probe, y, &parts);
    let mut states = first.clone();
    let mut found = [const { Vec::new() }; 3];
    let mut complete = true;
    for (n, part) in parts.iter().enumerate() {
        let size = part.len();
        let all: Vec<usize> = (0..size).collect();
        let ones = equations((n, &all), &first, |b, _| b.to_vec());
        let (ones, least) = null_space(ones, size, ZERO);
        complete &= least > CLEAR;
        let unknowns = size * (size + 1) / 2;
        let rank = (size - ones.len()).min(first.first().map_or(0, |(_, b)| b[n].len()));
        let mut twos = Matrix::new();
        if unknowns > UNKNOWNS {
            complete = false;
        } else if probe.description.linearity != Linearity::Constant && rank > 0 {
            while states.len() * rank < SURPLUS * unknowns {
                let new = points(probe);
                if new.is_empty() {
                    complete = false;
                    break;
                }
                states.extend(with_blocks(probe, new, &parts));
            }
            let rows = equations((n, &all), &states, |b, y| quadratic_row(part, b, y));
            let (found, least) = null_space(rows, unknowns, ZERO);
            complete &= least > CLEAR;
            twos = beyond(found, products(&ones, size));
        }
        // Components that are Casimirs by themselves have logarithms that are nothing new.
        let mut moving = all.clone();
        moving.retain(|&j| first.iter().flat_map(|(_, b)| &b[n]).any(|row| row[j] != 0.0));
        if size > LOGARITHMS {
            moving.clear();
        }
        let of_logarithms = equations((n, &moving), &first, |b, y| {
            without_own(b, &moving.iter().map(|&j| y[part[j]]).collect::<Vec<_>>())
        });
        let (logarithms, _) = null_space(of_logarithms, moving.len(), ZERO);
        let whole = |degree: u32, x: Vec<f64>| {
            let mut coefficients = vec![0.0; d.pow(degree.max(1))];
            let x = readable(x, ZERO).into_iter();
            if degree == 2 {
                for ((k, l), c) in places(size).zip(x) {
                    coefficients[part[k] * d + part[l]] = c;
                    coefficients[part[l] * d + part[k]] = c;
                }
            } else {
                let places = if degree == 0 { &moving } else { &all };
                places.iter().zip(x).for_each(|(i, c)| coefficients[part[*i]] = c);
            }
            Form { degree, coefficients }
        };
        for (found, (degree, x)) in found.iter_mut().zip([(1, ones), (2, twos), (0, logarithms)]) {
            found.extend(x.into_iter().map(|x| whole(degree, x)));
        }
    }
    Candidates { forms: found.concat(), complete }
}

/// The parts of the state that B joins: by an entry, or by what an entry depends on.
fn parts(probe: &mut Probe<'_>, y: &[Vec<f64>]) -> Vec<Vec<usize>> {
    let d = probe.dimension();
    let mut label: Vec<usize> = (0..d).collect();
    // A vector without special ratios.
    let v = [(0..d).map(|i| sin(1.0 + 0.7 * i as f64)).collect()];
    for j in 0..d {
        let axis = [axis(d, j)];
        let column = probe.structure(y, &axis);
        let along = probe.structure_along(y, &axis, &v);
        for i in (0..d).filter(|i| column.iter().chain(&along).any(|out| out[*i] != 0.0)) {
            let (one, other) = (label[i], label[j]);
            label.iter_mut().filter(|label| **label == other).for_each(|label| *label = one);
        }
    }
    let part = |one: usize| (0..d).filter(|i| label[*i] == one).collect::<Vec<_>>();
    (0..d).map(part).filter(|part| !part.is_empty()).collect()
}

/// Points with the blocks of B there. Columns of different parts are computed at once.
fn with_blocks(probe: &mut Probe<'_>, y: Batch, parts: &[Vec<usize>]) -> Vec<AtPoint> {
    if probe.description.plain {
        let rows = probe.matrix(&y).into_iter().map(|rows| vec![rows]);
        return y.into_iter().zip(rows).collect();
    }
    let zero = |part: &Vec<usize>| vec![vec![0.0; part.len()]; part.len()];
    let mut blocks: Vec<Vec<Matrix>> = vec![parts.iter().map(zero).collect(); y.len()];
    for k in 0..parts.iter().map(Vec::len).max().unwrap_or(0) {
        let mut v = vec![0.0; probe.dimension()];
        parts.iter().filter_map(|part| part.get(k)).for_each(|&j| v[j] = 1.0);
        for (blocks, column) in blocks.iter_mut().zip(probe.structure(&y, &[v])) {
            for (block, part) in blocks.iter_mut().zip(parts).filter(|(_, part)| k < part.len()) {
                block.iter_mut().zip(part).for_each(|(row, &i)| row[k] = column[i]);
            }
        }
    }
    y.into_iter().zip(blocks).collect()
}

/// Equations bᵀ∇C(y) = 0 for every row b of B(y) on components of a part, at all points, as rows
/// of length one; `row` gives the equation from b and y.
fn equations(
    (part, components): (usize, &[usize]),
    points: &[AtPoint],
    row: impl Fn(&[f64], &[f64]) -> Vec<f64>,
) -> Matrix {
    let mut rows = Matrix::new();
    for (y, blocks) in points {
        let noise = NOISE * largest(blocks.iter().flatten().flatten());
        for b in &blocks[part] {
            let b: Vec<f64> = components.iter().map(|&j| b[j]).collect();
            if norm(&b) > noise {
                let row = row(&b, y);
                let length = norm(&row);
                rows.extend((length > 0.0).then(|| row.iter().map(|x| x / length).collect()));
            }
        }
    }
    rows
}

/// The equation for the coefficients of a quadratic Casimir.
fn quadratic_row(part: &[usize], b: &[f64], y: &[f64]) -> Vec<f64> {
    let entries = places(part.len()).map(|(k, l)| match k == l {
        true => b[k] * y[part[k]],
        false => b[k] * y[part[l]] + b[l] * y[part[k]],
    });
    entries.collect()
}

/// The products of linear forms, as quadratic ones.
fn products(linear: &Matrix, d: usize) -> Matrix {
    let pairs = places(linear.len()).map(|(i, j)| (&linear[i], &linear[j]));
    pairs.map(|(a, b)| places(d).map(|(i, j)| a[i] * b[j] + a[j] * b[i]).collect()).collect()
}

/// Vectors of `span` that are linearly independent of `known` and of one another, by Gram–Schmidt.
fn beyond(span: Matrix, known: Matrix) -> Matrix {
    let (mut basis, mut kept, known_first) = (Matrix::new(), Matrix::new(), known.len());
    for (n, x) in known.into_iter().chain(span).enumerate() {
        let mut rest = x.clone();
        for _ in 0..2 {
            for b in &basis {
                let share = dot(&rest, b);
                rest = moved(&rest, -share, b);
            }
        }
        let length = norm(&rest);
        if length > CLEAR * norm(&x) {
            basis.push(rest.into_iter().map(|x| x / length).collect());
            if n >= known_first {
                kept.push(x);
            }
        }
    }
    kept
}
