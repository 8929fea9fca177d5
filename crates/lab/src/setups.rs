//! The problems on which schemes are compared, and the schemes for each.

use mc::Observable;
use real::elementary::{cos, sin};
use schemes::{EulerMaruyama, Heun, Midpoint, Scheme, Sexp, SexpLevy};
use systems::paper::{
    lotka_volterra_1_1, lotka_volterra_2_2, maxwell_bloch, pendulum, poisson3_strong,
    rigid_body_energy, rigid_body_one_noise, rigid_body_three_noises, valid,
};
use systems::{Constant, Damping, PoissonSystem, Problem, SpinChain};
use verify::rigid_body_expectations;

use crate::{PaperSystem, compiled};

/// A problem with its name, what is measured on it and with which schemes.
pub struct Setup<S, G, const D: usize, const M: usize> {
    /// Identifier, for example `rigid-body-3`.
    pub id: &'static str,
    /// What it is called on a figure.
    pub title: &'static str,
    /// The system and its parameters in words.
    pub system: &'static str,
    /// System, damping, start and final time.
    pub problem: Problem<S, G, D>,
    /// Test functions of the final state.
    pub observables: [Observable<D>; 2],
    /// E φ(y(T)) of every test function without sampling, where it is known.
    pub expectations: fn(&Problem<S, G, D>, &[Observable<D>]) -> Option<Vec<f64>>,
    /// `sexp`, then `sexp-levy` where noises do not commute, and `midpoint`.
    pub implicit: Vec<Box<dyn Scheme<S, D, M>>>,
    /// `heun` and `em`.
    pub explicit: [Box<dyn Scheme<S, D, M>>; 2],
}

impl<S, G, const D: usize, const M: usize> Setup<S, G, D, M> {
    /// All schemes, the implicit ones first.
    pub fn schemes(&self) -> impl Iterator<Item = &dyn Scheme<S, D, M>> {
        self.implicit.iter().chain(&self.explicit).map(AsRef::as_ref)
    }
}

/// Something to do with every problem.
pub trait Visit {
    /// Why it could not be done.
    type Error;

    /// Does it with one problem.
    ///
    /// # Errors
    /// The visitor's own.
    fn visit<S: PoissonSystem<D, M>, G: Damping, const D: usize, const M: usize>(
        &mut self,
        setup: Setup<S, G, D, M>,
    ) -> Result<(), Self::Error>;
}

