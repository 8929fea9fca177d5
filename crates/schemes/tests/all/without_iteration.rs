//! Schemes that keep Casimirs without iteration: `sexp-li` and `split`.

use crate::common::{
    Numbers, Visit, any_damping, any_increments, any_state, any_step, conformal_defect,
    exact_systems, spins,
};
use noise::Noise;
use schemes::{Scheme, SexpLi, Split};
use systems::{Flows, Form, InvariantKind, PoissonSystem};

const SAMPLES: usize = 2000;
/// In the units of [`conformal_defect`]: rounding alone, there is no solver.
const ALLOWED: f64 = 4.0;

struct KeepsCasimirs(usize);

impl KeepsCasimirs {
    fn check<S: PoissonSystem<D, M>, const D: usize, const M: usize>(
        &mut self,
        scheme: &dyn Scheme<S, D, M>,
        system: &S,
        y0: [f64; D],
    ) {
        let mut numbers = Numbers(8);
        for _ in 0..SAMPLES {
            let damping = any_damping(&mut numbers);
            let step = any_step(&mut numbers, damping.as_ref());
            let dw = any_increments(&mut numbers, step.tau);
            let y = any_state(&mut numbers, system, y0);
            let solution = scheme.step(system, &step, &Noise::increments(dw), y);
            assert!(solution.outcome.converged());
            for (index, invariant) in system.invariants().iter().enumerate() {
                if invariant.kind == InvariantKind::Casimir {
                    let defect = conformal_defect(system, index, &step, dw, y, solution.z);
                    let name = system.name();
                    assert!(defect <= ALLOWED, "{} {name} {index}: {defect}", scheme.id());
                    self.0 += 1;
                }
            }
        }
    }
}

impl Visit for KeepsCasimirs {
    fn visit<S: PoissonSystem<D, M>, const D: usize, const M: usize>(
        &mut self,
        system: &S,
        y0: [f64; D],
    ) {
        let scheme = SexpLi::new(system, y0).unwrap();
        self.check(&scheme, system, y0);
    }
}

#[test]
fn casimirs_are_kept_by_linearly_implicit_steps() {
    let mut keeps = KeepsCasimirs(0);
    exact_systems(&mut keeps);
    keeps.visit(&spins(), [0.6, 0.0, 0.8, 0.0, 1.0, 0.0]);
    assert!(keeps.0 > 8 * SAMPLES);
}
