//! `sexp` keeps Casimirs and energies on their conformal law over several steps, `sexp-li` Casimirs
//! for increments of all sizes.

use std::cell::Cell;

use noise::Noise;
use nonlin::{Method, Solver};
use proptest::prelude::*;
use proptest::test_runner::TestCaseResult;
use schemes::{Scheme, Sexp, SexpLi, Step, WithSolver};
use systems::PoissonSystem;

use crate::damping::{Rate, any_rate};
use crate::hamiltonian::MAX_DEGREE;
use crate::law::{Conserved, SexpMap, Transition, solver_leaves};
use crate::random::{Increments, Largest, Several, any_noise, for_all, one_noise, several, state};
use crate::rounding::{Bounded, exact};
use crate::structure::{
    Base, Casimir, Scale, Structure, any_structure, symmetric_matrix, with_casimir,
};

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
    prop::sample::select(&[Method::FixedPoint, Method::Newton][..])
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
    casimirs::<4, 2>();
    casimirs::<5, 3>();
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
    for_all(CASES, draws, |(system, method, damping, noise, y0): (Several<D, 1>, _, _, _, _)| {
        tally.follow(&system, &system.drift.polynomial(), method, damping, noise, y0)
    });
    tally.report(&format!("energy, D = {D}"));
}

#[test]
fn sexp_keeps_every_homogeneous_energy() {
    energies::<2>();
    energies::<5>();
}

#[test]
fn sexp_li_keeps_random_casimirs() {
    let largest = Largest::default();
    // v × ∇C with C = ½yᵀQy, for increments of all sizes.
    let structures = symmetric_matrix().prop_map(|q| {
        let base = Base::Cross(Casimir::Quadratic(q));
        Structure { scale: Scale::One, base }
    });
    let draws = (several(structures), any_rate(), 0..50u64, (-3.0..0.0f64, -3.0..3.0f64), state());
    for_all(CASES, draws, |(system, rate, n, (tau, size), y): (Several<3, 1>, _, _, _, _)| {
        let (tau, dw) = (10f64.powf(tau), [size.powi(3)]);
        let step = Step::new(rate.damping().as_ref(), n, tau).unwrap();
        let scheme = SexpLi::new(&system, y).unwrap();
        let solution = scheme.step(&system, &step, &Noise::increments(dw), y);
        // The same equation with error bounds. v is that of the scheme up to rounding, and the
        // Casimir does not depend on it.
        let start = y.map(|x| x * step.first_decay);
        let field: [f64; 3] = system.structure(start, system.gradient(start, tau, dw));
        let middle: [f64; 3] = std::array::from_fn(|i| start[i] + 0.5 * field[i]);
        let gradient: [f64; 3] = system.gradient(middle, tau, dw);
        let far: [f64; 3] = system.structure(middle, gradient);
        let v =
            system.averaged_gradient(start, std::array::from_fn(|i| start[i] + far[i]), tau, dw);
        let z = system.cayley(exact(start), exact(v));
        prop_assume!(z.iter().all(|x| x.error < 1e-3 * (1.0 + x.value.abs())));
        prop_assert!(solution.outcome.converged());
        let casimir = system.structure.base.casimir().unwrap();
        let value = |y: [Bounded; 3]| casimir.value(y);
        let decay = Bounded {
            error: f64::EPSILON * step.second_decay,
            ..Bounded::exact(step.second_decay)
        };
        let end = value(z.map(|x| x * decay));
        let law = value(exact(start)) * decay * decay;
        let defect = value(exact(solution.z)) - law;
        largest.check(defect.value.abs(), defect.error + 2.0 * end.error)
    });
    largest.report("sexp-li, random quadratic Casimirs", SHARP);
}
