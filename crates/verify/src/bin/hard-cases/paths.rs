//! A few paths of one scheme, each until its end or a typed error, and their distance from
//! conformal laws.

use std::{collections::BTreeMap, fmt::Display};

use anyhow::Result;
use mc::{Ladder, NextNoise, Run, Statistic, View, bind};
use noise::{StreamKey, Truncation};
use real::WIDTH;
use systems::{
    Damping, Flows, InvariantKind, PoissonSystem, Problem, RigidBody,
    paper::rigid_body_three_noises,
};
use verify::rounding::{law_bound, residual_share};

use crate::{
    Context, Rows,
    row::Row,
    schemes::{Family, Tested, by_parts, schemes},
};

/// One path as far as it lasts.
pub struct Path<const D: usize> {
    /// y₀, y₁, ….
    pub states: Vec<[f64; D]>,
    /// What the robust solver left of the equation of each step; none where it was not needed.
    pub residuals: Vec<Option<f64>>,
    /// Why it ends early, and in which step, counted from 1.
    pub stop: Option<(&'static str, u64)>,
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
    pub steps: u64,
    pub paths: u64,
    pub truncation: Truncation,
    pub key: StreamKey,
    /// Where the noise comes from, if not from the streams.
    /// It gives that of a block of paths, see [`mc::NoiseSource`].
    pub noise: Option<Box<dyn Fn(u64) -> NextNoise<'static> + Sync>>,
    /// `split` and `nv`, where flows are known.
    pub by_parts: Option<ByParts<S, D, M>>,
}

type ByParts<S, const D: usize, const M: usize> = fn(&S) -> [Tested<S, D, M>; 2];

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
    /// Whether rows report the steps that the robust solver takes.
    pub counts_continuation: bool,
}

/// The law of a quadratic Casimir.
pub const CASIMIR: Law = Law {
    invariants: &[0],
    weight: 1.0,
    newton_step: 0.0,
    to_the_end: &[],
    counts_continuation: false,
};

