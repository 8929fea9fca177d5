//! Fluids on the sphere without chance.

use std::{f64::consts::PI, sync::Arc};

use matrix::{Harmonics, Scheme, Sphere, Stirring, c64, gauss, inner};
use mc::Observe;
use real::{PathMask, WIDTH};
use systems::run_time::{Op, System, Weights};

use crate::{after, matrix, problem, setup, state};

fn harmonic(n: usize, l: usize, m: isize) -> Vec<c64> {
    let mut w = vec![c64::default(); n * n];
    Harmonics::new(n).add(&mut w, l, m, 1.0);
    w
}

/// Rounding errors of sums of N² terms, with N² ε for each eigenvector of a Laplacian.
const ROUNDING: f64 = 1e-11;

#[test]
fn harmonics_are_orthonormal_eigenmatrices() {
    for n in [2, 3, 8, 33] {
        let fluid = Sphere::new(n, 0.0, 1.0, []).unwrap();
        let all: Vec<_> = (0..n)
            .flat_map(|l| (-(l as isize)..=l as isize).map(move |m| (l, m)))
            .map(|(l, m)| (l, m, harmonic(n, l, m)))
            .collect();
        assert_eq!(all.len(), n * n);
        for (k, (l, m, w)) in all.iter().enumerate() {
            for (other, (.., u)) in
                all.iter().enumerate().filter(|(o, _)| n < 33 || o % 97 == k % 97)
            {
                let known = f64::from(u8::from(k == other));
                assert!((inner(w, u) - known).abs() < ROUNDING, "{n} {l} {m} {other}");
            }
            // 2H₀ = 1/l(l+1).
            let energy = 2.0 * fluid.kinetic_energy(w) * (l * (l + 1)) as f64;
            assert!((energy - f64::from(u8::from(*l > 0))).abs() < ROUNDING, "{n} {l} {m}");
        }
    }
    // Large ones, of degrees from least to largest, and the twin of another degree.
    let n = 512;
    let fluid = Sphere::new(n, 0.0, 1.0, []).unwrap();
    for (l, m) in [(1, 0), (256, 256), (300, 17), (511, 0), (511, -511), (511, 255)] {
        let w = harmonic(n, l, m);
        let energy = 2.0 * fluid.kinetic_energy(&w) * (l * (l + 1)) as f64;
        assert!((inner(&w, &w) - 1.0).abs() < ROUNDING && (energy - 1.0).abs() < 1e-9, "{l} {m}");
        let power = Harmonics::new(n).power(&w, l);
        assert!((power - 1.0).abs() < ROUNDING, "{l} {m}: {power}");
        assert!(Harmonics::new(n).power(&w, if l == 1 { 3 } else { l - 2 }) < 1e-15);
    }
}

/// Energies of degrees are parts of the energy, also where the sphere rotates.
#[test]
fn functions_of_a_fluid_are_those_of_its_coefficients() {
    let fluid = Arc::new(Sphere::new(5, 0.8, 1.0, []).unwrap());
    let given: Vec<f64> = (0..24).map(|k| 0.3 + f64::from(k % 7) / 5.0).collect();
    let w = fluid.vorticity(&given);
    let relative = fluid.relative(&w);
    let orders = (1..5).flat_map(|l| (-(l as isize)..=l as isize).map(move |m| (l, m)));
    let mut energies = [0.0; 5];
    for ((l, m), x) in orders.zip(&given) {
        assert!((fluid.harmonics().coefficient(&relative, l, m) - x).abs() < 1e-13, "{l} {m}");
        energies[l] += x * x / (2 * l * (l + 1)) as f64;
    }
    energies[0] = energies[1..].iter().sum();
    let rows: Vec<_> = state(5, &w).into_iter().map(|y| [y; WIDTH]).collect();
    let of = |function: &matrix::Function| function.values(&rows, PathMask::ALL)[5];
    let functions = fluid.functions(4);
    assert!((of(&functions[0]) - energies[0]).abs() < 1e-13);
    for (l, energy) in energies.iter().enumerate().skip(1) {
        assert!((of(&functions[1 + l]) - energy).abs() < 1e-13, "{l}");
    }
}

