//! Whether noises reach all of a leaf, and whether e^{−βH₀} has an integral.

use real::elementary::{ln, powi};
use serde::Serialize;
use systems::{
    Linearity,
    run_time::{Description, System},
};

use super::{
    Batch, Matrix, Probe, Purpose, Random, axis, bath::energies, largest, moved, multiplied, norm,
    null_space, rank, scaled, seen, transposed,
};

/// The directions that noises reach along a path, and those of the leaf of B.
///
/// The path has random controls in the place of noises. Along it C′ = AC + CAᵀ + Σ fₘfₘᵀ with the
/// derivative A of the controlled field. For analytic fields the rank of C is that of the brackets
/// of Hörmander's condition, for almost all controls (Sontag, *Ann. Inst. H. Poincaré C* 9, 1992).
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Span {
    /// Rank of C, on the leaf.
    pub reached: usize,
    /// Rank of B.
    pub leaf: usize,
    /// Components that no noise reaches, counted from 0.
    pub never: Vec<usize>,
}

/// How H₀ grows far away, where B is constant and invertible.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub enum Growth {
    /// In all directions looked at, so that e^{−βH₀} seems to have an integral.
    Everywhere,
    /// Not bounded below: falls along this component; `None` for another direction.
    Falls(Option<usize>),
    /// Too little along this component, counted from 0; `None` for another direction.
    NotAlong(Option<usize>),
    /// Not known.
    Unknown,
}

/// Largest number of components for which the rank is computed.
const MAX_COMPONENTS: usize = 24;
/// Steps, those for each component besides, and their length over the inverse of ‖A‖.
const STEPS: [usize; 2] = [60, 6];
const LENGTH: f64 = 0.05;
/// Pivots of the correlation matrix of C that count as zero: errors of a step have the fifth order
/// in its length, and those of C the tenth.
const ZERO: f64 = 1e-12;

/// The directions that noises reach; none for large systems and where a path leaves the domain.
pub fn span(system: &dyn System, y0: &[f64]) -> Option<Span> {
    let d = y0.len();
    let (mut probe, states) = seen(system, y0);
    if d > MAX_COMPONENTS || probe.noises() == 0 {
        return None;
    }
    let leaf = probe.matrix(&states).into_iter().map(|b| rank(b, d)).max()?;
    let mut random = Random::new(Purpose::Vectors);
    let (mut y, mut c) = (y0.to_vec(), vec![vec![0.0; d]; d]);
    for _ in 0..STEPS[0] + STEPS[1] * d {
        let weights = [vec![1.0], random.vector(probe.noises())].concat();
        let (_, a) = derivative(&mut probe, &y, &weights);
        let size = a.iter().map(|row| norm(row)).fold(1e-3, f64::max);
        let h = LENGTH / size;
        let (next, flow) = step(&mut probe, &y, &weights, h);
        c = multiplied(&flow, &multiplied(&c, &transposed(&flow)));
        y = next;
        if !y.iter().all(|y| y.is_finite()) || !probe.in_domain(&y) {
            return None;
        }
        for m in 1..=probe.noises() {
            let f = &probe.field(&[y.clone()], &probe.weights(m))[0];
            for (row, &x) in c.iter_mut().zip(f) {
                *row = moved(row, h * x, f);
            }
        }
    }
    let scale: Vec<f64> = (0..d).map(|i| c[i][i].sqrt()).collect();
    let size = largest(&scale);
    let never: Vec<usize> = (0..d).filter(|&i| scale[i] <= ZERO * size).collect();
    for (i, j) in (0..d).flat_map(|i| (0..d).map(move |j| (i, j))) {
        let is_zero = never.contains(&i) || never.contains(&j);
        c[i][j] = if is_zero { 0.0 } else { c[i][j] / (scale[i] * scale[j]) };
    }
    let reached = (d - null_space(c, d, ZERO).0.len()).min(leaf);
    Some(Span { reached, leaf, never })
}