/// Distance of paths from a law.
#[derive(Default)]
pub struct Distance {
    /// The largest relative distance.
    pub worst: f64,
    /// The largest quotient of a distance and what is allowed there, of laws that the scheme keeps.
    pub excess: f64,
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
        let problem = Problem::new::<M>(system, damping, y0, steps as f64 * tau)?;
        let (truncation, key) = (verify::truncation(), context.key);
        Ok(Self { problem, steps, paths: 1, truncation, key, noise: None, by_parts: None })
    }

    /// With noise from elsewhere: a function of the number of a block's first path.
    pub fn with_noise(self, source: impl Fn(u64) -> NextNoise<'static> + Sync + 'static) -> Self {
        Self { noise: Some(Box::new(source)), ..self }
    }

    /// The paths of one scheme.
    pub fn run(&self, scheme: &Tested<S, D, M>) -> Result<Vec<Path<D>>> {
        let runs = vec![Run::new(bind(&self.problem, scheme), 0)];
        let mut ladder = Ladder::new(
            &mc::Problem::of(&self.problem),
            self.steps,
            0,
            self.truncation,
            self.key,
            runs,
        )?;
        if let Some(source) = &self.noise {
            ladder = ladder.with_noise(source)?;
        }
        let record = || Record { experiment: self, paths: BTreeMap::new() };
        let measured = ladder.run(self.paths, record, &|_| ());
        Ok(measured.statistic.paths.into_values().collect())
    }

    /// The schemes.
    pub fn schemes(&self) -> Vec<Tested<S, D, M>> {
        let mut all = schemes(self.problem.system(), self.problem.y0());
        if let Some(by_parts) = self.by_parts {
            let midpoint = all.iter().position(|scheme| scheme.family == Family::Midpoint);
            let place = midpoint.unwrap_or(all.len());
            all.splice(place..place, by_parts(self.problem.system()));
        }
        for scheme in &mut all {
            scheme.paths = WIDTH.min(self.paths as usize);
        }
        all
    }

    /// A row for every scheme, which `complete` gives its figure and its claim.
    pub fn rows(
        &self,
        setting: impl Display,
        complete: impl Fn(Row, &Tested<S, D, M>, &[Path<D>]) -> Result<Row>,
    ) -> Rows {
        let row = |scheme: &Tested<S, D, M>| {
            let paths = self.run(scheme)?;
            complete(Row::new(&setting, scheme.name, stops(&paths)), scheme, &paths)
        };
        self.schemes().iter().map(row).collect()
    }

    /// The distance from a law for every scheme. The conformal schemes keep it, those without
    /// iteration that of its Casimirs; `must_exceed` is
    /// the distance that a scheme has to exceed, if theory predicts that it fails.
    pub fn law_rows(
        &self,
        setting: impl Display,
        law: &Law,
        must_exceed: impl Fn(Family) -> Option<f64>,
    ) -> Rows {
        self.rows(setting, |row, scheme, paths| {
            let Distance { worst, excess, bound } = self.distance(paths, law, scheme);
            let early = row.error.is_some() && law.to_the_end.contains(&scheme.family);
            let kept = excess <= 1.0 && !early;
            let row = row.with_figure(worst);
            let row = match must_exceed(scheme.family) {
                _ if scheme.family.keeps(InvariantKind::Casimir) => row.guaranteed(kept, bound),
                Some(bound) => row.must_exceed(bound),
                None => row,
            };
            let robust = paths.iter().flat_map(|path| &path.residuals).flatten().count();
            let continuation = (law.counts_continuation && robust > 0)
                .then(|| format!("{robust} steps by continuation"));
            Ok(Row { error: row.error.or(continuation), ..row })
        })
    }

    /// The distance of all paths of a scheme from a law. Where both sides of it overflow there is
    /// none.
    pub fn distance(&self, paths: &[Path<D>], law: &Law, scheme: &Tested<S, D, M>) -> Distance {
        let (system, damping, y0) =
            (self.problem.system(), self.problem.damping(), self.problem.y0());
        let invariants = system.invariants();
        let newton_step = if scheme.newton { law.newton_step } else { 0.0 };
        let time = |n: usize| n as f64 * (self.problem.t_end() / self.steps as f64);
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
                    let exact = system.invariant(index, y0) * decay;
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
    /// With `split` and `nv`.
    pub fn with_parts(self) -> Self {
        Self { by_parts: Some(by_parts), ..self }
    }
}

/// How paths ended early, in words.
fn stops<const D: usize>(paths: &[Path<D>]) -> Option<String> {
    let stops: Vec<_> = paths.iter().filter_map(|path| path.stop).collect();
    let (cause, step) = stops.last()?;
    Some(match paths.len() {
        1 => format!("{cause} in step {step}"),
        all => format!("{} of {all} paths stop: {cause}", stops.len()),
    })
}

/// Keeps every path.
struct Record<'a, S, G, const D: usize, const M: usize> {
    experiment: &'a Experiment<S, G, D, M>,
    paths: BTreeMap<u64, Path<D>>,
}

impl<S: PoissonSystem<D, M>, G: Damping, const D: usize, const M: usize> Statistic
    for Record<'_, S, G, D, M>
{
    fn observe(&mut self, view: &View<'_>) {
        let Experiment { problem, paths, .. } = &self.experiment;
        let block = (view.first_path..(*paths).min(view.first_path + WIDTH as u64)).zip(0..);
        for (number, p) in block {
            let start = || Path { states: vec![problem.y0()], residuals: Vec::new(), stop: None };
            let path = self.paths.entry(number).or_insert_with(start);
            if path.stop.is_some() {
                continue;
            }
            let (y, status) = (view.path(0, p), &view.statuses[0]);
            let cause = if !y.iter().all(|component| component.is_finite()) {
                Some("overflow")
            } else if !view.live.contains(p) {
                Some("no solution")
            } else {
                problem.system().check_domain(y).is_err().then_some("outside the domain")
            };
            path.stop = cause.map(|cause| (cause, view.time));
            if cause.is_none() {
                path.states.push(y);
                path.residuals.push(status.robust.contains(p).then(|| status.residual(p)));
            }
        }
    }

    fn merge(&mut self, later: Self) {
        self.paths.extend(later.paths);
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
