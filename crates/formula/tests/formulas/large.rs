//! Systems with thousands of components: made in a time that is linear in their terms, and right.

use std::time::{Duration, Instant};

use formula::{Definition, FormulaSystem, Structure};
use noise::StepNoise;
use nonlin::BlockStatus;
use real::{Row, Rows, WIDTH};
use schemes::{Sexp, Split, Step, run_time::Scheme};
use systems::{
    Constant,
    run_time::{System, Weights},
};

use crate::expression::Random;

fn sum(terms: impl Iterator<Item = String>) -> String {
    terms.collect::<Vec<_>>().join(" + ")
}

/// Masses on springs with a cubic force, between a wall and a free end, with noise at both.
fn chain(n: usize) -> FormulaSystem {
    let name = |kind: &str, k: usize| format!("{kind}{}", k + 1);
    let kinetic = sum((0..n).map(|k| format!("{}^2/2", name("p", k))));
    let stretch = |k: usize| match k {
        0 => "q1".to_owned(),
        _ => format!("({} - {})", name("q", k), name("q", k - 1)),
    };
    let springs = sum((0..n).map(stretch).map(|x| format!("{x}^2/2 + {x}^4/4")));
    let definition = Definition {
        name: "chain".into(),
        state: ["q", "p"].iter().flat_map(|kind| (0..n).map(|k| name(kind, k))).collect(),
        structure: Structure::Entries((0..n).map(|k| ((k, n + k), "1".into())).collect()),
        energy: format!("{kinetic} + {springs}"),
        noises: vec!["0.3*q1".into(), format!("0.2*{}", name("q", n - 1))],
        ..Definition::default()
    };
    FormulaSystem::new(&definition, &vec![0.1; 2 * n]).unwrap()
}

/// Spins with exchange along a line, in a field.
fn spins(n: usize) -> FormulaSystem {
    let name = |kind: char, k: usize| format!("{kind}{k}");
    let bond = |k: usize| sum("xyz".chars().map(|c| format!("{}*{}", name(c, k), name(c, k + 1))));
    let field = sum((0..n).map(|k| format!("0.3*{}", name('z', k))));
    let entries = |k: usize| {
        let (x, y, z) = (3 * k, 3 * k + 1, 3 * k + 2);
        let entry = |i, j, sign: &str, c| ((i, j), format!("{sign}{}", name(c, k)));
        [entry(x, y, "-", 'z'), entry(x, z, "", 'y'), entry(y, z, "-", 'x')]
    };
    let definition = Definition {
        name: "spins".into(),
        state: (0..n).flat_map(|k| "xyz".chars().map(move |c| name(c, k))).collect(),
        structure: Structure::Entries((0..n).flat_map(entries).collect()),
        energy: format!("{} + {field}", sum((0..n - 1).map(bond))),
        noises: vec![format!("0.1*({})", sum((0..n).map(|k| name('z', k))))],
        ..Definition::default()
    };
    FormulaSystem::new(&definition, &vec![0.6; 3 * n]).unwrap()
}

/// Least time of three.
fn time(make: impl Fn() -> FormulaSystem) -> Duration {
    let one = |_| {
        let start = Instant::now();
        make();
        start.elapsed()
    };
    (0..3).map(one).min().unwrap()
}

/// Eight times the terms take about eight times the time; 64 times if it were quadratic.
#[test]
fn a_system_is_made_in_a_time_linear_in_its_terms() {
    for (make, n) in [(chain as fn(usize) -> FormulaSystem, 250), (spins, 100)] {
        let (short, long) = (time(|| make(n)), time(|| make(8 * n)));
        assert!(long < 24 * short, "{short:?}, {long:?}");
    }
    let parts = spins(400).description().parts.clone().unwrap();
    assert_eq!(parts.number, 3, "{parts:?}");
}

/// The forces on the masses by hand.
fn forces(q: &[f64]) -> Vec<f64> {
    let spring = |k: usize| {
        let x = if k == 0 { q[0] } else { q[k] - q[k - 1] };
        x + x * x * x
    };
    let pull = |k: usize| if k + 1 < q.len() { spring(k + 1) } else { 0.0 };
    (0..q.len()).map(|k| pull(k) - spring(k)).collect()
}

fn step(
    scheme: &dyn Scheme,
    system: &FormulaSystem,
    y0: &[f64],
    dw: [f64; 2],
    steps: u64,
) -> Vec<Row> {
    let mut paths = scheme.stepper(system).unwrap();
    paths.state_mut().copy_from_slice(&Rows::splat(y0));
    let mut noise = StepNoise::zero(2);
    noise.increments.copy_from_slice(&dw.map(|dw| [dw; WIDTH]));
    let (damping, mut status) = (Constant::new(0.0).unwrap(), BlockStatus::explicit());
    for n in 0..steps {
        paths.step(&Step::new(&damping, n, TAU).unwrap(), &noise, &mut status);
    }
    assert!(status.failed.is_empty());
    paths.state().to_vec()
}

const TAU: f64 = 0.02;

/// `split` is the leapfrog method, and `sexp` keeps the energy, of 2000 masses.
#[test]
fn a_long_chain_moves_as_by_hand() {
    let (n, mut random) = (2000, Random::new(11));
    let system = chain(n);
    let y0: Vec<f64> = (0..2 * n).map(|_| 0.5 * random.number()).collect();
    let (q, p) = y0.split_at(n);
    let parts = &system.description().parts.as_ref().unwrap().words;
    assert!(parts.len() == 2 && parts[1].contains("of H2"), "{parts:?}");
    // p moves by half a step, q by a whole one, p by the other half: or q first, whichever part
    // the system has first.
    let dw = [0.03, -0.05];
    let kick = |q: &[f64], p: &[f64], share: f64| -> Vec<f64> {
        let noise = |k: usize| match k {
            0 => 0.3 * dw[0],
            _ if k + 1 == n => 0.2 * dw[1],
            _ => 0.0,
        };
        (0..n).zip(forces(q)).map(|(k, f)| p[k] + share * (TAU * f - noise(k))).collect()
    };
    let drift = |q: &[f64], p: &[f64], share: f64| -> Vec<f64> {
        q.iter().zip(p).map(|(q, p)| q + share * TAU * p).collect()
    };
    let half = drift(q, p, 0.5);
    let moved = kick(&half, p, 1.0);
    let expected = [drift(&half, &moved, 0.5), moved].concat();
    for (ours, theirs) in step(&Split, &system, &y0, dw, 1).iter().zip(expected) {
        assert!((ours[7] - theirs).abs() < 1e-14, "{} for {theirs}", ours[7]);
    }
    let energy = |y: &[Row]| {
        let (mut out, dw) = ([0.0; WIDTH], [[0.0; WIDTH]; 2]);
        let mut scratch = Rows::zero(system.description().scratch_rows());
        let h = Weights { dt: 1.0, dw: &dw, ..Weights::NONE };
        system.energy(y, h, &mut out, &mut scratch);
        out[3]
    };
    let before = energy(&Rows::splat(&y0));
    let after = energy(&step(&Sexp, &system, &y0, [0.0; 2], 10));
    // The equation of a step is solved to some roundings.
    assert!((after / before - 1.0).abs() < 1e-13, "{before} and {after}");
}