#[test]
fn grids_and_matrices_are_the_same_function() {
    let n = 24;
    let (grid, weights) = gauss(n).unwrap();
    let mut w = vec![c64::default(); n * n];
    let known = [(0, 0, 0.3), (1, 1, 0.5), (1, -1, -0.7), (2, 0, 1.1), (23, -20, 0.4), (9, 9, 0.2)];
    for (l, m, x) in known {
        Harmonics::new(n).add(&mut w, l, m, x);
    }
    let values = grid.values(n, &w);
    let back = grid.matrix(n, &values, &weights);
    let apart = w.iter().zip(&back).map(|(a, b)| (a - b).norm_sqr()).sum::<f64>().sqrt();
    assert!(apart < ROUNDING, "{apart:e}");
    for (l, m, x) in known {
        assert!((Harmonics::new(n).coefficient(&back, l, m) - x).abs() < ROUNDING, "{l} {m}");
    }
    // Y₁₁, Y₁₋₁ and Y₁₀ are √(3/4π) times x, y, z.
    let unit = (3.0 / (4.0 * PI)).sqrt();
    let at = |l, m, i: usize, k: usize| grid.values(n, &harmonic(n, l, m))[i * 2 * n + k];
    let (z, angle) = (grid.sines[5], 7.0 * PI / n as f64);
    let x = (1.0 - z * z).sqrt();
    assert!((at(1, 0, 5, 7) - unit * z).abs() < ROUNDING);
    assert!((at(1, 1, 5, 7) - unit * x * angle.cos()).abs() < ROUNDING);
    assert!((at(1, -1, 5, 7) - unit * x * angle.sin()).abs() < ROUNDING);
}

/// A wave of one degree and any orders drifts westward with the rate 2Ω/l(l+1): a phase of order two
/// in τ.
#[test]
fn rossby_haurwitz_waves_drift_westward() {
    let (n, rotation, l) = (12, 1.3, 4);
    let fluid = Arc::new(Sphere::new(n, rotation, 1.0, []).unwrap());
    let harmonics = Harmonics::new(n);
    let mut w = vec![c64::default(); n * n];
    harmonics.add(&mut w, 1, 0, 2.0 * rotation * (4.0 * PI / 3.0).sqrt());
    harmonics.add(&mut w, l, 3, 0.8);
    harmonics.add(&mut w, l, -2, 0.5);
    harmonics.add(&mut w, l, 0, 0.4);
    let t = 3.0;
    let rate = 2.0 * rotation / (l * (l + 1)) as f64;
    // cos m(φ + rate t), and sin of it.
    let turned = |m: f64| (m * rate * t).sin_cos();
    let known = [
        (3, 0.8 * turned(3.0).1),
        (-3, -0.8 * turned(3.0).0),
        (-2, 0.5 * turned(2.0).1),
        (2, 0.5 * turned(2.0).0),
        (0, 0.4),
    ];
    for scheme in [Scheme::Explicit, Scheme::Midpoint] {
        let problem = problem(&fluid, &w, 0.0, t);
        let setup = setup(&problem, &fluid, scheme);
        let error = |steps: u64| {
            let end = matrix(n, &after(&setup, steps, t / steps as f64, 1), 0);
            let of = known.map(|(m, x)| (harmonics.coefficient(&end, l, m) - x).abs());
            of.into_iter().fold(0.0, f64::max)
        };
        let errors = [error(50), error(100)];
        assert!(errors[1] < 1e-3 && errors[0] > 1e-9, "{errors:?}");
        assert!((3.5..4.5).contains(&(errors[0] / errors[1])), "{scheme:?} {errors:?}");
    }
}

/// Itô's correction of isotropic noise is −κ_L on degree L.
#[test]
fn isotropic_noise_damps_degrees_by_known_rates() {
    let five = [1.0 / 2.0, 17.0 / 14.0, 11.0 / 7.0, 5.0 / 7.0];
    let eight = [5.0 / 42.0, 1.0 / 3.0, 25.0 / 42.0, 5.0 / 6.0, 20.0 / 21.0, 5.0 / 6.0, 1.0 / 3.0];
    for (n, known) in [(5, &five[..]), (8, &eight[..])] {
        let strength = 1.0 / matrix::bracket_scale(n);
        let fluid = Arc::new(Sphere::new(n, 0.0, 0.0, Stirring::isotropic(2, strength)).unwrap());
        let system = matrix::InCoordinates::new(fluid);
        for (l, rate) in (1..n).zip(known) {
            for m in [0, 1 - l as isize, l as isize] {
                let y = state(n, &harmonic(n, l, m));
                let rows: Vec<_> = y.iter().map(|y| [*y; WIDTH]).collect();
                let mut out = rows.clone();
                let op = Op::ItoCorrection { y: &rows[..] };
                system.apply(op, 0..n * n, Weights::NONE, &mut out, &mut []);
                let apart = out.iter().zip(&y).map(|(f, y)| (f[3] + rate * y).abs());
                assert!(apart.fold(0.0, f64::max) < ROUNDING, "{n} {l} {m}");
            }
        }
    }
}
