//! An iterate that comes back from far away is no converged one.

use nonlin::{FixedPoint, Outcome, Solver};
use real::Real;

/// ψ(z) = 1 + 10¹⁸ exp(−λ(z − 2)²) with λ = ln 10¹⁸: ψ(1) = 2, ψ is 1 far away and 10¹⁸ at z = 2. The last evaluations of
/// the first sweep from 100 are a jump of 99 and one of 1, which looks like fast contraction and is none.
#[derive(Clone, Copy)]
struct Peak;

impl FixedPoint<1> for Peak {
    fn start(&self) -> [f64; 1] {
        [100.0]
    }
    fn map<R: Real>(&self, [z]: [R; 1]) -> [R; 1] {
        let lambda = 18.0 * std::f64::consts::LN_10;
        let distance = z - 2.0;
        [(distance * distance * -lambda).exp() * 1e18 + 1.0]
    }
}

#[test]
fn an_excursion_does_not_pass_for_contraction() {
    let solution = Solver::default().solve(&Peak);
    let [value] = Peak.map(solution.z);
    let residual = (value - solution.z[0]).abs();
    match solution.outcome {
        Outcome::Failed { .. } => {}
        // A solution there is only near z = 1 or beyond 2; it must be one.
        _ => assert!(residual <= 1e-6 * solution.z[0].abs(), "{solution:?} with residual {residual:e}"),
    }
}
