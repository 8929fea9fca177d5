//! What a status says of states that are no numbers.

use nonlin::{BlockStatus, Outcome, Solution};
use real::{Block, PathMask, WIDTH};

/// A solution that is no number has failed, with an infinite residual, alone and in a block.
#[test]
fn what_is_not_finite_has_failed() {
    let outcome = Outcome::Robust { iterations: 7, residual: 1e-16 };
    let states: [[f64; 2]; WIDTH] = std::array::from_fn(|p| match p {
        3 => [f64::NAN, 1.0],
        8 => [1.0, f64::INFINITY],
        21 => [f64::NEG_INFINITY, f64::NAN],
        _ => [p as f64, f64::MAX],
    });
    let (mut block, mut status) = (Block::zero(), BlockStatus::explicit());
    assert!(status.robust.is_empty() && status.failed.is_empty());
    // Two that the robust method solved, one of which is lost afterwards.
    status.robust.insert(3);
    status.robust.insert(4);
    for (p, state) in states.into_iter().enumerate() {
        block.set_path(p, state);
        let finite = ![3, 8, 21].contains(&p);
        let failed = Outcome::Failed { residual: f64::INFINITY };
        let checked = Solution { z: state, outcome }.checked();
        assert_eq!(checked.outcome, if finite { outcome } else { failed });
        assert_eq!(checked.z.map(f64::to_bits), state.map(f64::to_bits));
    }
    status.fail_where_not_finite(&block.0);
    assert_eq!(status.failed, PathMask(1 << 3 | 1 << 8 | 1 << 21));
    assert_eq!(status.robust, PathMask(1 << 4));
    for p in 0..WIDTH {
        let expected = if status.failed.contains(p) { (0, f64::INFINITY) } else { (1, 0.0) };
        assert_eq!((status.iterations(p), status.residual(p)), expected, "path {p}");
    }

    let (all, before) = (Block::splat([1.0, -2.0]), status);
    status.fail_where_not_finite(&all.0);
    assert_eq!(status, before, "states that are finite change nothing");
}
