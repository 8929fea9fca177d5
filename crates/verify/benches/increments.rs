//! What a Wiener increment costs.
//!
//! First, ns per normal of [`WienerRows::increments`] for one, two and three noises at each level
//! of instructions: the least of many runs of 256 steps of 32 paths.
//!
//! Then the same of [`WienerRows`] and of [`QuasiWiener`] for a few steps: points, scrambling,
//! quantiles, bridge and differences. The two take turns, and the least of many runs counts.
//!
//! Then, by criterion, the same steps for one and for three noises, and those of [`WienerPath`] for
//! a single path. An element is one path and step, so criterion's `Melem/s` are millions of
//! path-steps a second: **ns per path-step = 1000 / (Melem/s)**; divided by the number of noises it
//! is ns per normal. The ratio of the rates of `block` and `path` says whether the path loop is
//! still vectorised: about one would mean that it is not.

use std::hint::black_box;
use std::time::{Duration, Instant};

use criterion::{BenchmarkGroup, Criterion, Throughput, criterion_group};
use noise::{QuasiWiener, StreamKey, WienerPath, WienerRows};
use real::{Block, Rows, Simd, WIDTH, limit_to};

const STEPS: usize = 256;

const KEY: StreamKey = StreamKey { seed: 1, experiment: 1 };

/// Runs of which the least time counts.
const RUNS: usize = 2000;

fn ns_per_normal<const M: usize>() -> f64 {
    let mut noise = WienerRows::new(KEY, 0);
    let mut dw = Block::<M>::zero();
    let mut least = Duration::MAX;
    for _ in 0..RUNS {
        let start = Instant::now();
        for _ in 0..STEPS {
            noise.increments(black_box(0.0625), &mut dw.0);
            black_box(&dw);
        }
        least = least.min(start.elapsed());
    }
    least.as_secs_f64() * 1e9 / (M * WIDTH * STEPS) as f64
}

fn print_ns_per_normal() {
    println!("ns per normal   1 noise  2 noises  3 noises");
    for level in [Simd::Baseline, Simd::Avx2, Simd::Avx512] {
        limit_to(level);
        if Simd::current() == level {
            let [one, two, three] =
                [ns_per_normal::<1>(), ns_per_normal::<2>(), ns_per_normal::<3>()];
            println!("{:13} {one:9.2} {two:9.2} {three:9.2}", level.name());
        }
    }
    limit_to(Simd::Avx512);
}

/// ns per normal of Box–Muller and of Sobol points.
fn both_kinds(noises: usize, steps: u64) -> [f64; 2] {
    let quasi = QuasiWiener::new(KEY, 0, steps, noises, 1.0).unwrap();
    let mut wiener = WienerRows::new(KEY, 0);
    let mut rows = Rows::zero(quasi.dimensions());
    let mut least = [Duration::MAX; 2];
    let blocks = STEPS / steps as usize * 4;
    for run in 0..RUNS as u64 {
        let start = Instant::now();
        for _ in 0..blocks {
            for step in rows.chunks_mut(noises) {
                wiener.increments(black_box(0.0625), step);
            }
            black_box(&rows);
        }
        least[0] = least[0].min(start.elapsed());
        let start = Instant::now();
        for block in 0..blocks as u64 {
            quasi.block((run << 12) + block * WIDTH as u64, &mut rows);
            black_box(&rows);
        }
        least[1] = least[1].min(start.elapsed());
    }
    let normals = (quasi.dimensions() * WIDTH * blocks) as f64;
    least.map(|least| least.as_secs_f64() * 1e9 / normals)
}

fn print_both_kinds() {
    println!("ns per normal   Box-Muller  Sobol (3 noises, 4 steps)   Box-Muller  Sobol (1, 64)");
    for level in [Simd::Baseline, Simd::Avx2, Simd::Avx512] {
        limit_to(level);
        if Simd::current() == level {
            let ([random, quasi], [random_64, quasi_64]) = (both_kinds(3, 4), both_kinds(1, 64));
            let name = level.name();
            println!("{name:15} {random:10.2} {quasi:26.2} {random_64:12.2} {quasi_64:14.2}");
        }
    }
    limit_to(Simd::Avx512);
}

fn increments<const M: usize>(
    group: &mut BenchmarkGroup<'_, criterion::measurement::WallTime>,
    name: &str,
) {
    group.throughput(Throughput::Elements((WIDTH * STEPS) as u64));
    group.bench_function(format!("{name}/block"), |bencher| {
        let mut noise = WienerRows::new(KEY, 0);
        let mut dw = Block::<M>::zero();
        bencher.iter(|| {
            for _ in 0..STEPS {
                noise.increments(0.0625, &mut dw.0);
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

fn main() {
    // `cargo test` starts benches without this argument.
    if std::env::args().any(|argument| argument == "--bench") {
        print_ns_per_normal();
        print_both_kinds();
    }
    benches();
    Criterion::default().configure_from_args().final_summary();
}
