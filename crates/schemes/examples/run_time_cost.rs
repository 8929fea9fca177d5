//! temp
use noise::{BlockNoise, StreamKey, WienerBlock};
use nonlin::BlockStatus;
use real::Block;
use schemes::{Heun, Scheme, Sexp, SexpLi, Step, run_time};
use std::time::Instant;
use systems::{Constant, RigidBody, PoissonSystem, Poisson3, run_time::Compiled};
fn cost<S: PoissonSystem<D, M> + Copy, C: Scheme<S, D, M> + run_time::Scheme, const D: usize, const M: usize>(system: S, y0: [f64; D], scheme: &C) {
    let adapter = Compiled::new(system, y0);
    let mut noise = BlockNoise::zero();
    WienerBlock::<M>::new(StreamKey { seed: 1, experiment: 1 }, 0).increments(0.01, &mut noise.increments);
    let step = Step::new(&Constant::new(0.0).unwrap(), 0, 1e-4).unwrap();
    let mut status = BlockStatus::explicit();
    let n = 20000;
    let mut best = [f64::INFINITY; 2];
    for _ in 0..20 {
        let mut y = Block::splat(y0);
        let t = Instant::now();
        for _ in 0..n { scheme.step_block(&system, &step, &noise, &mut y, &mut status); }
        best[0] = best[0].min(t.elapsed().as_nanos() as f64 / n as f64 / 32.0);
        let mut paths = scheme.stepper(&adapter).unwrap();
        paths.state_mut().copy_from_slice(&Block::splat(y0).0);
        let t = Instant::now();
        for _ in 0..n { paths.step(&step, &noise.increments.0, &mut status); }
        best[1] = best[1].min(t.elapsed().as_nanos() as f64 / n as f64 / 32.0);
    }
    println!("{} {}: compiled {:.2} ns, run time {:.2} ns", system.name(), run_time::Scheme::id(scheme), best[0], best[1]);
}
fn main() {
    let body = RigidBody::three_noises([2.0, 1.0, 0.6], [1.0, 2.0, 3.0]).unwrap();
    let y0 = [0.6, 0.0, 0.8];
    cost(body, y0, &Heun);
    cost(body, y0, &SexpLi::new(&body, y0).unwrap());
    cost(body, y0, &Sexp);
    let p = Poisson3::new(1.0).unwrap();
    cost(p, [1.0, 2.0, 3.0], &Heun);
    cost(p, [1.0, 2.0, 3.0], &Sexp);
}
