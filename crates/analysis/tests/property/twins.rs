//! The same checks reject what is wrong on purpose: a method, a system or a claim with one mistake.

use dgrad::midpoint;
use noise::Noise;
use nonlin::{Method, Solver};
use proptest::strategy::Strategy;
use real::Real;
use schemes::{EulerMaruyama, Scheme, Sexp, Step, WithSolver};
use systems::PoissonSystem;

use crate::damping::{Rate, changing_rate};
use crate::law::{Conserved, SexpMap, Transition, solver_leaves};
use crate::random::{Increments, Several, one_noise, several, share, state, visible_noise};
use crate::rounding::dot;
use crate::structure::{Casimir, Matrix, any_structure, symmetric_matrix, with_quadratic_casimir};

const CASES: u32 = 300;
/// A defect is visible when it is this many times the tolerance.
const VISIBLE: f64 = 1000.0;
/// The share of draws in which the mistake must be visible. The others are those where it has no
/// effect: noise close to zero, monomials that do not depend on what was changed, scales of a
/// rank-deficient Casimir.
const MOST: f64 = 0.8;

/// A system with one mistake.
struct Twin<'a, S, const D: usize> {
    system: &'a S,
    /// Added to B.
    extra: Matrix<D>,
    /// ∇h at the middle in place of its average.
    one_node: bool,
}

impl<'a, S, const D: usize> Twin<'a, S, D> {
    fn correct(system: &'a S) -> Self {
        Self { system, extra: [[0.0; D]; D], one_node: false }
    }
}

impl<S: PoissonSystem<D, M>, const D: usize, const M: usize> PoissonSystem<D, M>
    for Twin<'_, S, D>
{
    fn name(&self) -> &'static str {
        "twin"
    }
    fn structure<R: Real>(&self, y: [R; D], v: [R; D]) -> [R; D] {
        let right = self.system.structure(y, v);
        std::array::from_fn(|i| right[i] + dot(self.extra[i].map(R::constant), v))
    }
    fn energy<R: Real>(&self, y: [R; D], dt: f64, dw: [f64; M]) -> R {
        self.system.energy(y, dt, dw)
    }
    fn averaged_gradient<R: Real>(&self, a: [R; D], b: [R; D], dt: f64, dw: [f64; M]) -> [R; D] {
        if self.one_node {
            self.system.gradient(midpoint(a, b), dt, dw)
        } else {
            self.system.averaged_gradient(a, b, dt, dw)
        }
    }
}

/// Step number 5 of size τ.
fn step(rate: Rate, tau: f64) -> Step {
    Step::new(rate.damping().as_ref(), 5, tau).unwrap()
}

/// Whether a step of `scheme` on `system` visibly breaks the law of `function`, by the measure that
/// `sexp` meets.
fn breaks<S: PoissonSystem<D, M>, C: Scheme<S, D, M>, const D: usize, const M: usize>(
    scheme: &C,
    system: &S,
    function: &impl Conserved<D>,
    (step, rate): (Step, Rate),
    dw: [f64; M],
    y0: [f64; D],
) -> bool {
    let y1 = scheme.step(system, &step, &Noise::increments(dw), y0).z;
    let transition = Transition { step, y0, y1 };
    let map = SexpMap { system, tau: step.tau, dw, before: transition.before() };
    let verdict = transition.judge(function, &map, rate, solver_leaves(Method::Newton));
    verdict.defect > VISIBLE * verdict.allowed
}

fn sexp() -> WithSolver<Sexp> {
    WithSolver { formula: Sexp, solver: Solver::new(Method::Newton) }
}

/// Shares with the mistake, and without it on the same draws.
fn rejected(what: &str, mistaken: f64, correct: f64) {
    println!("{what}: visible in {mistaken} of the draws, in {correct} without the mistake");
    assert!(mistaken > MOST, "{what}: {mistaken}");
    assert_eq!(correct, 0.0, "{what}");
}

/// A system, a symmetric matrix, a damping, the noise of a step and where it begins.
struct Draw<S, const M: usize> {
    system: S,
    extra: Matrix<4>,
    rate: Rate,
    tau: f64,
    dw: [f64; M],
    y0: [f64; 4],
}

impl<S, const M: usize> Draw<S, M> {
    fn step(&self) -> (Step, Rate) {
        (step(self.rate, self.tau), self.rate)
    }

    /// The matrix times a factor.
    fn extra(&self, factor: f64) -> Matrix<4> {
        self.extra.map(|row| row.map(|x| factor * x))
    }
}

