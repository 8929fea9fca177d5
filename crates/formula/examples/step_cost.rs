//! What a step costs on formulas, on two compiled formulas and on tuned systems, side by side.
//!
//! `cargo run --release -p casimir-formula --features measuring --example step_cost [LEVEL]` prints
//! ns per step of one path without drawing noise, the least of many runs, and multiples: a formula
//! over two compiled formulas, and over the tuned kernel.

mod paper;

use std::time::Instant;

use formula::{Definition, FormulaSystem};
use noise::{StepNoise, StreamKey, WienerRows};
use nonlin::BlockStatus;
use real::{Block, Real, Simd, limit_to};
use schemes::{Scheme, Sexp, SexpLi, Step, run_time};
use systems::{
    Constant, LotkaVolterra, MaxwellBloch, Pendulum, Poisson3, PoissonSystem, RigidBody,
};

/// A system of which only the two formulas are known.
struct TwoFormulas<S>(S);

impl<S: PoissonSystem<D, M>, const D: usize, const M: usize> PoissonSystem<D, M>
    for TwoFormulas<S>
{
    fn name(&self) -> &'static str {
        self.0.name()
    }
    #[inline(always)]
    fn structure<R: Real>(&self, y: [R; D], v: [R; D]) -> [R; D] {
        self.0.structure(y, v)
    }
    #[inline(always)]
    fn energy<R: Real>(&self, y: [R; D], dt: f64, dw: [f64; M]) -> R {
        self.0.energy(y, dt, dw)
    }
}

const TAU: f64 = 1.0 / 256.0;
const RUNS: usize = 30;
const STEPS: usize = 2000;

/// ns per step and path, the least of some runs of `step` from the state that `start` sets.
fn least<T>(mut start: impl FnMut() -> T, mut step: impl FnMut(&mut T)) -> f64 {
    let mut least = f64::INFINITY;
    for _ in 0..RUNS {
        let mut state = start();
        let begin = Instant::now();
        for _ in 0..STEPS {
            step(&mut state);
        }
        least = least.min(begin.elapsed().as_nanos() as f64 / (32 * STEPS) as f64);
    }
    least
}

fn noise(noises: usize) -> StepNoise {
    let mut noise = StepNoise::zero(noises);
    let mut wiener = WienerRows::new(StreamKey { seed: 1, experiment: 1 }, 0);
    wiener.increments(TAU.sqrt(), &mut noise.increments);
    noise
}

fn compiled<S: PoissonSystem<D, M>, const D: usize, const M: usize>(
    scheme: &dyn Scheme<S, D, M>,
    system: &S,
    y0: [f64; D],
) -> f64 {
    let step = step();
    let (noise, mut status) = (noise(M), BlockStatus::explicit());
    let noise = (&noise).into();
    least(|| Block::splat(y0), |y| scheme.step_block(system, &step, &noise, y, &mut status))
}

fn step() -> Step {
    let step = Constant::new(0.0).map(|damping| Step::new(&damping, 0, TAU));
    step.unwrap().unwrap()
}

fn at_run_time<const M: usize>(
    scheme: &dyn run_time::Scheme,
    system: &FormulaSystem,
    y0: &[f64],
) -> f64 {
    let step = step();
    let (noise, mut status) = (noise(M), BlockStatus::explicit());
    let mut paths = scheme.stepper(system).unwrap();
    let start = real::Rows::splat(y0);
    // The state is set before each run, and carried by the stepper.
    let mut least = f64::INFINITY;
    for _ in 0..RUNS {
        paths.state_mut().copy_from_slice(&start);
        let begin = Instant::now();
        for _ in 0..STEPS {
            paths.step(&step, &noise, &mut status);
        }
        least = least.min(begin.elapsed().as_nanos() as f64 / (32 * STEPS) as f64);
    }
    least
}

fn compare<S: PoissonSystem<D, M> + Clone, const D: usize, const M: usize>(
    system: &S,
    definition: &Definition,
    y0: [f64; D],
) {
    let two = TwoFormulas(system.clone());
    let formulas = FormulaSystem::new(definition, &y0).unwrap();
    let row = |scheme: &str, tuned: f64, two: f64, formula: f64| {
        println!(
            "{:>15} {scheme:>8} {tuned:8.2} {two:8.2} {formula:8.2}   {:5.2} {:5.2}",
            system.name(),
            formula / two,
            formula / tuned
        );
    };
    let sexp = at_run_time::<M>(&Sexp, &formulas, &y0);
    row("sexp", compiled(&Sexp, system, y0), compiled(&Sexp, &two, y0), sexp);
    if let (Ok(tuned), Ok(at_run_time_scheme)) =
        (SexpLi::new(system, y0), SexpLi::at_run_time(&formulas))
    {
        let of_two = SexpLi::new(&two, y0).map(|scheme| compiled(&scheme, &two, y0));
        let formula = at_run_time::<M>(&at_run_time_scheme, &formulas, &y0);
        row("sexp-li", compiled(&tuned, system, y0), of_two.unwrap_or(f64::NAN), formula);
    }
}

fn main() {
    match std::env::args().nth(1).as_deref() {
        Some("baseline") => limit_to(Simd::Baseline),
        Some("avx2") => limit_to(Simd::Avx2),
        _ => {}
    }
    println!("{}: ns per step of one path", Simd::current().name());
    println!("{:>15} {:>8} {:>8} {:>8} {:>8}   multiples", "", "", "tuned", "two", "formula");
    compare(&Pendulum::new(1.0).unwrap(), &paper::pendulum(1.0), [0.2, 1.0]);
    let (inertia, noise) = ([2.0, 1.0, 2.0 / 3.0], [1.0, 2.0, 3.0]);
    let body = RigidBody::three_noises(inertia, noise).unwrap();
    compare(&body, &paper::rigid_body(inertia, noise), [0.45, 0.0, 0.89]);
    let populations = LotkaVolterra::<2, 2>::new(1.0).unwrap();
    compare(&populations, &paper::lotka_volterra(1.0), [0.2, 0.4, 0.6]);
    compare(&MaxwellBloch, &paper::maxwell_bloch(), [1.0, 2.0, 3.0]);
    compare(&Poisson3::new(1.0).unwrap(), &paper::poisson3(1.0), [1.0, 2.0, 3.0]);
}
