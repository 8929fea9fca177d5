//! Facts of systems from texts, against what is known and against the whole inspection.

use formula::Definition;
use inspect::facts::Facts;

use crate::{SPIN, casimirs, inspect_around, problem, system, texts};

fn facts(definition: &Definition, rate: f64, y0: &[f64]) -> Facts {
    Facts::of(&problem(definition, rate, y0, 1.0))
}

fn formulas(facts: &Facts) -> Vec<String> {
    facts.casimirs.iter().map(|casimir| casimir.formula()).collect()
}

#[test]
fn casimirs_and_energies_of_known_systems() {
    let y0 = [0.6, 0.0, 0.8];
    let of = |structure: &[&str], energy: &str, noises: &[&str], rate| {
        facts(&texts("x y z", structure, energy, noises), rate, &y0)
    };
    let body = of(&SPIN, "x^2/2 + y^2 + 2*z^2", &["0.3*(x^2/2 + y^2 + 2*z^2) + 7"], 0.5);
    assert_eq!(formulas(&body), ["0.5 y1² + 0.5 y2² + 0.5 y3²"]);
    assert_eq!((body.proportional, body.degree, body.energy_law()), (true, Some(2.0), Some(2.0)));
    // Another noise, and an energy without a degree.
    assert!(!of(&SPIN, "x^2/2 + y^2", &["x^2/2 - y^2"], 0.0).proportional);
    let mixed = |rate| of(&SPIN, "x^2/2 + y^4", &["x^2 + 2*y^4"], rate);
    assert_eq!((mixed(0.5).energy_law(), mixed(0.0).energy_law()), (None, Some(0.0)));
    // B(y)v = Qy × v has the Casimir ½yᵀQy, here x² + xy + y² + z²/2.
    let tilted = of(&["-z x+2*y", "-2*x-y"], "x^2", &[], 0.0);
    assert_eq!(formulas(&tilted), ["y1² + y2² + 0.5 y3² + y1 y2"]);
    // A canonical pair and a constant: the square of a linear Casimir is none of its own.
    let plane = of(&["1 0", "0"], "x^2 + y^2", &[], 0.0);
    assert_eq!(formulas(&plane), ["y3"]);
    // B of Lotka and Volterra's equations has a Casimir that is no polynomial.
    let prey = of(&["x*y x*z", "y*z"], "x + y + z", &["x"], 0.0);
    assert!(formulas(&prey).is_empty());
    // The oscillator's algebra: a component that moves nothing is in the Casimir of others.
    let algebra = texts("z h q p", &["0 0 0", "p -q", "z"], "h + q^2", &[]);
    let algebra = facts(&algebra, 0.0, &[0.5, 0.1, 0.2, 0.3]);
    assert_eq!(formulas(&algebra), ["y1", "0.5 y3² + 0.5 y4² + y1 y2"]);
    // Rank two in six dimensions: few equations at a point, and no quadratic Casimir but (p·z).
    let rows = ["1+c^2 0 0 0 0", "0 0 0 0", "0 0 0", "0 0", "0"];
    let low = texts("a b c d e f", &rows, "a^2 + b^2", &[]);
    let low = facts(&low, 0.0, &[0.1, 0.2, 0.3, 0.4, 0.5, 0.6]);
    assert_eq!(formulas(&low), ["y3", "y4", "y5", "y6"]);
}

/// Spins on a chain: B joins the components of each alone.
fn chain(spins: usize) -> Definition {
    let d = 3 * spins;
    let name = |i: usize| format!("s{i}");
    let state: Vec<String> = (0..d).map(name).collect();
    let entry = |i: usize, j: usize| match (i / 3 == j / 3, i % 3, j % 3) {
        (true, 0, 1) => format!("-s{}", i + 2),
        (true, 0, 2) => name(i + 1),
        (true, 1, 2) => format!("-s{}", i - 1),
        _ => "0".into(),
    };
    let structure: Vec<Vec<String>> =
        (0..d - 1).map(|i| (i + 1..d).map(|j| entry(i, j)).collect()).collect();
    let bonds: Vec<String> = (0..d - 3).map(|i| format!("s{i}*s{}", i + 3)).collect();
    let energy = if spins > 1 { bonds.join(" + ") } else { "s2^2".into() };
    let noises = (0..spins).map(|n| format!("0.2*s{}", 3 * n + 2)).collect();
    Definition {
        name: "chain".into(),
        state,
        structure: structure.into(),
        energy,
        noises,
        ..Definition::default()
    }
}

#[test]
fn every_spin_keeps_its_length_and_facts_agree_with_the_inspection() {
    for spins in [1, 2, 20] {
        let (definition, y0) = (chain(spins), [0.6, 0.0, 0.8].repeat(spins));
        let found = facts(&definition, 0.1, &y0);
        let spin = |n: usize| {
            let square = |i: usize| format!("0.5 y{}²", 3 * n + i);
            format!("{} + {} + {}", square(1), square(2), square(3))
        };
        assert_eq!(formulas(&found), (0..spins).map(spin).collect::<Vec<_>>());
        if spins < 3 {
            let inspected = inspect_around(&system(&definition, &y0), &y0).unwrap();
            assert_eq!(formulas(&found), casimirs(&inspected));
        }
        for (casimir, n) in found.casimirs.iter().zip(0..) {
            let y: Vec<f64> = (0..3 * spins).map(|i| 0.1 * i as f64).collect();
            let exact: f64 = y[3 * n..3 * n + 3].iter().map(|y| 0.5 * y * y).sum();
            assert!((casimir.value(&y) - exact).abs() < 1e-12);
        }
    }
}