/// The share of draws that are broken.
fn broken<S: std::fmt::Debug, const M: usize>(
    systems: impl Strategy<Value = S>,
    is_broken: impl Fn(&Draw<S, M>) -> bool,
) -> f64 {
    let draws = (systems, symmetric_matrix(), changing_rate(), visible_noise(), state());
    let check = |(system, extra, rate, noise, y0): (S, _, _, Increments<M, 1>, _)| {
        is_broken(&Draw { system, extra, rate, tau: noise.tau, dw: noise.dw[0], y0 })
    };
    share(CASES, draws, check)
}

type WithCasimir = Several<4, 2>;

fn casimir(system: &WithCasimir) -> Casimir<4> {
    system.structure.base.casimir().unwrap()
}

fn casimirs(is_broken: impl Fn(&Draw<WithCasimir, 2>) -> bool) -> f64 {
    broken(several(with_quadratic_casimir()), is_broken)
}

type WithEnergy = Several<4, 1>;

fn energies(
    degrees: std::ops::RangeInclusive<usize>,
    is_broken: impl Fn(&Draw<WithEnergy, 1>) -> bool,
) -> f64 {
    broken(one_noise(any_structure(), degrees), is_broken)
}

#[test]
fn a_symmetric_part_of_the_structure_is_noticed() {
    let of = |factor: f64| {
        casimirs(|draw| {
            let twin = Twin { extra: draw.extra(factor), ..Twin::correct(&draw.system) };
            breaks(&sexp(), &twin, &casimir(&draw.system), draw.step(), draw.dw, draw.y0)
        })
    };
    rejected("symmetric part, Casimir", of(1e-3), of(0.0));
    let of = |factor: f64| {
        energies(1..=4, |draw| {
            let twin = Twin { extra: draw.extra(factor), ..Twin::correct(&draw.system) };
            let energy = &draw.system.drift.polynomial();
            breaks(&sexp(), &twin, energy, draw.step(), draw.dw, draw.y0)
        })
    };
    rejected("symmetric part, energy", of(1e-3), of(0.0));
}

#[test]
fn the_gradient_at_the_middle_is_noticed_by_energies_from_degree_three_on() {
    let of = |degrees, one_node| {
        energies(degrees, |draw| {
            let twin = Twin { one_node, ..Twin::correct(&draw.system) };
            let energy = &draw.system.drift.polynomial();
            breaks(&sexp(), &twin, energy, draw.step(), draw.dw, draw.y0)
        })
    };
    rejected("gradient at the middle", of(3..=4, true), of(3..=4, false));
    // The average of a linear gradient is its value at the middle, and a Casimir does not notice.
    assert_eq!(of(1..=2, true), 0.0);
    let broken = casimirs(|draw| {
        let twin = Twin { one_node: true, ..Twin::correct(&draw.system) };
        breaks(&sexp(), &twin, &casimir(&draw.system), draw.step(), draw.dw, draw.y0)
    });
    assert_eq!(broken, 0.0);
}

#[test]
fn damping_over_a_wrong_interval_is_noticed() {
    let with = |mistake: fn(Step, Rate) -> Step| {
        casimirs(|draw| {
            let (step, rate) = draw.step();
            let step = (mistake(step, rate), rate);
            breaks(&sexp(), &draw.system, &casimir(&draw.system), step, draw.dw, draw.y0)
        })
    };
    let first_half_twice = with(|mut step, _| {
        step.second_decay = step.first_decay;
        step
    });
    let next_step = with(|step, rate| {
        let mut next = Step::new(rate.damping().as_ref(), 6, step.tau).unwrap();
        next.t = step.t;
        next
    });
    let correct = with(|step, _| step);
    rejected("first half twice", first_half_twice, correct);
    rejected("integral of the next step", next_step, correct);
}

#[test]
fn a_perturbed_casimir_and_a_scheme_that_keeps_none_are_noticed() {
    let with = |size: f64| {
        casimirs(|draw| {
            let Casimir::Quadratic(mut q) = casimir(&draw.system) else {
                panic!("a quadratic Casimir was asked for")
            };
            for (row, extra) in q.iter_mut().zip(draw.extra(size)) {
                row.iter_mut().zip(extra).for_each(|(q, extra)| *q += extra);
            }
            let claim = Casimir::Quadratic(q);
            breaks(&sexp(), &draw.system, &claim, draw.step(), draw.dw, draw.y0)
        })
    };
    rejected("perturbed Casimir", with(1e-3), with(0.0));
    // Even without damping.
    const UNDAMPED: Rate = Rate::Constant(0.0);
    fn undamped<C: Scheme<WithCasimir, 4, 2>>(scheme: &C) -> f64 {
        casimirs(|draw| {
            let step = (step(UNDAMPED, draw.tau), UNDAMPED);
            breaks(scheme, &draw.system, &casimir(&draw.system), step, draw.dw, draw.y0)
        })
    }
    rejected("Euler–Maruyama", undamped(&EulerMaruyama), undamped(&sexp()));
}
