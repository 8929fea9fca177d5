//! A few paths of one scheme, each until its end or a typed error, and their distance from
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

use crate::{Context, Row, Rows};

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
        self == Self::Conformal || self == Self::WithoutIteration && kind == InvariantKind::Casimir
    }
}

/// A scheme under its name in results.
pub struct Tested<S, const D: usize, const M: usize> {
    pub name: &'static str,
    pub family: Family,
    /// What a step rounds, in units of that of `sexp`, see `rounding`.
    pub rounding: f64,
    /// A step of a single path: no kernel for blocks has to be compiled for the systems of hard
    /// cases.
    pub advance: Box<Advance<S, D, M>>,
    newton: bool,
    reads_areas: bool,
    clips_increments: bool,
}

type Advance<S, const D: usize, const M: usize> =
    dyn Fn(&S, &Step, &Noise<M>, [f64; D]) -> Solution<D>;

impl<S, const D: usize, const M: usize> Tested<S, D, M> {
    fn new(family: Family, rounding: f64, scheme: impl Scheme<S, D, M> + 'static) -> Self {
        Self {
            name: scheme.id(),
            family,
            rounding,
            newton: false,
            reads_areas: scheme.reads_areas(),
            clips_increments: scheme.clips_increments(),
            advance: Box::new(move |system, step, noise, y| scheme.step(system, step, noise, y)),
        }
    }
}

/// Every scheme that differs from the others with M noises, without exact flows.
fn schemes<S: PoissonSystem<D, M>, const D: usize, const M: usize>(
    system: &S,
    y0: [f64; D],
) -> Vec<Tested<S, D, M>> {
    use Family::{Conformal, Explicit, Midpoint as Middle, WithoutIteration};
    let newton = WithSolver { formula: Sexp, solver: Solver::new(Method::Newton) };
    let fixed_point = WithSolver { formula: Sexp, solver: Solver::new(Method::FixedPoint) };
    let mut all = vec![
        Tested::new(Conformal, 1.0, fixed_point),
        Tested { name: "sexp-newton", newton: true, ..Tested::new(Conformal, 1.0, newton) },
    ];
    if M > 1 {
        all.push(Tested::new(Conformal, 1.0, SexpLevy::new(system, y0)));
    }
    if let Ok(scheme) = SexpLi::new(system, y0) {
        all.push(Tested::new(WithoutIteration, LINEARLY_IMPLICIT, scheme));
    }
    all.push(Tested::new(Middle, 1.0, Midpoint));
    all.push(Tested::new(Explicit, 1.0, Heun));
    all.push(Tested::new(Explicit, 1.0, EulerMaruyama));
    all
}

