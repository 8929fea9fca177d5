//! `sexp` keeps every claimed invariant on its conformal law: to round-off, in every step, for
//! every step size, damping and outcome of the noise. And wrong schemes do not, by the same
//! measure.

use crate::common::{
    INERTIA, Numbers, Visit, any_damping, any_increments, any_state, any_step, body,
    conformal_defect, every_system, populations_1, populations_2,
};
use kernels::Tuned;
use noise::Noise;
use nonlin::{Method, Outcome, Solver};
use real::Real;
use schemes::{BuiltIn, EulerMaruyama, Midpoint, Scheme, Sexp, Step, WithSolver};
use systems::{
    Constant, ImplicitStep, Invariant, MaxwellBloch, Pendulum, Poisson3, PoissonSystem,
    RigidBodyEnergy, vector_field,
};

/// Largest defect in the units of [`conformal_defect`]. Newton solves to the rounding of the
/// equation: each of the terms counted there is rounded at most four times, half an ε each.
const NEWTON: f64 = 2.0;
/// The fixed point stops at a residual that it foresees from two changes; where modes that contract
/// differently mix it may leave more than it meant to, in rare cases and up to this many ε (see the
/// tests of `nonlin`).
const FIXED_POINT: f64 = 256.0;
/// Half of all steps must be within this, whatever the solver.
const TYPICAL: f64 = 0.5;

const SAMPLES: usize = 4000;

/// All claims of all systems that are exact.
struct KeepsTheLaw {
    invariants: usize,
}

impl Visit for KeepsTheLaw {
    fn visit<S: Tuned<D, M>, const D: usize, const M: usize>(&mut self, system: &S, y0: [f64; D]) {
        let allowed = match S::IMPLICIT_STEP {
            ImplicitStep::FixedPoint | ImplicitStep::UnrolledFixedPoint => FIXED_POINT,
            ImplicitStep::Newton | ImplicitStep::Predicted => NEWTON,
        };
        let mut numbers = Numbers(5);
        let claims = system.invariants();
        let sexp = S::scheme(BuiltIn::Sexp, system, y0).unwrap();
        let mut defects = vec![Vec::new(); claims.len()];
        let mut unsolved = 0;
        for _ in 0..SAMPLES {
            let damping = any_damping(&mut numbers);
            let step = any_step(&mut numbers, damping.as_ref());
            let dw = any_increments(&mut numbers, step.tau);
            let y = any_state(&mut numbers, system, y0);
            let solution = sexp.step(system, &step, &Noise::increments(dw), y);
            if let Outcome::Failed { .. } = solution.outcome {
                unsolved += 1;
                continue;
            }
            for index in 0..claims.len() {
                let defect = conformal_defect(system, index, &step, dw, y, solution.z);
                let name = system.name();
                assert!(defect <= allowed, "{name}: {defect} at {step:?} {dw:?} {y:?}");
                defects[index].push(defect);
            }
        }
        // Truncated increments make nearly every step solvable, even at the largest step size.
        assert!(unsolved <= SAMPLES / 1000, "{}: {unsolved}", system.name());
        for mut sorted in defects {
            self.invariants += 1;
            sorted.sort_by(f64::total_cmp);
            assert!(sorted[sorted.len() / 2] < TYPICAL);
        }
    }
}

#[test]
fn every_invariant_of_every_system() {
    let mut keeps = KeepsTheLaw { invariants: 0 };
    every_system(&mut keeps);
    // Rigid body 1 + 1 + 2, Lotka–Volterra 2 + 2, Maxwell–Bloch 1, Poisson3 2.
    assert_eq!(keeps.invariants, 11);
}

/// What a twin is measured on: as many ε as make a visible defect, 10⁶ε ≈ 2·10⁻¹⁰.
const VISIBLE: f64 = 1e6;

