//! Spins on a lattice: lengths on their law, equilibrium at a temperature, one path beside many.

use std::sync::Arc;

use lattice::LargePath;
use mc::{Checkpoint, LadderError, Setup, Simulation, parts::Program};
use noise::{StreamKey, Truncation};
use nonlin::Solver;
use schemes::{Explicit, Heun, Increment, Sexp, SexpLi, Split, WithSolver, run_time::Scheme};
use stats::CentralMoments;
use systems::{
    Constant,
    lattice::{Couplings, Shape, SpinLattice, noise_at_temperature},
    run_time::Problem,
};

use crate::on_threads;

const KEY: StreamKey = StreamKey { seed: 20_261_122, experiment: 0 };

fn truncation() -> Truncation {
    Truncation::new(4).unwrap()
}

/// All spins in one direction, on [0, T] with a constant damping.
fn problem(lattice: SpinLattice, rate: f64, t_end: f64) -> Problem {
    let spins = lattice.shape().sites();
    let y0 = [0.6, 0.0, 0.8].repeat(spins);
    Problem::new(Arc::new(lattice), Arc::new(Constant::new(rate).unwrap()), y0, t_end).unwrap()
}

/// max ||sᵢ|/length − 1|; a NaN is the largest.
fn length_defect(path: &LargePath<'_>, problem: &Problem, length: f64) -> f64 {
    let defect = |spin: usize| {
        let square = |c: usize| path.component(3 * spin + c).powi(2);
        ((0..3).map(square).sum::<f64>().sqrt() / length - 1.0).abs()
    };
    (0..problem.y0().len() / 3).map(defect).max_by(f64::total_cmp).unwrap()
}

#[test]
#[ignore = "long: run by the gate"]
fn every_length_is_on_its_law_after_100_000_steps() {
    const STEPS: u64 = 100_000;
    let couplings = Couplings {
        exchange: 1.0,
        anisotropy: 0.3,
        field: [0.0, 0.1, 0.2],
        noise: 0.2,
        local: true,
        damping: 0.0,
    };
    let lattice = SpinLattice::one_path(Shape::periodic(&[4, 4, 2]).unwrap(), couplings).unwrap();
    let damped = Couplings { damping: 0.2, ..couplings };
    let transverse = SpinLattice::one_path(lattice.shape().clone(), damped).unwrap();
    let sexp_li = SexpLi::at_run_time(&lattice).unwrap();
    // The residual of a step is at most 2ε of all spins together, of one sign for long, and may
    // fall on one of them. One more sweep leaves round-off.
    let settled = WithSolver { formula: Sexp, solver: Solver::default().settled() };
    for (lattice, scheme, steps) in [
        (&lattice, &sexp_li as &dyn Scheme, STEPS),
        (&transverse, &sexp_li, STEPS),
        (&lattice, &Split, STEPS),
        (&lattice, &settled, STEPS),
        (&lattice, &Sexp, STEPS / 10),
    ] {
        let problem = problem(lattice.clone(), 1e-3, 1e-2 * STEPS as f64);
        let mut path = LargePath::new(&problem, scheme, STEPS, truncation(), KEY, 3).unwrap();
        path.advance(steps).unwrap();
        let law = (-1e-3 * path.time()).exp();
        let defect = length_defect(&path, &problem, law);
        assert!(defect < 1e-12, "{}: {defect:e}", scheme.about().id);
    }
    // An explicit scheme leaves the law.
    let problem = problem(lattice.clone(), 1e-3, 1e-2 * STEPS as f64);
    let mut path = LargePath::new(&problem, &Heun, STEPS, truncation(), KEY, 3).unwrap();
    path.advance(STEPS / 100).unwrap();
    assert!(length_defect(&path, &problem, (-1e-3 * path.time()).exp()) > 1e-6);
}

/// coth x − 1/x.
fn langevin(x: f64) -> f64 {
    1.0 / x.tanh() - 1.0 / x
}

