//! A few paths of every scheme, each until its end or a typed error, and their distance from
//! conformal laws.

use std::fmt::Display;

use anyhow::Result;
use noise::{
    AreaPath, Noise, StreamKey, Truncation, WienerPath, area_terms, strong_order_one_error,
};
use nonlin::{Method, Outcome, Solution, Solver};
use schemes::{
    EulerMaruyama, Heun, Midpoint, Nv, Scheme, Sexp, SexpLevy, SexpLi, Split, Step, WithSolver,
};
use systems::{
    Damping, Flows, InvariantKind, PoissonSystem, Problem, RigidBody,
    paper::rigid_body_three_noises,
};
use verify::rounding::{LINEARLY_IMPLICIT, law_bound, residual_share, rotations};

use crate::{Context, Expected, Row, Rows};

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

use Family::{Conformal, Explicit, WithoutIteration};

impl Family {
    /// Whether Casimirs obey their conformal law.
    pub fn keeps_casimirs(self) -> bool {
        matches!(self, Conformal | WithoutIteration)
    }
}

/// A scheme under its name in results.
pub struct Tested<S, const D: usize, const M: usize> {
    pub name: &'static str,
    pub family: Family,
    /// What a step rounds, in units of that of `sexp`, see `rounding`.
    pub rounding: f64,
    reads_areas: bool,
    clips_increments: bool,
    /// A step of a single path: no kernel for blocks has to be compiled for the systems of hard
    /// cases.
    advance: Box<Advance<S, D, M>>,
}

type Advance<S, const D: usize, const M: usize> =
    dyn Fn(&S, &Step, &Noise<M>, [f64; D]) -> Solution<D>;

impl<S, const D: usize, const M: usize> Tested<S, D, M> {
    fn new(family: Family, rounding: f64, scheme: impl Scheme<S, D, M> + 'static) -> Self {
        Self {
            name: scheme.id(),
            family,
            rounding,
            reads_areas: scheme.reads_areas(),
            clips_increments: scheme.clips_increments(),
            advance: Box::new(move |system, step, noise, y| scheme.step(system, step, noise, y)),
        }
    }
}

const NEWTON: &str = "sexp-newton";

/// Every scheme that differs from the others with M noises, without exact flows.
fn schemes<S: PoissonSystem<D, M>, const D: usize, const M: usize>(
    system: &S,
    y0: [f64; D],
) -> Vec<Tested<S, D, M>> {
    let sexp = |method| {
        let formula = WithSolver { formula: Sexp, solver: Solver::new(method) };
        Tested::new(Conformal, 1.0, formula)
    };
    let mut all = vec![sexp(Method::FixedPoint), Tested { name: NEWTON, ..sexp(Method::Newton) }];
    if M > 1 {
        all.push(Tested::new(Conformal, 1.0, SexpLevy::new(system, y0)));
    }
    let linear = SexpLi::new(system, y0);
    all.extend(linear.map(|scheme| Tested::new(WithoutIteration, LINEARLY_IMPLICIT, scheme)));
    all.push(Tested::new(Family::Midpoint, 1.0, Midpoint));
    all.push(Tested::new(Explicit, 1.0, Heun));
    all.push(Tested::new(Explicit, 1.0, EulerMaruyama));
    all
}

/// One path as far as it lasts.
pub struct Path<const D: usize> {
    /// y₀, y₁, ….
    pub states: Vec<[f64; D]>,
    /// What the robust solver left of the equation of each step; zero where it was not needed.
    residuals: Vec<f64>,
    /// Why it ends early.
    stop: Option<&'static str>,
}

/// The paths of a problem, on equal steps up to its final time.
pub struct Experiment<S, G, const D: usize, const M: usize> {
    pub problem: Problem<S, G, D>,
    pub schemes: Vec<Tested<S, D, M>>,
    pub steps: u64,
    pub paths: u64,
    pub truncation: Truncation,
    pub key: StreamKey,
    /// Whether areas are drawn for schemes that read them.
    pub areas: bool,
    /// The noise of each step by the number of the path and its own, where it does not come from
    /// the streams.
    pub noise: Option<Box<dyn Fn(u64, u64) -> Noise<M>>>,
    /// The start of each path, where it is not that of the problem.
    pub start: Option<fn(u64) -> [f64; D]>,
}

