//! Traces, functions and operations in coordinates against sums by hand.

use std::sync::Arc;

use matrix::{
    Function, InCoordinates, MatrixSystem, Quantum, Sphere, SpinCouplings, Stirring, SuSpins, c64,
    inner, pure, traces,
};
use mc::Observe;
use real::{PathMask, WIDTH};
use systems::{
    lattice::Shape,
    run_time::{Op, System, Weights},
};

use crate::{generic, numbers, state};

/// QdQ of a diagonal d with a reflection Q.
fn reflected(d: &[f64]) -> Vec<c64> {
    let n = d.len();
    let mut u: Vec<c64> = (0..n as u64).map(|j| c64::new(numbers(j), numbers(j + 50))).collect();
    let norm = u.iter().map(|u| u.norm_sqr()).sum::<f64>().sqrt();
    u.iter_mut().for_each(|u| *u /= norm);
    let q =
        |j: usize, k: usize| c64::new(f64::from(u8::from(j == k)), 0.0) - u[j] * u[k].conj() * 2.0;
    let entry = |at: usize| (0..n).map(|l| q(at % n, l) * q(l, at / n) * d[l]).sum();
    (0..n * n).map(entry).collect()
}

/// At two sites, by loops and by faer.
#[test]
fn traces_are_sums_of_powers_of_eigenvalues() {
    for n in [3, 9, 70] {
        let [d, e] =
            [7, 90].map(|seed| (0..n as u64).map(|j| numbers(seed + j)).collect::<Vec<_>>());
        let w = [reflected(&d), reflected(&e)].concat();
        for (k, found) in (1..).zip(traces(n, &w, 8)) {
            let known: f64 = d.iter().chain(&e).map(|x| x.powi(k)).sum();
            assert!((found - known).abs() < 1e-13 * n as f64, "{n} {k}: {found} {known}");
        }
    }
}

fn value(functions: &[Function], name: &str, n: usize, w: &[c64]) -> f64 {
    let rows: Vec<_> = state(n, w).into_iter().map(|y| [y; WIDTH]).collect();
    let of = functions.iter().find(|of| of.name() == name).unwrap();
    of.values(&rows, PathMask::ALL)[3]
}

/// ψ = (1, 2i, 2)/3, for which ⟨S⁺⟩ = √2(ψ̄₁ψ₂ + ψ̄₂ψ₃) = −2√2i/9.
#[test]
fn functions_of_a_state_are_those_of_its_amplitudes() {
    let psi = [c64::new(1.0, 0.0), c64::new(0.0, 2.0), c64::new(2.0, 0.0)];
    let w: Vec<c64> = (0..9).map(|at| psi[at % 3] * psi[at / 3].conj() / 9.0).collect();
    let couplings = SpinCouplings {
        quadratic: 0.7,
        quartic: 0.2,
        field: [0.0, 0.3, 0.5],
        ..Default::default()
    };
    let spins = Arc::new(SuSpins::new(3, Shape::open(&[2]).unwrap(), couplings).unwrap());
    // A second site with ψ = (1, 0, 0), which `pure` makes of any length.
    let mut both = w.clone();
    pure(&[-2.0, 0.0, 0.0], &mut both);
    let (my, mz) = (-2.0 * 2f64.sqrt() / 9.0, -1.0 / 3.0);
    let energy = 0.9 * (5.0 / 9.0 + 1.0) - 0.3 * my - 0.5 * (mz + 1.0);
    for (name, sum) in [
        ("mx", 0.0),
        ("my", my),
        ("mz", mz + 1.0),
        ("p1", 1.0 / 9.0 + 1.0),
        ("p3", 4.0 / 9.0),
        ("energy", energy),
    ] {
        let found = value(&spins.functions(), name, 3, &both);
        assert!((found - 0.5 * sum).abs() < 1e-14, "{name}: {found}");
    }
    // S = 2 in its highest level: 4D + 16K.
    let anisotropy = SpinCouplings { quadratic: 0.7, quartic: 0.2, ..Default::default() };
    let five = Arc::new(SuSpins::new(5, Shape::open(&[1]).unwrap(), anisotropy).unwrap());
    let mut highest = Vec::new();
    pure(&[3.0, 0.0, 0.0, 0.0, 0.0], &mut highest);
    assert!((value(&five.functions(), "energy", 5, &highest) - 6.0).abs() < 1e-14);
    let h = generic(3, 5);
    let known: f64 = (0..9).map(|at| (h[at].conj() * w[at]).re).sum();
    let quantum = Arc::new(Quantum::new(3, h, vec![]).unwrap());
    for (name, known) in [
        ("p2", 4.0 / 9.0),
        ("purity", 1.0),
        ("energy", known),
        ("re1_2", 0.0),
        ("im1_2", -2.0 / 9.0),
        ("re1_3", 2.0 / 9.0),
        ("im2_3", 4.0 / 9.0),
    ] {
        let found = value(&quantum.functions(), name, 3, &w);
        assert!((found - known).abs() < 1e-14, "{name}: {found}");
    }
}

