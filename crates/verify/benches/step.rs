//! What one step of one path costs, noise included, Lévy areas where the scheme reads them.
//!
//! Measured, each time 256 steps of τ = 2⁻⁸ from the paper's initial value, with increments drawn
//! and truncated:
//!
//! - `rigid body`: every scheme on the rigid body with three noises; `sexp-levy` draws its areas at
//!   its own step, with an error of τ^{3/2} as strong order one asks;
//! - `sexp`: the conformal scheme on the five systems;
//! - `own system`: the rigid body with three noises as somebody else might write it.
//!
//! `block` advances 32 paths at once, `path` one.
//!
//! An element is one path and step, so criterion's `Melem/s` are millions of path-steps a second:
//! **ns per path-step = 1000 / (Melem/s)**. The rate of `block` over the rate of `path` says what
//! vectorisation brings. It guards the path loop: a ratio near one means that something in it is no
//! longer inlined or vectorised.

mod own;

use std::hint::black_box;
use std::time::Duration;

use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, Criterion, Throughput, criterion_group, criterion_main};
use noise::{
    AreaPath, AreaSampler, Noise, StepNoise, StreamKey, Truncation, WienerPath, WienerRows, clip,
    strong_order_one_error,
};
use nonlin::{BlockStatus, Method, Solver};
use real::{Block, WIDTH};
use schemes::{EulerMaruyama, Heun, Midpoint, Scheme, Sexp, SexpLevy, Step, WithSolver};
use systems::{
    Constant, Cosine, Damping, Linear, LotkaVolterra, MaxwellBloch, Pendulum, Poisson3,
    PoissonSystem, RigidBody, Sine,
};

const STEPS: u64 = 256;
const TAU: f64 = 1.0 / STEPS as f64;
const KEY: StreamKey = StreamKey { seed: 1, experiment: 1 };

/// How many terms of areas strong order one asks for.
fn terms<const M: usize>() -> usize {
    noise::area_terms(strong_order_one_error(TAU), TAU, M).expect("a handful of terms")
}

/// A system with what it takes to run it: damping tabulated for every step, and y₀.
struct Run<S, const D: usize> {
    system: S,
    steps: Vec<Step>,
    bound: f64,
    area_bound: f64,
    y0: [f64; D],
}

impl<S, const D: usize> Run<S, D> {
    fn new(system: S, damping: &dyn Damping, y0: [f64; D]) -> Self {
        Self {
            system,
            steps: (0..STEPS).map(|n| Step::new(damping, n, TAU).expect("0 < τ")).collect(),
            bound: Truncation::new(4)
                .and_then(|truncation| truncation.bound(TAU))
                .expect("0 < τ < 1"),
            area_bound: Truncation::new(4)
                .and_then(|truncation| truncation.area_bound(TAU))
                .expect("0 < τ < 1"),
            y0,
        }
    }

    /// 32 paths from 0 to 1; every call takes the next paths of the stream.
    fn block<const M: usize>(
        &self,
        group: &mut BenchmarkGroup<'_, WallTime>,
        name: &str,
        scheme: &impl Scheme<S, D, M>,
    ) where
        S: PoissonSystem<D, M>,
    {
        group.throughput(Throughput::Elements(WIDTH as u64 * STEPS));
        group.bench_function(name, |bencher| {
            let (mut drawn, mut shown) = (StepNoise::with_areas(M), StepNoise::with_areas(M));
            let mut status = BlockStatus::explicit();
            let mut first_path = 0;
            bencher.iter(|| {
                let mut wiener = WienerRows::new(KEY, first_path);
                let mut sampler = scheme
                    .about()
                    .reads_areas
                    .then(|| AreaSampler::new(KEY, first_path, M, terms::<M>()));
                let mut y = Block::splat(self.y0);
                for step in &self.steps {
                    wiener.increments(TAU.sqrt(), &mut drawn.increments);
                    if let Some(sampler) = &mut sampler {
                        sampler.areas(TAU, &drawn.increments, &mut drawn.areas);
                        clip(&drawn.areas, self.area_bound, &mut shown.areas);
                    }
                    clip(&drawn.increments, self.bound, &mut shown.increments);
                    scheme.step_block(&self.system, step, &(&shown).into(), &mut y, &mut status);
                }
                first_path += WIDTH as u64;
                black_box(y)
            });
        });
    }

    /// `name/block` and `name/path`.
    fn both<const M: usize>(
        &self,
        group: &mut BenchmarkGroup<'_, WallTime>,
        name: &str,
        scheme: &impl Scheme<S, D, M>,
    ) where
        S: PoissonSystem<D, M>,
    {
        self.block(group, &format!("{name}/block"), scheme);
        self.path(group, &format!("{name}/path"), scheme);
    }