/// The average over time of `observable`, in steps of size τ after a tenth of them, and its
/// standard error from 33 batches, each of some fifteen times of decorrelation.
fn average(
    lattice: &SpinLattice,
    scheme: &dyn Scheme,
    (tau, steps): (f64, u64),
    key: StreamKey,
    observable: &dyn Fn(&LargePath<'_>) -> f64,
) -> (f64, f64) {
    let problem = problem(lattice.clone(), 0.0, tau * steps as f64);
    let mut path = LargePath::new(&problem, scheme, steps, truncation(), key, 0).unwrap();
    path.advance(steps / 10).unwrap();
    let mut batches = CentralMoments::default();
    while path.steps_done() < steps {
        let mut batch = CentralMoments::default();
        for _ in 0..512 {
            path.advance(8).unwrap();
            batch.add(observable(&path));
        }
        batches.add(batch.mean());
    }
    (batches.mean(), batches.variance_of_mean().sqrt())
}

const ALPHA: f64 = 1.0;
/// Steps of size 0.004β/α, so that σ²τ = 0.008, and at most 0.01. They are some 500 times of
/// decorrelation, β/2α.
const STEPS: u64 = 150_000;

fn tau(beta: f64) -> f64 {
    f64::min(0.004 * beta / ALPHA, 0.01)
}

/// Open chains of spins at the temperature 1/β.
fn at_temperature(beta: f64, noise: f64, sites: usize, energy: Couplings) -> SpinLattice {
    let noise = noise * noise_at_temperature(ALPHA, 1.0 / beta);
    let couplings = Couplings { noise, local: true, damping: ALPHA, ..energy };
    SpinLattice::one_path(Shape::open(&[sites]).unwrap(), couplings).unwrap()
}

/// Independent spins in a field along z.
fn in_a_field(beta: f64, noise: f64) -> SpinLattice {
    let energy = Couplings { field: [0.0, 0.0, 1.0], ..Couplings::default() };
    at_temperature(beta, noise, 64, energy)
}

fn mean_z(path: &LargePath<'_>) -> f64 {
    (0..64).map(|spin| path.component(3 * spin + 2)).sum::<f64>() / 64.0
}

/// An open Heisenberg chain without field.
fn chain(beta: f64, noise: f64) -> SpinLattice {
    at_temperature(beta, noise, 65, Couplings { exchange: 1.0, ..Couplings::default() })
}

fn mean_bond(path: &LargePath<'_>) -> f64 {
    let bond = |spin: usize| -> f64 {
        (0..3).map(|c| path.component(3 * spin + c) * path.component(3 * spin + 3 + c)).sum()
    };
    (0..64).map(bond).sum::<f64>() / 64.0
}

/// The weak error in units of σ²τ. With steps four and eight times as large it is seen, in
/// proportion to τ: at most 0.2 for spins in a field, and 0.17, 0.35 and 0.2 for the chain at β =
/// ½, 2 and 6. For the chain at β = 2 it is 1.6 standard errors, elsewhere less than one.
const WEAK_ERROR: f64 = 0.4;

/// Standard errors that a mean may be off beside that: each of six tests fails by chance with a
/// probability of 6e-5 for a normal mean, 2e-4 for Student's t with 31 degrees of freedom.
const MAX_ERRORS: f64 = 4.0;

/// E s_z = coth βh − 1/(βh) (Langevin), and E sᵢ·sᵢ₊₁ = coth βJ − 1/(βJ) (Fisher, *Am. J. Phys.*
/// 32, 1964).
#[test]
#[ignore = "long: run by the gate"]
fn the_equilibrium_is_that_of_the_temperature() {
    for (n, beta) in [0.5, 2.0, 6.0].into_iter().enumerate() {
        let key = StreamKey { experiment: n as u64, ..KEY };
        let (spins, bonds) = (in_a_field(beta, 1.0), chain(beta, 1.0));
        let sexp_li = SexpLi::at_run_time(&spins).unwrap();
        for (what, (mean, se)) in [
            ("a field", average(&spins, &sexp_li, (tau(beta), STEPS), key, &mean_z)),
            ("a chain", average(&bonds, &sexp_li, (tau(beta), STEPS), key, &mean_bond)),
        ] {
            let error = (mean - langevin(beta)).abs();
            let weak = WEAK_ERROR * 2.0 * ALPHA / beta * tau(beta);
            assert!(error < MAX_ERRORS * se + weak, "{what} at {beta}: {error} of {mean} ± {se}");
            assert!(se < 0.005, "{what} at {beta}: {se}");
        }
    }
}

/// Euler's method without the correction: the Itô equation with the fields of the Stratonovich one.
struct Ito;

impl Explicit for Ito {
    const ID: &'static str = "ito";
    fn advance<H: Increment>(&self, h: H, y: H::Vector) -> H::Vector {
        y + h.field(y)
    }
}

#[test]
fn wrong_noise_is_not_at_the_temperature() {
    let beta = 2.0;
    // σ² = 2α/(β(1 + α²)), which belongs to damped noise.
    let misplaced = (1.0 / (1.0 + ALPHA * ALPHA)).sqrt();
    for (lattice, observable) in [
        (in_a_field(beta, misplaced), &mean_z as &dyn Fn(&LargePath<'_>) -> f64),
        (chain(beta, misplaced), &mean_bond),
    ] {
        let sexp_li = SexpLi::at_run_time(&lattice).unwrap();
        let (mean, se) = average(&lattice, &sexp_li, (tau(beta), STEPS), KEY, observable);
        assert!((mean - langevin(beta)).abs() > 2.0 * MAX_ERRORS * se, "{mean} ± {se}");
    }
    // Lengths grow, as E|s|² = exp(2σ²t).
    let lattice = in_a_field(beta, 1.0);
    let problem = problem(lattice.clone(), 0.0, 1.0);
    let mut path = LargePath::new(&problem, &Ito, 100, truncation(), KEY, 0).unwrap();
    path.advance(100).unwrap();
    assert!(length_defect(&path, &problem, 1.0) > 0.1);
}

#[test]
fn one_path_has_the_common_noise_of_the_path_with_its_number() {
    let couplings =
        Couplings { exchange: 0.7, anisotropy: 0.2, noise: 0.5, ..Couplings::default() };
    let shape = Shape::periodic(&[6, 5]).unwrap();
    let on_paths = SpinLattice::on_paths(shape.clone(), couplings).unwrap();
    let sexp_li = SexpLi::at_run_time(&on_paths).unwrap();
    let many = problem(on_paths, 0.1, 1.0);
    let simulation = Simulation::new(Setup::at_run_time(&many, &sexp_li).unwrap(), truncation());
    let table = simulation.paths(50, KEY, 33..34).unwrap();
    let single = problem(SpinLattice::one_path(shape, couplings).unwrap(), 0.1, 1.0);
    let mut path = LargePath::new(&single, &sexp_li, 50, truncation(), KEY, 33).unwrap();
    path.advance(50).unwrap();
    for component in 0..90 {
        let column = table[0].column(&format!("y{}", component + 1)).unwrap();
        assert_eq!(path.component(component), column[50], "component {component}");
    }
}

#[test]
fn local_noise_depends_on_neither_threads_nor_pieces_of_time() {
    // One slab, and with one thread four, of which the first and the last are neighbours.
    for shape in [Shape::open(&[5000]).unwrap(), Shape::periodic(&[70, 70, 8]).unwrap()] {
        local_noise_is_the_same(shape);
    }
}

fn local_noise_is_the_same(shape: Shape) {
    let couplings = Couplings { exchange: 0.7, noise: 0.5, local: true, ..Couplings::default() };
    let lattice = SpinLattice::one_path(shape, couplings).unwrap();
    let sexp_li = SexpLi::at_run_time(&lattice).unwrap();
    let problem = problem(lattice, 0.1, 1.0);
    let run = |threads, pieces: u64, path| {
        on_threads(threads, || {
            let path = LargePath::new(&problem, &sexp_li, 30, truncation(), KEY, path);
            let mut path = path.unwrap();
            (0..pieces).for_each(|_| path.advance(30 / pieces).unwrap());
            path.state().to_vec()
        })
    };
    let expected = run(1, 1, 0);
    assert!(run(2, 1, 0) == expected && run(3, 5, 0) == expected);
    assert!(run(1, 1, 1) != expected);
}

/// A midpoint step moves a free spin by σ|ΔW| at most. Without bounds it moves one in eleven beyond
/// σ√3 times the bound: none of 400 with a probability of 1e-16.
#[test]
fn local_noise_is_within_its_bounds() {
    let couplings = Couplings { noise: 0.5, local: true, ..Couplings::default() };
    let lattice = SpinLattice::one_path(Shape::open(&[400]).unwrap(), couplings).unwrap();
    let problem = problem(lattice, 0.0, 0.5);
    let farthest = |truncation| {
        let mut path = LargePath::new(&problem, &Sexp, 1, truncation, KEY, 0).unwrap();
        path.advance(1).unwrap();
        let moved = |n: usize| path.component(n) - problem.y0()[n];
        let of_spin = |n: usize| (0..3).map(|c| moved(3 * n + c).powi(2)).sum::<f64>().sqrt();
        (0..400).map(of_spin).fold(0.0, f64::max)
    };
    // The bound √(2τ|ln τ|), on each of three noises.
    let most = 0.5 * (3.0 * 2f64.ln()).sqrt();
    assert!(farthest(Truncation::new(1).unwrap()) < most * (1.0 + 1e-9));
    assert!(farthest(Truncation::none()) > most);
}

#[test]
fn a_path_goes_on_from_its_file_with_the_same_bits() {
    let folder = tempfile::tempdir().unwrap();
    // Common noise of three rows has a spare normal after an odd number of steps.
    for local in [false, true] {
        let couplings = Couplings { exchange: 0.7, noise: 0.5, local, ..Couplings::default() };
        let lattice =
            SpinLattice::one_path(Shape::periodic(&[30, 20]).unwrap(), couplings).unwrap();
        let sexp_li = SexpLi::at_run_time(&lattice).unwrap();
        let problem = problem(lattice, 0.1, 1.0);
        let new = || LargePath::new(&problem, &sexp_li, 30, truncation(), KEY, 0).unwrap();
        let mut whole = new();
        whole.advance(30).unwrap();
        let checkpoint = |input: &str| {
            let file = folder.path().join(format!("path-{local}.bin"));
            Checkpoint::new(file, Program { input: input.into(), ..Program::default() })
        };
        let one = checkpoint("one");
        let mut first = new().keeping(&one).unwrap();
        first.advance(13).unwrap();
        first.keep();
        first.advance(4).unwrap();
        let mut second = new().keeping(&one).unwrap();
        assert_eq!(second.steps_done(), 13);
        second.advance(17).unwrap();
        assert_eq!(second.state(), whole.state());
        // That of another path is refused.
        assert!(new().keeping(&checkpoint("another")).is_err());
    }
}

#[test]
fn wrong_paths_are_refused() {
    let couplings = Couplings { exchange: 1.0, noise: 0.5, ..Couplings::default() };
    let shape = Shape::periodic(&[5]).unwrap();
    let one = problem(SpinLattice::one_path(shape.clone(), couplings).unwrap(), 0.0, 1.0);
    let many = problem(SpinLattice::on_paths(shape, couplings).unwrap(), 0.0, 1.0);
    let new = |problem, scheme, steps| {
        LargePath::new(problem, scheme, steps, truncation(), KEY, 0).map(|_| ()).unwrap_err()
    };
    let many_paths = new(&many, &Heun, 10);
    assert!(many_paths.to_string().contains("hold 32 paths"), "{many_paths}");
    assert_eq!(new(&one, &Heun, 0), LadderError::Steps { steps: 0, multiple_of: 1 });
    // The truncation needs τ < 1.
    assert!(matches!(new(&one, &Heun, 1), LadderError::Noise(_)));
    let odd = new(&one, &Split, 10).to_string();
    assert!(odd.contains("periodic with 5 sites"), "{odd}");
    let refused = Setup::at_run_time(&one, &Heun).map(|_| ()).unwrap_err();
    assert!(refused.to_string().contains("hold one path"), "{refused}");
}

/// Chains of 300 and of 10⁵ components run on the threads that there are, with iteration too, where
/// a step hardly contracts and where it does not.
#[test]
fn long_chains_need_no_large_stack() {
    let couplings = Couplings { exchange: 1.0, noise: 0.2, local: true, ..Couplings::default() };
    let shape = Shape::open(&[100]).unwrap();
    let many = problem(SpinLattice::on_paths(shape.clone(), couplings).unwrap(), 0.1, 4.0);
    let one = problem(SpinLattice::one_path(shape, couplings).unwrap(), 0.1, 4.0);
    let sexp_li = SexpLi::at_run_time(many.system()).unwrap();
    for (scheme, steps) in [(&sexp_li as &dyn Scheme, 8), (&Heun, 64), (&Sexp, 64), (&Sexp, 6)] {
        let setup = Setup::at_run_time(&many, scheme).unwrap();
        let paths = Simulation::new(setup, truncation()).paths(steps, KEY, 0..2).unwrap();
        assert!(paths.iter().all(|path| path.halted.is_none()), "{}", scheme.about().id);
        let mut path = LargePath::new(&one, scheme, steps, truncation(), KEY, 0).unwrap();
        path.advance(steps).unwrap();
    }
    let shape = Shape::open(&[33_334]).unwrap();
    let large = problem(SpinLattice::one_path(shape, couplings).unwrap(), 0.1, 1.0);
    for (scheme, steps) in [(&sexp_li as &dyn Scheme, 8), (&Heun, 8), (&Split, 8), (&Sexp, 8)] {
        let mut path = LargePath::new(&large, scheme, steps, truncation(), KEY, 0).unwrap();
        path.advance(2).unwrap();
    }
}
