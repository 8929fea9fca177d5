//! The same checks reject what is wrong on purpose: a method, a system or a claim with one mistake.

use dgrad::midpoint;
use noise::Noise;
use nonlin::{Method, Solver};
use real::Real;
use schemes::{EulerMaruyama, Scheme, Sexp, Step, WithSolver};
use systems::PoissonSystem;

use crate::damping::{Rate, any_rate, changing_rate};
use crate::law::{Conserved, SexpMap, Transition, solver_leaves};
use crate::random::{
    Increments, OneNoise, Several, one_noise, several, share, state, visible_noise,
};
use crate::rounding::{Bounded, dot};
use crate::structure::{
    Casimir, Matrix, any_structure, symmetric_matrix, with_casimir, with_quadratic_casimir,
};

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

fn by_newton() -> WithSolver<Sexp> {
    WithSolver { formula: Sexp, solver: Solver::new(Method::Newton) }
}

/// Shares with the mistake, and without it on the same draws.
fn rejected(what: &str, mistaken: f64, correct: f64) {
    println!("{what}: visible in {mistaken} of the draws, in {correct} without the mistake");
    assert!(mistaken > MOST, "{what}: {mistaken}");
    assert_eq!(correct, 0.0, "{what}");
}

#[test]
fn a_symmetric_part_of_the_structure_is_noticed() {
    let draws = || (any_structure::<4>(), symmetric_matrix::<4>(), state(), state());
    let skew = |spoil: f64| {
        share(CASES, draws(), |(structure, extra, y, v)| {
            let [y, v] = [y, v].map(|x| x.map(Bounded::exact));
            let image = structure.apply(y, v);
            let spoilt = std::array::from_fn(|i| {
                image[i] + dot(extra[i].map(|x| Bounded::exact(spoil * x)), v)
            });
            let form = dot(v, spoilt);
            form.value.abs() > VISIBLE * form.error
        })
    };
    rejected("skewness", skew(1e-3), skew(0.0));

    let draws =
        || (several(with_casimir()), symmetric_matrix(), any_rate(), visible_noise(), state());
    let casimir = |spoil: f64| {
        share(
            CASES,
            draws(),
            |(system, extra, rate, noise, y0): (
                Several<3, 2>,
                Matrix<3>,
                _,
                Increments<2, 1>,
                _,
            )| {
                let extra = extra.map(|row| row.map(|x| spoil * x));
                let twin = Twin { extra, ..Twin::correct(&system) };
                let function = system.structure.base.casimir().unwrap();
                breaks(
                    &by_newton(),
                    &twin,
                    &function,
                    (step(rate, noise.tau), rate),
                    noise.dw[0],
                    y0,
                )
            },
        )
    };
    rejected("symmetric part, Casimir", casimir(1e-3), casimir(0.0));

    let draws = || {
        (
            one_noise(any_structure(), 1..=4),
            symmetric_matrix(),
            any_rate(),
            visible_noise(),
            state(),
        )
    };
    let energy = |spoil: f64| {
        share(
            CASES,
            draws(),
            |(system, extra, rate, noise, y0): (OneNoise<4>, Matrix<4>, _, Increments<1, 1>, _)| {
                let extra = extra.map(|row| row.map(|x| spoil * x));
                let twin = Twin { extra, ..Twin::correct(&system) };
                breaks(
                    &by_newton(),
                    &twin,
                    &system.hamiltonian,
                    (step(rate, noise.tau), rate),
                    noise.dw[0],
                    y0,
                )
            },
        )
    };
    rejected("symmetric part, energy", energy(1e-3), energy(0.0));
}

#[test]
fn the_gradient_at_the_middle_is_noticed_from_degree_three_on() {
    let draws =
        |degrees| (one_noise(any_structure(), degrees), any_rate(), visible_noise(), state());
    let energy = |degrees, one_node| {
        share(
            CASES,
            draws(degrees),
            |(system, rate, noise, y0): (OneNoise<3>, _, Increments<1, 1>, _)| {
                let twin = Twin { one_node, ..Twin::correct(&system) };
                breaks(
                    &by_newton(),
                    &twin,
                    &system.hamiltonian,
                    (step(rate, noise.tau), rate),
                    noise.dw[0],
                    y0,
                )
            },
        )
    };
    rejected("gradient at the middle", energy(3..=4, true), energy(3..=4, false));
    assert_eq!(
        energy(1..=2, true),
        0.0,
        "the average of a linear gradient is its value at the middle"
    );
}

#[test]
fn a_casimir_does_not_notice_the_gradient_at_the_middle() {
    let draws = (several(with_casimir()), any_rate(), visible_noise(), state());
    let broken = share(
        CASES,
        draws,
        |(system, rate, noise, y0): (Several<4, 2>, _, Increments<2, 1>, _)| {
            let twin = Twin { one_node: true, ..Twin::correct(&system) };
            let function = system.structure.base.casimir().unwrap();
            breaks(&by_newton(), &twin, &function, (step(rate, noise.tau), rate), noise.dw[0], y0)
        },
    );
    assert_eq!(broken, 0.0);
}

#[test]
fn damping_over_a_wrong_interval_is_noticed() {
    let draws = || (several(with_casimir()), changing_rate(), visible_noise(), state());
    type Draw = (Several<4, 2>, Rate, Increments<2, 1>, [f64; 4]);
    let with = |mistake: fn(Step, Rate) -> Step| {
        share(CASES, draws(), |(system, rate, noise, y0): Draw| {
            let step = mistake(step(rate, noise.tau), rate);
            let function = system.structure.base.casimir().unwrap();
            breaks(&by_newton(), &system, &function, (step, rate), noise.dw[0], y0)
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
fn a_perturbed_casimir_matrix_is_noticed() {
    let draws = || {
        (
            several(with_quadratic_casimir()),
            symmetric_matrix(),
            any_rate(),
            visible_noise(),
            state(),
        )
    };
    type Draw = (Several<4, 2>, Matrix<4>, Rate, Increments<2, 1>, [f64; 4]);
    let with = |size: f64| {
        share(CASES, draws(), |(system, extra, rate, noise, y0): Draw| {
            let Some(Casimir::Quadratic(mut q)) = system.structure.base.casimir() else {
                panic!("a quadratic Casimir was asked for")
            };
            for i in 0..4 {
                for j in 0..4 {
                    q[i][j] += size * extra[i][j];
                }
            }
            breaks(
                &by_newton(),
                &system,
                &Casimir::Quadratic(q),
                (step(rate, noise.tau), rate),
                noise.dw[0],
                y0,
            )
        })
    };
    rejected("perturbed Casimir", with(1e-3), with(0.0));
}

#[test]
fn euler_maruyama_keeps_no_quadratic_casimir_even_undamped() {
    const UNDAMPED: Rate = Rate::Constant(0.0);
    type Draw = (Several<4, 2>, Increments<2, 1>, [f64; 4]);
    let draws = || (several(with_quadratic_casimir()), visible_noise(), state());
    fn broken<C: Scheme<Several<4, 2>, 4, 2>>(scheme: &C, (system, noise, y0): Draw) -> bool {
        let function = system.structure.base.casimir().unwrap();
        breaks(scheme, &system, &function, (step(UNDAMPED, noise.tau), UNDAMPED), noise.dw[0], y0)
    }
    let em = share(CASES, draws(), |draw| broken(&EulerMaruyama, draw));
    rejected("Euler–Maruyama", em, share(CASES, draws(), |draw| broken(&by_newton(), draw)));
}
