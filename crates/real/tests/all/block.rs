//! Blocks hold what was put into them, and masks are sets.

use proptest::prelude::*;
use real::{Block, PathMask, WIDTH};

#[test]
fn a_block_is_a_row_of_paths() {
    let mut block = Block::<3>::zero();
    assert_eq!(block, Block::splat([0.0; 3]));
    (0..WIDTH).for_each(|p| block.set_path(p, [p as f64, -(p as f64), 0.5]));
    for p in 0..WIDTH {
        // Setting one path leaves the others alone, and the path index is the innermost one.
        assert_eq!(block.path(p), [p as f64, -(p as f64), 0.5]);
        assert_eq!(block.0[1][p], -(p as f64));
    }
    // A block straddles no cache line.
    assert_eq!(align_of::<Block<1>>(), 64);
    assert_eq!(size_of::<Block<3>>(), 3 * WIDTH * size_of::<f64>());
}

#[test]
fn the_first_paths() {
    assert_eq!(PathMask::first(0), PathMask::NONE);
    assert_eq!(PathMask::first(WIDTH), PathMask::ALL);
    assert_eq!(PathMask::first(WIDTH + 7), PathMask::ALL);
    for n in 0..=WIDTH {
        let mask = PathMask::first(n);
        assert_eq!(mask.len() as usize, n);
        assert!(mask.paths().eq(0..n));
    }
    assert!(PathMask::default().is_empty());
    assert!(!PathMask::ALL.is_empty());
}

proptest! {
    #[test]
    fn masks_obey_the_laws_of_sets(a: u32, b: u32, p in 0..WIDTH) {
        let (x, y) = (PathMask(a), PathMask(b));
        prop_assert_eq!(x.and(y).contains(p), x.contains(p) && y.contains(p));
        prop_assert_eq!(x.or(y).contains(p), x.contains(p) || y.contains(p));
        prop_assert_eq!(x.without(y).contains(p), x.contains(p) && !y.contains(p));
        prop_assert_eq!(x.without(y).or(x.and(y)), x);
        prop_assert_eq!(x.or(y).len() + x.and(y).len(), x.len() + y.len());
        let mut inserted = x;
        inserted.insert(p);
        prop_assert_eq!(inserted, x.or(PathMask(1 << p)));
        let mut collected = PathMask::NONE;
        x.paths().for_each(|path| collected.insert(path));
        prop_assert_eq!(collected, x);
        prop_assert_eq!(x.paths().count(), x.len() as usize);
    }
}
