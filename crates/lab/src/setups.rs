//! The problems on which schemes are compared, and the schemes for each.

use mc::Observable;
use real::elementary::{cos, sin};
use schemes::{Midpoint, Scheme, Sexp, SexpLevy};
use systems::paper::{
    INERTIA, LOTKA_VOLTERRA_START, NOISE_INERTIA, half_cosine, rigid_body_start, valid,
};
use systems::{
    Constant, Cosine, Damping, IntegerExponents, LotkaVolterra, MaxwellBloch, Pendulum, Poisson3,
    Problem, RigidBody, RigidBodyEnergy, Sine, SpinChain,
};
use verify::rigid_body_expectations;

use crate::Compiled;

/// A problem with its name, and what is measured on it.
pub struct Setup<S, G, const D: usize> {
    /// Identifier, for example `rigid-body-3`.
    pub id: &'static str,
    /// What it is called on a figure.
    pub title: &'static str,
    /// The system and its parameters in words.
    pub system: &'static str,
    /// System, damping, start and final time.
    pub problem: Problem<S, G, D>,
    /// Test functions of the final state.
    pub observables: Vec<Observable<D>>,
    /// E φ(y(T)) of every test function without sampling, where it is known.
    pub expectations: fn(&Problem<S, G, D>, &[Observable<D>]) -> Option<Vec<f64>>,
}

/// Something to do with every problem.
pub trait Visit {
    /// Why it could not be done.
    type Error;

    /// Does it with one problem.
    ///
    /// # Errors
    /// The visitor's own.
    fn visit<S: Compiled<D, M>, G: Damping, const D: usize, const M: usize>(
        &mut self,
        setup: Setup<S, G, D>,
    ) -> Result<(), Self::Error>;
}

fn observable<const D: usize>(name: &'static str, function: fn([f64; D]) -> f64) -> Observable<D> {
    Observable { name, function }
}

/// Visits the paper's problems: its systems, dampings and starts, and the final times of its
/// strong errors; T = 1 where the paper measures none.
///
/// # Errors
/// The first of the visitor's.
pub fn visit_paper<V: Visit>(visitor: &mut V) -> Result<(), V::Error> {
    visitor.visit(Setup {
        id: "pendulum",
        title: "Pendulum",
        system: "pendulum, c = 1",
        problem: valid(Problem::new(
            valid(Pendulum::new(1.0)),
            valid(Constant::new(2.0)),
            [0.2, 1.0],
            1.0,
        )),
        observables: vec![observable("y1^2", |y| y[0] * y[0]), observable("cos y2", |y| cos(y[1]))],
        expectations: |_, _| None,
    })?;
    visitor.visit(rigid_body(
        "rigid-body-1",
        "Rigid body, one noise",
        "rigid body, only W₁, I = (2, 1, 2/3), Î₁ = 1",
        valid(RigidBody::one_noise(INERTIA, NOISE_INERTIA[0])),
    ))?;
    visitor.visit(rigid_body_3())?;
    visitor.visit(Setup {
        id: "lotka-volterra",
        title: "Lotka–Volterra",
        system: "Lotka–Volterra, a = −1, b = −1, c = 1",
        problem: valid(Problem::new(
            valid(LotkaVolterra::<IntegerExponents<1, 1>>::integer(1.0)),
            valid(Sine::new(1.0, 1.0)),
            LOTKA_VOLTERRA_START,
            1.0,
        )),
        observables: vec![observable("y2", |y| y[1]), observable("cos y3", |y| cos(y[2]))],
        expectations: |_, _| None,
    })?;
    visitor.visit(Setup {
        id: "maxwell-bloch",
        title: "Maxwell–Bloch",
        system: "Maxwell–Bloch",
        problem: valid(Problem::new(MaxwellBloch, half_cosine(), [1.0, 2.0, 3.0], 1.0)),
        observables: vec![observable("y1", |y| y[0]), observable("y2^2", |y| y[1] * y[1])],
        expectations: |_, _| None,
    })?;
    visitor.visit(Setup {
        id: "poisson3",
        title: "Three-dimensional Poisson system",
        system: "three-dimensional Poisson system, c = 1",
        problem: valid(Problem::new(
            valid(Poisson3::new(1.0)),
            half_cosine(),
            [1.0, 2.0, 3.0],
            0.5,
        )),
        observables: vec![observable("y1", |y| y[0]), observable("sin y2", |y| sin(y[1]))],
        expectations: |_, _| None,
    })
}

