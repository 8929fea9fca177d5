//! The expansion of one step of `split-h` and `sexp-h` in τ, without sampling: linear equations
//! have closed forms, and Gauss–Hermite quadrature the means over ΔW and H.
//!
//! Terms up to τ^{3/2} are right on each path, and the error has a mean of τ³: strong order 1.5.
//! In Langevin dynamics terms up to τ² are right: strong order 2.

use std::sync::Arc;

use formula::FormulaSystem;
use noise::StepNoise;
use nonlin::BlockStatus;
use real::WIDTH;
use schemes::{SexpH, SplitH, Step, run_time::Scheme};
use systems::Damping;

use crate::{SPIN, constant, texts};

/// Nodes of the Gauss–Hermite rule and their weights: exact up to degree nine.
const RULE: [(f64, f64); 5] = [
    (-2.856_970_013_872_806, 0.011_257_411_327_720_7),
    (-1.355_626_179_974_266, 0.222_075_922_005_613),
    (0.0, 0.533_333_333_333_333_3),
    (1.355_626_179_974_266, 0.222_075_922_005_613),
    (2.856_970_013_872_806, 0.011_257_411_327_720_7),
];

type Matrix = Vec<Vec<f64>>;

/// dy = Ay dt + (Cy + b) ∘ dW.
struct Linear {
    system: FormulaSystem,
    friction: Vec<(Arc<dyn Damping>, Vec<usize>)>,
    /// Damping of all components.
    rate: f64,
    y0: Vec<f64>,
    a: Matrix,
    c: Matrix,
    b: Vec<f64>,
}

fn apply(a: &Matrix, y: &[f64]) -> Vec<f64> {
    a.iter().map(|row| row.iter().zip(y).map(|(a, y)| a * y).sum()).collect()
}

fn plus(y: &[f64], factor: f64, z: &[f64]) -> Vec<f64> {
    y.iter().zip(z).map(|(y, z)| y + factor * z).collect()
}

fn matrix<const N: usize>(rows: [[f64; N]; N]) -> Matrix {
    rows.map(Vec::from).into()
}

/// A spin in a field, with noise about another axis, and damping.
fn spin() -> Linear {
    let y0 = vec![0.6, 0.0, 0.8];
    let texts = texts("x y z", &SPIN, "0.8*x - 0.5*y", &["0.7*z"]);
    Linear {
        system: FormulaSystem::new(&texts, &y0).unwrap(),
        friction: Vec::new(),
        rate: 0.2,
        y0,
        a: matrix([[-0.2, 0.0, 0.5], [0.0, -0.2, 0.8], [-0.5, -0.8, -0.2]]),
        c: matrix([[0.0, 0.7, 0.0], [-0.7, 0.0, 0.0], [0.0, 0.0, 0.0]]),
        b: vec![0.0; 3],
    }
}

/// An oscillator with friction and noise on its momentum.
fn oscillator() -> Linear {
    let y0 = vec![0.5, 0.3];
    let texts = texts("q p", &["1"], "p^2/2 + 0.65*q^2", &["0.7*q"]);
    Linear {
        system: FormulaSystem::new(&texts, &y0).unwrap(),
        friction: vec![(Arc::new(constant(0.4)), vec![1])],
        rate: 0.0,
        y0,
        a: matrix([[0.0, 1.0], [-1.3, -0.4]]),
        c: matrix([[0.0; 2]; 2]),
        b: vec![0.0, -0.7],
    }
}

impl Linear {
    fn split(&self) -> SplitH {
        SplitH::of(&self.system, self.friction.clone())
    }

    /// The states after one step, for each pair of normals (ΔW/√τ, H/√(τ/12)).
    fn steps(&self, scheme: &dyn Scheme, tau: f64, pairs: &[[f64; 2]]) -> Vec<Vec<f64>> {
        assert!(pairs.len() <= WIDTH);
        let mut paths = scheme.stepper(&self.system).unwrap();
        for (row, y) in paths.state_mut().iter_mut().zip(&self.y0) {
            *row = [*y; WIDTH];
        }
        let mut noise = StepNoise::zero(1).with_space_time();
        for (p, [w, h]) in pairs.iter().enumerate() {
            noise.increments[0][p] = tau.sqrt() * w;
            noise.space_time[0][p] = (tau / 12.0).sqrt() * h;
        }
        let step = Step::new(&constant(self.rate), 0, tau).unwrap();
        paths.step(&step, &noise, &mut BlockStatus::explicit());
        let state = |p: usize| paths.state().iter().map(|row| row[p]).collect();
        (0..pairs.len()).map(state).collect()
    }