/// One path as far as it lasts.
pub struct Path<const D: usize> {
    /// y₀, y₁, ….
    pub states: Vec<[f64; D]>,
    /// What the robust solver left of the equation of each step; none where it was not needed.
    residuals: Vec<Option<f64>>,
    /// Why it ends early, and in which step, counted from 1.
    stop: Option<(&'static str, u64)>,
}

impl<const D: usize> Path<D> {
    /// Its last state.
    pub fn end(&self) -> [f64; D] {
        self.states[self.states.len() - 1]
    }
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
    /// The noise of each step by its number, where it does not come from the streams.
    pub noise: Option<Box<dyn Fn(u64) -> Noise<M>>>,
}

/// A conformal law with the rounding that is allowed.
pub struct Law {
    /// Numbers of the invariants.
    pub invariants: &'static [usize],
    /// How many times the rounding of a quadratic Casimir is allowed.
    pub weight: f64,
    /// What a step of Newton's method may add.
    pub newton_step: f64,
    /// Of which schemes that keep the law no path may end early.
    pub to_the_end: &'static [Family],
}

/// The law of a quadratic Casimir.
pub const CASIMIR: Law = Law { invariants: &[0], weight: 1.0, newton_step: 0.0, to_the_end: &[] };

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
        let schemes = schemes(&system, y0);
        let problem = Problem::new::<M>(system, damping, y0, steps as f64 * tau)?;
        let (truncation, key) = (verify::truncation(), context.key);
        Ok(Self { problem, schemes, steps, paths: 1, truncation, key, areas: true, noise: None })
    }

    fn tau(&self) -> f64 {
        self.problem.t_end() / self.steps as f64
    }

    /// The paths of one scheme.
    pub fn run(&self, scheme: &Tested<S, D, M>) -> Result<Vec<Path<D>>> {
        (0..self.paths).map(|number| self.path(scheme, number)).collect()
    }

    fn path(&self, scheme: &Tested<S, D, M>, number: u64) -> Result<Path<D>> {
        let (system, tau) = (self.problem.system(), self.tau());
        let areas = self.areas && scheme.reads_areas;
        let terms = if areas { area_terms(strong_order_one_error(tau), tau, M)? } else { 1 };
        let mut areas = areas.then(|| AreaPath::new(self.key, number, terms));
        let mut increments = WienerPath::new(self.key, number);
        let clips = if scheme.clips_increments { self.truncation } else { Truncation::none() };
        let (bound, area_bound) = (clips.bound(tau)?, clips.area_bound(tau)?);
        let mut path = Path { states: vec![self.problem.y0()], residuals: Vec::new(), stop: None };
        for n in 0..self.steps {
            let drawn = || {
                let dw = increments.increments(tau.sqrt());
                let drawn = Noise::increments(dw);
                areas.as_mut().map_or(drawn, |areas| Noise { areas: areas.areas(tau, dw), ..drawn })
            };
            let noise = self.noise.as_ref().map_or_else(drawn, |noise| noise(n));
            let noise = Noise {
                increments: noise.increments.map(|dw| dw.clamp(-bound, bound)),
                areas: noise.areas.map(|row| row.map(|a| a.clamp(-area_bound, area_bound))),
            };
            let step = Step::new(self.problem.damping(), n, tau)?;
            let Solution { z, outcome } = (scheme.advance)(system, &step, &noise, path.end());
            let cause = match outcome {
                _ if !z.iter().all(|component| component.is_finite()) => Some("overflow"),
                Outcome::Failed { .. } => Some("no solution"),
                _ => system.check_domain(z).is_err().then_some("outside the domain"),
            };
            if let Some(cause) = cause {
                path.stop = Some((cause, n + 1));
                break;
            }
            path.states.push(z);
            path.residuals.push(match outcome {
                Outcome::Robust { residual, .. } => Some(residual),
                _ => None,
            });
        }
        Ok(path)
    }

    /// A row for every scheme, which `complete` gives its figure and its claim.
    pub fn rows(
        &self,
        setting: impl Display,
        complete: impl Fn(Row, &Tested<S, D, M>, &[Path<D>]) -> Result<Row>,
    ) -> Rows {
        let row = |scheme: &Tested<S, D, M>| {
            let paths = self.run(scheme)?;
            let stops: Vec<_> = paths.iter().filter_map(|path| path.stop).collect();
            let error = stops.last().map(|(cause, step)| match paths.len() {
                1 => format!("{cause} in step {step}"),
                all => format!("{} of {all} paths stop: {cause}", stops.len()),
            });
            complete(Row::new(&setting, scheme.name, error), scheme, &paths)
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
        self.rows(setting, |row, scheme, paths| {
            let Distance { worst, excess, bound } = self.distance(paths, law, scheme);
            let early = row.error.is_some() && law.to_the_end.contains(&scheme.family);
            let row = row.with_figure(worst);
            Ok(match must_exceed(scheme.family) {
                _ if scheme.family.keeps(InvariantKind::Casimir) => {
                    row.guaranteed(excess <= 1.0 && !early, bound)
                }
                Some(bound) => row.must_exceed(bound),
                None => row,
            })
        })
    }

    /// The distance of all paths of a scheme from a law. Where both sides of it overflow there is
    /// none.
    pub fn distance(&self, paths: &[Path<D>], law: &Law, scheme: &Tested<S, D, M>) -> Distance {
        let (system, damping) = (self.problem.system(), self.problem.damping());
        let invariants = system.invariants();
        let newton_step = if scheme.newton { law.newton_step } else { 0.0 };
        let time = |n: usize| n as f64 * self.tau();
        let mut distance = Distance::default();
        for path in paths {
            let (mut total, mut residuals) = (0.0, 0.0);
            for (n, y) in path.states.iter().enumerate() {
                if n > 0 {
                    total += damping.integral(time(n - 1), time(n)).abs();
                    residuals += residual_share(path.residuals[n - 1].unwrap_or(0.0), *y);
                }
                let rounding = scheme.rounding * law_bound(n as u64, total);
                let allowed = law.weight * (rounding + residuals) + newton_step * n as f64;
                let integral = damping.integral(0.0, time(n));
                for &index in law.invariants {
                    let decay = (-invariants[index].degree * integral).exp();
                    let exact = system.invariant(index, self.problem.y0()) * decay;
                    let defect = (system.invariant(index, *y) / exact - 1.0).abs();
                    distance.worst = distance.worst.max(defect);
                    if scheme.family.keeps(invariants[index].kind) {
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
    /// With `split` and `nv`: exact flows of parts that are rotations about axes.
    pub fn with_parts(mut self) -> Self {
        let all = 2 * S::PARTS - 1;
        let drifting = |&part: &usize| self.problem.system().drifts(part);
        let noise = |part: Option<usize>| if part.is_some() { 1 } else { 3 * all };
        let noises: usize = S::NOISE_PARTS.into_iter().map(noise).sum();
        let of_nv = 2 * (0..S::PARTS).filter(drifting).count() + noises;
        let without = Family::WithoutIteration;
        let middle = self.schemes.iter().position(|scheme| scheme.family == Family::Midpoint);
        let place = middle.unwrap_or(self.schemes.len());
        self.schemes.insert(place, Tested::new(without, rotations(of_nv), Nv::of_parts()));
        self.schemes.insert(place, Tested::new(without, rotations(all), Split));
        self
    }
}

/// The paper's rigid body with three noises, with any damping and steps.
pub fn body<G: Damping>(
    context: &Context,
    damping: G,
    steps: (u64, f64),
) -> Result<Experiment<RigidBody<3>, G, 3, 3>> {
    let (body, _, y0, _) = rigid_body_three_noises(1.0).into_parts();
    Ok(Experiment::new(context, (body, damping), y0, steps)?.with_parts())
}
