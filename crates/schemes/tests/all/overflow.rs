//! A state that leaves the numbers in the second half of the damping is no solution, though the
//! equation was solved.

use noise::{BlockNoise, Noise};
use nonlin::{BlockStatus, Outcome};
use real::Block;
use schemes::{Scheme, Sexp, SexpLevy, Step};
use systems::Constant;

use crate::stiff_damping::Alone;

#[test]
fn overflow_in_the_second_half_is_a_failure() {
    // Each half multiplies by e^{±370} = 5·10^{±160}.
    let growing = Step::new(&Constant::new(-1480.0).unwrap(), 0, 0.5).unwrap();
    let shrinking = Step::new(&Constant::new(1480.0).unwrap(), 0, 0.5).unwrap();
    let schemes: [&dyn Scheme<Alone, 2, 1>; 2] = [&Sexp, &SexpLevy::new(&Alone, [1.0, 1.0])];
    for scheme in schemes {
        for (step, y, fails) in
            [(&growing, 1e-10, true), (&growing, 1e-15, false), (&shrinking, 1e140, false)]
        {
            let large = [1e-20, -y];
            let alone = scheme.step(&Alone, step, &Noise::increments([0.1]), large);
            let failed = matches!(alone.outcome, Outcome::Failed { .. });
            assert_eq!(failed, fails, "{} {y}", scheme.about().id);

            let mut block = Block::splat([1e-20, 1e-20]);
            block.set_path(7, large);
            let mut status = BlockStatus::explicit();
            let dw = Block::splat([0.1]);
            let noise = BlockNoise::increments(&dw.0);
            scheme.step_block(&Alone, step, &noise, &mut block, &mut status);
            assert_eq!(status.failed.contains(7), fails, "{y}");
            assert!(!status.failed.contains(8));
            assert_eq!(block.path(7), alone.z);
            assert_eq!(
                block.path(8),
                scheme.step(&Alone, step, &Noise::increments([0.1]), [1e-20, 1e-20]).z
            );
        }
    }
}