    /// |E[z] − E[y(τ)]|, and the same of z zᵀ where the noise is additive. `size`: H over its own
    /// size.
    fn error_of_means(&self, scheme: &dyn Scheme, tau: f64, size: f64) -> f64 {
        let rule = RULE.iter().flat_map(|w| RULE.iter().map(move |h| (w, h)));
        let pairs: Vec<[f64; 2]> = rule.clone().map(|(w, h)| [w.0, size * h.0]).collect();
        let states = self.steps(scheme, tau, &pairs);
        let mean = |of: &dyn Fn(&[f64]) -> f64| -> f64 {
            rule.clone().zip(&states).map(|((w, h), z)| w.1 * h.1 * of(z)).sum()
        };
        // exp(τ(A + ½C²)) y and, of additive noise, the covariance of the solution.
        let generator =
            |y: &[f64]| plus(&apply(&self.a, y), 0.5, &apply(&self.c, &apply(&self.c, y)));
        let (mut term, mut exact) = (self.y0.clone(), self.y0.clone());
        for n in 1..20 {
            term = generator(&term).iter().map(|x| x * tau / f64::from(n)).collect();
            exact = plus(&exact, 1.0, &term);
        }
        let d = exact.len();
        let mut error: f64 = (0..d).map(|i| (mean(&|z| z[i]) - exact[i]).powi(2)).sum();
        if self.b.iter().any(|&b| b != 0.0) {
            let mut term: Matrix =
                self.b.iter().map(|x| self.b.iter().map(|y| x * y * tau).collect()).collect();
            let mut covariance = term.clone();
            for n in 2..20 {
                let left: Vec<Vec<f64>> =
                    term.iter().map(|column| apply(&self.a, column)).collect();
                for i in 0..d {
                    for j in 0..d {
                        term[i][j] = (left[i][j] + left[j][i]) * tau / f64::from(n);
                        covariance[i][j] += term[i][j];
                    }
                }
            }
            for (i, j) in (0..d).flat_map(|i| (0..d).map(move |j| (i, j))) {
                let exact = covariance[i][j] + exact[i] * exact[j];
                error += (mean(&|z| z[i] * z[j]) - exact).powi(2);
            }
        }
        error.sqrt()
    }

    /// |z − y(τ)| for given normals, up to terms of τ² or, of additive noise, of τ^{5/2} in y(τ).
    fn error_of_path(&self, scheme: &dyn Scheme, tau: f64, [w, h]: [f64; 2]) -> f64 {
        let state = self.steps(scheme, tau, &[[w, h]]).remove(0);
        let (dw, area) = (tau.sqrt() * w, (tau / 12.0).sqrt() * h);
        // ∫W ds and ∫s dW.
        let first = tau * (0.5 * dw + area);
        let second = tau * dw - first;
        let Self { a, c, b, y0, .. } = self;
        let of = |matrices: &[&Matrix]| matrices.iter().fold(y0.clone(), |y, m| apply(m, &y));
        let mut exact = y0.clone();
        for (factor, term) in [
            (tau, of(&[a])),
            (dw, of(&[c])),
            (dw * dw / 2.0, of(&[c, c])),
            (dw * dw * dw / 6.0, of(&[c, c, c])),
            // First C, then A: ∫W ds.
            (first, of(&[c, a])),
            (second, of(&[a, c])),
            (dw, b.clone()),
            (first, apply(a, b)),
            (tau * tau / 2.0, of(&[a, a])),
        ] {
            exact = plus(&exact, factor, &term);
        }
        plus(&state, -1.0, &exact).iter().map(|x| x * x).sum::<f64>().sqrt()
    }
}

/// The exponent of an error as τ → 0.
fn exponent(error: impl Fn(f64) -> f64) -> f64 {
    let [coarse, fine] = [5, 6].map(|k| error(0.5f64.powi(k)));
    (coarse / fine).log2()
}

#[test]
fn a_step_with_space_time_areas_has_the_right_expansion() {
    for (system, path) in [(spin(), 2.0), (oscillator(), 2.5)] {
        let sexp = SexpH::of(&system.system, system.friction.clone());
        let split = system.split();
        let schemes: [&dyn Scheme; 2] = [&split, &sexp];
        for scheme in schemes {
            let id = scheme.about().id;
            let means = exponent(|tau| system.error_of_means(scheme, tau, 1.0));
            assert!(means > 2.9, "{id}: {means}");
            // Normals of both signs and sizes.
            for normals in [[0.7, 1.1], [-1.3, 0.4], [0.2, -1.9]] {
                let found = exponent(|tau| system.error_of_path(scheme, tau, normals));
                assert!(found > path - 0.2, "{id} {normals:?}: {found}");
            }
        }
        // Areas of the other sign have the same law, and are wrong on each path.
        let turned = exponent(|tau| {
            let z = system.steps(&split, tau, &[[0.7, -1.1]]).remove(0);
            let right = system.steps(&split, tau, &[[0.7, 1.1]]).remove(0);
            plus(&z, -1.0, &right).iter().map(|x| x * x).sum::<f64>().sqrt()
        });
        assert!((turned - 1.5).abs() < 0.2, "{turned}");
        // Areas that are too large are wrong in the means.
        let large = exponent(|tau| system.error_of_means(&split, tau, 2f64.sqrt()));
        let without = SplitH { delta: 0.0, ..system.split() };
        let straight = exponent(|tau| system.error_of_means(&without, tau, 1.0));
        if path == 2.0 {
            assert!(large < 2.2 && straight < 2.2, "{large} {straight}");
        }
    }
}
