//! What a Lévy area costs.
//!
//! Measured: [`AreaSampler::areas`] with the terms of strong order one at a step of 2⁻¹², 64 steps
//! of 32 paths, and the same steps of [`AreaPath`] for a single path. The increments are drawn
//! beforehand.
//!
//! An element is one path and step, so criterion's `Melem/s` are millions of path-steps a second:
//! **ns per path-step = 1000 / (Melem/s)**; divided by 2nm + m(m + 1)/2 for n terms and m noises it
//! is ns per normal, to be compared with `increments`.

use std::hint::black_box;
use std::time::Duration;

use criterion::{BenchmarkGroup, Criterion, Throughput, criterion_group, criterion_main};
use noise::{AreaPath, AreaSampler, StreamKey, WienerRows};
use real::{Block, WIDTH};

const STEPS: usize = 64;
const STEP: f64 = 1.0 / 4096.0;

const KEY: StreamKey = StreamKey { seed: 1, experiment: 1 };

type Group<'a> = BenchmarkGroup<'a, criterion::measurement::WallTime>;

fn increment<const M: usize>() -> Block<M> {
    let mut dw = Block::<M>::zero();
    WienerRows::new(KEY, 0).increments(STEP.sqrt(), &mut dw.0);
    dw
}

fn areas<const M: usize>(group: &mut Group<'_>, noises: &str, terms: usize) {
    let name = format!("{noises}/{terms}");
    let dw = increment::<M>();
    group.throughput(Throughput::Elements((WIDTH * STEPS) as u64));
    group.bench_function(format!("{name}/block"), |bencher| {
        let mut sampler = AreaSampler::new(KEY, 0, M, terms);
        let mut areas = vec![[0.0; WIDTH]; M * M];
        bencher.iter(|| {
            for _ in 0..STEPS {
                sampler.areas(STEP, &black_box(&dw).0, &mut areas);
                black_box(&areas);
            }
        });
    });
    group.throughput(Throughput::Elements(STEPS as u64));
    group.bench_function(format!("{name}/path"), |bencher| {
        let mut sampler = AreaPath::<M>::new(KEY, 0, terms);
        bencher.iter(|| {
            for _ in 0..STEPS {
                black_box(sampler.areas(STEP, black_box(dw.path(0))));
            }
        });
    });
}

fn bench(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("areas");
    group
        .sample_size(20)
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(1));
    areas::<3>(&mut group, "three noises", 11);
    areas::<2>(&mut group, "two noises", 9);
    areas::<6>(&mut group, "six noises", 15);
    group.finish();
}

criterion_group!(benches, bench);
criterion_main!(benches);
