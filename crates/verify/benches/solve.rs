//! What solving z = ψ(z) costs, against how fast ψ contracts.
//!
//! Measured: ψ(z) = c + q·Rz in three dimensions, with a rotation R and so with the contraction q
//! everywhere, from a start at distance one, by both methods on a block and on one path. An element
//! is one equation, so criterion's `Melem/s` are millions of equations a second: **µs per equation
//! = 1 / (Melem/s)**. With q = 0.9 the fixed point takes more evaluations than it has, and what is
//! measured is the rescue.

use std::hint::black_box;
use std::time::Duration;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use nonlin::{BlockFixedPoint, BlockStatus, FixedPoint, Method, Solver};
use real::{Block, Kernel, Real, WIDTH, dispatch};

#[derive(Clone, Copy)]
struct Turn {
    contraction: f64,
    constant: [f64; 3],
}

impl FixedPoint<3> for Turn {
    #[inline(always)]
    fn start(&self) -> [f64; 3] {
        [1.0, 0.5, -0.5]
    }
    #[inline(always)]
    fn map<R: Real>(&self, z: [R; 3]) -> [R; 3] {
        let (q, c) = (self.contraction, self.constant);
        [z[1] * -q + c[0], z[0] * q + c[1], z[2] * q + c[2]]
    }
}

/// The constants differ from path to path, or one solution would do for the block.
#[derive(Clone, Copy)]
struct Turns {
    contraction: f64,
    constants: Block<3>,
}

impl BlockFixedPoint<3> for Turns {
    type Path = Turn;
    #[inline(always)]
    fn path(&self, p: usize) -> Turn {
        Turn { contraction: self.contraction, constant: self.constants.path(p) }
    }
}

struct Solve<'a> {
    solver: Solver,
    equations: &'a Turns,
    z: &'a mut Block<3>,
    status: &'a mut BlockStatus,
}

impl Kernel for Solve<'_> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        self.solver.solve_block(self.equations, self.z, self.status);
    }
}

const CONTRACTIONS: [f64; 4] = [0.01, 0.1, 0.5, 0.9];

fn bench(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("solve");
    group
        .sample_size(20)
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(1));
    for (method, name) in [(Method::FixedPoint, "fixed point"), (Method::Newton, "newton")] {
        let solver = Solver::new(method);
        for contraction in CONTRACTIONS {
            let mut equations = Turns { contraction, constants: Block::zero() };
            for p in 0..WIDTH {
                let shift = p as f64 / WIDTH as f64;
                equations.constants.set_path(p, [0.3 + shift, 0.2 - shift, shift - 0.1]);
            }
            let one = equations.path(0);
            let (mut z, mut status) = (Block::zero(), BlockStatus::explicit());
            group.throughput(Throughput::Elements(WIDTH as u64));
            group.bench_function(format!("{name}, {contraction}/block"), |bencher| {
                bencher.iter(|| {
                    dispatch(Solve {
                        solver,
                        equations: black_box(&equations),
                        z: &mut z,
                        status: &mut status,
                    });
                    black_box(&z);
                });
            });
            group.throughput(Throughput::Elements(1));
            group.bench_function(format!("{name}, {contraction}/path"), |bencher| {
                bencher.iter(|| solver.solve(black_box(&one)));
            });
        }
    }
    group.finish();
}

criterion_group!(benches, bench);
criterion_main!(benches);
