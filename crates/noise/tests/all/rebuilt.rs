//! The areas are those of paths: orientation and sign, on paths rebuilt from the coefficients.

use approx::assert_relative_eq;
use std::f64::consts::{PI, TAU};

use noise::WienerPath;

use crate::areas::key;
use crate::written_out::{Coefficients, normals};

const GRID: usize = 4096;

/// W(t) = Wt/h + Σ_r √(h/2)/(πr) [X_r (cos(2πrt/h) − 1) + Y_r sin(2πrt/h)] at t = hg/G, g = 0 .. G.
fn path<const M: usize>(
    coefficients: &Coefficients<M>,
    terms: usize,
    step: f64,
    dw: [f64; M],
) -> Vec<[f64; M]> {
    let point = |g: usize| {
        let mut at = dw.map(|w| w * g as f64 / GRID as f64);
        for r in 1..=terms {
            // r·g turns of the grid, reduced exactly.
            let (sin, cos) = (TAU * (r * g % GRID) as f64 / GRID as f64).sin_cos();
            for m in 0..M {
                let size = (0.5 * step).sqrt() / (PI * r as f64);
                at[m] += size
                    * (coefficients.x[r - 1][m] * (cos - 1.0) + coefficients.y[r - 1][m] * sin);
            }
        }
        at
    };
    (0..=GRID).map(point).collect()
}

/// ∫W_i∘dW_j of the polygon through the points.
fn integral<const M: usize>(path: &[[f64; M]], i: usize, j: usize) -> f64 {
    path.windows(2).map(|at| 0.5 * (at[0][i] + at[1][i]) * (at[1][j] - at[0][j])).sum()
}

/// The polygon of the path that is cut after n terms has the area and the integrals of the series,
/// sign included.
///
/// On the grid, the products of different frequencies still add up to zero, and the coupling of a
/// frequency to the straight part is exact; the area of frequency r with itself is multiplied by
/// sin(φ)/φ, φ = 2πr/G, an error of φ²/6 at most.
#[test]
fn areas_are_those_of_the_path_with_their_sign() {
    const TERMS: usize = 12;
    let step = 0.7;
    let (mut products, mut squares) = (0.0, 0.0);
    for number in 0..64 {
        let key = key(400);
        let dw = WienerPath::<3>::new(key, number).increments(f64::sqrt(step));
        let coefficients = Coefficients::<3>::draw(&mut normals(key, number), TERMS);
        // The series of the sampler, with which it agrees to rounding.
        let upper = coefficients.series(dw.map(|w| w / step.sqrt()), 0, TERMS, 1.0);
        let areas: [[f64; 3]; 3] = std::array::from_fn(|i| {
            std::array::from_fn(|j| (upper[i][j] - upper[j][i]) * step / TAU)
        });
        let path = path(&coefficients, TERMS, step, dw);
        for a in 0..3 {
            assert!((path[GRID][a] - dw[a]).abs() < 1e-12);
            for b in 0..3 {
                let frequency = |r: usize| {
                    let (x, y) = (coefficients.x[r - 1], coefficients.y[r - 1]);
                    let phase = TAU * r as f64 / GRID as f64;
                    (x[a] * y[b] - x[b] * y[a]).abs() / r as f64 * phase * phase / 6.0
                };
                let error = step / TAU * (1..=TERMS).map(frequency).sum::<f64>() + 1e-12;
                let polygon = integral(&path, a, b);
                let expected = 0.5 * dw[a] * dw[b] + areas[a][b];
                assert!(
                    (polygon - expected).abs() <= error,
                    "{a}{b}: {polygon} {expected} {error}"
                );
                let area = 0.5 * (polygon - integral(&path, b, a));
                assert!((area - areas[a][b]).abs() <= error);
                products += area * areas[a][b];
                squares += areas[a][b] * areas[a][b];
            }
        }
    }
    // The correlation is one, not minus one: the slope of the regression on the sampler's areas.
    assert_relative_eq!(products, squares, epsilon = 0.0, max_relative = 1e-4);
}
