//! Tangent vectors along a path.

use std::sync::Arc;

use noise::StepNoise;
use nonlin::BlockStatus;
use real::{Row, WIDTH, elementary};
use schemes::{About, Method, Step, Stepper};

/// A method with tangent vectors after its states, and the logarithms of their growth since the
/// start; last the sum of these. Orthogonalisation separates the vectors (Benettin, Galgani,
/// Giorgilli and Strelcyn, *Meccanica* 15, 1980).
///
/// A tangent vector v is carried along by the difference of a step from y + δv and one from y, both
/// with the same noise, over δ = √(10⁻¹⁵ ab) with the largest component a of y and the largest
/// change b of a component in a step so far: in between what rounds and what bends, also far from
/// zero. At first, and at rest, δ is 10⁻⁷ times a, or one.
pub struct Tangents<'a> {
    /// The method.
    pub method: Arc<dyn Method + 'a>,
    /// Number of components of the state.
    pub dimension: usize,
    /// Number of vectors.
    pub count: usize,
}

/// Values of δ²/ab, and of δ/a where nothing moves.
const SQUARE: f64 = 1e-15;
const DIFFERENCE: f64 = 1e-7;
/// Size below which states and changes count as zero, where δ is that of rest.
const SMALLEST: f64 = 1e-150;

impl Method for Tangents<'_> {
    fn about(&self) -> About {
        self.method.about()
    }

    /// Starts with generic vectors, or with those that `y` has after the state.
    fn start(&self, y: &[Row]) -> Box<dyn Stepper + '_> {
        let &Self { ref method, dimension, count } = self;
        let (state, vectors) = y.split_at(dimension);
        let mut rows = state.to_vec();
        match vectors.get(..count * dimension) {
            Some(vectors) => rows.extend_from_slice(vectors),
            None => {
                rows.extend((0..count * dimension).map(generic));
                let vectors = &mut rows[dimension..];
                orthogonalise(vectors, dimension, &mut vec![[0.0; WIDTH]; count + 1]);
            }
        }
        rows.resize(rows.len() + count + 1, [0.0; WIDTH]);
        let inner = method.start(state);
        let near = (0..count).map(|_| method.start(state)).collect();
        Box::new(Carried { dimension, inner, near, rows, moved: [0.0; WIDTH] })
    }
}

/// Component number `n` of generic vectors, which are in no subspace that a system conserves: a
/// number in [−1, 1) by the multiplications of SplitMix64 (Steele, Lea and Flood 2014). Components
/// are the same on all paths, so that chains differ by their noise alone.
fn generic(n: usize) -> Row {
    let z = (n as u64 + 1).wrapping_mul(noise::GOLDEN);
    let z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    [(z >> 11) as f64 * f64::EPSILON - 1.0; WIDTH]
}

struct Carried<'a> {
    dimension: usize,
    inner: Box<dyn Stepper + 'a>,
    near: Vec<Box<dyn Stepper + 'a>>,
    rows: Vec<Row>,
    /// The largest change of a component so far.
    moved: Row,
}

impl Stepper for Carried<'_> {
    fn state(&self) -> &[Row] {
        &self.rows
    }

    fn state_mut(&mut self) -> &mut [Row] {
        &mut self.rows
    }

    fn step(&mut self, step: &Step, noise: &StepNoise, status: &mut BlockStatus) {
        let Self { dimension, inner, near, rows, moved } = self;
        let d = *dimension;
        let (y, rest) = rows.split_at_mut(d);
        let (vectors, grown) = rest.split_at_mut(near.len() * d);
        let delta = difference(y, moved);
        for (v, near) in vectors.chunks(d).zip(near.iter_mut()) {
            for ((near, y), v) in near.state_mut().iter_mut().zip(&*y).zip(v) {
                for p in 0..WIDTH {
                    near[p] = y[p] + delta[p] * v[p];
                }
            }
        }
        inner.step(step, noise, status);
        for (y, next) in y.iter_mut().zip(inner.state()) {
            for p in 0..WIDTH {
                moved[p] = moved[p].max((next[p] - y[p]).abs());
            }
            *y = *next;
        }
        for (v, near) in vectors.chunks_mut(d).zip(near.iter_mut()) {
            let mut own = BlockStatus::explicit();
            near.step(step, noise, &mut own);
            status.failed = status.failed.or(own.failed);
            for ((near, y), v) in near.state().iter().zip(&*y).zip(v) {
                for p in 0..WIDTH {
                    v[p] = (near[p] - y[p]) / delta[p];
                }
            }
        }
        orthogonalise(vectors, d, grown);
    }
}

/// The difference δ of each path.
fn difference(y: &[Row], moved: &Row) -> Row {
    let mut size = [0.0f64; WIDTH];
    for row in y {
        size.iter_mut().zip(row).for_each(|(size, y)| *size = size.max(y.abs()));
    }
    std::array::from_fn(|p| match (size[p] > SMALLEST, moved[p] > SMALLEST) {
        (true, true) => (SQUARE * size[p] * moved[p]).sqrt(),
        (true, false) => DIFFERENCE * size[p],
        _ => 1.0,
    })
}

/// Makes vectors orthonormal, and adds the logarithms of their lengths and the sum of these to
/// `grown`.
fn orthogonalise(vectors: &mut [Row], d: usize, grown: &mut [Row]) {
    let count = grown.len() - 1;
    for n in 0..count {
        let (before, rest) = vectors.split_at_mut(n * d);
        let v = &mut rest[..d];
        for unit in before.chunks(d) {
            let along = dot(unit, v);
            for (v, unit) in v.iter_mut().zip(unit) {
                for p in 0..WIDTH {
                    v[p] -= along[p] * unit[p];
                }
            }
        }
        let square = dot(v, v);
        for p in 0..WIDTH {
            let length = square[p].sqrt();
            v.iter_mut().for_each(|row| row[p] /= length);
            let logarithm = elementary::ln(length);
            grown[n][p] += logarithm;
            grown[count][p] += logarithm;
        }
    }
}

fn dot(a: &[Row], b: &[Row]) -> Row {
    let mut sum = [0.0; WIDTH];
    for (a, b) in a.iter().zip(b) {
        for p in 0..WIDTH {
            sum[p] += a[p] * b[p];
        }
    }
    sum
}