/// The share of steps with a visible defect, for steps taken by `advance`. Rates of damping are one
/// and steps are 0.05, where a defect is a matter of the order of the scheme and not of the size of
/// the step.
fn visible<S: PoissonSystem<D, M>, const D: usize, const M: usize>(
    system: &S,
    index: usize,
    y0: [f64; D],
    advance: impl Fn(&S, &Step, [f64; M], [f64; D]) -> [f64; D],
) -> f64 {
    let damping = systems::Sine::new(1.0, 1.0).unwrap();
    let mut numbers = Numbers(6);
    let samples = 400;
    let mut count = 0;
    for n in 0..samples {
        let step = Step::new(&damping, 10 + n, 0.05).unwrap();
        let dw = any_increments(&mut numbers, step.tau);
        let y = any_state(&mut numbers, system, y0);
        let y1 = advance(system, &step, dw, y);
        count += u32::from(conformal_defect(system, index, &step, dw, y, y1) > VISIBLE);
    }
    f64::from(count) / samples as f64
}

/// All but a few steps: those where the defect happens to pass through zero.
const NEARLY_ALL: f64 = 0.9;

fn sexp<S: PoissonSystem<D, M>, const D: usize, const M: usize>(
    system: &S,
    step: &Step,
    dw: [f64; M],
    y: [f64; D],
) -> [f64; D] {
    Sexp.step(system, step, &Noise::increments(dw), y).z
}

#[test]
fn wrong_schemes_break_the_law() {
    fn euler<S: PoissonSystem<D, M>, const D: usize, const M: usize>(
        system: &S,
        step: &Step,
        dw: [f64; M],
        y: [f64; D],
    ) -> [f64; D] {
        let before = y.map(|x| step.first_decay * x);
        let field = vector_field(system, before, step.tau, dw);
        std::array::from_fn(|i| step.second_decay * (before[i] + field[i]))
    }
    // The factor of the first half used for both. Both factors before the step keep the law; what
    // they break is the order, see `order.rs`.
    let wrong_half = |system: &_, step: &Step, dw, y| {
        let mut wrong = *step;
        wrong.second_decay = step.first_decay;
        sexp(system, &wrong, dw, y)
    };
    let em = |system: &_, step: &Step, dw, y| {
        EulerMaruyama.step(system, step, &Noise::increments(dw), y).z
    };
    let midpoint =
        |system: &_, step: &Step, dw, y| Midpoint.step(system, step, &Noise::increments(dw), y).z;
    for share in [
        visible(&body(), 0, [0.5; 3], wrong_half),
        visible(&body(), 0, [0.5; 3], em),
        visible(&body(), 0, [0.5; 3], midpoint),
        visible(&body(), 0, [0.5; 3], euler),
        visible(&MaxwellBloch, 0, [1.0, 2.0, 3.0], euler),
        visible(&populations_2(), 0, [1.0; 3], euler),
    ] {
        assert!(share > NEARLY_ALL, "{share}");
    }
    // A linear Casimir is kept by anything that stays in the image of B, and `sexp` keeps all.
    assert_eq!(visible(&populations_2(), 1, [1.0; 3], euler), 0.0);
    assert_eq!(visible(&body(), 0, [0.5; 3], sexp), 0.0);
    assert_eq!(visible(&populations_2(), 0, [1.0; 3], sexp), 0.0);
}

/// A system with one part replaced.
struct Twin<S> {
    system: S,
    /// ∇̄h by the gradient at the midpoint: the quadrature with one node.
    one_node: bool,
    /// The last component of B(y)v with the wrong sign.
    wrong_sign: bool,
}

impl<S: PoissonSystem<D, M>, const D: usize, const M: usize> PoissonSystem<D, M> for Twin<S> {
    fn name(&self) -> &'static str {
        self.system.name()
    }
    fn structure<R: Real>(&self, y: [R; D], v: [R; D]) -> [R; D] {
        let mut b = self.system.structure(y, v);
        if self.wrong_sign {
            b[D - 1] = -b[D - 1];
        }
        b
    }
    fn energy<R: Real>(&self, y: [R; D], dt: f64, dw: [f64; M]) -> R {
        self.system.energy(y, dt, dw)
    }
    fn gradient<R: Real>(&self, y: [R; D], dt: f64, dw: [f64; M]) -> [R; D] {
        self.system.gradient(y, dt, dw)
    }
    fn averaged_gradient<R: Real>(&self, a: [R; D], b: [R; D], dt: f64, dw: [f64; M]) -> [R; D] {
        if self.one_node {
            self.system.gradient(dgrad::midpoint(a, b), dt, dw)
        } else {
            self.system.averaged_gradient(a, b, dt, dw)
        }
    }
    fn invariants(&self) -> Vec<Invariant> {
        self.system.invariants()
    }
    fn invariant<R: Real>(&self, index: usize, y: [R; D]) -> R {
        self.system.invariant(index, y)
    }
}