/// A conformal law with the rounding that is allowed.
#[derive(Clone, Copy)]
pub struct Law {
    /// Numbers of the invariants.
    pub invariants: &'static [usize],
    /// How many times the rounding of a quadratic Casimir is allowed.
    pub weight: f64,
    /// What a step of Newton's method may add.
    pub newton_step: f64,
    /// Of which schemes that keep the law no path may end early.
    pub to_the_end: &'static [Family],
    /// Whether distances are shown relative to what is allowed.
    pub relative: bool,
}

/// The law of a quadratic Casimir.
pub const CASIMIR: Law =
    Law { invariants: &[0], weight: 1.0, newton_step: 0.0, to_the_end: &[], relative: false };

/// Distance of paths from a law.
#[derive(Default)]
pub struct Distance {
    /// The largest relative distance.
    worst: f64,
    /// The largest quotient of a distance and what is allowed there, of laws that the scheme keeps.
    excess: f64,
    /// What is allowed in the last step.
    pub bound: f64,
}

impl<S: PoissonSystem<D, M>, G: Damping, const D: usize, const M: usize> Experiment<S, G, D, M> {
    /// One path with increments truncated as in the reproduction, and steps of size `tau`.
    pub fn new(
        context: &Context,
        (system, damping): (S, G),
        y0: [f64; D],
        (steps, tau): (u64, f64),
    ) -> Result<Self> {
        Ok(Self {
            schemes: schemes(&system, y0),
            problem: Problem::new::<M>(system, damping, y0, steps as f64 * tau)?,
            steps,
            paths: 1,
            truncation: verify::truncation(),
            key: context.key,
            areas: true,
            noise: None,
            start: None,
        })
    }

    fn tau(&self) -> f64 {
        self.problem.t_end() / self.steps as f64
    }

    /// A path of a scheme.
    pub fn path(&self, scheme: &Tested<S, D, M>, number: u64) -> Result<Path<D>> {
        let (system, tau) = (self.problem.system(), self.tau());
        let mut areas = None;
        if self.areas && scheme.reads_areas {
            let terms = area_terms(strong_order_one_error(tau), tau, M)?;
            areas = Some(AreaPath::new(self.key, number, terms));
        }
        let mut increments = WienerPath::new(self.key, number);
        let clips = if scheme.clips_increments { self.truncation } else { Truncation::none() };
        let (bound, area_bound) = (clips.bound(tau)?, clips.area_bound(tau)?);
        let mut y = self.start.map_or(self.problem.y0(), |start| start(number));
        let mut path = Path { states: vec![y], residuals: Vec::new(), stop: None };
        for n in 0..self.steps {
            let drawn = || {
                let dw = increments.increments(tau.sqrt());
                let drawn = Noise::increments(dw);
                areas.as_mut().map_or(drawn, |areas| Noise { areas: areas.areas(tau, dw), ..drawn })
            };
            let noise = self.noise.as_ref().map_or_else(drawn, |noise| noise(number, n));
            let noise = Noise {
                increments: noise.increments.map(|dw| dw.clamp(-bound, bound)),
                areas: noise.areas.map(|row| row.map(|a| a.clamp(-area_bound, area_bound))),
            };
            let step = Step::new(self.problem.damping(), n, tau)?;
            let Solution { z, outcome } = (scheme.advance)(system, &step, &noise, y);
            path.stop = match outcome {
                _ if !z.iter().all(|component| component.is_finite()) => Some("overflow"),
                Outcome::Failed { .. } => Some("no solution"),
                _ => system.check_domain(z).is_err().then_some("outside the domain"),
            };
            if path.stop.is_some() {
                break;
            }
            y = z;
            path.states.push(y);
            let robust =
                if let Outcome::Robust { residual, .. } = outcome { residual } else { 0.0 };
            path.residuals.push(robust);
        }
        Ok(path)
    }

    /// A row for every scheme, with the figure and what is expected of it by `judge`, which is told
    /// whether a path ended early.
    pub fn rows(
        &self,
        setting: impl Display,
        judge: impl Fn(&Tested<S, D, M>, &[Path<D>], bool) -> Result<(f64, Expected)>,
    ) -> Rows {
        let row = |scheme: &Tested<S, D, M>| {
            let paths = (0..self.paths).map(|number| self.path(scheme, number));
            let paths = paths.collect::<Result<Vec<_>>>()?;
            let stops: Vec<_> = paths.iter().filter_map(|path| path.stop).collect();
            let error = stops.last().map(|cause| match paths.len() {
                1 => format!("{cause} in step {}", paths[0].states.len()),
                all => format!("{} of {all} paths stop: {cause}", stops.len()),
            });
            let (figure, expected) = judge(scheme, &paths, error.is_some())?;
            Ok(Row::new(&setting, scheme.name, error, figure, expected))
        };
        self.schemes.iter().map(row).collect()
    }

