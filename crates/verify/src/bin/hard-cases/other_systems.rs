//! Hamiltonians that are stiff or vary sharply, states at rest or next to poles of the structure,
//! and a linear equation that is singular or nearly so.

use noise::{Noise, Truncation};
use real::Real;
use systems::{
    Constant, Invariant, LotkaVolterra, Pendulum, PoissonSystem, RigidBody, RigidBodyEnergy,
    paper::{INERTIA, NOISE_INERTIA, half_cosine, rigid_body_start, sine},
};
use verify::rounding::length;

use crate::{
    Context, Expected, Rows, each,
    paths::{CASIMIR, Experiment, Family, Law},
};

/// y₀ = 0 and other points where B∇Hₘ = 0 for all m and γy = 0, so that the solution stays; 128
/// steps of τ = 1/16.
pub fn equilibria(context: &Context) -> Rows {
    let body = RigidBody::three_noises(INERTIA, NOISE_INERTIA)?;
    let (pendulum, still) = (Pendulum::new(1.0)?, Pendulum::new(0.0)?);
    let volterra = LotkaVolterra::<1, 1>::new(1.0)?;
    let (none, some) = (Constant::new(0.0)?, Constant::new(2.0)?);
    // The float next to π is no equilibrium: its sine is 1.2e-16, and the distance grows like e^t.
    let (pi, grown) = (std::f64::consts::PI, f64::EPSILON * 8f64.exp());
    Ok([
        stay(context, "rigid body, y₀ = 0, γ = 2", (body, some), [0.0; 3], 0.0)?,
        stay(context, "rigid body, y₀ = (0, 1, 0), γ = 0", (body, none), [0.0, 1.0, 0.0], 0.0)?,
        stay(context, "pendulum, y₀ = 0, γ = 2", (pendulum, some), [0.0; 2], 0.0)?,
        stay(context, "pendulum upright, γ = 0, no noise", (still, none), [0.0, pi], grown)?,
        stay(context, "Lotka–Volterra, y₀ = (½, ½, ½), γ = 0", (volterra, none), [0.5; 3], 0.0)?,
    ]
    .concat())
}

/// The largest distance from y₀, at most `bound`.
fn stay<S: PoissonSystem<D, M>, const D: usize, const M: usize>(
    context: &Context,
    setting: &str,
    system: (S, Constant),
    y0: [f64; D],
    bound: f64,
) -> Rows {
    let experiment = Experiment::new(context, system, y0, (128, 1.0 / 16.0))?;
    experiment.rows(setting, |_, paths, ended| {
        let states = paths[0].states.iter();
        let components = states.flat_map(|y| (0..D).map(|i| (y[i] - y0[i]).abs()));
        let largest = components.fold(0.0, f64::max);
        Ok((largest, Expected::at_most(bound, largest, ended)))
    })
}

/// The rigid body with a rippled energy, H = ½(y₁²/2 + y₂² + 3y₃²/2) + sin(κy₁)/κ as drift and as
/// noise, whose discrete gradient is the default of the trait: eight Gauss–Legendre nodes.
struct Rippled {
    body: RigidBodyEnergy,
    kappa: f64,
}

impl PoissonSystem<3, 1> for Rippled {
    fn name(&self) -> &'static str {
        "rippled-body"
    }
    fn structure<R: Real>(&self, y: [R; 3], v: [R; 3]) -> [R; 3] {
        self.body.structure(y, v)
    }
    fn energy<R: Real>(&self, y: [R; 3], dt: f64, dw: [f64; 1]) -> R {
        let ripple = (y[0] * self.kappa).sin() / self.kappa;
        self.body.energy(y, dt, dw) + ripple * (dt + dw[0])
    }
    fn gradient<R: Real>(&self, y: [R; 3], dt: f64, dw: [f64; 1]) -> [R; 3] {
        let [first, second, third] = self.body.gradient(y, dt, dw);
        [first + (y[0] * self.kappa).cos() * (dt + dw[0]), second, third]
    }
    fn cayley<R: Real>(&self, y: [R; 3], v: [R; 3]) -> [R; 3] {
        self.body.cayley(y, v)
    }
    fn invariants(&self) -> Vec<Invariant> {
        self.body.invariants()
    }
    /// The Casimir is that of the body.
    fn invariant<R: Real>(&self, index: usize, y: [R; 3]) -> R {
        self.body.invariant(index, y)
    }
}