/// The field B∇h at y and its derivative.
pub fn derivative(probe: &mut Probe<'_>, y: &[f64], weights: &[f64]) -> (Vec<f64>, Matrix) {
    let y = [y.to_vec()];
    let slope = probe.gradient(&y, weights);
    let field = probe.structure(&y, &slope).remove(0);
    let columns = probe.field_columns(&y, &slope, weights).concat();
    (field, transposed(&columns))
}

/// A step of the classical Runge–Kutta method, and its derivative.
fn step(probe: &mut Probe<'_>, y: &[f64], weights: &[f64], h: f64) -> (Vec<f64>, Matrix) {
    let unit: Matrix = (0..y.len()).map(|i| axis(y.len(), i)).collect();
    let sum = |a: &Matrix, c: f64, b: &Matrix| -> Matrix {
        a.iter().zip(b).map(|(a, b)| moved(a, c, b)).collect()
    };
    let (mut to, mut flow) = (y.to_vec(), unit.clone());
    let (mut last, mut turned) = (vec![0.0; y.len()], vec![vec![0.0; y.len()]; y.len()]);
    for (part, weight) in [(0.0, 1.0), (0.5, 2.0), (0.5, 2.0), (1.0, 1.0)] {
        let (field, a) = derivative(probe, &moved(y, part * h, &last), weights);
        (last, turned) = (field, multiplied(&a, &sum(&unit, part * h, &turned)));
        to = moved(&to, weight * h / 6.0, &last);
        flow = sum(&flow, weight * h / 6.0, &turned);
    }
    (to, flow)
}

/// Powers of ten of the radii, in sizes of y₀, and the number of random directions.
const RADII: std::ops::RangeInclusive<i32> = 1..=12;
const DIRECTIONS: usize = 64;
/// Pairs of radii over which what has a period falls at least once.
const LAST: usize = 6;

/// How H₀ grows from y₀ along components and in random directions.
pub fn growth(system: &dyn System, y0: &[f64], beta: f64) -> Growth {
    let d = y0.len();
    let (mut probe, states) = seen(system, y0);
    let Description { linearity, has_guard, .. } = probe.description;
    let b = probe.matrix(&states[..1]).remove(0);
    if *linearity != Linearity::Constant || *has_guard || !null_space(b, d, 1e-9).0.is_empty() {
        return Growth::Unknown;
    }
    let mut random = Random::new(Purpose::Vectors);
    let axes =
        (0..2 * d).map(|k| (Some(k / 2), scaled(1.0 - 2.0 * (k % 2) as f64, &axis(d, k / 2))));
    let others = (0..DIRECTIONS).map(|_| {
        let v = random.vector(d);
        (None, scaled(1.0 / norm(&v), &v))
    });
    let size = norm(y0).max(1.0);
    for (component, direction) in axes.chain(others) {
        let points: Batch =
            RADII.map(|power| moved(y0, size * powi(10.0, power), &direction)).collect();
        let energies = energies(&mut probe, &points);
        if energies.iter().any(|energy| energy.is_nan()) {
            return Growth::Unknown;
        }
        // Far away e^{−βH₀}rᵈ falls; less than that, as with a logarithm, is not looked at.
        let least = (d as f64 + 1.0) * ln(10.0);
        let growth = energies.windows(2).rev().map(|pair| match pair[1].is_infinite() {
            true => pair[1],
            false => beta * (pair[1] - pair[0]),
        });
        if !growth.clone().next().is_some_and(|last| last > least) {
            let falls: Vec<f64> = growth.clone().take(LAST).collect();
            if falls.last().is_some_and(|fall| *fall < 0.0)
                && falls.windows(2).all(|pair| pair[0] <= 2.0 * pair[1])
            {
                return Growth::Falls(component);
            }
            return match growth.take(LAST).all(|one| one > 0.0) {
                true => Growth::Unknown,
                false => Growth::NotAlong(component),
            };
        }
    }
    Growth::Everywhere
}
