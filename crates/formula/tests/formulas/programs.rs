//! A scheme's formula as one tape has the bits of its operations one by one.

use std::ops::Range;

use formula::FormulaSystem;
use noise::StepNoise;
use nonlin::BlockStatus;
use real::{Row, WIDTH};
use schemes::{EulerMaruyama, Heun, Midpoint, Sexp, SexpLi, Step, run_time::Scheme};
use systems::{
    Constant,
    run_time::{Description, MAX_INPUTS, Op, Recorded, System, Weights},
};

use crate::{expression::Random, paper};

/// A system that does not compile formulas of schemes.
struct OneByOne<'a>(&'a FormulaSystem);

impl System for OneByOne<'_> {
    fn description(&self) -> &Description {
        self.0.description()
    }
    fn apply(
        &self,
        op: Op<&[Row]>,
        tile: Range<usize>,
        h: Weights<'_>,
        out: &mut [Row],
        scratch: &mut [Row],
    ) {
        self.0.apply(op, tile, h, out, scratch);
    }
    fn energy(&self, y: &[Row], h: Weights<'_>, out: &mut Row, scratch: &mut [Row]) {
        self.0.energy(y, h, out, scratch);
    }
}

/// Some steps from near `y0`.
fn path(scheme: &dyn Scheme, system: &dyn System, y0: &[f64]) -> Vec<Row> {
    let mut random = Random::new(17);
    let mut stepper = scheme.stepper(system).unwrap();
    for (row, y) in stepper.state_mut().iter_mut().zip(y0) {
        *row = [(); WIDTH].map(|()| y + 0.05 * random.number());
    }
    let damping = Constant::new(0.3).unwrap();
    for n in 0..5 {
        let step = Step::new(&damping, n, 0.01).unwrap();
        let mut noise = StepNoise::zero(system.description().noises);
        noise.increments.iter_mut().flatten().for_each(|dw| *dw = 0.05 * random.number());
        let mut status = BlockStatus::explicit();
        stepper.step(&step, &noise, &mut status);
        assert!(status.failed.is_empty(), "{}: {status:?}", scheme.about().id);
    }
    stepper.state().to_vec()
}

/// Formulas of schemes and their programs have the same limit.
#[test]
fn a_formula_has_at_most_so_many_inputs() {
    let system = FormulaSystem::new(&paper::pendulum(0.5), &[1.0, 1.2]).unwrap();
    let compiles = |inputs: usize| {
        let mut nodes: Vec<Recorded> = (0..inputs).map(Recorded::Input).collect();
        nodes.push(Recorded::Sum(0, inputs - 1));
        system.compile(&nodes, inputs, &[inputs]).is_some()
    };
    assert!(compiles(MAX_INPUTS) && !compiles(MAX_INPUTS + 1));
}

#[test]
fn a_formula_in_one_piece_has_the_bits_of_its_operations() {
    let y3 = [1.0, 1.2, 0.8];
    let (inertia, noise) = ([2.0, 1.0, 2.0 / 3.0], [1.0, 2.0, 3.0]);
    let definitions = [
        (paper::rigid_body(inertia, noise), &y3[..]),
        (paper::pendulum(0.5), &y3[..2]),
        (paper::lotka_volterra(0.5), &y3[..]),
        (paper::maxwell_bloch(), &y3[..]),
        (paper::poisson3(0.5), &y3[..]),
    ];
    for (definition, y0) in definitions {
        let system = FormulaSystem::new(&definition, y0).unwrap();
        let linear = SexpLi::at_run_time(&system);
        let mut schemes: Vec<&dyn Scheme> = vec![&EulerMaruyama, &Heun, &Sexp, &Midpoint];
        schemes.extend(linear.iter().map(|linear| linear as &dyn Scheme));
        for scheme in schemes {
            let one = path(scheme, &system, y0);
            let other = path(scheme, &OneByOne(&system), y0);
            assert_eq!(one, other, "{} on {}", scheme.about().id, definition.name);
        }
    }
}
