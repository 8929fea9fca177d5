use std::hint::black_box;
use std::time::Instant;

use noise::{StreamKey, WienerBlock};
use real::{Block, Level, WIDTH, limit_to};
use schemes::*;
use systems::*;

fn best(mut f: impl FnMut() -> u64) -> f64 {
    let mut best = f64::INFINITY;
    for _ in 0..400 {
        let start = Instant::now();
        let n = f();
        best = best.min(start.elapsed().as_secs_f64() * 1e9 / n as f64);
    }
    best
}
fn main() {
    let body = RigidBody::three_noises([2.0, 1.0, 2.0 / 3.0], [1.0, 2.0, 3.0]).unwrap();
    let damping = Cosine::new(0.5, 2.0).unwrap();
    let tau = 1.0 / 4096.0f64;
    for level in [Level::Avx512] {
        limit_to(level);
        let schemes: [(&str, &dyn Scheme<RigidBody<3>, 3, 3>); 4] = [
            ("sexp fp", &Sexp { solver: nonlin::Solver::new(nonlin::Method::FixedPoint) }),
            ("sexp newton", &Sexp { solver: nonlin::Solver::new(nonlin::Method::Newton) }),
            ("midpoint", &Midpoint::default()),
            ("em", &EulerMaruyama),
        ];
        for (name, scheme) in schemes {
            let mut b = 0;
            let steps: Vec<Step> = (0..256).map(|n| Step::new(&damping, n, tau).unwrap()).collect();
            let mut status = nonlin::BlockStatus::explicit();
            let t = best(|| {
                b += 1;
                let mut noise = WienerBlock::<3>::new(StreamKey { seed: 1, experiment: 1 }, b * 32);
                let mut y = Block::splat([1.1f64.cos(), 0.0, 1.1f64.sin()]);
                let mut dw = Block::zero();
                for n in 0..256 {
                    noise.increments(tau.sqrt(), &mut dw);
                    scheme.step_block(&body, &steps[n], &dw, &mut y, &mut status);
                }
                black_box(&y);
                256 * WIDTH as u64
            });
            println!("{level:?} {name}: {t:.2} ns");
        }
        let mut noise = WienerBlock::<3>::new(StreamKey { seed: 1, experiment: 1 }, 0);
        let mut dw = Block::zero();
        let t = best(|| {
            for _ in 0..256 {
                noise.increments(tau.sqrt(), &mut dw);
                black_box(&dw);
            }
            256 * 32
        });
        println!("{level:?} noise {t:.2}");
    }
}