#[test]
fn wrong_systems_break_the_law() {
    let body = RigidBodyEnergy::new(INERTIA, 1.0).unwrap();
    let wrong_sign = Twin { system: body, one_node: false, wrong_sign: true };
    let one_node = Twin { system: populations_2(), one_node: true, wrong_sign: false };
    let cubic = Twin { system: populations_1(), one_node: true, wrong_sign: false };
    for share in [
        visible(&wrong_sign, 0, [0.5; 3], sexp),
        visible(&wrong_sign, 1, [0.5; 3], sexp),
        visible(&one_node, 0, [1.0; 3], sexp),
        visible(&cubic, 0, [1.0; 3], sexp),
    ] {
        assert!(share > NEARLY_ALL, "{share}");
    }
    // The linear Casimir does not depend on the gradient.
    assert_eq!(visible(&one_node, 1, [1.0; 3], sexp), 0.0);
}

/// Solved to the rounding of the equation, so that a tolerance is about the scheme and not about
/// the solver.
fn by_newton() -> WithSolver<Sexp> {
    WithSolver { formula: Sexp, solver: Solver::new(Method::Newton) }
}

/// Σ|∇̄Hᵢ| times the lengths involved, and |H|: what H(z) − H(ẑ) is rounded relative to; sines are
/// good to an ε, a sinc to two, and the solver leaves a few ε of ‖z‖.
const UNDAMPED: f64 = 32.0 * f64::EPSILON;

/// The defect of the energy in an undamped step, relative to its terms.
fn undamped_defect<S: PoissonSystem<D, 1>, const D: usize>(
    system: &S,
    numbers: &mut Numbers,
    y0: [f64; D],
) -> f64 {
    let step = Step::new(&Constant::new(0.0).unwrap(), 3, 0.05).unwrap();
    let y = any_state(numbers, system, y0);
    let noise = Noise::increments(any_increments(numbers, step.tau));
    let y1 = by_newton().step(system, &step, &noise, y).z;
    let h = |y| -> f64 { system.energy(y, 1.0, [0.0]) };
    let slope: [f64; D] = system.averaged_gradient(y, y1, 1.0, [0.0]);
    let lengths: f64 = y.iter().chain(&y1).map(|x| x.abs()).sum();
    let terms = slope.iter().map(|x| x.abs()).sum::<f64>() * lengths + h(y).abs() + 3.0;
    (h(y1) - h(y)).abs() / terms
}

#[test]
fn without_damping_any_energy_is_kept() {
    // Sines and cosines: not homogeneous, so there is no conformal law, but the law without damping
    // holds.
    let mut numbers = Numbers(7);
    let (pendulum, poisson) = (Pendulum::new(1.0).unwrap(), Poisson3::new(1.0).unwrap());
    let one_node = Twin { system: poisson, one_node: true, wrong_sign: false };
    let mut broken = 0;
    for _ in 0..2000 {
        let defect = undamped_defect(&pendulum, &mut numbers, [0.2, 1.0]);
        assert!(defect < UNDAMPED, "{defect}");
        let defect = undamped_defect(&poisson, &mut numbers, [1.0, 2.0, 3.0]);
        assert!(defect < UNDAMPED, "{defect}");
        broken += u32::from(undamped_defect(&one_node, &mut numbers, [1.0, 2.0, 3.0]) > 1e-9);
    }
    assert!(broken > 1800, "{broken}");
}
