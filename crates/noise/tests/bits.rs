//! Increments and areas are a function of (seed, experiment, path) alone: the same bits in a block
//! and alone, at every level of instructions, in any block, and in every release.

use noise::{
    AreaPath, AreaSampler, DyadicLadder, QuasiWiener, ScrambledSobol, StepNoise, StreamKey,
    WienerPath, WienerRows,
};
use real::{Simd, WIDTH, limit_to};

const KEY: StreamKey = StreamKey { seed: 42, experiment: 3 };

/// Steps of different sizes, so that a spare normal crosses from one step size to the next.
fn sqrt_tau(n: usize) -> f64 {
    [1.0, 0.25, (1.0f64 / 3.0).sqrt()][n % 3]
}

fn block_equals_its_paths<const M: usize>(first_path: u64, steps: usize) {
    let mut block = WienerRows::new(KEY, first_path);
    let mut paths: Vec<_> =
        (0..WIDTH as u64).map(|p| WienerPath::<M>::new(KEY, first_path + p)).collect();
    let mut noise = StepNoise::zero(M);
    for n in 0..steps {
        block.increments(sqrt_tau(n), &mut noise.increments);
        for (p, path) in paths.iter_mut().enumerate() {
            assert_eq!(
                noise.path::<M>(p).increments.map(f64::to_bits),
                path.increments(sqrt_tau(n)).map(f64::to_bits),
                "M = {M}, step {n}, path {p}"
            );
        }
    }
}

fn areas_equal_those_of_the_paths<const M: usize>(first_path: u64, steps: usize) {
    for terms in [3, 9] {
        let mut wiener = WienerRows::new(KEY, first_path);
        let mut block = AreaSampler::new(KEY, first_path, M, terms);
        let mut paths: Vec<_> =
            (0..WIDTH as u64).map(|p| AreaPath::<M>::new(KEY, first_path + p, terms)).collect();
        let mut noise = StepNoise::with_areas(M);
        // Whatever was there is overwritten.
        noise.areas.fill([f64::NAN; WIDTH]);
        for n in 0..steps {
            wiener.increments(sqrt_tau(n), &mut noise.increments);
            let step = sqrt_tau(n) * sqrt_tau(n);
            block.areas(step, &noise.increments, &mut noise.areas);
            for (p, path) in paths.iter_mut().enumerate() {
                let drawn = noise.path::<M>(p);
                let alone = path.areas(step, drawn.increments);
                assert_eq!(
                    drawn.areas.map(|row| row.map(f64::to_bits)),
                    alone.map(|row| row.map(f64::to_bits)),
                    "{terms} terms, M = {M}, step {n}, path {p}"
                );
            }
        }
    }
}

fn quasi_block_equals_its_paths(steps: u64, noises: usize) {
    let noise = QuasiWiener::new(KEY, 9, steps, noises, 2.0).unwrap();
    assert_eq!(noise.dimensions(), steps as usize * noises);
    let of_scramble = QuasiWiener::new(KEY, 2, steps, noises, 2.0).unwrap().of_scramble(9);
    assert_eq!(of_scramble.path(70), noise.path(70));
    let mut rows = vec![[f64::NAN; WIDTH]; noise.dimensions()];
    for first_point in [0, 32, 4096 + 64, 1 << 20, ScrambledSobol::POINTS - 32] {
        noise.block(first_point, &mut rows);
        for p in 0..WIDTH {
            let path = noise.path(first_point + p as u64);
            let block: Vec<u64> = rows.iter().map(|row| row[p].to_bits()).collect();
            let path: Vec<u64> = path.into_iter().map(f64::to_bits).collect();
            assert_eq!(block, path, "{steps} steps, {noises} noises, point {first_point} + {p}");
        }
    }
}

