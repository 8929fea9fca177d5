//! What schemes keep: spectra to round-off, whatever the noise and the threads.

use std::sync::Arc;

use matrix::{
    MatrixSystem, Quantum, Scheme, Sphere, SpinCouplings, Stirring, SuSpins, c64, inner, traces,
};
use mc::Setup;
use noise::StepNoise;
use nonlin::BlockStatus;
use real::{Row, WIDTH};
use schemes::{About, EulerMaruyama, Heun, Method, Step, Stepper};
use systems::{lattice::Shape, run_time};

use crate::{after, generic, matrix, numbers, problem, setup};

/// Largest change of tr Wᵏ for k from 2 to `most`, relative to tr Wᵏ, of odd k to the geometric mean
/// of those beside, so that cancellations do not count.
fn change(before: &[c64], after: &[c64], n: usize, most: usize) -> f64 {
    let [a, b] = [before, after].map(|w| traces(n, w, most + 1));
    let size = |k: usize| if k.is_multiple_of(2) { a[k - 1] } else { (a[k - 2] * a[k]).sqrt() };
    (2..=most).map(|k| (a[k - 1] - b[k - 1]).abs() / size(k)).fold(0.0, f64::max)
}

fn unit(mut w: Vec<c64>) -> Vec<c64> {
    let norm = inner(&w, &w).sqrt();
    w.iter_mut().for_each(|w| *w /= norm);
    w
}

/// A fluid with noise of degrees 1 and 2, a vorticity of norm one, and a step at which τ‖V‖ is of
/// size one.
fn fluid(n: usize) -> (Arc<Sphere>, Vec<c64>, f64) {
    let scale = matrix::bracket_scale(n);
    let noise = [1, 2].into_iter().flat_map(|l| Stirring::isotropic(l, 0.5 / scale));
    (Arc::new(Sphere::new(n, 0.0, 10.0 / scale, noise).unwrap()), unit(generic(n, 7)), 0.1)
}

/// (H(W + U) − H(W − U))/2 is ⟨∇H₀(W), U⟩ to round-off for energies of degree two at most.
#[track_caller]
fn has_gradient(system: &dyn MatrixSystem) {
    let (n, sites) = (system.size(), system.sites());
    let generic = |seed: u64| -> Vec<c64> {
        (0..sites).flat_map(|site| generic(n, seed + 100 * site as u64)).collect()
    };
    let (w, u) = (generic(1), generic(50));
    let moved = |by: f64| w.iter().zip(&u).map(|(w, u)| *w + *u * by).collect::<Vec<_>>();
    let [above, below] = [1.0, -1.0].map(|by| system.energy(&moved(by)));
    let mut v = vec![c64::default(); w.len()];
    system.generator(&w, 1.0, &vec![0.0; system.noises()], &mut v);
    let (slope, size) = (inner(&v, &u), inner(&v, &v).sqrt() * inner(&u, &u).sqrt());
    assert!((0.5 * (above - below) - slope).abs() < 1e-13 * (size + above.abs()), "{slope}");
    assert!(slope.abs() > 1e-3 * size);
}

/// A constant Hamiltonian of two levels turns ρ₁₂ by τ times their distance, to (τ/2)⁷/100800 of
/// each, and Cayley's map to a twelfth of (τ/2)³.
#[test]
fn a_step_is_an_exponential() {
    let real = |x: f64| c64::new(x, 0.0);
    let energies = vec![real(0.5), real(0.0), real(0.0), real(-0.5)];
    // A noise turns it by its increment.
    let noisy = Quantum::new(2, vec![real(0.0); 4], vec![energies.clone()]).unwrap();
    let noisy = Arc::new(noisy);
    let moved = problem(&noisy, &[real(0.5); 4], 0.0, 1.0);
    let turned = matrix(2, &after(&setup(&moved, &noisy, Scheme::Explicit), 1, 1.0, 1), 0)[2];
    let dw = numbers(0) * 3f64.sqrt();
    assert!(dw.abs() > 0.1 && (turned.im.atan2(turned.re) + dw).abs() < 1e-4, "{dw} {turned}");
    // The first entry of D is zero: rows must be exchanged.
    let mut across = vec![real(0.0); 9];
    let entries = [(1, 10f64.sqrt()), (3, 10f64.sqrt()), (5, 1.0), (7, 1.0)];
    entries.into_iter().for_each(|(at, v)| across[at] = real(v));
    let across = Arc::new(Quantum::new(3, across, vec![]).unwrap());
    let w = generic(3, 40);
    let turned = problem(&across, &w, 0.0, 1.0);
    let turned = matrix(3, &after(&setup(&turned, &across, Scheme::Explicit), 1, 1.0, 1), 0);
    assert!(change(&w, &turned, 3, 3) < 1e-13);
    let system = Arc::new(Quantum::new(2, energies, vec![]).unwrap());
    let still = problem(&system, &[real(0.5); 4], 0.0, 1.0);
    let half = 0.5f64;
    for (scheme, known) in [
        (Scheme::Explicit, 2.0 * half.powi(7) / 100_800.0),
        (Scheme::Midpoint, 2.0 * half.powi(3) / 12.0),
    ] {
        let found = matrix(2, &after(&setup(&still, &system, scheme), 1, 1.0, 1), 0)[2];
        let off = (found.im.atan2(found.re) + 1.0).abs();
        assert!((off - known).abs() < 0.1 * known, "{scheme:?} {off} {known}");
    }
}