/// Names and words of a set-up: identifier, title, system.
type Words = [&'static str; 3];

/// The set-up of a problem whose noises commute.
fn setup<S: PaperSystem<D, M>, G, const D: usize, const M: usize>(
    [id, title, system]: Words,
    problem: Problem<S, G, D>,
    first: (&'static str, fn([f64; D]) -> f64),
    second: (&'static str, fn([f64; D]) -> f64),
) -> Setup<S, G, D, M> {
    let observables = [first, second].map(|(name, function)| Observable { name, function });
    Setup {
        id,
        title,
        system,
        problem,
        observables,
        expectations: |_, _| None,
        implicit: vec![compiled(Sexp::default()), compiled(Midpoint::default())],
        explicit: [Box::new(Heun), compiled(EulerMaruyama)],
    }
}

/// Identifiers of [`visit_paper`], in its order.
pub const PAPER: [&str; 6] =
    ["pendulum", "rigid-body-1", "rigid-body-3", "lotka-volterra", "maxwell-bloch", "poisson3"];

/// Visits the paper's problems with the final times of its strong errors; T = 1 where it measures
/// none.
///
/// # Errors
/// The first of the visitor's.
pub fn visit_paper<V: Visit>(visitor: &mut V) -> Result<(), V::Error> {
    visitor.visit(setup(
        ["pendulum", "Pendulum", "pendulum, c = 1"],
        pendulum(),
        ("y1^2", |y| y[0] * y[0]),
        ("cos y2", |y| cos(y[1])),
    ))?;
    // Spherical harmonics up to degree 96: expectations to round-off for this body.
    visitor.visit(Setup {
        expectations: |problem, phi| Some(rigid_body_expectations(problem, 96, phi)),
        ..setup(
            [
                "rigid-body-1",
                "Rigid body, one noise",
                "rigid body, only W₁, I = (2, 1, 2/3), Î₁ = 1",
            ],
            rigid_body_one_noise(),
            ("y1^2", |y| y[0] * y[0]),
            ("cos y3", |y| cos(y[2])),
        )
    })?;
    let problem = rigid_body_three_noises(1.0);
    visitor.visit(Setup {
        expectations: |problem, phi| Some(rigid_body_expectations(problem, 96, phi)),
        implicit: vec![
            compiled(Sexp::default()),
            compiled(SexpLevy::new(&problem.system, problem.y0)),
            compiled(Midpoint::default()),
        ],
        ..setup(
            [
                "rigid-body-3",
                "Rigid body, three noises",
                "rigid body, I = (2, 1, 2/3), Î = (1, 2, 3)",
            ],
            problem,
            ("y1^2", |y| y[0] * y[0]),
            ("cos y3", |y| cos(y[2])),
        )
    })?;
    visitor.visit(setup(
        ["lotka-volterra", "Lotka–Volterra", "Lotka–Volterra, a = −1, b = −1, c = 1"],
        lotka_volterra_1_1(),
        ("y2", |y| y[1]),
        ("cos y3", |y| cos(y[2])),
    ))?;
    visitor.visit(setup(
        ["maxwell-bloch", "Maxwell–Bloch", "Maxwell–Bloch"],
        maxwell_bloch(1.0),
        ("y1", |y| y[0]),
        ("y2^2", |y| y[1] * y[1]),
    ))?;
    visitor.visit(setup(
        ["poisson3", "Three-dimensional Poisson system", "three-dimensional Poisson system, c = 1"],
        poisson3_strong(),
        ("y1", |y| y[0]),
        ("sin y2", |y| sin(y[1])),
    ))
}

/// Visits three more on [0, 1]: the rigid body with noise H₀, Lotka–Volterra with H = y₁²y₂²y₃, and
/// two spins in a fluctuating field.
///
/// # Errors
/// The first of the visitor's.
pub fn visit_others<V: Visit>(visitor: &mut V) -> Result<(), V::Error> {
    visitor.visit(setup(
        ["rigid-body-energy", "Rigid body, noise H₀", "rigid body with noise H₀, I = (2, 1, 2/3)"],
        rigid_body_energy(1.0),
        ("y1^2", |y| y[0] * y[0]),
        ("cos y3", |y| cos(y[2])),
    ))?;
    visitor.visit(setup(
        ["lotka-volterra-2", "Lotka–Volterra, b = −2", "Lotka–Volterra, a = −1, b = −2, c = 1"],
        lotka_volterra_2_2(1.0),
        ("y2", |y| y[1]),
        ("cos y3", |y| cos(y[2])),
    ))?;
    let spins = valid(SpinChain::<6>::new(1.0, 0.5, 0.8));
    let start = [1.0, 0.0, 0.0, 0.0, 0.6, 0.8];
    let levy = SexpLevy::new(&spins, start);
    visitor.visit(Setup {
        id: "spin-chain",
        title: "Spin chain, two spins",
        system: "two spins in a fluctuating field",
        problem: valid(Problem::new(spins, valid(Constant::new(0.1)), start, 1.0)),
        observables: [
            Observable { name: "y1^2", function: |y| y[0] * y[0] },
            Observable { name: "cos y3", function: |y| cos(y[2]) },
        ],
        expectations: |_, _| None,
        implicit: vec![compiled(Sexp::default()), compiled(levy), Box::new(Midpoint::default())],
        explicit: [Box::new(Heun), Box::new(EulerMaruyama)],
    })
}
