//! Whether noises reach all of a leaf, and whether e^{−βH₀} has an integral.

use real::elementary::{ln, powi};
use serde::Serialize;
use systems::{Linearity, run_time::System};

use super::{
    Batch, Matrix, Probe, Purpose, Random, axis, largest, moved, multiplied, norm, null_space,
    scaled, seen, transposed,
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
    let leaf = probe.matrix(&states).into_iter().map(|b| {
        let zero = 1e-9 * largest(b.iter().flatten());
        d - null_space(b, d, zero).0.len()
    });
    let leaf = leaf.max()?;
    let mut random = Random::new(Purpose::Vectors);
    let (mut y, mut c) = (y0.to_vec(), vec![vec![0.0; d]; d]);
    for _ in 0..STEPS[0] + STEPS[1] * d {
        let mut weights = vec![1.0];
        weights.extend((0..probe.noises()).map(|_| random.uniform()));
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
            let one = probe.weights(m);
            let f = &probe.field(&[y.clone()], &one)[0];
            for (row, &x) in c.iter_mut().zip(f) {
                *row = moved(row, h * x, f);
            }
        }
    }
    let scale: Vec<f64> = (0..d).map(|i| c[i][i].sqrt()).collect();
    let size = largest(&scale);
    let never: Vec<usize> = (0..d).filter(|&i| scale[i] <= ZERO * size).collect();
    let one = |i: usize, j: usize| match never.contains(&i) || never.contains(&j) {
        true => 0.0,
        false => c[i][j] / (scale[i] * scale[j]),
    };
    let correlation: Matrix = (0..d).map(|i| (0..d).map(|j| one(i, j)).collect()).collect();
    let reached = (d - null_space(correlation, d, ZERO).0.len()).min(leaf);
    Some(Span { reached, leaf, never })
}

/// The field B∇h at y and its derivative.
fn derivative(probe: &mut Probe<'_>, y: &[f64], weights: &[f64]) -> (Vec<f64>, Matrix) {
    let y = [y.to_vec()];
    let slope = probe.gradient(&y, weights);
    let field = probe.structure(&y, &slope).remove(0);
    (field, probe.matrices(|probe, u| probe.field_along(&y, u, &slope, weights)).remove(0))
}

/// A step of the classical Runge–Kutta method, and its derivative.
fn step(probe: &mut Probe<'_>, y: &[f64], weights: &[f64], h: f64) -> (Vec<f64>, Matrix) {
    let unit: Matrix = (0..y.len()).map(|i| axis(y.len(), i)).collect();
    let (mut to, mut flow) = (y.to_vec(), unit.clone());
    let (mut last, mut turned) = (vec![0.0; y.len()], vec![vec![0.0; y.len()]; y.len()]);
    for (part, weight) in [(0.0, 1.0), (0.5, 2.0), (0.5, 2.0), (1.0, 1.0)] {
        let at = moved(y, part * h, &last);
        let by = |k: usize| moved(&unit[k], part * h, &turned[k]);
        let by: Matrix = (0..y.len()).map(by).collect();
        let (field, a) = derivative(probe, &at, weights);
        (last, turned) = (field, multiplied(&a, &by));
        to = moved(&to, weight * h / 6.0, &last);
        let next = flow.iter().zip(&turned).map(|(row, more)| moved(row, weight * h / 6.0, more));
        flow = next.collect();
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
    let is_whole = |b: Matrix| null_space(b, d, 1e-9).0.is_empty();
    let constant = probe.description().linearity == Linearity::Constant;
    if !constant
        || probe.description().has_guard
        || !probe.matrix(&states[..1]).into_iter().all(is_whole)
    {
        return Growth::Unknown;
    }
    let mut random = Random::new(Purpose::Vectors);
    let axes =
        (0..2 * d).map(|k| (Some(k / 2), scaled(1.0 - 2.0 * (k % 2) as f64, &axis(d, k / 2))));
    let others = (0..DIRECTIONS).map(|_| {
        let v: Vec<f64> = (0..d).map(|_| random.uniform()).collect();
        (None, scaled(1.0 / norm(&v), &v))
    });
    let directions: Vec<_> = axes.chain(others.collect::<Vec<_>>()).collect();
    let size = norm(y0).max(1.0);
    let weights = probe.weights(0);
    for (component, direction) in directions {
        let points: Batch =
            RADII.map(|power| moved(y0, size * powi(10.0, power), &direction)).collect();
        let energies = probe.energy(&points, &weights);
        if energies.iter().any(|energy| energy.is_nan()) {
            return Growth::Unknown;
        }
        // Far away e^{−βH₀}rᵈ falls; less than that, as with a logarithm, is not looked at.
        let least = (d as f64 + 1.0) * ln(10.0);
        let more = |pair: &[f64]| match pair[1] == f64::INFINITY {
            true => f64::INFINITY,
            false => beta * (pair[1] - pair[0]),
        };
        let growth: Vec<f64> = energies.windows(2).map(more).collect();
        if growth.last().is_some_and(|last| *last > least) {
            continue;
        }
        return match growth.iter().rev().take(LAST).all(|one| *one > 0.0) {
            true => Growth::Unknown,
            false => Growth::NotAlong(component),
        };
    }
    Growth::Everywhere
}
