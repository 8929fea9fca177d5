//! A whole expectation has the same bits on every instruction set and any number of threads.
//!
//! Alone in its program, since the instruction set is that of the whole process. Release builds
//! have all sets, others one.

use std::sync::Arc;

use expectation::{Expect, Expectation};
use mc::Observable;
use real::{Simd, elementary, limit_to};
use systems::{
    Cosine, Problem, RigidBody,
    run_time::{self, Compiled},
};

#[test]
fn an_expectation_has_the_same_bits_on_every_instruction_set() {
    let body = RigidBody::three_noises([2.0, 1.0, 2.0 / 3.0], [1.0, 2.0, 3.0]).unwrap();
    let (damping, y0) = (Cosine::new(0.5, 2.0).unwrap(), [0.45, 0.0, 0.89]);
    let problem = Problem::new(body, damping, y0, 1.0).unwrap();
    let system = Arc::new(Compiled::new(body, y0));
    let at_run_time = run_time::Problem::new(system, Arc::new(damping), y0.to_vec(), 1.0).unwrap();
    let phi = Observable::<3> { name: "cos y3", function: |y| elementary::cos(y[2]) };
    let expectations = |threads: usize| -> [Expectation; 3] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let run_time = Expect::at_run_time(&at_run_time).unwrap();
            [
                Expect::by_parts(&problem).run(&[&phi], 2e-4).unwrap(),
                Expect::new(&problem).run(&[&phi], 2e-4).unwrap(),
                run_time.run(&[&phi], 2e-4).unwrap(),
            ]
        })
    };
    let one = expectations(1);
    assert_eq!(one[1], one[2]);
    for (&level, threads) in Simd::BUILT.iter().zip(2..) {
        limit_to(level);
        assert_eq!(expectations(threads), one, "{level:?}, {threads} threads");
    }
}
