//! The search for linear and quadratic Casimirs, from B alone.

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

/// Point y with the matrix B(y).
type AtPoint = (Vec<f64>, Matrix);

/// Solves B(y)∇C(y) = 0 for the coefficients of C in each part of the state that B does not join
/// with others. `points` gives more points with each call, if it has any.
pub fn casimirs(
    probe: &mut Probe<'_>,
    mut points: impl FnMut(&mut Probe<'_>) -> Batch,
) -> Candidates {
    let d = probe.dimension();
    let mut more = |probe: &mut Probe<'_>| -> Vec<AtPoint> {
        let y = points(probe);
        let matrices = probe.matrix(&y);
        y.into_iter().zip(matrices).collect()
    };
    let first = more(probe);
    let mut states = first.clone();
    let mut found = [const { Vec::new() }; 3];
    let mut complete = true;
    for part in parts(probe, &first) {
        let size = part.len();
        let (ones, least) = null_space(equations(&part, &first, |b, _| b.to_vec()), size, ZERO);
        complete &= least > CLEAR;
        let (unknowns, rank) = (size * (size + 1) / 2, size - ones.len());
        let mut twos = Matrix::new();
        if unknowns > UNKNOWNS {
            complete = false;
        } else if probe.description().linearity != Linearity::Constant && rank > 0 {
            while states.len() * rank < SURPLUS * unknowns {
                let new = more(probe);
                if new.is_empty() {
                    complete = false;
                    break;
                }
                states.extend(new);
            }
            let rows = equations(&part, &states, |b, y| quadratic_row(&part, b, y));
            let (found, least) = null_space(rows, unknowns, ZERO);
            complete &= least > CLEAR;
            twos = beyond(found, products(&ones, size));
        }
        // Components that are Casimirs by themselves have logarithms that are nothing new.
        let moves = |j: &usize| first.iter().flat_map(|(_, b)| b).any(|row| row[*j] != 0.0);
        let moving: Vec<usize> =
            part.iter().copied().filter(moves).filter(|_| size <= LOGARITHMS).collect();
        let of_logarithms = equations(&moving, &first, |b, y| {
            without_own(b, &moving.iter().map(|&j| y[j]).collect::<Vec<_>>())
        });
        let (logarithms, _) = null_space(of_logarithms, moving.len(), ZERO);
        let whole = |degree: u32, x: Vec<f64>| {
            let mut coefficients = vec![0.0; d.pow(degree.max(1))];
            let x = readable(x, ZERO).into_iter();
            match degree {
                2 => places(size).zip(x).for_each(|((k, l), c)| {
                    coefficients[part[k] * d + part[l]] = c;
                    coefficients[part[l] * d + part[k]] = c;
                }),
                _ => {
                    let places = if degree == 0 { &moving } else { &part };
                    places.iter().zip(x).for_each(|(i, c)| coefficients[*i] = c);
                }
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
fn parts(probe: &mut Probe<'_>, points: &[AtPoint]) -> Vec<Vec<usize>> {
    let d = probe.dimension();
    let y: Batch = points.iter().map(|(y, _)| y.clone()).collect();
    let mut label: Vec<usize> = (0..d).collect();
    // A vector without special ratios.
    let v: Vec<f64> = (0..d).map(|i| sin(1.0 + 0.7 * i as f64)).collect();
    for j in 0..d {
        let along = probe.structure_along(&y, &[axis(d, j)], std::slice::from_ref(&v));
        let moves = |i: &usize| {
            points.iter().any(|(_, b)| b[*i][j] != 0.0) || along.iter().any(|out| out[*i] != 0.0)
        };
        for i in (0..d).filter(moves) {
            let (one, other) = (label[i], label[j]);
            label.iter_mut().filter(|label| **label == other).for_each(|label| *label = one);
        }
    }
    let part = |one: usize| (0..d).filter(|i| label[*i] == one).collect::<Vec<_>>();
    (0..d).map(part).filter(|part| !part.is_empty()).collect()
}

/// Equations bᵀ∇C(y) = 0 for every row b of B(y) on a part, at all points, as rows of length one;
/// `row` gives the equation from b and y.
fn equations(
    part: &[usize],
    points: &[AtPoint],
    row: impl Fn(&[f64], &[f64]) -> Vec<f64>,
) -> Matrix {
    let mut rows = Matrix::new();
    for (y, b) in points {
        let noise = NOISE * largest(b.iter().flatten());
        for b in b {
            let b: Vec<f64> = part.iter().map(|&j| b[j]).collect();
            let row = if norm(&b) > noise { row(&b, y) } else { continue };
            let length = norm(&row);
            if length > 0.0 {
                rows.push(row.into_iter().map(|x| x / length).collect());
            }
        }
    }
    rows
}

/// The equation for the coefficients of a quadratic Casimir.
fn quadratic_row(part: &[usize], b: &[f64], y: &[f64]) -> Vec<f64> {
    let entry = |(k, l): (usize, usize)| match k == l {
        true => b[k] * y[part[k]],
        false => b[k] * y[part[l]] + b[l] * y[part[k]],
    };
    places(part.len()).map(entry).collect()
}

/// The products of linear forms, as quadratic ones.
fn products(linear: &Matrix, d: usize) -> Matrix {
    let product = |a: &[f64], b: &[f64]| {
        places(d).map(|(i, j)| a[i] * b[j] + a[j] * b[i]).collect::<Vec<_>>()
    };
    places(linear.len()).map(|(i, j)| product(&linear[i], &linear[j])).collect()
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
