//! Where paths fail at every step size, that is said at once.

use expectation::{Expect, WarningKind};
use mc::Observable;
use real::Real;
use systems::{Constant, PoissonSystem, Problem};

use crate::statistical::random_points::warns;

/// p = W, and no step is defined where p is larger than this.
pub struct Walled(pub f64);

impl PoissonSystem<2, 1> for Walled {
    fn name(&self) -> &'static str {
        "walled"
    }
    fn structure<R: Real>(&self, _: [R; 2], v: [R; 2]) -> [R; 2] {
        [v[1], -v[0]]
    }
    fn energy<R: Real>(&self, y: [R; 2], dt: f64, dw: [f64; 1]) -> R {
        (-y[1] + self.0).sqrt() * dt - y[0] * dw[0]
    }
}

#[test]
fn an_accuracy_that_failing_paths_forbid_is_said_after_the_first_levels() {
    let problem = Problem::new(Walled(1.0), Constant::new(0.0).unwrap(), [0.0, 0.0], 4.0).unwrap();
    let phi = Observable { name: "p", function: |y: [f64; 2]| y[1] };
    let found = Expect::new(&problem).run(&[&phi], 0.5).unwrap();
    assert!(!found.reached() && warns(&found, WarningKind::OutOfReach), "{found}");
    assert!(found.to_string().contains("of the paths fails"), "{found}");
    // The first four levels with both schemes: (1 + 3 + 6 + 12) of 4096 paths, from one step and
    // from eight.
    assert!(found.cost <= 4096 * 22 * 9, "{found}");
}
