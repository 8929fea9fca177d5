//! What a step costs on tuned systems, on two compiled formulas and on texts, side by side.
//!
//! `cargo run --release -p casimir-formula --features measuring --example step_cost [LEVEL]` prints
//! ns per step of one path without drawing noise, the least of many runs that take turns: of the
//! tuned kernel, of a system of which only B(y)v and h are compiled, and of a text. A dash stands
//! where there is no such kernel or scheme.

mod own;
mod paper;

use std::time::Instant;

use formula::{Definition, FormulaSystem};
use kernels::Tuned;
use noise::{StepNoise, StreamKey, WienerRows};
use nonlin::BlockStatus;
use real::{Block, Real, Row, Rows, Simd, limit_to};
use schemes::{BuiltIn, Heun, Scheme, Sexp, SexpLi, Step};
use systems::{
    Constant, LotkaVolterra, MaxwellBloch, Pendulum, Poisson3, PoissonSystem, RigidBody,
};

use own::{
    Chain, HeavyTop, Particle, Species, Star, TwoSpins, Well, chain, heavy_top, particle, species,
    star, two_spins, well,
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
const SCHEMES: [BuiltIn; 5] =
    [BuiltIn::Sexp, BuiltIn::SexpLi, BuiltIn::Split, BuiltIn::Nv, BuiltIn::Heun];

/// Steps of 32 paths from the start, so many.
type Run<'a> = Box<dyn FnMut(usize) + 'a>;

/// Friction on the momentum of the double well: the component, and its factor over half a step.
type Friction = Option<(usize, f64)>;

/// Noise there and back in turn.
fn noise(noises: usize) -> [StepNoise; 2] {
    let [mut there, mut back] = [(); 2].map(|()| StepNoise::zero(noises));
    let mut wiener = WienerRows::new(StreamKey { seed: 1, experiment: 1 }, 0);
    wiener.increments(TAU.sqrt(), &mut there.increments);
    let all = back.increments.iter_mut().flatten().zip(there.increments.iter().flatten());
    all.for_each(|(back, dw)| *back = -dw);
    [there, back]
}

fn step(n: usize) -> Step {
    let step = Constant::new(0.0).map(|damping| Step::new(&damping, n as u64 % 2, TAU));
    step.unwrap().unwrap()
}

fn slow(friction: Friction, state: &mut [Row]) {
    if let Some((k, factor)) = friction {
        state[k].iter_mut().for_each(|p| *p *= factor);
    }
}

fn compiled<'a, S: PoissonSystem<D, M>, const D: usize, const M: usize>(
    scheme: Box<dyn Scheme<S, D, M>>,
    system: &'a S,
    y0: [f64; D],
    friction: Friction,
) -> Run<'a> {
    let (steps, noise, mut status) = ([0, 1].map(step), noise(M), BlockStatus::explicit());
    Box::new(move |number| {
        let mut y = Block::splat(y0);
        for n in 0..number {
            slow(friction, &mut y.0);
            let noise = (&noise[n % 2]).into();
            scheme.step_block(system, &steps[n % 2], &noise, &mut y, &mut status);
            slow(friction, &mut y.0);
        }
        assert!(status.failed.is_empty());
    })
}

fn on_text<'a>(
    scheme: &'a dyn schemes::run_time::Scheme,
    system: &'a FormulaSystem,
    y0: &[f64],
    friction: Friction,
) -> Option<Run<'a>> {
    let noises = systems::run_time::System::description(system).noises;
    let (steps, noise, mut status) = ([0, 1].map(step), noise(noises), BlockStatus::explicit());
    let (mut paths, start) = (scheme.stepper(system).ok()?, Rows::splat(y0));
    Some(Box::new(move |number| {
        paths.state_mut().copy_from_slice(&start);
        for n in 0..number {
            slow(friction, paths.state_mut());
            paths.step(&steps[n % 2], &noise[n % 2], &mut status);
            slow(friction, paths.state_mut());
        }
        assert!(status.failed.is_empty());
    }))
}

/// The schemes that a system of two formulas has.
fn of_two<S: PoissonSystem<D, M>, const D: usize, const M: usize>(
    kind: BuiltIn,
    system: &S,
    y0: [f64; D],
) -> Option<Box<dyn Scheme<S, D, M>>> {
    Some(match kind {
        BuiltIn::Sexp => Box::new(Sexp),
        BuiltIn::SexpLi => Box::new(SexpLi::new(system, y0).ok()?),
        BuiltIn::Heun => Box::new(Heun),
        _ => return None,
    })
}

