//! The areas written out from their coefficients, independently of the samplers, with knobs for
//! doing it wrong.

use std::f64::consts::{PI, SQRT_2, TAU};

use noise::{AREA_STREAM, StreamKey, WienerPath};
use real::{Block, WIDTH};

use crate::AreaBlock;

/// Which tails follow the terms of the series.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AreaMethod {
    /// None.
    Fourier,
    /// The exact one of the terms with w.
    Milstein,
    /// The same, and a normal for each pair: what is drawn.
    MrongowiusRoessler,
}

/// The normals that the areas of a path are made of.
pub fn normals(key: StreamKey, path: u64) -> WienerPath<1> {
    WienerPath::new(StreamKey { experiment: key.experiment ^ AREA_STREAM, ..key }, path)
}

/// Coefficients X_r, Y_r of M noises; `x[r - 1][i]`.
pub struct Coefficients<const M: usize> {
    pub x: Vec<[f64; M]>,
    pub y: Vec<[f64; M]>,
}

impl<const M: usize> Coefficients<M> {
    /// Term by term, noise by noise, X before Y.
    pub fn draw(normals: &mut WienerPath<1>, terms: usize) -> Self {
        let (mut x, mut y) = (vec![[0.0; M]; terms], vec![[0.0; M]; terms]);
        for r in 0..terms {
            for i in 0..M {
                x[r][i] = normals.normal();
                y[r][i] = normals.normal();
            }
        }
        Self { x, y }
    }

    /// Σ (1/r)[X_i(Y_j − √2 w_j) − X_j(Y_i − √2 w_i)] over the terms first < r ≤ last.
    pub fn series(&self, w: [f64; M], first: usize, last: usize) -> [[f64; M]; M] {
        self.series_with(w, first, last, 1.0)
    }

    /// The same with −√2 w_i of the second product multiplied by `sign`.
    fn series_with(&self, w: [f64; M], first: usize, last: usize, sign: f64) -> [[f64; M]; M] {
        let mut sum = [[0.0; M]; M];
        for r in first + 1..=last {
            let (x, y) = (self.x[r - 1], self.y[r - 1]);
            for i in 0..M {
                for j in i + 1..M {
                    let one = x[i] * (y[j] - SQRT_2 * w[j]);
                    let other = x[j] * (y[i] - sign * SQRT_2 * w[i]);
                    sum[i][j] += (one - other) / r as f64;
                }
            }
        }
        sum
    }
}

/// a = √(2Σ_{r>n} r⁻²).
pub fn amplitude(n: usize) -> f64 {
    let drawn: f64 = (1..=n).map(|r| (r as f64).powi(-2)).sum();
    (2.0 * (PI * PI / 6.0 - drawn)).sqrt()
}

/// Ways to get a formula wrong.
#[derive(Clone, Copy)]
pub struct Knobs {
    /// Sign of w_i in X_j(Y_i − √2 w_i): 1 is right.
    pub coupling: f64,
    /// a = √(2ψ₁(n + shift)): 1 is right.
    pub shift: usize,
    /// Sign of w_jΨ_i in the tail: 1 is right.
    pub tail: f64,
}

pub const RIGHT: Knobs = Knobs { coupling: 1.0, shift: 1, tail: 1.0 };

/// A method written out for the paths of a block.
pub struct WrittenOut {
    normals: Vec<WienerPath<1>>,
    method: AreaMethod,
    terms: usize,
    knobs: Knobs,
}

impl WrittenOut {
    pub fn new(
        key: StreamKey,
        first_path: u64,
        method: AreaMethod,
        terms: usize,
        knobs: Knobs,
    ) -> Self {
        let normals = (0..WIDTH as u64).map(|p| normals(key, first_path + p)).collect();
        Self { normals, method, terms, knobs }
    }

    pub fn areas<const M: usize>(&mut self, step: f64, dw: &Block<M>, areas: &mut AreaBlock<M>) {
        for p in 0..WIDTH {
            let w = dw.path(p).map(|w| w / step.sqrt());
            let area = self.path(p, w);
            areas.set_path(p, area.map(|row| row.map(|a| a * step / TAU)));
        }
    }

    fn path<const M: usize>(&mut self, p: usize, w: [f64; M]) -> [[f64; M]; M] {
        let Self { normals, method, terms, knobs } = self;
        let normals = &mut normals[p];
        let mut sum = Coefficients::draw(normals, *terms).series_with(w, 0, *terms, knobs.coupling);
        let a = amplitude((*terms + knobs.shift) - 1);
        let mut draw = || normals.normal();
        let mut psi = [0.0; M];
        if *method != AreaMethod::Fourier {
            psi = psi.map(|_| draw());
        }
        let mut g = [[0.0; M]; M];
        if *method == AreaMethod::MrongowiusRoessler {
            for i in 0..M {
                for j in i + 1..M {
                    g[i][j] = draw();
                }
            }
        }
        let normals = match method {
            AreaMethod::Fourier => 0,
            AreaMethod::Milstein => M,
            AreaMethod::MrongowiusRoessler => M * (M + 1) / 2,
        };
        // The twin of the last of an odd number is dropped.
        if normals % 2 == 1 {
            draw();
        }
        for i in 0..M {
            for j in i + 1..M {
                sum[i][j] += a * (w[i] * psi[j] - knobs.tail * w[j] * psi[i]) + a * g[i][j];
            }
        }
        sum
    }
}
