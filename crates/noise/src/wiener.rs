//! Wiener increments of a block of paths and of one path. Both call the same functions, so they
//! give the same bits.

use real::{Row, WIDTH};

use crate::{
    StreamKey,
    box_muller::{fill_pair, normal_pair},
    stream::{BlockStreams, next_word},
};

/// Increments of independent Wiener processes on 32 consecutive paths.
///
/// Two words of a path's stream give two independent standard normals (Box and Muller 1958), of
/// which none exceeds √(106 ln 2) ≈ 8.57. Normals are used step by step and noise by noise. With an
/// odd number of noises every second step begins with a normal left over from the step before.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct WienerRows {
    streams: BlockStreams,
    spare: Row,
    has_spare: bool,
}

impl WienerRows {
    /// The increments of paths `first_path` .. `first_path + 32`.
    pub fn new(key: StreamKey, first_path: u64) -> Self {
        Self { streams: BlockStreams::new(key, first_path), spare: [0.0; WIDTH], has_spare: false }
    }

    /// Writes the next increment of each noise, each N(0, τ), into a row of `dw`; `sqrt_tau` = √τ.
    #[inline]
    pub fn increments(&mut self, sqrt_tau: f64, dw: &mut [Row]) {
        let mut rows = dw;
        if self.has_spare
            && let [row, rest @ ..] = rows
        {
            for p in 0..WIDTH {
                row[p] = self.spare[p] * sqrt_tau;
            }
            (rows, self.has_spare) = (rest, false);
        }
        if !rows.is_empty() {
            self.has_spare = rows.len() % 2 == 1;
            fill(&mut self.streams.0, rows, &mut self.spare, sqrt_tau);
        }
    }
}

real::kernel! {
    /// Fills the rows of `dw` with pairs of normals. The last one of an odd number of rows leaves
    /// the other normal of its pair as the spare.
    fn fill(
        words: &'a mut [[u64; WIDTH]; 4], dw: &'a mut [Row], spare: &'a mut Row, sqrt_tau: f64
    ) {
        let mut rows = dw;
        while let [first, second, rest @ ..] = rows {
            fill_pair(words, first, second, sqrt_tau, sqrt_tau);
            rows = rest;
        }
        if let [last] = rows {
            fill_pair(words, last, spare, sqrt_tau, 1.0);
        }
    }
}

/// Increments of M independent Wiener processes on one path, with the same bits as that path of a
/// [`WienerRows`].
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct WienerPath<const M: usize> {
    state: [u64; 4],
    spare: Option<f64>,
}

impl<const M: usize> WienerPath<M> {
    /// The increments of path `path`.
    pub fn new(key: StreamKey, path: u64) -> Self {
        Self { state: key.state(path), spare: None }
    }

    /// The next M increments, each N(0, τ); `sqrt_tau` = √τ.
    pub fn increments(&mut self, sqrt_tau: f64) -> [f64; M] {
        std::array::from_fn(|_| self.normal() * sqrt_tau)
    }

    /// The next standard normal of the path.
    pub fn normal(&mut self) -> f64 {
        if let Some(spare) = self.spare.take() {
            return spare;
        }
        let (first, second) = normal_pair(next_word(&mut self.state), next_word(&mut self.state));
        self.spare = Some(second);
        first
    }
}
