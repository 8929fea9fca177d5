//! Strong convergence: root-mean-square errors of several schemes at many step sizes, on one noise.

use std::ops::RangeInclusive;

use analysis::{Exact, wrong_limit};
use mc::{Ladder, Measured, Reference, Run, StrongErrors, WorstTimes, bind};
use noise::Truncation;
use schemes::{SexpLevy, SexpLi};
use stats::{Rate, fit_strong, root_mean_squares};
use systems::{Damping, PoissonSystem, Problem, paper::valid};

use super::curves::{Curve, curves};
use crate::{
    Compiled, Conditions, Findings, Method, PaperSystem, TRUNCATED, Words, compiled,
    results::{Claim, Clipped, Evidence, Kind, Panel, Series},
    streams, truncation,
};

/// Coarsest step size 2⁻⁵.
const FIRST: u32 = 5;
/// The part of an experiment whose noise finds the times of the largest errors.
const WORST_TIMES: u64 = streams::PARTS - 1;
/// Paths that find them.
const PILOT_PATHS: u64 = 512;

/// Step sizes 2⁻⁵ … 2^−last with a reference at 2^−(last + 2), and the number of paths.
#[derive(Clone, Copy)]
pub struct Grid {
    pub last: u32,
    pub samples: u64,
}

impl Grid {
    /// Exponents of the step sizes, coarsest first.
    fn exponents(self) -> RangeInclusive<u32> {
        FIRST..=self.last
    }

    /// The exponent of the reference's step size.
    pub fn reference(self) -> u32 {
        self.last + 2
    }

    /// The level of a step size above that of the reference.
    fn level(self, exponent: u32) -> usize {
        (self.reference() - exponent) as usize
    }

    /// Steps of the reference on [0, T].
    pub fn finest_steps(self, t_end: f64) -> u64 {
        (t_end * 2f64.powi(self.reference() as i32)).round() as u64
    }
}

/// What the curves of a strong panel are drawn from.
pub struct StrongRuns<'a, S, G, const D: usize, const M: usize> {
    pub words: Words,
    /// How increments are truncated.
    pub truncation: Truncation,
    /// The same in words.
    pub truncated: &'static str,
    pub problem: &'a Problem<S, G, D>,
    pub grid: Grid,
    /// The exact solution, which is known at the final time only.
    pub exact: Option<Exact<'a>>,
    /// The one with areas, or else the first, runs at the finest step, too; the errors are
    /// differences from that unless `exact` is given.
    pub curves: &'a [Curve<S, D, M>],
    /// Whether `sexp` is held to the paper's bound, and if so, whether the paper proves it here.
    pub bound: Option<bool>,
}