    /// One path from 0 to 1.
    fn path<const M: usize>(
        &self,
        group: &mut BenchmarkGroup<'_, WallTime>,
        name: &str,
        scheme: &impl Scheme<S, D, M>,
    ) where
        S: PoissonSystem<D, M>,
    {
        group.throughput(Throughput::Elements(STEPS));
        group.bench_function(name, |bencher| {
            let mut path = 0;
            bencher.iter(|| {
                let mut wiener = WienerPath::<M>::new(KEY, path);
                let mut sampler =
                    scheme.about().reads_areas.then(|| AreaPath::<M>::new(KEY, path, terms::<M>()));
                let mut areas = [[0.0; M]; M];
                let mut y = self.y0;
                for step in &self.steps {
                    let dw = wiener.increments(TAU.sqrt());
                    if let Some(sampler) = &mut sampler {
                        let drawn = sampler.areas(TAU, dw);
                        areas = drawn.map(|row| {
                            row.map(|area| area.clamp(-self.area_bound, self.area_bound))
                        });
                    }
                    let increments = dw.map(|w| w.clamp(-self.bound, self.bound));
                    y = scheme
                        .step(
                            &self.system,
                            step,
                            &Noise { areas, ..Noise::increments(increments) },
                            y,
                        )
                        .z;
                }
                path += 1;
                black_box(y)
            });
        });
    }
}

/// The paper's (cos 1.1, 0, sin 1.1).
fn momentum() -> [f64; 3] {
    [1.1f64.cos(), 0.0, 1.1f64.sin()]
}
const POPULATIONS: [f64; 3] = [0.2, 0.4, 0.6];

fn short<'a>(criterion: &'a mut Criterion, name: &str) -> BenchmarkGroup<'a, WallTime> {
    let mut group = criterion.benchmark_group(name);
    group
        .sample_size(20)
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(1));
    group
}

fn rigid_body(criterion: &mut Criterion) {
    let body = RigidBody::three_noises([2.0, 1.0, 2.0 / 3.0], [1.0, 2.0, 3.0]).expect("positive");
    let damping = Cosine::new(0.5, 2.0).expect("finite");
    let run = Run::new(body, &damping, momentum());
    let sexp = |method| WithSolver { formula: Sexp, solver: Solver::new(method) };
    let mut group = short(criterion, "rigid body");
    run.both(&mut group, "sexp", &sexp(Method::FixedPoint));
    run.both(&mut group, "sexp newton", &sexp(Method::Newton));
    run.both(&mut group, "sexp-levy", &SexpLevy::new(&body, momentum()));
    run.both(&mut group, "midpoint", &Midpoint);
    run.both(&mut group, "heun", &Heun);
    run.both(&mut group, "em", &EulerMaruyama);
    group.finish();
}

fn systems(criterion: &mut Criterion) {
    let mut group = short(criterion, "sexp");
    let sexp = Sexp;
    let constant = Constant::new(2.0).expect("finite");
    let sine = Sine::new(1.0, 1.0).expect("finite");
    let cosine = Cosine::new(0.5, 2.0).expect("finite");
    let linear = Linear::new(1.0).expect("finite");

    let pendulum = Pendulum::new(1.0).expect("finite");
    Run::new(pendulum, &constant, [0.2, 1.0]).both(&mut group, "pendulum", &sexp);
    let body = RigidBody::one_noise([2.0, 1.0, 2.0 / 3.0], 1.0).expect("positive");
    Run::new(body, &cosine, momentum()).both(&mut group, "rigid body, one noise", &sexp);
    let body = RigidBody::three_noises([2.0, 1.0, 2.0 / 3.0], [1.0, 2.0, 3.0]).expect("positive");
    Run::new(body, &cosine, momentum()).both(&mut group, "rigid body, three noises", &sexp);
    let populations = LotkaVolterra::<1, 1>::new(1.0).expect("finite");
    Run::new(populations, &sine, POPULATIONS).both(&mut group, "lotka-volterra 1, 1", &sexp);
    let populations = LotkaVolterra::<2, 2>::new(1.0).expect("finite");
    Run::new(populations, &sine, POPULATIONS).both(&mut group, "lotka-volterra 2, 2", &sexp);
    Run::new(MaxwellBloch, &cosine, [1.0, 2.0, 3.0]).both(&mut group, "maxwell-bloch", &sexp);
    let poisson = Poisson3::new(1.0).expect("finite");
    Run::new(poisson, &linear, [1.0, 2.0, 3.0]).both(&mut group, "poisson3", &sexp);
    group.finish();
}

fn own_system(criterion: &mut Criterion) {
    let mut group = short(criterion, "own system");
    let damping = Cosine::new(0.5, 2.0).expect("finite");
    let sexp = Sexp;
    let tuned = RigidBody::three_noises([2.0, 1.0, 2.0 / 3.0], [1.0, 2.0, 3.0]).expect("positive");
    Run::new(tuned, &damping, momentum()).block(&mut group, "tuned", &sexp);
    Run::new(own::TwentyLines, &damping, momentum()).block(&mut group, "twenty lines", &sexp);
    Run::new(own::TwoFormulas, &damping, momentum()).block(&mut group, "two formulas", &sexp);
    group.finish();
}

criterion_group!(benches, rigid_body, systems, own_system);
criterion_main!(benches);
