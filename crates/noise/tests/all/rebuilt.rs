//! The areas are those of paths: orientation and sign, on paths rebuilt from the coefficients.

use std::f64::consts::{PI, TAU};

use noise::WienerPath;

use crate::statistical::areas::key;
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
/// sin(φ)/φ, φ = 2πr/G, an error of φ²/6 < 6e-5 at most.
#[test]
fn areas_are_those_of_the_path_with_their_sign() {
    const TERMS: usize = 12;
    let step = 0.7;
    for number in 0..64 {
        let key = key(400);
        let dw = WienerPath::<3>::new(key, number).increments(f64::sqrt(step));
        let coefficients = Coefficients::<3>::draw(&mut normals(key, number), TERMS);
        // The series of the sampler, with which it agrees to rounding.
        let upper = coefficients.series(dw.map(|w| w / step.sqrt()), 0, TERMS, 1.0);
        let path = path(&coefficients, TERMS, step, dw);
        for a in 0..3 {
            assert!((path[GRID][a] - dw[a]).abs() < 1e-12);
            for b in 0..3 {
                let own = coefficients.x.iter().zip(&coefficients.y).zip(1..);
                let own = own.map(|((x, y), r)| (x[a] * y[b] - x[b] * y[a]).abs() / f64::from(r));
                let error = 6e-5 * step / TAU * own.sum::<f64>() + 1e-12;
                let area = (upper[a][b] - upper[b][a]) * step / TAU;
                let (polygon, back) = (integral(&path, a, b), integral(&path, b, a));
                assert!((polygon - 0.5 * dw[a] * dw[b] - area).abs() <= error, "{a}{b}: {polygon}");
                assert!((0.5 * (polygon - back) - area).abs() <= error, "{a}{b}: {area}");
            }
        }
    }
}