impl<'a, S: PoissonSystem<D, M>, G: Damping, const D: usize, const M: usize>
    StrongRuns<'a, S, G, D, M>
{
    /// With the truncation of the reproduction, and without an exact solution.
    pub fn new(
        words: Words,
        problem: &'a Problem<S, G, D>,
        grid: Grid,
        curves: &'a [Curve<S, D, M>],
    ) -> Self {
        Self {
            words,
            truncation: truncation(),
            truncated: TRUNCATED,
            problem,
            grid,
            exact: None,
            curves,
            bound: None,
        }
    }

    /// A panel with a claim for each curve. Its series are the errors at the final time of each
    /// curve, then, unless the solution is exact, those at the worst time of the common grid.
    pub fn measure(&self, conditions: &Conditions) -> Findings {
        let Self { problem, curves, .. } = *self;
        let grid = Grid { samples: conditions.paths(self.grid.samples), ..self.grid };
        let finest = curves.iter().find(|curve| curve.scheme.reads_areas()).unwrap_or(&curves[0]);
        let mut runs = vec![Run::new(bind(problem, finest.scheme.as_ref()), 0)];
        let mut series = Vec::new();
        for curve in curves {
            let first = runs.len();
            let run =
                |exponent| Run::new(bind(problem, curve.scheme.as_ref()), grid.level(exponent));
            runs.extend(grid.exponents().map(run));
            series.push((first..runs.len()).collect::<Vec<_>>());
        }
        let reference = match &self.exact {
            Some(exact) => {
                series.push(vec![0]);
                Reference::Exact(&*exact.solution)
            }
            None => Reference::Run(0),
        };
        let mut ladder = valid(Ladder::new(
            &mc::Problem::of(problem),
            grid.finest_steps(problem.t_end()),
            grid.level(FIRST),
            self.truncation,
            conditions.key(0),
            runs,
        ));
        if let Some(exact) = &self.exact {
            ladder = ladder.with_time_change(exact.time_change);
        }
        let times = if self.exact.is_none() { self.worst_times(conditions) } else { Vec::new() };
        let statistic = || {
            let errors = StrongErrors::new(reference, &series, ladder.coarse_steps());
            if times.is_empty() { errors } else { errors.and_at(&times) }
        };
        conditions.progress.begin(conditions.id(), ladder.steps_per_path() * grid.samples);
        let measured = conditions.run(&ladder, grid.samples, statistic);
        conditions.progress.end();

        let taus: Vec<f64> = grid.exponents().map(power_of_half).collect();
        let more = conditions.times_in_words();
        let errors = &measured.statistic;
        let (mut series, mut claims, mut clipped) = (Vec::new(), Vec::new(), Vec::new());
        let all = 0..curves.len();
        let at_end = all.clone().map(|s| (s, "y(T)", "at the final time", errors.at_end(s)));
        let over_time = all
            .filter(|_| self.exact.is_none())
            .map(|s| (s, "sup y", "largest over the common time grid", errors.at_time(s)));
        for (s, quantity, when, squares) in at_end.chain(over_time) {
            let Curve { name, method, .. } = curves[s];
            let rate = fit_strong(&taus[..taus.len() - 1], &squares.differences);
            let elsewhere = wrong_limit(&squares.errors, &squares.differences);
            let when = format!("{when}{more}");
            claims.push(self.claim(conditions.id(), method, &when, rate.clone(), elsewhere));
            series.push(Series {
                scheme: name.into(),
                quantity: quantity.into(),
                points: root_mean_squares(&taus, &squares.errors),
                rate,
                ..Series::default()
            });
        }
        let all_clipped = curves.iter().enumerate();
        for (s, curve) in all_clipped.filter(|(_, curve)| curve.scheme.clips_increments()) {
            for (r, exponent) in grid.exponents().enumerate() {
                let increments = measured.clipped[grid.level(exponent)];
                if increments > 0 {
                    let share = errors.clipped_share(s, r);
                    let scheme = curve.name.into();
                    clipped.push(Clipped { scheme, tau: taus[r], increments, share });
                }
            }
        }
        let at_finest = format!("{} at τ = 2^-{}", finest.method.id(), grid.reference());
        let steps = format!("τ = 2^-{FIRST} … 2^-{}, {}{more}", grid.last, self.truncated);
        let mut panel = Panel {
            samples: grid.samples,
            failures: describe_failures(&measured),
            series,
            clipped,
            ..self.words.panel(conditions.id(), Kind::Strong, problem, &steps)
        };
        if self.exact.is_some() {
            panel.reference = "the exact solution by a change of time, path by path".into();
            let error = |series, level| errors.at_end(series).errors.mean(level).sqrt();
            let own = error(curves.len(), 0);
            panel.paper += &format!(
                " {at_finest}, the kind of reference that the paper takes, is itself {:.1e} (root \
                 mean square) away from the exact solution, {:.0} % of the error of sexp at τ = \
                 2^-{}",
                own,
                100.0 * own / error(0, taus.len() - 1),
                grid.last
            );
        } else {
            panel.reference = format!("{at_finest} on the same noise");
        }
        Findings { panels: vec![panel], claims }
    }

    /// For each curve the time of the common grid at which the error of its coarsest step is
    /// largest, from the difference between that step and a quarter of it on paths of their own,
    /// so that the times do not depend on the errors that are measured there.
    fn worst_times(&self, conditions: &Conditions) -> Vec<u64> {
        let runs = |curve: &'a Curve<S, D, M>| {
            [2, 0].map(|level| Run::new(bind(self.problem, curve.scheme.as_ref()), level))
        };
        let ladder = valid(Ladder::new(
            &mc::Problem::of(self.problem),
            (self.problem.t_end() * 2f64.powi(FIRST as i32 + 2)).round() as u64,
            2,
            self.truncation,
            conditions.key(WORST_TIMES),
            self.curves.iter().flat_map(runs).collect(),
        ));
        let pairs: Vec<_> = (0..self.curves.len()).map(|s| [2 * s, 2 * s + 1]).collect();
        let new = || WorstTimes::new(pairs.clone(), ladder.coarse_steps());
        ladder.run(PILOT_PATHS, new, &|_| ()).statistic.times()
    }

    /// The order of a curve whose errors are taken at the time `when`.
    fn claim(
        &self,
        panel: &str,
        method: Method,
        when: &str,
        rate: Option<Rate>,
        wrong_limit: Option<f64>,
    ) -> Claim {
        // A single noise commutes with itself.
        let commuting = M == 1;
        let (id, bound) = match method {
            Method::SexpLevy | Method::SexpLiLevy => ("strong-one-levy", ""),
            _ if commuting => ("strong-one", "C τ for one noise (k ≥ 2)"),
            _ => ("strong-half", "C τ^½ for several noises (k ≥ 1)"),
        };
        let order = method.strong_order(commuting);
        let bounded = self.bound.filter(|_| method == Method::Sexp);
        let statement = match bounded {
            Some(_) => format!("sup over n of (E‖y_n − y(t_n)‖²)^½ ≤ {bound} ({when})"),
            None => format!("{} has strong order {order} ({when})", method.id()),
        };
        let measured = Evidence::Order { order, one_sided: bounded.is_some(), rate, wrong_limit };
        let claim = Claim::new(id, statement, measured).about(panel, method.id());
        claim.proven(bounded == Some(true))
    }
}

