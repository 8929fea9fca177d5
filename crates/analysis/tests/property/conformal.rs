//! `sexp` keeps Casimirs and energies on their conformal law over several steps, `midpoint` keeps
//! Casimirs undamped.

use std::cell::Cell;

use noise::Noise;
use nonlin::{Method, Solver};
use proptest::prelude::*;
use proptest::test_runner::TestCaseResult;
use schemes::{Midpoint, Scheme, Sexp, Step, WithSolver};
use systems::PoissonSystem;

use crate::damping::{Rate, any_rate};
use crate::hamiltonian::MAX_DEGREE;
use crate::law::{Conserved, MidpointMap, SexpMap, Transition, solver_leaves};
use crate::random::{
    Increments, Largest, OneNoise, Several, any_noise, for_all, one_noise, several, state,
};
use crate::rounding::Bounded;
use crate::structure::{any_structure, with_casimir};

const CASES: u32 = 500;
/// Steps of a path.
const STEPS: usize = 4;
/// The largest allowed share of steps that no solver could do: at τ up to 0.9 and with increments
/// at the bound some random equations have no solution that continues the flow.
const UNSOLVED: f64 = 0.02;
/// The largest allowed share of steps that a solver takes for solved although their residual is too
/// large: the fixed point takes an iterate that comes back from far away for fast contraction. One
/// in 20 000 random steps does.
const LOOSE: f64 = 0.001;
/// Bounds are worst cases, and count what a solver may leave in the rarest case.
const SHARP: f64 = 0.01;

/// Follows paths and counts what became of their steps.
#[derive(Default)]
struct Tally {
    steps: Cell<u32>,
    unsolved: Cell<u32>,
    loose: Cell<u32>,
    /// Of a single step, and of all steps so far.
    one: Largest,
    all: Largest,
}

fn count(cell: &Cell<u32>) {
    cell.set(cell.get() + 1);
}

impl Tally {
    /// Drives `function` along a path of `sexp`; a path ends with a step that is not solved to
    /// round-off.
    fn follow<S: PoissonSystem<D, M>, F: Conserved<D>, const D: usize, const M: usize>(
        &self,
        system: &S,
        function: &F,
        method: Method,
        (rate, n): (Rate, u64),
        noise: Increments<M, STEPS>,
        y0: [f64; D],
    ) -> TestCaseResult {
        let sexp = WithSolver { formula: Sexp, solver: Solver::new(method) };
        let damping = rate.damping();
        let value = |y: [f64; D]| function.value(y.map(Bounded::exact)).value;
        let (mut y, mut law, mut allowed) = (y0, 1.0, 0.0);
        for (k, dw) in noise.dw.into_iter().enumerate() {
            let step = Step::new(damping.as_ref(), n + k as u64, noise.tau).unwrap();
            let solution = sexp.step(system, &step, &Noise::increments(dw), y);
            count(&self.steps);
            if !solution.outcome.converged() {
                count(&self.unsolved);
                return Ok(());
            }
            let transition = Transition { step, y0: y, y1: solution.z };
            let map = SexpMap { system, tau: step.tau, dw, before: transition.before() };
            let verdict = transition.judge(function, &map, rate, solver_leaves(method));
            if !verdict.solved {
                count(&self.loose);
                return Ok(());
            }
            self.one.check(verdict.defect, verdict.allowed)?;
            y = solution.z;
            // Defects of earlier steps are damped like the function itself.
            law *= verdict.law;
            allowed = verdict.law * allowed + verdict.allowed;
            self.all.check((value(y) - law * value(y0)).abs(), allowed)?;
        }
        Ok(())
    }

    fn report(&self, what: &str) {
        let [steps, unsolved, loose] =
            [&self.steps, &self.unsolved, &self.loose].map(|cell| f64::from(cell.get()));
        println!("{what}: of {steps} steps {unsolved} unsolved, {loose} loose");
        assert!(
            unsolved <= UNSOLVED * steps && loose <= LOOSE * steps,
            "{what}: {unsolved} {loose} of {steps}"
        );
        self.one.report(&format!("{what}, one step"), SHARP);
        self.all.report(&format!("{what}, several steps"), SHARP);
    }
}

/// Step numbers: at τ = 0.9 the last one starts after t = 40.
const NUMBERS: std::ops::Range<u64> = 0..50;

fn any_method() -> impl Strategy<Value = Method> {
    prop_oneof![Just(Method::FixedPoint), Just(Method::Newton)]
}

fn casimirs<const D: usize, const M: usize>() {
    let tally = Tally::default();
    let draws =
        (several(with_casimir()), any_method(), (any_rate(), NUMBERS), any_noise(), state());
    for_all(CASES, draws, |(system, method, damping, noise, y0): (Several<D, M>, _, _, _, _)| {
        let casimir = system.structure.base.casimir().unwrap();
        tally.follow(&system, &casimir, method, damping, noise, y0)
    });
    tally.report(&format!("Casimir, D = {D}, M = {M}"));
}

#[test]
fn sexp_keeps_every_casimir() {
    casimirs::<3, 1>();
    casimirs::<3, 3>();
    casimirs::<4, 2>();
    casimirs::<5, 2>();
}

fn energies<const D: usize>() {
    let tally = Tally::default();
    let draws = (
        one_noise(any_structure(), 1..=MAX_DEGREE),
        any_method(),
        (any_rate(), NUMBERS),
        any_noise(),
        state(),
    );
    for_all(CASES, draws, |(system, method, damping, noise, y0): (OneNoise<D>, _, _, _, _)| {
        tally.follow(&system, &system.hamiltonian, method, damping, noise, y0)
    });
    tally.report(&format!("energy, D = {D}"));
}

#[test]
fn sexp_keeps_every_homogeneous_energy() {
    energies::<2>();
    energies::<3>();
    energies::<4>();
    energies::<5>();
}

fn undamped_midpoint<const D: usize>() {
    const UNDAMPED: Rate = Rate::Constant(0.0);
    let (largest, unsolved) = (Largest::default(), Cell::new(0));
    let draws = (several(with_casimir()), any_method(), any_noise(), state());
    for_all(
        CASES,
        draws,
        |(system, method, noise, y0): (Several<D, 2>, _, Increments<2, 1>, _)| {
            let [dw] = noise.dw;
            let step = Step::new(UNDAMPED.damping().as_ref(), 0, noise.tau).unwrap();
            let solution = WithSolver { formula: Midpoint, solver: Solver::new(method) }.step(
                &system,
                &step,
                &Noise::increments(dw),
                y0,
            );
            let transition = Transition { step, y0, y1: solution.z };
            let map = MidpointMap(SexpMap { system: &system, tau: step.tau, dw, before: y0 });
            let casimir = system.structure.base.casimir().unwrap();
            let verdict = transition.judge(&casimir, &map, UNDAMPED, solver_leaves(method));
            if !solution.outcome.converged() || !verdict.solved {
                count(&unsolved);
                return Ok(());
            }
            largest.check(verdict.defect, verdict.allowed)
        },
    );
    println!("midpoint, D = {D}: {} of {CASES} steps unsolved", unsolved.get());
    assert!(f64::from(unsolved.get()) <= UNSOLVED * f64::from(CASES));
    largest.report(&format!("undamped midpoint, Casimir, D = {D}"), SHARP);
}

#[test]
fn midpoint_keeps_every_casimir_undamped() {
    undamped_midpoint::<3>();
    undamped_midpoint::<4>();
    undamped_midpoint::<5>();
}
