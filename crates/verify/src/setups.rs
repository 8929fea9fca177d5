//! The problems on which schemes are compared, and the schemes for each.

use analysis::rigid_body_expectations;
use anyhow::Result;
use mc::Observable;
use real::elementary::{cos, sin};
use schemes::{EulerMaruyama, Heun, Midpoint, Scheme, Sexp, SexpLevy, SexpLi};
use systems::{
    Constant, Damping, PoissonSystem, Problem,
    paper::{
        lotka_volterra_1_1, lotka_volterra_2_2, maxwell_bloch, pendulum, poisson3_strong,
        rigid_body_energy, rigid_body_one_noise, rigid_body_three_noises, valid,
    },
};

use crate::{PaperSystem, TwoSpins, compiled, in_words};

/// What a scheme is.
#[derive(Clone, Copy, PartialEq)]
pub enum Kind {
    /// The conformal exponential integrator.
    Sexp,
    /// The same with Lévy areas.
    SexpLevy,
    /// A scheme that keeps Casimirs without iteration.
    WithoutIteration,
    /// Another implicit scheme.
    OtherImplicit,
    /// Heun's method.
    Heun,
    /// Euler and Maruyama's method.
    EulerMaruyama,
}

impl Kind {
    /// Whether the scheme keeps Casimirs on their conformal law.
    pub fn conformal(self) -> bool {
        matches!(self, Self::Sexp | Self::SexpLevy | Self::WithoutIteration)
    }
}

/// E φ(y(T)) of test functions on a problem, without sampling.
pub type Expectations<S, G, const D: usize> = fn(&Problem<S, G, D>, &[Observable<D>]) -> Vec<f64>;

/// A test function with its name.
pub(crate) type TestFunction<const D: usize> = (&'static str, fn([f64; D]) -> f64);

/// A problem with its name, its schemes, and what is measured on it.
pub struct Setup<S, G, const D: usize, const M: usize> {
    /// Identifier, for example `rigid-body-3`.
    pub id: &'static str,
    /// System, damping, start and final time.
    pub problem: Problem<S, G, D>,
    /// `sexp`, `sexp-levy` where noises do not commute, `sexp-li`, `split` and `nv` where flows are
    /// known, `midpoint`, `heun` and `em`.
    pub schemes: Vec<(Kind, Box<dyn Scheme<S, D, M>>)>,
    /// What it is called on a figure; empty where only times are measured, and so are the next two.
    pub title: &'static str,
    /// The system and its parameters in words.
    pub system: &'static str,
    /// Test functions of the final state.
    pub observables: Vec<Observable<D>>,
    /// The expectations of test functions, where they are known.
    pub expectations: Option<Expectations<S, G, D>>,
}

impl<S, G, const D: usize, const M: usize> Setup<S, G, D, M> {
    fn new(
        id: &'static str,
        problem: Problem<S, G, D>,
        schemes: Vec<(Kind, Box<dyn Scheme<S, D, M>>)>,
    ) -> Self {
        let observables = Vec::new();
        Self { id, problem, schemes, title: "", system: "", observables, expectations: None }
    }

    fn described(
        self,
        title: &'static str,
        system: &'static str,
        observables: [TestFunction<D>; 2],
    ) -> Self {
        let observables = observables.map(|(name, function)| Observable { name, function }).into();
        Self { title, system, observables, ..self }
    }
}

/// Something to do with every problem.
pub trait Visit {
    /// Does it with one problem.
    ///
    /// # Errors
    /// The visitor's own.
    fn visit<S: PoissonSystem<D, M>, G: Damping, const D: usize, const M: usize>(
        &mut self,
        setup: Setup<S, G, D, M>,
    ) -> Result<()>;
}

/// The set-up of a problem whose noises commute.
fn setup<S: PaperSystem<D, M> + 'static, G, const D: usize, const M: usize>(
    id: &'static str,
    problem: Problem<S, G, D>,
) -> Setup<S, G, D, M> {
    let linearly_implicit = valid(SexpLi::new(problem.system(), problem.y0()));
    let mut schemes =
        vec![(Kind::Sexp, compiled(Sexp)), (Kind::WithoutIteration, compiled(linearly_implicit))];
    let by_parts = S::by_parts().into_iter().flatten();
    schemes.extend(by_parts.map(|scheme| (Kind::WithoutIteration, scheme)));
    schemes.extend([
        (Kind::OtherImplicit, compiled(Midpoint)),
        (Kind::Heun, Box::new(Heun) as Box<dyn Scheme<S, D, M>>),
        (Kind::EulerMaruyama, compiled(EulerMaruyama)),
    ]);
    Setup::new(id, problem, schemes)
}