pub fn power_of_half(exponent: u32) -> f64 {
    0.5f64.powi(exponent as i32)
}

/// Paths that were left out: the first few, and how many.
pub fn describe_failures<T>(Measured { failed, failures, .. }: &Measured<T>) -> Vec<String> {
    let mut lines: Vec<String> = failures.iter().map(ToString::to_string).collect();
    if *failed > failures.len() as u64 {
        lines.push(format!("… {failed} paths in all"));
    }
    lines
}

/// A panel of strong errors.
pub struct StrongPanel {
    pub words: Words,
    /// Exponent of the finest step size at the paper's sizes.
    pub last: u32,
    /// Paths at the paper's sizes.
    pub samples: u64,
    /// Whether the paper proves the order of `sexp` here.
    pub proven: bool,
}

/// Sizes of the quick mode.
const QUICK: Grid = Grid { last: 10, samples: 512 };

impl StrongPanel {
    /// The three schemes of the paper, and those without iteration that are wanted, against `sexp`
    /// at the finest step, with a claim for each curve.
    pub fn compare<S: PaperSystem<D, M>, G: Damping, const D: usize, const M: usize>(
        &self,
        conditions: &Conditions,
        problem: &Problem<S, G, D>,
    ) -> Findings {
        let curves = curves(conditions, problem);
        let runs = StrongRuns::new(self.words, problem, self.grid(conditions, 0), &curves);
        StrongRuns { bound: Some(self.proven), ..runs }.measure(conditions)
    }

    /// The step sizes, of which the last `fewer` are left out at the paper's sizes.
    fn grid(&self, conditions: &Conditions, fewer: u32) -> Grid {
        conditions.choose(Grid { last: self.last - fewer, samples: self.samples }, QUICK)
    }

    /// [`compare`](Self::compare) with more curves where they are wanted: the schemes with areas,
    /// against the first of them at a finer step. Drawing areas costs as many normals as the square
    /// root of the step count, so its steps end three levels before those of the others.
    pub fn compare_with_areas<
        S: PaperSystem<D, 3> + Compiled<SexpLevy, D, 3>,
        G: Damping,
        const D: usize,
    >(
        &self,
        conditions: &Conditions,
        problem: &Problem<S, G, D>,
    ) -> Findings {
        let mut findings = self.compare(conditions, problem);
        let (system, y0) = (problem.system(), problem.y0());
        let wanted = |method| conditions.further.contains(&method);
        let mut curves = Vec::new();
        if wanted(Method::SexpLevy) {
            curves.push(Curve::new(Method::SexpLevy, compiled(SexpLevy::new(system, y0))));
        }
        if wanted(Method::SexpLiLevy) {
            let levy = compiled(valid(SexpLi::with_areas(system, y0)));
            curves.push(Curve::new(Method::SexpLiLevy, levy));
        }
        if curves.is_empty() {
            return findings;
        }
        let runs = StrongRuns::new(self.words, problem, self.grid(conditions, 3), &curves);
        let areas = runs.measure(conditions);
        findings.claims.extend(areas.claims);
        for (panel, areas) in findings.panels.iter_mut().zip(areas.panels) {
            panel.reference = format!("{}; with areas: {}", panel.reference, areas.reference);
            panel.failures.extend(areas.failures);
            panel.series.extend(areas.series);
        }
        findings
    }
}
