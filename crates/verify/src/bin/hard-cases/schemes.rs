//! The schemes that every case is run with.

use noise::{BlockNoise, Noise};
use nonlin::{BlockStatus, Method, Solution, Solver};
use real::{Block, WIDTH};
use schemes::{
    EulerMaruyama, Heun, Midpoint, Nv, Scheme, Sexp, SexpLevy, SexpLi, Split, Step, WithSolver,
};
use systems::{Flows, InvariantKind, PoissonSystem};
use verify::rounding::{LINEARLY_IMPLICIT, rotations};

/// Where a scheme reads γ, and what it keeps.
#[derive(Clone, Copy, PartialEq)]
pub enum Family {
    /// The forms of `sexp`: reads ∫γ alone, and keeps conformal laws.
    Conformal,
    /// Reads ∫γ alone, keeps conformal laws of Casimirs, and has no equation to iterate on.
    WithoutIteration,
    /// The midpoint rule: reads γ in the middle of a step.
    Midpoint,
    /// Reads γ at the ends of a step, and solves nothing.
    Explicit,
}

impl Family {
    /// Whether invariants of this kind obey their conformal law.
    pub fn keeps(self, kind: InvariantKind) -> bool {
        match self {
            Self::Conformal => true,
            Self::WithoutIteration => kind == InvariantKind::Casimir,
            Self::Midpoint | Self::Explicit => false,
        }
    }
}

/// A scheme under its name in results. It boxes the step of a single path: hard cases have few
/// paths, and no kernel for blocks has to be compiled for their systems.
pub struct Tested<S, const D: usize, const M: usize> {
    pub name: &'static str,
    pub family: Family,
    /// Whether Newton's method comes before the fixed point.
    pub newton: bool,
    /// The order for ordinary differential equations.
    pub order: f64,
    /// What a step rounds, in units of that of `sexp`, see `rounding`.
    pub rounding: f64,
    /// The paths of each block that are advanced.
    pub paths: usize,
    advance: Box<Advance<S, D, M>>,
    reads_areas: bool,
    clips_increments: bool,
}

type Advance<S, const D: usize, const M: usize> =
    dyn Fn(&S, &Step, &Noise<M>, [f64; D]) -> Solution<D> + Send + Sync;

/// Every scheme that differs from the others with M noises, but for those [`by_parts`].
pub fn schemes<S: PoissonSystem<D, M>, const D: usize, const M: usize>(
    system: &S,
    y0: [f64; D],
) -> Vec<Tested<S, D, M>> {
    use Family::{Conformal, Explicit};
    let sexp = |method| WithSolver { formula: Sexp, solver: Solver::new(method) };
    let mut all = vec![
        Tested::new(Conformal, sexp(Method::FixedPoint)),
        Tested {
            name: "sexp-newton",
            newton: true,
            ..Tested::new(Conformal, sexp(Method::Newton))
        },
    ];
    if M > 1 {
        all.push(Tested::new(Conformal, SexpLevy::new(system, y0)));
    }
    if let Ok(linearly_implicit) = SexpLi::new(system, y0) {
        let scheme = Tested::new(Family::WithoutIteration, linearly_implicit);
        all.push(Tested { rounding: LINEARLY_IMPLICIT, ..scheme });
    }
    all.push(Tested::new(Family::Midpoint, Midpoint));
    all.push(Tested::new(Explicit, Heun));
    all.push(Tested { order: 1.0, ..Tested::new(Explicit, EulerMaruyama) });
    all
}

/// Exact flows of parts that are rotations about axes: `split` and `nv`.
pub fn by_parts<S: Flows<D, M>, const D: usize, const M: usize>(
    system: &S,
) -> [Tested<S, D, M>; 2] {
    let all = 2 * S::PARTS - 1;
    let drifting = 2 * (0..S::PARTS).filter(|&part| system.drifts(part)).count();
    let noise = |part: Option<usize>| if part.is_some() { 1 } else { 3 * all };
    let noises: usize = S::NOISE_PARTS.into_iter().map(noise).sum();
    let without = |rounding, scheme| Tested { rounding, ..scheme };
    [
        without(rotations(all), Tested::new(Family::WithoutIteration, Split)),
        without(
            rotations(2 * drifting + noises),
            Tested::new(Family::WithoutIteration, Nv::of_parts()),
        ),
    ]
}

impl<S, const D: usize, const M: usize> Tested<S, D, M> {
    fn new(family: Family, scheme: impl Scheme<S, D, M> + 'static) -> Self {
        Self {
            name: scheme.id(),
            family,
            newton: false,
            order: 2.0,
            rounding: 1.0,
            paths: WIDTH,
            reads_areas: scheme.reads_areas(),
            clips_increments: scheme.clips_increments(),
            advance: Box::new(move |system, step, noise, y| scheme.step(system, step, noise, y)),
        }
    }
}

/// Steps of the paths of a block, one after the other.
impl<S, const D: usize, const M: usize> Scheme<S, D, M> for Tested<S, D, M> {
    fn id(&self) -> &'static str {
        self.name
    }

    fn reads_areas(&self) -> bool {
        self.reads_areas
    }

    fn clips_increments(&self) -> bool {
        self.clips_increments
    }

    fn step_block(
        &self,
        system: &S,
        step: &Step,
        noise: &BlockNoise<M>,
        y: &mut Block<D>,
        status: &mut BlockStatus,
    ) {
        *status = BlockStatus::explicit();
        for p in 0..self.paths {
            let solution = self.step(system, step, &noise.path(p), y.path(p));
            y.set_path(p, solution.z);
            status.set(p, solution.outcome);
        }
    }

    fn step(&self, system: &S, step: &Step, noise: &Noise<M>, y: [f64; D]) -> Solution<D> {
        (self.advance)(system, step, noise, y)
    }
}
