//! What a status says of paths that nothing had to be solved for.

use nonlin::BlockStatus;
use real::WIDTH;

#[test]
fn an_explicit_step_is_one_iteration_everywhere() {
    let status = BlockStatus::explicit();
    for p in 0..WIDTH {
        assert_eq!((status.iterations(p), status.residual(p)), (1, 0.0));
    }
    assert!(status.robust.is_empty() && status.failed.is_empty());
}