/// A line of the table: for each scheme the tuned kernel, the two formulas and the text.
fn line<S: PoissonSystem<D, M> + Clone, const D: usize, const M: usize>(
    name: &str,
    (system, definition, y0): (&S, &Definition, [f64; D]),
    friction: Friction,
    tuned: impl Fn(BuiltIn) -> Option<Box<dyn Scheme<S, D, M>>>,
) {
    let (two, text) = (TwoFormulas(system.clone()), FormulaSystem::new(definition, &y0).unwrap());
    print!("| {name} |");
    for kind in SCHEMES {
        let at_run_time = kind.at_run_time(&text).ok();
        let mut runs: [Option<Run<'_>>; 3] = [
            tuned(kind).map(|scheme| compiled(scheme, system, y0, friction)),
            of_two(kind, &two, y0).map(|scheme| compiled(scheme, &two, y0, friction)),
            at_run_time.as_ref().and_then(|scheme| on_text(&**scheme, &text, &y0, friction)),
        ];
        let mut least = [f64::INFINITY; 3];
        for _ in 0..RUNS {
            for (run, least) in runs.iter_mut().zip(&mut least) {
                let Some(run) = run else { continue };
                let begin = Instant::now();
                run(STEPS);
                *least = least.min(begin.elapsed().as_nanos() as f64 / (32 * STEPS) as f64);
            }
        }
        let words =
            least.map(|ns| if ns < f64::INFINITY { format!("{ns:.1}") } else { "–".into() });
        print!(" {} |", words.join(" / "));
    }
    println!();
}

fn own<S: PoissonSystem<D, M> + Clone, const D: usize, const M: usize>(
    name: &str,
    of: (&S, &Definition, [f64; D]),
    friction: Friction,
) {
    line(name, of, friction, |_| None);
}

fn project<S: Tuned<D, M> + Clone, const D: usize, const M: usize>(
    name: &str,
    of: (&S, &Definition, [f64; D]),
) {
    line(name, of, None, |kind| S::scheme(kind, of.0, of.2).ok());
}

fn main() {
    match std::env::args().nth(1).as_deref() {
        Some("baseline") => limit_to(Simd::Baseline),
        Some("avx2") => limit_to(Simd::Avx2),
        _ => {}
    }
    println!("{}: ns per step of one path, tuned / two formulas / text", Simd::current().name());
    println!("| system | {} |", SCHEMES.map(|kind| format!("`{}`", kind.id())).join(" | "));
    println!("|---|{}", "---|".repeat(SCHEMES.len()));
    let (inertia, noise) = ([2.0, 1.0, 2.0 / 3.0], [1.0, 2.0, 3.0]);
    project("pendulum", (&Pendulum::new(1.0).unwrap(), &paper::pendulum(1.0), [0.2, 1.0]));
    let body = RigidBody::three_noises(inertia, noise).unwrap();
    let text = paper::rigid_body(inertia, noise);
    project("rigid body, three noises", (&body, &text, [0.45, 0.0, 0.89]));
    project("Maxwell–Bloch", (&MaxwellBloch, &paper::maxwell_bloch(), [1.0, 2.0, 3.0]));
    let poisson3 = Poisson3::new(1.0).unwrap();
    project("Poisson system in 3D", (&poisson3, &paper::poisson3(1.0), [1.0, 2.0, 3.0]));
    let populations = LotkaVolterra::<2, 2>::new(1.0).unwrap();
    project("Lotka–Volterra (2, 2)", (&populations, &paper::lotka_volterra(1.0), [0.2, 0.4, 0.6]));
    own("three species", (&Species, &species(), [0.7, 0.8, 0.9]), None);
    own("double well, friction", (&Well, &well(), [-1.0, 0.0]), Some((1, (-0.25 * TAU).exp())));
    own("Hénon–Heiles", (&Star, &star(), [0.0, 0.1, 0.35, 0.1]), None);
    own("charged particle", (&Particle, &particle(), [1.0, 0.0, 0.0, 0.5]), None);
    own("two spins", (&TwoSpins, &two_spins(), [0.6, 0.0, 0.8, 0.0, 1.0, 0.0]), None);
    own("heavy top", (&HeavyTop, &heavy_top(), [0.2, 0.1, 1.0, 0.1, 0.2, 0.9]), None);
    own("Toda chain of three", (&Chain, &chain(), [0.8, 0.6, 0.5, 0.6, 0.0, -0.3]), None);
}
