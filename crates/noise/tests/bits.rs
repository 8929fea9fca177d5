//! Increments and areas are a function of (seed, experiment, path) alone: the same bits in a block
//! and alone, at every level of instructions, in any block, and in every release.

use noise::{
    AreaBlock, AreaMethod, AreaPath, AreaSampler, DyadicLadder, ExactArea, StreamKey, WienerBlock,
    WienerPath,
};
use real::{Block, Level, WIDTH, limit_to};

const KEY: StreamKey = StreamKey { seed: 42, experiment: 3 };

/// Steps of different sizes, so that a spare normal crosses from one step size to the next.
fn sqrt_tau(n: usize) -> f64 {
    [1.0, 0.25, (1.0f64 / 3.0).sqrt()][n % 3]
}

fn block_equals_its_paths<const M: usize>(first_path: u64, steps: usize) {
    let mut block = WienerBlock::<M>::new(KEY, first_path);
    let mut paths: Vec<_> =
        (0..WIDTH as u64).map(|p| WienerPath::<M>::new(KEY, first_path + p)).collect();
    let mut dw = Block::splat([f64::NAN; M]);
    for n in 0..steps {
        block.increments(sqrt_tau(n), &mut dw);
        for (p, path) in paths.iter_mut().enumerate() {
            assert_eq!(
                dw.path(p).map(f64::to_bits),
                path.increments(sqrt_tau(n)).map(f64::to_bits),
                "M = {M}, step {n}, path {p}"
            );
        }
    }
}

fn areas_equal_those_of_the_paths<const M: usize>(first_path: u64, steps: usize) {
    for (n, method) in AreaMethod::ALL.into_iter().enumerate() {
        let terms = [9, 5, 4, 3][n];
        let mut noise = WienerBlock::<M>::new(KEY, first_path);
        let mut block = AreaSampler::<M>::new(KEY, first_path, method, terms);
        let mut paths: Vec<_> = (0..WIDTH as u64)
            .map(|p| AreaPath::<M>::new(KEY, first_path + p, method, terms))
            .collect();
        let mut dw = Block::zero();
        // Whatever was in the block is overwritten.
        let mut areas = AreaBlock([[[f64::NAN; WIDTH]; M]; M]);
        for n in 0..steps {
            noise.increments(sqrt_tau(n), &mut dw);
            let step = sqrt_tau(n) * sqrt_tau(n);
            block.areas(step, &dw, &mut areas);
            for (p, path) in paths.iter_mut().enumerate() {
                let alone = path.areas(step, dw.path(p));
                assert_eq!(
                    areas.path(p).map(|row| row.map(f64::to_bits)),
                    alone.map(|row| row.map(f64::to_bits)),
                    "{method:?}, M = {M}, step {n}, path {p}"
                );
            }
        }
    }
}

/// One test: the limit belongs to the whole process.
#[test]
fn a_block_is_its_paths_at_every_level() {
    for &level in Level::BUILT {
        limit_to(level);
        block_equals_its_paths::<1>(0, 2000);
        block_equals_its_paths::<2>(32, 2000);
        block_equals_its_paths::<3>(64, 2000);
        block_equals_its_paths::<4>(1 << 40, 2000);
        block_equals_its_paths::<5>(7, 500);
        areas_equal_those_of_the_paths::<1>(0, 10);
        areas_equal_those_of_the_paths::<2>(32, 200);
        areas_equal_those_of_the_paths::<3>(64, 200);
        areas_equal_those_of_the_paths::<4>(1 << 40, 100);
        areas_equal_those_of_the_paths::<5>(7, 100);
    }
}

#[test]
fn without_noise_nothing_is_drawn() {
    let mut block = WienerBlock::<0>::new(KEY, 0);
    let mut dw = Block::zero();
    block.increments(1.0, &mut dw);
    assert_eq!(WienerPath::<0>::new(KEY, 0).increments(1.0), [0.0; 0]);
}

#[test]
fn a_path_is_the_same_in_every_block() {
    // Path 40 as member 8 of the block that starts at 32 and as member 23 of the one that starts at
    // 17.
    let (mut one, mut other) = (WienerBlock::<3>::new(KEY, 32), WienerBlock::<3>::new(KEY, 17));
    let (mut dw, mut other_dw) = (Block::zero(), Block::zero());
    for _ in 0..100 {
        one.increments(1.0, &mut dw);
        other.increments(1.0, &mut other_dw);
        assert_eq!(dw.path(8), other_dw.path(23));
    }
}

#[test]
fn areas_of_a_path_are_the_same_in_every_block() {
    let method = AreaMethod::Wiktorsson;
    let (mut one, mut other) =
        (AreaSampler::<3>::new(KEY, 32, method, 2), AreaSampler::<3>::new(KEY, 17, method, 2));
    let (mut areas, mut other_areas) = (AreaBlock::zero(), AreaBlock::zero());
    for n in 0..100 {
        let dw = Block::splat([1.0, -0.5, 0.1 * f64::from(n)]);
        one.areas(1.0, &dw, &mut areas);
        other.areas(1.0, &dw, &mut other_areas);
        assert_eq!(areas.path(8), other_areas.path(23));
    }
}