    /// The distance from a law for every scheme. The conformal schemes keep it, those without
    /// iteration that of its Casimirs; `must_exceed` is the distance that a scheme has to exceed,
    /// if theory predicts that it fails.
    pub fn law_rows(
        &self,
        setting: impl Display,
        law: &Law,
        must_exceed: impl Fn(Family) -> Option<f64>,
    ) -> Rows {
        self.rows(setting, |scheme, paths, ended| {
            let Distance { worst, excess, bound } = self.distance(paths, law, scheme);
            let early = ended && law.to_the_end.contains(&scheme.family);
            let (figure, bound) = if law.relative { (excess, 1.0) } else { (worst, bound) };
            let expected = match must_exceed(scheme.family) {
                _ if scheme.family.keeps_casimirs() => {
                    Expected::Guarantee(excess <= 1.0 && !early, Some(bound))
                }
                Some(bound) => Expected::MoreThan(bound),
                None => Expected::Anything,
            };
            Ok((figure, expected))
        })
    }

    /// The distance of all paths of a scheme from a law.
    pub fn distance(&self, paths: &[Path<D>], law: &Law, scheme: &Tested<S, D, M>) -> Distance {
        let (system, damping) = (self.problem.system(), self.problem.damping());
        let invariants = system.invariants();
        let newton_step = if scheme.name == NEWTON { law.newton_step } else { 0.0 };
        let time = |n: usize| n as f64 * self.tau();
        let mut distance = Distance::default();
        for path in paths {
            let (mut total, mut residuals) = (0.0, 0.0);
            for (n, y) in path.states.iter().enumerate() {
                if n > 0 {
                    total += damping.integral(time(n - 1), time(n)).abs();
                    residuals += residual_share(path.residuals[n - 1], *y);
                }
                let rounding = scheme.rounding * law_bound(n as u64, total);
                let allowed = law.weight * (rounding + residuals) + newton_step * n as f64;
                let integral = damping.integral(0.0, time(n));
                for &index in law.invariants {
                    let decay = (-invariants[index].degree * integral).exp();
                    let exact = system.invariant(index, path.states[0]) * decay;
                    let defect = (system.invariant(index, *y) / exact - 1.0).abs();
                    distance.worst = distance.worst.max(defect);
                    // Of an energy `sexp-li`, `split` and `nv` do not keep the law.
                    let casimir = invariants[index].kind == InvariantKind::Casimir;
                    if casimir || scheme.family != WithoutIteration {
                        distance.excess = distance.excess.max(defect / allowed);
                    }
                }
                distance.bound = distance.bound.max(allowed);
            }
        }
        distance
    }
}

impl<S: Flows<D, M>, G: Damping, const D: usize, const M: usize> Experiment<S, G, D, M> {
    /// With `split` and `nv` by exact flows of parts that are rotations about axes, of which a step
    /// has so many.
    pub fn with_parts(mut self, [of_split, of_nv]: [usize; 2]) -> Self {
        let middle = self.schemes.iter().position(|scheme| scheme.family == Family::Midpoint);
        let parts = [
            Tested::new(WithoutIteration, rotations(of_split), Split),
            Tested::new(WithoutIteration, rotations(of_nv), Nv::of_parts()),
        ];
        let place = middle.unwrap_or(self.schemes.len());
        self.schemes.splice(place..place, parts);
        self
    }
}

/// Rotations of `split` and `nv` on [`body`].
pub const OF_BODY: [usize; 2] = [5, 7];

/// The paper's rigid body with three noises, with any damping and steps.
pub fn body<G: Damping>(
    context: &Context,
    damping: G,
    steps: (u64, f64),
) -> Result<Experiment<RigidBody<3>, G, 3, 3>> {
    let (body, _, y0, _) = rigid_body_three_noises(1.0).into_parts();
    Ok(Experiment::new(context, (body, damping), y0, steps)?.with_parts(OF_BODY))
}