/// Visits three more: the rigid body with noise H₀, Lotka–Volterra with exponents 2, and two spins
/// in a fluctuating field. They have no test functions.
///
/// # Errors
/// The first of the visitor's.
pub fn visit_others<V: Visit>(visitor: &mut V) -> Result<(), V::Error> {
    visitor.visit(Setup {
        id: "rigid-body-energy",
        title: "Rigid body, noise H₀",
        system: "rigid body with noise H₀, I = (2, 1, 2/3)",
        problem: valid(Problem::new(
            valid(RigidBodyEnergy::new(INERTIA, 1.0)),
            half_cosine(),
            rigid_body_start(),
            1.0,
        )),
        observables: Vec::new(),
        expectations: |_, _| None,
    })?;
    visitor.visit(Setup {
        id: "lotka-volterra-2",
        title: "Lotka–Volterra, exponents 2",
        system: "Lotka–Volterra, a = −1, b = −2, c = 1",
        problem: valid(Problem::new(
            valid(LotkaVolterra::<IntegerExponents<2, 2>>::integer(1.0)),
            valid(Sine::new(1.0, 1.0)),
            LOTKA_VOLTERRA_START,
            1.0,
        )),
        observables: Vec::new(),
        expectations: |_, _| None,
    })?;
    visitor.visit(Setup {
        id: "spin-chain",
        title: "Spin chain, two spins",
        system: "two spins in a fluctuating field",
        problem: valid(Problem::new(
            valid(SpinChain::<6>::new(1.0, 0.5, 0.8)),
            valid(Constant::new(0.1)),
            [1.0, 0.0, 0.0, 0.0, 0.6, 0.8],
            1.0,
        )),
        observables: Vec::new(),
        expectations: |_, _| None,
    })
}

/// The rigid body with three noises.
#[must_use]
pub fn rigid_body_3() -> Setup<RigidBody<3>, Cosine, 3> {
    rigid_body(
        "rigid-body-3",
        "Rigid body, three noises",
        "rigid body, I = (2, 1, 2/3), Î = (1, 2, 3)",
        valid(RigidBody::three_noises(INERTIA, NOISE_INERTIA)),
    )
}

/// Spherical harmonics up to this degree: expectations to round-off for this body.
const DEGREE: usize = 96;

fn rigid_body<const M: usize>(
    id: &'static str,
    title: &'static str,
    system: &'static str,
    body: RigidBody<M>,
) -> Setup<RigidBody<M>, Cosine, 3>
where
    RigidBody<M>: Compiled<3, M>,
{
    Setup {
        id,
        title,
        system,
        problem: valid(Problem::new(body, half_cosine(), rigid_body_start(), 1.0)),
        observables: vec![observable("y1^2", |y| y[0] * y[0]), observable("cos y3", |y| cos(y[2]))],
        expectations: |problem, phi| Some(rigid_body_expectations(problem, DEGREE, phi)),
    }
}

/// The schemes for a problem: `sexp`, `sexp-levy` where it differs, `midpoint`, `heun`, `em`.
#[must_use]
pub fn schemes_for<S: Compiled<D, M>, G, const D: usize, const M: usize>(
    problem: &Problem<S, G, D>,
) -> Vec<Box<dyn Scheme<S, D, M>>> {
    let mut schemes = vec![S::sexp(Sexp::default())];
    let levy = S::sexp_levy(SexpLevy::new(&problem.system, problem.y0));
    if levy.needs_areas() {
        schemes.push(levy);
    }
    schemes.extend([S::midpoint(Midpoint::default()), S::heun(), S::euler_maruyama()]);
    schemes
}
