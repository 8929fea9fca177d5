//! What cutting the series costs, measured on n and N ≫ n terms of the same coefficients.
//!
//! Areas in units of h/2π. With R = Σ_{n<r≤N} (1/r)(X_iY_j − X_jY_i) and a² = 2Σ_{n<r≤N} r⁻², the
//! sampler puts a normal a g_ij for R; here it is the one that R itself is made of.

use std::f64::consts::{PI, TAU};

use noise::area_error;

use crate::statistical::areas::key;
use crate::statistical::check::Sum;
use crate::written_out::{Coefficients, normals};

/// N = 40n: finite, and in the formulas as what it is.
const MANY: usize = 40;

fn inverse_squares(first: usize, last: usize) -> f64 {
    (first + 1..=last).map(|r| (r as f64).powi(-2)).sum()
}

/// The mesh of the quadratures.
const MESH: f64 = 0.05;

/// E[√S] = (1/√π)∫₀^∞ (1 − φ(s²)) ds/s² for a positive S with the Laplace transform φ, by the
/// trapezoidal rule in ln s. φ(s²) = e^{−c}; the table holds s and c.
fn mean_root(table: &[(f64, f64)]) -> f64 {
    MESH * table.iter().map(|&(s, c)| -(-c).exp_m1() / s).sum::<f64>() / PI.sqrt()
}

/// The mean square error for two noises, exactly.
///
/// S = Σ r⁻²(X_1² + X_2²) is a number, with the Laplace transform Π(1 + 2t/r²)⁻¹, and the error is
/// E(√S − a)² = 2a² − 2aE√S.
fn two_noises(terms: usize) -> f64 {
    let many = MANY * terms;
    let exponent = |t: f64| (terms + 1..=many).map(|r| (2.0 * (t / (r * r) as f64)).ln_1p()).sum();
    let table: Vec<_> = (-500..=500)
        .map(|k| {
            let s = (MESH * f64::from(k)).exp();
            (s, exponent(s * s))
        })
        .collect();
    let a2 = 2.0 * inverse_squares(terms, many);
    2.0 * a2 - 2.0 * a2.sqrt() * mean_root(&table)
}

#[test]
fn the_error_of_the_normal_tail_for_two_noises() {
    for (terms, experiment) in [(1, 530), (4, 531), (16, 532)] {
        let many = MANY * terms;
        let expected = two_noises(terms);
        // Half the published error is enough; it is what the error tends to.
        let ratio = expected / area_error(TAU, terms, 2).powi(2);
        assert!(ratio < 0.25 && ratio > 0.25 * (1.0 - 1.0 / terms as f64), "{terms}: {ratio}");
        let mut sum = Sum::default();
        for number in 0..4000 {
            let coefficients = Coefficients::<2>::draw(&mut normals(key(experiment), number), many);
            let a = (2.0 * inverse_squares(terms, many)).sqrt();
            let rest = coefficients.series([0.0; 2], terms, many, 1.0)[0][1];
            let square = |r: usize| coefficients.x[r - 1].map(|x| x * x).iter().sum::<f64>();
            let s: f64 = (terms + 1..=many).map(|r| square(r) / (r * r) as f64).sum();
            sum.add((rest - a * rest / s.sqrt()).powi(2) - expected);
        }
        assert_eq!(sum.verdict(), Ok(()), "{terms}");
    }
}
