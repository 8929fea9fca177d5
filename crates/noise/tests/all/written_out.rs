//! The areas written out from their coefficients, independently of the samplers, with knobs for
//! doing it wrong.

use std::f64::consts::{PI, SQRT_2, TAU};

use noise::{Noise, Purpose, StepNoise, StreamKey, WienerPath};
use real::WIDTH;

/// The normals that the areas of a path are made of.
pub fn normals(key: StreamKey, path: u64) -> WienerPath<1> {
    WienerPath::new(key.beside(Purpose::Areas), path)
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
                (x[r][i], y[r][i]) = (normals.normal(), normals.normal());
            }
        }
        Self { x, y }
    }

    /// Σ (1/r)[X_i(Y_j − √2 w_j) − X_j(Y_i − √2 `sign` w_i)] over the terms first < r ≤ last, with
    /// the sign 1 if it is right.
    pub fn series(&self, w: [f64; M], first: usize, last: usize, sign: f64) -> [[f64; M]; M] {
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

/// Ways to get a formula wrong: right is 1 everywhere.
#[derive(Clone, Copy)]
pub struct Knobs {
    /// Sign of w_i in X_j(Y_i − √2 w_i).
    pub coupling: f64,
    /// a = √(2ψ₁(n + shift)).
    pub shift: usize,
    /// Sign of w_jΨ_i in the tail of the noises.
    pub sign: f64,
    /// Size of the tail of the noises, a(w_iΨ_j − w_jΨ_i): 0 leaves it out.
    pub of_noises: f64,
    /// Size of the tail of the pairs, a·g_ij.
    pub of_pairs: f64,
}

pub const RIGHT: Knobs =
    Knobs { coupling: 1.0, shift: 1, sign: 1.0, of_noises: 1.0, of_pairs: 1.0 };

/// A sampler of the paths from `first_path` on.
pub fn written_out<const M: usize>(
    key: StreamKey,
    first_path: u64,
    terms: usize,
    knobs: Knobs,
) -> impl FnMut(f64, &mut StepNoise) {
    let mut streams: Vec<_> = (0..WIDTH as u64).map(|p| normals(key, first_path + p)).collect();
    move |step, noise| {
        for (p, normals) in streams.iter_mut().enumerate() {
            let increments = noise.path::<M>(p).increments;
            let areas = areas(normals, terms, knobs, increments.map(|w| w / step.sqrt()));
            let areas = areas.map(|row| row.map(|a| a * step / TAU));
            noise.set_path(p, &Noise { areas, ..Noise::increments(increments) });
        }
    }
}

/// Of one path, above the diagonal, in units of h/2π.
fn areas<const M: usize>(
    normals: &mut WienerPath<1>,
    terms: usize,
    knobs: Knobs,
    w: [f64; M],
) -> [[f64; M]; M] {
    let mut sum = Coefficients::draw(normals, terms).series(w, 0, terms, knobs.coupling);
    let drawn: f64 = (1..terms + knobs.shift).map(|r| (r as f64).powi(-2)).sum();
    let a = (2.0 * (PI * PI / 6.0 - drawn)).sqrt();
    let psi = [(); M].map(|()| normals.normal());
    for i in 0..M {
        for j in i + 1..M {
            let of_noises = w[i] * psi[j] - knobs.sign * w[j] * psi[i];
            sum[i][j] += a * (knobs.of_noises * of_noises + knobs.of_pairs * normals.normal());
        }
    }
    // The twin of the last of an odd number is dropped.
    if M * (M + 1) / 2 % 2 == 1 {
        normals.normal();
    }
    sum
}
