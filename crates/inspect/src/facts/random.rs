//! Random numbers, the same in every run.

use noise::{StreamKey, WienerPath};

/// Random numbers, the same in every run.
pub struct Random {
    pub normals: WienerPath<1>,
    key: StreamKey,
    drawn: u64,
}

/// Purpose of random numbers; each has its own stream.
#[derive(Clone, Copy)]
pub enum Purpose {
    Points,
    Around,
    Vectors,
    Weights,
    Areas,
    Clusters,
}

const KEY: StreamKey = StreamKey { seed: 0x1257_ec71, experiment: 0 };

impl Random {
    /// Numbers that are independent of those for other purposes: a vector that is parallel to the
    /// point would hide much.
    pub fn new(purpose: Purpose) -> Self {
        let key = StreamKey { experiment: purpose as u64, ..KEY };
        Self { normals: WienerPath::new(key, 0), key, drawn: 0 }
    }

    /// Uniform in [−1, 1), from the seeds of paths, which are mixed words.
    pub fn uniform(&mut self) -> f64 {
        self.drawn += 1;
        (self.key.path_seed(self.drawn) >> 11) as f64 * f64::EPSILON - 1.0
    }

    /// Vector of uniform numbers.
    pub fn vector(&mut self, length: usize) -> Vec<f64> {
        (0..length).map(|_| self.uniform()).collect()
    }
}
