//! A prediction is accepted if its residual bound is below the tolerance, and only then.

use crate::common::{SineMap, difference, norm};
use nonlin::{FirstSweep, FixedPoint, Method, Outcome, Solver};
use real::Real;

/// A contraction with any prediction and any bound.
#[derive(Clone, Copy, Debug)]
pub struct Predicted {
    pub map: SineMap<2>,
    pub prediction: [f64; 2],
    pub bound: f64,
}

impl FixedPoint<2> for Predicted {
    const METHOD: Method = Method::Newton;
    const FIRST_SWEEP: FirstSweep = FirstSweep::Predicted;
    fn start(&self) -> [f64; 2] {
        self.map.start()
    }
    #[inline(always)]
    fn map<R: Real>(&self, z: [R; 2]) -> [R; 2] {
        self.map.map(z)
    }
    #[inline(always)]
    fn predict(&self) -> ([f64; 2], f64) {
        (self.prediction, self.bound)
    }
}

pub fn map() -> SineMap<2> {
    SineMap::new(0.5, &[0.3, -0.8, 0.1, 0.9, -0.4, 0.7, 0.2])
}

#[test]
fn sweeps_start_from_a_prediction_with_a_larger_bound() {
    let map = map();
    let exact = Solver::default().solve(&map).z;
    let near = exact.map(|x| x * (1.0 + 1e-11));
    // ‖z − ψ(z)‖₁ may be 2ε‖z‖₁.
    let allowed = 2.0 * f64::EPSILON * norm(near);
    for bound in [allowed * (1.0 + 4.0 * f64::EPSILON), 1e-9, 1e300] {
        let solution = Solver::default().solve(&Predicted { map, prediction: near, bound });
        // From there one Newton step is enough; from the start it is not.
        assert_eq!(solution.outcome, Outcome::Fast { iterations: 2 }, "{bound}");
        assert!(difference(solution.z, exact) < 1e-14);
    }
    let far = Solver::new(Method::Newton).solve(&map);
    assert!(matches!(far.outcome, Outcome::Fast { iterations } if iterations > 2), "{far:?}");
}

#[test]
fn without_a_finite_bound_sweeps_begin_at_the_start() {
    let map = map();
    let plain = Solver::new(Method::Newton).solve(&map);
    let Outcome::Fast { iterations } = plain.outcome else { panic!("{plain:?}") };
    let exact = plain.z;
    // The prediction is not used, whether it is good or no number at all.
    for prediction in [exact, [f64::NAN, 1.0], [f64::INFINITY; 2]] {
        for bound in [f64::INFINITY, f64::NAN] {
            let solution = Solver::default().solve(&Predicted { map, prediction, bound });
            assert_eq!(solution.z, plain.z);
            assert_eq!(solution.outcome, Outcome::Fast { iterations: 1 + iterations });
        }
    }
}
