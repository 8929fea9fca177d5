//! What an averaged discrete gradient costs.
//!
//! Measured on 32 paths in a [`real::Kernel`]: the closed forms, and Gauss–Legendre with 2, 8 and
//! 12 nodes on a field with two exponentials. An element is one path, so criterion's `Melem/s` are
//! millions of gradients a second: **ns per gradient = 1000 / (Melem/s)**. Per node the rate must
//! not depend on the number of nodes; where it falls, the loop over the nodes is no longer
//! unrolled.

use std::hint::black_box;
use std::time::Duration;

use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, Criterion, Throughput, criterion_group, criterion_main};
use dgrad::{GradientField, averaged, mean_cosine, midpoint};
use real::{Block, Kernel, Real, WIDTH, dispatch};

/// ∇̄H(a, b) of something on one path.
trait Mean: Copy {
    fn mean(&self, a: [f64; 2], b: [f64; 2]) -> [f64; 2];
}

/// H = e^{y₁ − y₂}.
#[derive(Clone, Copy)]
struct Exponential;

impl GradientField<2> for Exponential {
    #[inline(always)]
    fn gradient<R: Real>(&self, y: [R; 2]) -> [R; 2] {
        let power = (y[0] - y[1]).exp();
        [power, -power]
    }
}

#[derive(Clone, Copy)]
struct Quadrature<const N: usize>;

impl<const N: usize> Mean for Quadrature<N> {
    #[inline(always)]
    fn mean(&self, a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
        averaged::<N, f64, _, 2>(&Exponential, a, b)
    }
}

#[derive(Clone, Copy)]
struct Middle;

impl Mean for Middle {
    #[inline(always)]
    fn mean(&self, a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
        midpoint(a, b)
    }
}

#[derive(Clone, Copy)]
struct Cosines;

impl Mean for Cosines {
    #[inline(always)]
    fn mean(&self, a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
        [mean_cosine(a[0], b[0]), mean_cosine(a[1], b[1])]
    }
}

struct All<'a, F> {
    mean: F,
    a: &'a Block<2>,
    b: &'a Block<2>,
    result: &'a mut Block<2>,
}

impl<F: Mean> Kernel for All<'_, F> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        for p in 0..WIDTH {
            self.result.set_path(p, self.mean.mean(self.a.path(p), self.b.path(p)));
        }
    }
}

fn measure(group: &mut BenchmarkGroup<'_, WallTime>, name: &str, mean: impl Mean) {
    let (mut a, mut b) = (Block::zero(), Block::zero());
    for p in 0..WIDTH {
        let shift = p as f64 / WIDTH as f64;
        a.set_path(p, [0.3 + shift, -0.2]);
        b.set_path(p, [0.4, 0.1 - shift]);
    }
    let mut result = Block::zero();
    group.throughput(Throughput::Elements(WIDTH as u64));
    group.bench_function(name, |bencher| {
        bencher.iter(|| {
            dispatch(All { mean, a: black_box(&a), b: black_box(&b), result: &mut result });
            black_box(&result);
        });
    });
}

fn bench(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("gradients");
    group
        .sample_size(20)
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(1));
    measure(&mut group, "midpoint", Middle);
    measure(&mut group, "mean cosine, two", Cosines);
    measure(&mut group, "2 nodes", Quadrature::<2>);
    measure(&mut group, "8 nodes", Quadrature::<8>);
    measure(&mut group, "12 nodes", Quadrature::<12>);
    group.finish();
}

criterion_group!(benches, bench);
criterion_main!(benches);
