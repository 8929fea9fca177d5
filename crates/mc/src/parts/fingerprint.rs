//! What a study is, as hashes of numbers that its formulas give.
//!
//! Names do not tell studies apart: a changed constant in a formula has the same name. So B(y)v,
//! h(y), γ, a step of every scheme and every statistic are evaluated at fixed points, and the bits
//! are hashed.

use real::{Row, WIDTH};
use serde::Serialize;
use sha2::{Digest, Sha256};

use crate::Problem;

/// The first 16 bytes of the SHA-256 of a value, in hexadecimal. What cannot be written is told
/// when sums are tried before the computing.
pub fn hash(value: &impl Serialize) -> String {
    let sum = Sha256::digest(postcard::to_stdvec(value).unwrap_or_default());
    sum[..16].iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Numbers in which every NaN is the same: it has many forms, and any is as good as another.
pub fn same_nan(numbers: &[f64]) -> impl Iterator<Item = f64> {
    numbers.iter().map(|x| if x.is_nan() { f64::NAN } else { *x })
}

/// Points at which formulas are evaluated.
const POINTS: usize = 8;
/// Times at which the damping is.
const TIMES: u32 = 16;

/// A number between −1 and 1 that looks random: the fraction of multiples of the golden ratio.
fn fixed(n: usize) -> f64 {
    2.0 * (n as f64 * 0.618_033_988_749_894_9).fract() - 1.0
}

/// A state near y₀, of the same signs.
fn near(y0: &[f64], n: usize) -> Vec<f64> {
    let near = |(i, &y): (usize, &f64)| {
        let shift = 0.05 * fixed(1 + n * y0.len() + i);
        if y == 0.0 { shift } else { y * (1.0 + shift) }
    };
    y0.iter().enumerate().map(near).collect()
}

/// 32 states near y₀, others for each n.
pub fn probe_states(y0: &[f64], n: usize) -> Vec<Row> {
    let mut rows = vec![[0.0; WIDTH]; y0.len()];
    for p in 0..WIDTH {
        rows.iter_mut().zip(near(y0, n * WIDTH + p)).for_each(|(row, y)| row[p] = y);
    }
    rows
}

/// B(y)v, h, γ, y₀ and T of a problem.
pub fn of_problem(problem: &Problem<'_>) -> String {
    let Problem { ref y0, t_end, damping, noises, ref formulas, .. } = *problem;
    let mut numbers = Vec::new();
    for n in 0..POINTS {
        let (y, v) = (near(y0, n), near(&vec![1.0; y0.len()], POINTS + n));
        let dw: Vec<f64> = (0..noises).map(|m| fixed(3 * n + m)).collect();
        numbers.extend(formulas.structure(&y, &v));
        numbers.push(formulas.energy(&y, fixed(n), &dw));
    }
    for n in 0..TIMES {
        let (from, to) = (t_end * f64::from(n) / 16.0, t_end * f64::from(n + 1) / 16.0);
        numbers.extend([damping.rate(from), damping.integral(from, to)]);
    }
    hash(&(y0, noises, t_end, same_nan(&numbers).collect::<Vec<_>>()))
}
