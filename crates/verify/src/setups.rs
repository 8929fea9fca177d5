//! The problems on which schemes are compared, and the schemes for each.

use anyhow::Result;
use schemes::{EulerMaruyama, Heun, Midpoint, Scheme, Sexp, SexpLevy, SexpLi};
use systems::{
    Damping, PoissonSystem, Problem,
    paper::{
        lotka_volterra_1_1, maxwell_bloch, pendulum, poisson3_strong, rigid_body_one_noise,
        rigid_body_three_noises, valid,
    },
};

use crate::{PaperSystem, TwoSpins, compiled};

/// A problem with its name and its schemes.
pub struct Setup<S, G, const D: usize, const M: usize> {
    /// Identifier, for example `rigid-body-3`.
    pub id: &'static str,
    /// System, damping, start and final time.
    pub problem: Problem<S, G, D>,
    /// `sexp`, those with Lévy areas where noises do not commute, `sexp-li`, `split` and `nv` where
    /// flows are known, `midpoint`, `heun` and `em`.
    pub schemes: Schemes<S, D, M>,
}

type Schemes<S, const D: usize, const M: usize> = Vec<Box<dyn Scheme<S, D, M>>>;

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
    let mut schemes: Schemes<S, D, M> = vec![compiled(Sexp), compiled(linearly_implicit)];
    schemes.extend(S::by_parts().into_iter().flatten());
    schemes.extend([compiled(Midpoint), Box::new(Heun), compiled(EulerMaruyama)]);
    Setup { id, problem, schemes }
}

/// Identifiers of [`visit_paper`], in its order.
pub const PAPER: [&str; 6] =
    ["pendulum", "rigid-body-1", "rigid-body-3", "lotka-volterra", "maxwell-bloch", "poisson3"];

/// Visits the paper's problems with the final times of its strong errors; T = 1 where it measures
/// none.
///
/// # Errors
/// The first of the visitor's.
pub fn visit_paper(visitor: &mut impl Visit) -> Result<()> {
    visitor.visit(setup("pendulum", pendulum()))?;
    visitor.visit(setup("rigid-body-1", rigid_body_one_noise()))?;
    let mut body = setup("rigid-body-3", rigid_body_three_noises(1.0));
    let (system, y0) = (body.problem.system(), body.problem.y0());
    let areas =
        [compiled(SexpLevy::new(system, y0)), compiled(valid(SexpLi::with_areas(system, y0)))];
    body.schemes.splice(1..1, areas);
    visitor.visit(body)?;
    visitor.visit(setup("lotka-volterra", lotka_volterra_1_1()))?;
    visitor.visit(setup("maxwell-bloch", maxwell_bloch(1.0)))?;
    visitor.visit(setup("poisson3", poisson3_strong()))
}

/// Two spins with exchange and anisotropy in a field that fluctuates about all three axes: D = 6.
pub(crate) fn spin_pair<G: Damping>(damping: G) -> Problem<TwoSpins, G, 6> {
    let spins = valid(TwoSpins::new(1.0, 0.5, 0.8));
    valid(Problem::new(spins, damping, [1.0, 0.0, 0.0, 0.0, 0.6, 0.8], 1.0))
}
