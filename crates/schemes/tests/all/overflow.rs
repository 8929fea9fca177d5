//! A state that leaves the numbers in the second half of the damping is no solution, though the
//! equation was solved.

use noise::{BlockNoise, Noise};
use nonlin::{BlockStatus, Outcome};
use real::{Block, Real};
use schemes::{Scheme, Sexp, SexpLevy, Step};
use systems::{Constant, PoissonSystem};

/// Nothing but damping.
struct Still;

impl PoissonSystem<2, 1> for Still {
    fn name(&self) -> &'static str {
        "still"
    }
    #[inline(always)]
    fn structure<R: Real>(&self, _y: [R; 2], _v: [R; 2]) -> [R; 2] {
        [R::zero(); 2]
    }
    #[inline(always)]
    fn energy<R: Real>(&self, _y: [R; 2], _dt: f64, _dw: [f64; 1]) -> R {
        R::zero()
    }
}

#[test]
fn overflow_in_the_second_half_is_a_failure() {
    // Each half multiplies by e^{±370} = 5·10^{±160}.
    let growing = Step::new(&Constant::new(-1480.0).unwrap(), 0, 0.5).unwrap();
    let shrinking = Step::new(&Constant::new(1480.0).unwrap(), 0, 0.5).unwrap();
    let schemes: [&dyn Scheme<Still, 2, 1>; 2] = [&Sexp, &SexpLevy::new(&Still, [1.0, 1.0])];
    for scheme in schemes {
        for (step, y, fails) in
            [(&growing, 1e-10, true), (&growing, 1e-15, false), (&shrinking, 1e140, false)]
        {
            let large = [1e-20, -y];
            let alone = scheme.step(&Still, step, &Noise::increments([0.1]), large);
            assert_eq!(
                matches!(alone.outcome, Outcome::Failed { .. }),
                fails,
                "{} {y}",
                scheme.id()
            );

            let mut block = Block::splat([1e-20, 1e-20]);
            block.set_path(7, large);
            let mut status = BlockStatus::explicit();
            let dw = Block::splat([0.1]);
            let noise = BlockNoise::increments(&dw.0);
            scheme.step_block(&Still, step, &noise, &mut block, &mut status);
            assert_eq!(
                status.failed.paths().collect::<Vec<_>>(),
                if fails { vec![7] } else { vec![] },
                "{y}"
            );
            assert_eq!(block.path(7), alone.z);
            assert_eq!(
                block.path(8),
                scheme.step(&Still, step, &Noise::increments([0.1]), [1e-20, 1e-20]).z
            );
        }
    }
}