/// The largest error of eight nodes for the mean of cos(κy₁) over a step of length `d` in y₁: its
/// 16th derivative is at most (κd)¹⁶, and no mean is off by more than two. The constant of eight
/// Gauss–Legendre nodes on [0, 1] is (8!)⁴/(17·(16!)³).
fn quadrature_error(kappa: f64, d: f64) -> f64 {
    let factorial = |n: u32| (1..=n).map(f64::from).product::<f64>();
    let constant = factorial(8).powi(4) / (17.0 * factorial(16).powi(3));
    (constant * (kappa * d).abs().powi(16)).min(2.0)
}

/// A Hamiltonian that varies faster than the nodes of the quadrature resolve, γ = 0, 64 steps of τ
/// = 1/16: |y|² and H are constant. Any discrete gradient keeps |y|², only an exact one H.
pub fn sharp_hamiltonian(context: &Context) -> Rows {
    each([1.0, 10.0, 100.0, 1e3, 1e4], |kappa| {
        let system = Rippled { body: RigidBodyEnergy::new(INERTIA, 1.0)?, kappa };
        let (system, steps) = ((system, Constant::new(0.0)?), (64, 1.0 / 16.0));
        let experiment = Experiment::new(context, system, rigid_body_start(), steps)?;
        let casimir = experiment.law_rows(format!("Casimir, κ = {kappa}"), &CASIMIR, |_| None)?;
        let energy = experiment.rows(format!("energy, κ = {kappa}"), |scheme, paths, _| {
            let states = &paths[0].states;
            let value = |y: &[f64; 3]| experiment.problem.system().energy(*y, 1.0, [0.0]);
            let distances = states.iter().map(|y| (value(y) - value(&states[0])).abs());
            let worst = distances.fold(0.0, f64::max);
            let steps = states.windows(2).map(|pair| pair[1][0] - pair[0][0]);
            let quadrature: f64 = steps.map(|d| quadrature_error(kappa, d) * d.abs()).sum();
            // H and |∇H| are at most about two, so that rounding in H is no more than four times
            // that in ½|y|². The argument κy₁ has a rounding of its own, ε κ/κ.
            let bound = quadrature + 4.0 * experiment.distance(paths, &CASIMIR, scheme).bound;
            let expected = match scheme.family {
                Family::Conformal => Expected::Guarantee(worst <= bound, Some(bound)),
                _ => Expected::Anything,
            };
            Ok((worst, expected))
        })?;
        Ok([casimir, energy].concat())
    })
}

/// H₀ is a quadratic form whose largest coefficient is three times its smallest, so that rounding
/// in it is at most three times that in ½|y|².
const LAWS: Law = Law { invariants: &[0, 1], weight: 3.0, ..CASIMIR };

/// Frequencies ω far above 1/τ: the body with noise H₀ and moments of inertia (2, 1, 2/3)/ω, γ =
/// ½cos 2t, 256 steps of τ = 1/64. |y|² and H₀ decay as e^(−2∫γ) for every ω; the phase is not
/// guaranteed. From ω = 1000 on ωτ is above 6, and explicit schemes multiply the fast components by
/// about as much in every step.
pub fn stiff_hamiltonian(context: &Context) -> Rows {
    each([1.0, 10.0, 100.0, 1e3, 1e4], |omega| {
        let system = (RigidBodyEnergy::new(INERTIA.map(|i| i / omega), 1.0)?, half_cosine());
        let fails = |family| omega >= 1e3 && family == Family::Explicit;
        let experiment = Experiment::new(context, system, rigid_body_start(), (256, 1.0 / 64.0))?;
        experiment.with_parts([5, 19]).law_rows(omega, &LAWS, |family| fails(family).then_some(1.0))
    })
}