#[test]
fn noises_commute_where_they_say_so() {
    let fluid = |orders: [isize; 2]| {
        let noises = [2, 3].into_iter().zip(orders);
        let noises = noises.map(|(degree, order)| Stirring { degree, order, strength: 1.0 });
        Sphere::new(5, 0.0, 1.0, noises).unwrap().noises_commute()
    };
    assert!(fluid([0, 0]) && !fluid([0, 1]) && !fluid([1, 1]));
    let quantum = |a: Vec<c64>, b| Quantum::new(3, a.clone(), vec![a, b]).unwrap().noises_commute();
    let (a, b) = (reflected(&[0.3, -1.0, 0.8]), reflected(&[1.3, 0.5, -0.1]));
    assert!(quantum(a.clone(), b) && !quantum(a, generic(3, 9)));
}

/// h = H₀dt + ΣHₘdwₘ is ⟨W, ½V₀ + Vₘ⟩ of a fluid without rotation, and its Hessian is ∇H₀ dt.
#[test]
fn operations_in_coordinates_are_those_of_matrices() {
    let n = 4;
    let fluid = Arc::new(Sphere::new(n, 0.0, 1.3, Stirring::isotropic(2, 0.4)).unwrap());
    let system = InCoordinates::new(Arc::clone(&fluid));
    let [w, u] = [1, 30].map(|seed| generic(n, seed));
    let row = |w: &[c64]| state(n, w).into_iter().map(|y| [y; WIDTH]).collect::<Vec<_>>();
    let dw: Vec<_> = (0..5).map(|m| [numbers(m); WIDTH]).collect();
    let h = Weights { dt: 0.7, dw: &dw, ..Weights::NONE };
    let generator = |w: &[c64], dt: f64, by: f64| {
        let mut v = vec![c64::default(); n * n];
        let dw: Vec<f64> = dw.iter().map(|row| by * row[0]).collect();
        fluid.generator(w, dt, &dw, &mut v);
        v
    };
    let mut energy = [0.0; WIDTH];
    system.energy(&row(&w), h, &mut energy, &mut []);
    let known = 0.5 * inner(&w, &generator(&w, 0.7, 0.0)) + inner(&w, &generator(&w, 0.0, 1.0));
    assert!((energy[2] - known).abs() < 1e-13, "{} {known}", energy[2]);
    let apply = |op: Op<&[real::Row]>| {
        let mut out = row(&w);
        system.apply(op, 0..n * n, h, &mut out, &mut []);
        out.iter().map(|out| out[2]).collect::<Vec<_>>()
    };
    let (y, u_rows) = (row(&w), row(&u));
    for (found, known) in [
        (apply(Op::Gradient { y: &y }), generator(&w, 0.7, 1.0)),
        (apply(Op::Hessian { y: &y, u: &u_rows }), generator(&u, 0.7, 0.0)),
    ] {
        let known = state(n, &known);
        assert!(found.iter().zip(known).all(|(a, b)| (a - b).abs() < 1e-12));
    }
}