/// One test: the limit belongs to the whole process.
#[test]
fn a_block_is_its_paths_at_every_level() {
    for &level in Simd::BUILT {
        limit_to(level);
        block_equals_its_paths::<0>(0, 1);
        block_equals_its_paths::<1>(0, 2000);
        block_equals_its_paths::<2>(32, 2000);
        block_equals_its_paths::<3>(64, 2000);
        block_equals_its_paths::<4>(1 << 40, 2000);
        block_equals_its_paths::<5>(7, 500);
        block_equals_its_paths::<7>(7, 100);
        for steps in [1, 2, 3, 7, 8] {
            for noises in [0, 1, 2, 3, 5] {
                quasi_block_equals_its_paths(steps, noises);
            }
        }
        quasi_block_equals_its_paths(100, 11); // 76 padded dimensions
        assert_eq!(quasi_increments(), PINNED_QUASI);
        areas_equal_those_of_the_paths::<1>(0, 10);
        areas_equal_those_of_the_paths::<2>(32, 200);
        areas_equal_those_of_the_paths::<3>(64, 200);
        areas_equal_those_of_the_paths::<4>(1 << 40, 100);
        areas_equal_those_of_the_paths::<5>(7, 100);
    }
}

/// A padded dimension and the first ones of two points; a change is a value-breaking change.
fn quasi_increments() -> [f64; 6] {
    let noise = QuasiWiener::new(StreamKey { seed: 1, experiment: 1 }, 2, 1025, 1, 1.0).unwrap();
    let few = QuasiWiener::new(StreamKey { seed: 1, experiment: 1 }, 2, 2, 2, 1.0).unwrap();
    let (long, one, other) = (noise.path(4711), few.path(0), few.path(4711));
    [one[0], one[1], other[0], other[3], long[0], long[1024]]
}

const PINNED_QUASI: [f64; 6] = [
    -0.599386928164209,
    -1.0442425933794381,
    0.06643554181938893,
    0.8996308926916476,
    -0.025412003890909356,
    -0.03848109206897632,
];

/// A change here changes every published number: it is a value-breaking change.
#[test]
fn the_first_normals_and_areas_are_pinned() {
    let key = StreamKey { seed: 1, experiment: 1 };
    for (path, pinned) in [(0, PINNED_0), (4711, PINNED_4711)] {
        let mut stream = WienerPath::<1>::new(key, path);
        assert_eq!([(); 6].map(|()| stream.normal()), pinned);
    }
    let mut path = AreaPath::<3>::new(key, 4711, 2);
    let areas = [(); 2].map(|()| path.areas(0.5, [0.5, -0.25, 1.0]));
    assert_eq!(areas.map(|a| [a[0][1], a[0][2], a[1][2]]), PINNED_AREAS);
}

const PINNED_AREAS: [[f64; 3]; 2] = [
    [-0.11222549423521401, 0.15278648700086347, -0.08053545733925623],
    [-0.1564441842148171, 0.025960342247222143, 0.18669002879909163],
];

const PINNED_0: [f64; 6] = [
    0.14026499603841205,
    -0.9107110851689912,
    1.7933565517383385,
    1.223862947575263,
    0.03708393144633514,
    0.4218855998101679,
];
const PINNED_4711: [f64; 6] = [
    0.6539078001718728,
    -1.3000570079262792,
    -1.666772944079786,
    -0.19778185817286142,
    0.6706061839170867,
    0.9542433137900147,
];

/// W over 2^level finest steps, summed as a balanced tree: the order that a ladder adds in.
fn tree<const M: usize>(path: &mut WienerPath<M>, level: usize, scale: f64) -> [f64; M] {
    if level == 0 {
        return path.increments(scale);
    }
    let first = tree(path, level - 1, scale);
    let second = tree(path, level - 1, scale);
    std::array::from_fn(|m| first[m] + second[m])
}

#[test]
fn ladder_sums_can_be_recomputed_from_a_path() {
    const LEVELS: usize = 6;
    let scale = 2f64.powi(-7);
    let mut wiener = WienerRows::new(KEY, 96);
    let mut ladder = DyadicLadder::new(LEVELS, &StepNoise::zero(3));
    let path = |p| WienerPath::<3>::new(KEY, 96 + p as u64);
    let mut replay = [(); LEVELS + 1].map(|()| [0, 13, 31].map(|p| (p, path(p))));
    for _ in 0..1 << 9 {
        let top = ladder.push(|finest| wiener.increments(scale, &mut finest.increments));
        for (level, paths) in replay[..=top].iter_mut().enumerate() {
            for (p, path) in paths {
                let sum = tree(path, level, scale);
                assert_eq!(ladder.whole(level).path::<3>(*p).increments, sum);
            }
        }
    }
}