#[test]
fn one_noise_has_no_areas() {
    let mut areas = AreaBlock([[[f64::NAN; WIDTH]]]);
    AreaSampler::<1>::new(KEY, 0, AreaMethod::Milstein, 3).areas(
        1.0,
        &Block::splat([1.0]),
        &mut areas,
    );
    assert_eq!(areas, AreaBlock::zero());
    assert_eq!(AreaPath::<0>::new(KEY, 0, AreaMethod::Milstein, 3).areas(1.0, []), [[0.0; 0]; 0]);
}

#[test]
fn the_first_areas_are_pinned() {
    // A change here changes every published number: it is a value-breaking change.
    let key = StreamKey { seed: 1, experiment: 1 };
    let mut areas = Vec::new();
    for method in AreaMethod::ALL {
        let mut path = AreaPath::<3>::new(key, 4711, method, 2);
        for _ in 0..2 {
            let a = path.areas(0.5, [0.5, -0.25, 1.0]);
            areas.push([a[0][1], a[0][2], a[1][2]]);
        }
    }
    let mut path = ExactArea::new(key, 4711);
    areas.push([(); 3].map(|()| path.area(0.5, [0.5, -0.25])));
    for (n, (areas, pinned)) in areas.iter().zip(PINNED_AREAS).enumerate() {
        assert_eq!(areas.map(f64::to_bits), pinned.map(f64::to_bits), "{n}: {areas:?}");
    }
    assert_eq!(areas.len(), PINNED_AREAS.len());
}

const PINNED_AREAS: [[f64; 3]; 9] = [
    [-0.1485653568792302, 0.032546440963638484, 0.021931279897931897],
    [-0.13991573596311918, 0.2804035511389258, 0.00367308180016961],
    [-0.11553366468124204, 0.13362446966441552, -0.0946711188484329],
    [0.17061441209446054, 0.09430536033064701, 0.050227505608413395],
    [-0.23047143890396796, 0.1584418509794862, 0.13827640565318164],
    [0.032644788623923414, 0.12401479720426836, 0.17731353033978006],
    [-0.08768726602597586, 0.09251423223902801, -0.0508614875642002],
    [-0.10760866337656935, 0.5614349143498122, -0.001972422494833692],
    [-0.1351830957949393, -0.17779401888534005, -0.5564203500854272],
];

#[test]
fn the_noises_share_one_sequence_of_normals() {
    // Step by step, noise by noise: three noises over two steps are six normals, in order.
    let mut normals = WienerPath::<1>::new(KEY, 5);
    let mut path = WienerPath::<3>::new(KEY, 5);
    for _ in 0..50 {
        let dw = path.increments(0.5);
        assert_eq!(dw, [(); 3].map(|()| normals.normal() * 0.5));
    }
}

#[test]
fn seed_experiment_and_path_all_matter() {
    let first = |seed, experiment, path| {
        WienerPath::<1>::new(StreamKey { seed, experiment }, path).normal()
    };
    let all = [first(1, 1, 1), first(2, 1, 1), first(1, 2, 1), first(1, 1, 2)];
    for i in 0..4 {
        for j in 0..i {
            assert_ne!(all[i], all[j]);
        }
    }
}

#[test]
fn the_first_normals_are_pinned() {
    // A change here changes every published number: it is a value-breaking change.
    let key = StreamKey { seed: 1, experiment: 1 };
    for (path, pinned) in [(0, PINNED_0), (4711, PINNED_4711)] {
        let mut stream = WienerPath::<1>::new(key, path);
        let normals = [(); 6].map(|()| stream.normal());
        assert_eq!(normals.map(f64::to_bits), pinned.map(f64::to_bits), "{normals:?}");
    }
}

const PINNED_0: [f64; 6] = [
    -0.126037568781829,
    0.938266191074953,
    -0.8871422356966696,
    1.4663483801822483,
    -0.706220903247306,
    1.654688784879398,
];
const PINNED_4711: [f64; 6] = [
    -1.3265246570152416,
    0.8367423818727519,
    0.16741394736428505,
    -0.12160886850385244,
    2.4547718486096777,
    0.7274301461475864,
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
    let mut noise = WienerBlock::<3>::new(KEY, 96);
    let mut ladder = DyadicLadder::<3>::new(LEVELS);
    let mut dw = Block::zero();
    let mut replay: Vec<Vec<_>> = (0..=LEVELS)
        .map(|_| (0..WIDTH as u64).map(|p| WienerPath::<3>::new(KEY, 96 + p)).collect())
        .collect();
    let mut completed = [0; LEVELS + 1];
    for _ in 0..1 << 9 {
        noise.increments(scale, &mut dw);
        let top = ladder.push(&dw);
        for level in 0..=top {
            completed[level] += 1;
            for p in 0..WIDTH {
                let path = &mut replay[level][p];
                let (first, sum) = if level == 0 {
                    ([0.0; 3], tree(path, 0, scale))
                } else {
                    let first = tree(path, level - 1, scale);
                    let second = tree(path, level - 1, scale);
                    // The second half is what the level below has just completed.
                    assert_eq!(ladder.increment(level - 1).path(p), second);
                    (first, std::array::from_fn(|m| first[m] + second[m]))
                };
                assert_eq!(ladder.increment(level).path(p), sum);
                if level > 0 {
                    assert_eq!(ladder.first_half(level).path(p), first);
                }
            }
        }
    }
    assert_eq!(completed, [512, 256, 128, 64, 32, 16, 8]);
}