#[test]
fn generators_are_gradients_of_energies() {
    has_gradient(&Sphere::new(6, 0.7, 1.3, Stirring::isotropic(2, 0.5)).unwrap());
    let couplings = SpinCouplings {
        exchange: 0.8,
        quadratic: 0.5,
        quartic: -0.2,
        field: [0.3, -0.4, 0.7],
        bath: None,
    };
    has_gradient(&SuSpins::new(4, Shape::periodic(&[3, 2]).unwrap(), couplings).unwrap());
    has_gradient(&Quantum::new(3, generic(3, 5), vec![generic(3, 9)]).unwrap());
}

#[test]
fn spectra_are_kept_at_any_step_and_damped_exactly() {
    for (n, steps) in [(5, 1000), (16, 300), (40, 20), (70, 3)] {
        let (system, w, tau) = fluid(n);
        for scheme in [Scheme::Explicit, Scheme::Midpoint] {
            let still = problem(&system, &w, 0.0, 1.0);
            let end = matrix(n, &after(&setup(&still, &system, scheme), steps, tau, 1), 0);
            // Some rounding errors in a step, of kε for tr Wᵏ, as a random walk.
            let bound = 8.0 * 4.0 * f64::EPSILON * (steps as f64).sqrt();
            assert!(change(&w, &end, n, 8) < bound, "{n} {scheme:?}: {:e}", change(&w, &end, n, 8));
            let (rate, few) = (0.3, steps.min(20));
            let damped = problem(&system, &w, rate, 1.0);
            let mut end = matrix(n, &after(&setup(&damped, &system, scheme), few, tau, 1), 0);
            end.iter_mut().for_each(|w| *w *= (rate * few as f64 * tau).exp());
            assert!(change(&w, &end, n, 8) < 1e-13);
        }
    }
}

/// Many steps at three sizes. By hand, 100 000 at 64 and 128 stay below 10⁻¹², too.
#[test]
#[ignore = "minutes"]
fn spectra_are_kept_over_many_steps() {
    for (n, steps) in [(16, 100_000), (64, 5000), (128, 300)] {
        let (system, w, tau) = fluid(n);
        let still = problem(&system, &w, 0.0, 1.0);
        let end = matrix(n, &after(&setup(&still, &system, Scheme::Explicit), steps, tau, 1), 0);
        println!("{n}: {:e}", change(&w, &end, n, 8));
        assert!(change(&w, &end, n, 8) < 1e-12, "{n}");
    }
}

/// A scheme for any system, then the norm of before.
struct Rescaled<'a>(Arc<dyn Method + 'a>);

impl Method for Rescaled<'_> {
    fn about(&self) -> About {
        self.0.about()
    }
    fn start(&self, y: &[Row]) -> Box<dyn Stepper + '_> {
        Box::new(RescaledPaths(self.0.start(y)))
    }
}

struct RescaledPaths<'a>(Box<dyn Stepper + 'a>);

impl Stepper for RescaledPaths<'_> {
    fn state(&self) -> &[Row] {
        self.0.state()
    }
    fn state_mut(&mut self) -> &mut [Row] {
        self.0.state_mut()
    }
    fn step(&mut self, step: &Step, noise: &StepNoise, status: &mut BlockStatus) {
        let norms = |y: &[Row]| -> Row {
            std::array::from_fn(|p| y.iter().map(|y| y[p] * y[p]).sum::<f64>().sqrt())
        };
        let before = norms(self.state());
        self.0.step(step, noise, status);
        let now = norms(self.state());
        for row in self.state_mut() {
            (0..WIDTH).for_each(|p| row[p] *= before[p] / now[p]);
        }
    }
}