/// Test functions of a body.
const BODY: [TestFunction<3>; 2] = [("y1^2", |y| y[0] * y[0]), ("cos y3", |y| cos(y[2]))];

/// Identifiers of [`visit_paper`], in its order.
pub const PAPER: [&str; 6] =
    ["pendulum", "rigid-body-1", "rigid-body-3", "lotka-volterra", "maxwell-bloch", "poisson3"];

/// Visits the paper's problems with the final times of its strong errors; T = 1 where it measures
/// none.
///
/// # Errors
/// The first of the visitor's.
pub fn visit_paper(visitor: &mut impl Visit) -> Result<()> {
    visitor.visit(setup("pendulum", pendulum()).described(
        "Pendulum",
        in_words::PENDULUM,
        [("y1^2", |y| y[0] * y[0]), ("cos y2", |y| cos(y[1]))],
    ))?;
    // Spherical harmonics up to degree 96: to round-off for this body.
    let mut one_noise = setup("rigid-body-1", rigid_body_one_noise()).described(
        "Rigid body, one noise",
        in_words::BODY_1,
        BODY,
    );
    one_noise.expectations = Some(|problem, phi| rigid_body_expectations(problem, 96, phi));
    visitor.visit(one_noise)?;
    let problem = rigid_body_three_noises(1.0);
    let levy = compiled(SexpLevy::new(problem.system(), problem.y0()));
    let mut three_noises = setup("rigid-body-3", problem).described(
        "Rigid body, three noises",
        in_words::BODY_3,
        BODY,
    );
    three_noises.schemes.insert(1, (Kind::SexpLevy, levy));
    let linearly_implicit =
        SexpLi::with_areas(three_noises.problem.system(), three_noises.problem.y0());
    let linearly_implicit = compiled(valid(linearly_implicit));
    three_noises.schemes.insert(2, (Kind::WithoutIteration, linearly_implicit));
    three_noises.expectations = Some(|problem, phi| rigid_body_expectations(problem, 96, phi));
    visitor.visit(three_noises)?;
    visitor.visit(setup("lotka-volterra", lotka_volterra_1_1()).described(
        "Lotka–Volterra",
        in_words::VOLTERRA,
        [("y2", |y| y[1]), ("cos y3", |y| cos(y[2]))],
    ))?;
    visitor.visit(setup("maxwell-bloch", maxwell_bloch(1.0)).described(
        "Maxwell–Bloch",
        "Maxwell–Bloch",
        [("y1", |y| y[0]), ("y2^2", |y| y[1] * y[1])],
    ))?;
    visitor.visit(setup("poisson3", poisson3_strong()).described(
        "Three-dimensional Poisson system",
        in_words::POISSON,
        [("y1", |y| y[0]), ("sin y2", |y| sin(y[1]))],
    ))
}

/// Two spins with exchange and anisotropy in a field that fluctuates about all three axes: D = 6.
pub(crate) fn spin_pair<G: Damping>(damping: G) -> Problem<TwoSpins, G, 6> {
    let spins = valid(TwoSpins::new(1.0, 0.5, 0.8));
    valid(Problem::new(spins, damping, [1.0, 0.0, 0.0, 0.0, 0.6, 0.8], 1.0))
}

/// Visits three more on [0, 1], of which only times are measured: the rigid body with noise H₀,
/// Lotka–Volterra with H = y₁²y₂²y₃, and two spins in a fluctuating field.
///
/// # Errors
/// The first of the visitor's.
pub fn visit_others(visitor: &mut impl Visit) -> Result<()> {
    visitor.visit(setup("rigid-body-energy", rigid_body_energy(1.0)))?;
    visitor.visit(setup("lotka-volterra-2", lotka_volterra_2_2(1.0)))?;
    let problem = spin_pair(valid(Constant::new(0.1)));
    let levy = compiled(SexpLevy::new(problem.system(), problem.y0()));
    let linearly_implicit = valid(SexpLi::new(problem.system(), problem.y0()));
    let schemes: Vec<(Kind, Box<dyn Scheme<TwoSpins, 6, 3>>)> = vec![
        (Kind::Sexp, compiled(Sexp)),
        (Kind::SexpLevy, levy),
        (Kind::WithoutIteration, Box::new(linearly_implicit)),
        (Kind::OtherImplicit, Box::new(Midpoint)),
        (Kind::Heun, Box::new(Heun)),
        (Kind::EulerMaruyama, Box::new(EulerMaruyama)),
    ];
    visitor.visit(Setup::new("spin-chain", problem, schemes))
}