/// The law of a linear Casimir costs half of what a quadratic one costs, but its coefficients
/// differ by two. They are positive: there is no cancellation in the octant.
const LINEAR: Law = Law { invariants: &[1], weight: 2.0, ..CASIMIR };

/// Next to the coordinate planes, where B has its poles: several paths of Lotka–Volterra, a = −1, b
/// = −2, γ = sin t, up to t = 2. The solution stays positive. The Casimir 2y₁ + y₂ + y₃ follows
/// e^(−∫γ).
pub fn lotka_volterra(context: &Context) -> Rows {
    let paths = if context.quick { 8 } else { 64 };
    let starts = [
        ("y₁ = 1e-12", [1e-12, 0.4, 0.6]),
        ("y₂ = 1e-12", [0.2, 1e-12, 0.6]),
        ("y₃ = 1e-12", [0.2, 0.4, 1e-12]),
        ("all 1e-12", [1e-12; 3]),
    ];
    let settings = starts.into_iter().flat_map(|start| [16, 64, 256].map(|n| (start, n)));
    each(settings, |((name, y0), per_unit)| {
        let system = LotkaVolterra::<2, 2>::new(1.0)?;
        let steps = (2 * per_unit, 1.0 / per_unit as f64);
        let experiment = Experiment::new(context, (system, sine()), y0, steps)?;
        let setting = format!("{name}, τ = 1/{per_unit}");
        Experiment { paths, ..experiment }.law_rows(setting, &LINEAR, |_| None)
    })
}

/// so(2,1) with one noise along an axis: B(y)v = K(y × v), K = diag(1, 1, −1), H₁ = y₁.
struct Hyperbolic;

impl PoissonSystem<3, 1> for Hyperbolic {
    fn name(&self) -> &'static str {
        "hyperbolic"
    }
    fn structure<R: Real>(&self, y: [R; 3], v: [R; 3]) -> [R; 3] {
        let along = y[1] * v[0] - y[0] * v[1];
        [y[1] * v[2] - y[2] * v[1], y[2] * v[0] - y[0] * v[2], along]
    }
    fn energy<R: Real>(&self, y: [R; 3], _dt: f64, dw: [f64; 1]) -> R {
        y[0] * dw[0]
    }
    fn invariants(&self) -> Vec<Invariant> {
        vec![Invariant::quadratic_casimir("C", "y₁² + y₂² − y₃²")]
    }
    fn invariant<R: Real>(&self, _index: usize, y: [R; 3]) -> R {
        y[0] * y[0] + y[1] * y[1] - y[2] * y[2]
    }
}

/// One step of `sexp-li` with ΔW = 2(1 − δ): (y₂, y₃) are boosted, and I − ½A has the determinant 1
/// − ¼ΔW². |z| grows like 1/δ with y₁² + y₂² − y₃² kept; at δ = 0 there is no solution.
pub fn near_singular(context: &Context) -> Rows {
    each([0.5, 1e-2, 1e-5, 1e-10, 1e-15, 0.0], |delta: f64| {
        let system = (Hyperbolic, Constant::new(0.0)?);
        let mut experiment = Experiment::new(context, system, [0.3, 0.8, 0.1], (1, 0.1))?;
        experiment.schemes.retain(|scheme| scheme.family == Family::WithoutIteration);
        experiment.truncation = Truncation::none();
        experiment.noise = Some(Box::new(move |_, _| Noise::increments([2.0 * (1.0 - delta)])));
        experiment.rows(delta, |_, paths, ended| {
            let [start, .., end] = paths[0].states[..] else {
                return Ok((f64::NAN, Expected::Guarantee(ended, None)));
            };
            let value = |y| PoissonSystem::<3, 1>::invariant(&Hyperbolic, 0, y);
            let size = length(start) + length(end);
            let change: f64 = value(end) - value(start);
            // The rounding of the determinant scales the change of the state: C changes by a
            // multiple of its own value. Otherwise products of the adjugate, z and C are rounded:
            // fewer than 64 halves of ε, each times at most (|y| + |z|)².
            let figure = change.abs() / (size * size);
            Ok((figure, Expected::at_most(32.0 * f64::EPSILON, figure, ended)))
        })
    })
}
