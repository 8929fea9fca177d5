//! What a study is, as hashes of numbers that its formulas give.
//!
//! Names do not tell studies apart: a changed constant in a formula has the same name. So B(y)v,
//! h(y), γ, a step of every scheme and every statistic are evaluated at fixed points, and the bits
//! are hashed.

use real::{Row, WIDTH};
use serde::Serialize;
use sha2::{Digest, Sha256};

use crate::Problem;

/// A hash of numbers and texts.
#[derive(Clone, Default)]
pub struct Hash(Sha256);

impl Hash {
    #[must_use]
    pub fn with(mut self, bytes: &[u8]) -> Self {
        self.0.update((bytes.len() as u64).to_le_bytes());
        self.0.update(bytes);
        self
    }

    #[must_use]
    pub fn with_number(self, number: u64) -> Self {
        self.with(&number.to_le_bytes())
    }

    /// The bits of real numbers. A NaN has many; any is as good as another.
    #[must_use]
    pub fn with_reals(self, numbers: impl IntoIterator<Item = f64>) -> Self {
        let bits = |x: f64| if x.is_nan() { u64::MAX } else { x.to_bits() };
        numbers.into_iter().fold(self, |hash, x| hash.with_number(bits(x)))
    }

    /// The first 16 bytes in hexadecimal.
    pub fn finish(self) -> String {
        self.0.finalize()[..16].iter().map(|byte| format!("{byte:02x}")).collect()
    }
}

/// A value as bytes for a hash. What cannot be written is told when sums are tried before the
/// computing.
pub fn bytes(value: &impl Serialize) -> Vec<u8> {
    postcard::to_stdvec(value).unwrap_or_default()
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
    let mut hash = Hash::default().with_number(y0.len() as u64).with_number(noises as u64);
    hash = hash.with_reals(y0.iter().copied()).with_reals([t_end]);
    for n in 0..POINTS {
        let (y, v) = (near(y0, n), near(&vec![1.0; y0.len()], POINTS + n));
        let dw: Vec<f64> = (0..noises).map(|m| fixed(3 * n + m)).collect();
        let energy = formulas.energy(&y, fixed(n), &dw);
        hash = hash.with_reals(formulas.structure(&y, &v)).with_reals([energy]);
    }
    for n in 0..TIMES {
        let (from, to) = (t_end * f64::from(n) / 16.0, t_end * f64::from(n + 1) / 16.0);
        hash = hash.with_reals([damping.rate(from), damping.integral(from, to)]);
    }
    hash.finish()
}
