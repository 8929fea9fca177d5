//! What a Wiener increment costs.
//!
//! Measured: [`WienerBlock::increments`] for one and for three noises, 256 steps of 32 paths, and
//! the same steps of [`WienerPath`] for a single path.
//!
//! An element is one path and step, so criterion's `Melem/s` are millions of path-steps a second:
//! **ns per path-step = 1000 / (Melem/s)**; divided by the number of noises it is ns per normal.
//! The ratio of the rates of `block` and `path` says whether the path loop is still vectorised:
//! about one would mean that it is not.

use std::hint::black_box;
use std::time::Duration;

use criterion::{BenchmarkGroup, Criterion, Throughput, criterion_group, criterion_main};
use noise::{StreamKey, WienerBlock, WienerPath};
use real::{Block, WIDTH};

const STEPS: usize = 256;

const KEY: StreamKey = StreamKey { seed: 1, experiment: 1 };

fn increments<const M: usize>(
    group: &mut BenchmarkGroup<'_, criterion::measurement::WallTime>,
    name: &str,
) {
    group.throughput(Throughput::Elements((WIDTH * STEPS) as u64));
    group.bench_function(format!("{name}/block"), |bencher| {
        let mut noise = WienerBlock::<M>::new(KEY, 0);
        let mut dw = Block::zero();
        bencher.iter(|| {
            for _ in 0..STEPS {
                noise.increments(0.0625, &mut dw);
                black_box(&dw);
            }
        });
    });
    group.throughput(Throughput::Elements(STEPS as u64));
    group.bench_function(format!("{name}/path"), |bencher| {
        let mut noise = WienerPath::<M>::new(KEY, 0);
        bencher.iter(|| {
            for _ in 0..STEPS {
                black_box(noise.increments(0.0625));
            }
        });
    });
}

fn bench(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("increments");
    group
        .sample_size(20)
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(1));
    increments::<1>(&mut group, "one noise");
    increments::<3>(&mut group, "three noises");
    group.finish();
}

criterion_group!(benches, bench);
criterion_main!(benches);