#[test]
fn other_schemes_lose_what_is_kept() {
    let (system, w, tau) = fluid(5);
    let still: run_time::Problem = problem(&system, &w, 0.0, 1.0);
    let end = |setup: &Setup<'_>| matrix(5, &after(setup, 100, tau / 10.0, 1), 0);
    let em = Setup::at_run_time(&still, &EulerMaruyama).unwrap();
    assert!(change(&w, &end(&em), 5, 2) > 1e-3);
    let heun = Setup::at_run_time(&still, &Heun).unwrap();
    assert!(change(&w, &end(&heun), 5, 2) > 1e-6);
    let rescaled = Setup { scheme: Arc::new(Rescaled(heun.scheme)), ..em };
    let end = end(&rescaled);
    assert!(change(&w, &end, 5, 2) < 1e-13 && change(&w, &end, 5, 3) > 1e-6);
}

/// Threads share the paths of matrices of some size, and the columns of large ones; paths that do
/// not go on change nothing.
#[test]
fn bits_are_the_same_for_any_number_of_threads() {
    for (n, steps, live) in [(33, 4, WIDTH), (150, 1, 2)] {
        let (system, w, tau) = fluid(n);
        let problem = problem(&system, &w, 0.1, 1.0);
        let setup = setup(&problem, &system, Scheme::Explicit);
        let run = |threads: usize, live: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| after(&setup, steps, tau, live))
        };
        let one = run(1, live);
        assert!(one == run(2, live) && one == run(3, live));
        let first = run(2, 1);
        assert!(one.iter().zip(first).all(|(all, one)| all[0].to_bits() == one[0].to_bits()));
    }
}

/// The mean of ρ after one step of all noises of three points, with the moments of normals up to the
/// fifth, obeys Lindblad's equation up to τ².
#[test]
fn means_of_steps_are_those_of_lindblad() {
    let n = 3;
    let (hamiltonian, noise) = (generic(n, 100), generic(n, 200));
    let system = Arc::new(Quantum::new(n, hamiltonian.clone(), vec![noise.clone()]).unwrap());
    let w = unit(generic(n, 300));
    let still = problem(&system, &w, 0.0, 1.0);
    let times = |a: &[c64], b: &[c64]| -> Vec<c64> {
        let entry = |at: usize| (0..n).map(|l| a[l * n + at % n] * b[at / n * n + l]).sum();
        (0..n * n).map(entry).collect()
    };
    let commutator = |a: &[c64], b: &[c64]| -> Vec<c64> {
        times(a, b).iter().zip(times(b, a)).map(|(x, y)| x - y).collect()
    };
    let lindblad = |w: &[c64]| -> Vec<c64> {
        let (turn, mix) = (commutator(&hamiltonian, w), commutator(&noise, &commutator(&noise, w)));
        turn.iter().zip(mix).map(|(a, b)| c64::new(0.0, -1.0) * a - b * 0.5).collect()
    };
    for scheme in [Scheme::Explicit, Scheme::Midpoint] {
        let setup = setup(&still, &system, scheme);
        let error = |tau: f64| {
            let mut paths = setup.scheme.start(&setup.start());
            let (mut noise, mut status) = (StepNoise::zero(1), BlockStatus::explicit());
            noise.increments[0][1] = (3.0 * tau).sqrt();
            noise.increments[0][2] = -(3.0 * tau).sqrt();
            let step = Step::new(still.damping(), 0, tau).unwrap();
            paths.step(&step, &noise, &mut status);
            let [a, b, c] = [0, 1, 2].map(|p| matrix(n, paths.state(), p));
            // The exponential by its series.
            let (mut exact, mut term) = (w.clone(), w.clone());
            for k in 1..30 {
                term = lindblad(&term).iter().map(|x| x * (tau / f64::from(k))).collect();
                exact.iter_mut().zip(&term).for_each(|(sum, term)| *sum += term);
            }
            let mean = |at: usize| a[at] * (2.0 / 3.0) + (b[at] + c[at]) * (1.0 / 6.0);
            (0..n * n).map(|at| (mean(at) - exact[at]).norm_sqr()).sum::<f64>().sqrt()
        };
        let errors = [error(0.02), error(0.01)];
        assert!((3.3..5.0).contains(&(errors[0] / errors[1])), "{scheme:?} {errors:?}");
    }
}
