//! Strong convergence: root-mean-square errors of several schemes at many step sizes, on one noise.

use std::ops::RangeInclusive;

use analysis::{Exact, wrong_limit};
use mc::{Ladder, Measured, Reference, Run, StrongErrors, WorstTimes};
use noise::Truncation;
use schemes::{BuiltIn, StrongOrder};
use stats::{Rate, fit_strong, root_mean_squares};
use systems::paper::valid;

use crate::{
    Compiled, Conditions, Curve, Findings, TRUNCATED, Words,
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
    fn reference(self) -> u32 {
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

/// What a strong panel is made of.
pub struct StrongPanel<'a> {
    pub words: Words,
    pub grid: Grid,
    /// How increments are truncated.
    pub truncation: Truncation,
    /// The same in words.
    pub truncated: &'static str,
    /// The exact solution, which is known at the final time only.
    pub exact: Option<Exact<'a>>,
    /// Whether `sexp` is held to the paper's bound, and if so, whether the paper proves it here.
    pub bound: Option<bool>,
}

impl StrongPanel<'_> {
    /// With the truncation of the reproduction, and without an exact solution.
    pub fn new(words: Words, grid: Grid) -> Self {
        let truncated = TRUNCATED;
        Self { words, grid, truncation: truncation(), truncated, exact: None, bound: None }
    }

    /// A panel with a claim for each curve. Its series are the errors at the final time of each
    /// curve, then, unless the solution is exact, those at the worst time of the common grid.
    ///
    /// The curve with areas, or else the first, runs at the finest step, too; the errors are
    /// differences from that unless the solution is exact.
    pub fn measure<'a>(&self, conditions: &Conditions, curves: &[Curve<'a>]) -> Findings {
        let (id, problem) = (conditions.id(), &curves[0].setup.problem);
        let grid = Grid { samples: conditions.paths(self.grid.samples), ..self.grid };
        let finest = curves.iter().find(|curve| curve.method.is_for_areas()).unwrap_or(&curves[0]);
        let run = |curve: &Curve<'a>, level| Run::new(curve.setup.scheme.clone(), level);
        let mut runs = vec![run(finest, 0)];
        let mut series = Vec::new();
        for curve in curves {
            let first = runs.len();
            runs.extend(grid.exponents().map(|exponent| run(curve, grid.level(exponent))));
            series.push((first..runs.len()).collect::<Vec<_>>());
        }
        let mut reference = Reference::Run(0);
        if let Some(exact) = &self.exact {
            series.push(vec![0]);
            reference = Reference::Exact(&*exact.solution);
        }
        let (steps, key) = (grid.finest_steps(problem.t_end), conditions.key(0));
        let coarsest = grid.level(FIRST);
        let mut ladder = valid(Ladder::new(problem, steps, coarsest, self.truncation, key, runs));
        if let Some(exact) = &self.exact {
            ladder = ladder.with_time_change(exact.time_change);
        }
        let over_time = self.exact.is_none();
        let times = over_time.then(|| self.worst_times(conditions, curves));
        let statistic = || {
            let errors = StrongErrors::new(reference, &series, ladder.coarse_steps());
            times.iter().fold(errors, |errors, times| errors.and_at(times))
        };
        conditions.progress.begin(id, ladder.steps_per_path() * grid.samples);
        let advance = |work| conditions.progress.advance(work);
        let measured = ladder.run(grid.samples, statistic, &advance);
        conditions.progress.end();

        let taus: Vec<f64> = grid.exponents().map(power_of_half).collect();
        let more = conditions.times_in_words();
        let errors = &measured.statistic;
        let (mut series, mut claims, mut clipped) = (Vec::new(), Vec::new(), Vec::new());
        for at_end in [true, false].into_iter().filter(|at_end| *at_end || over_time) {
            for (s, curve) in curves.iter().enumerate() {
                let (quantity, when, squares) = match at_end {
                    true => ("y(T)", "at the final time", errors.at_end(s)),
                    false => ("sup y", "largest over the common time grid", errors.at_time(s)),
                };
                let rate = fit_strong(&taus[..taus.len() - 1], &squares.differences);
                let elsewhere = wrong_limit(&squares.errors, &squares.differences);
                let when = format!("{when}{more}");
                let one_noise = problem.noises == 1;
                let claim = self.claim(curve.method, one_noise, &when, rate.clone(), elsewhere);
                claims.push(claim.about(id, curve.method.id()));
                series.push(Series {
                    scheme: curve.name.into(),
                    quantity: quantity.into(),
                    points: root_mean_squares(&taus, &squares.errors),
                    rate,
                    ..Series::default()
                });
            }
        }
        let curve_clips = |(_, curve): &(_, &Curve<'_>)| curve.setup.scheme.clips_increments();
        for (s, curve) in curves.iter().enumerate().filter(curve_clips) {
            for (r, exponent) in grid.exponents().enumerate() {
                let increments = measured.clipped[grid.level(exponent)];
                if increments > 0 {
                    let (tau, share) = (taus[r], errors.clipped_share(s, r));
                    clipped.push(Clipped { scheme: curve.name.into(), tau, increments, share });
                }
            }
        }
        let at_finest = format!("{} at τ = 2^-{}", finest.method.id(), grid.reference());
        let steps = format!("τ = 2^-{FIRST} … 2^-{}, {}{more}", grid.last, self.truncated);
        let mut panel = Panel {
            samples: grid.samples,
            reference: format!("{at_finest} on the same noise"),
            failures: describe_failures(&measured),
            series,
            clipped,
            ..self.words.panel(id, Kind::Strong, problem, &steps)
        };
        if !over_time {
            panel.reference = "the exact solution by a change of time, path by path".into();
            let error = |series, level| errors.at_end(series).errors.mean(level).sqrt();
            let own = error(curves.len(), 0);
            panel.paper += &format!(
                " {at_finest}, the kind of reference that the paper takes, is itself {own:.1e} \
                 (root mean square) away from the exact solution, {:.0} % of the error of sexp at \
                 τ = 2^-{}",
                100.0 * own / error(0, taus.len() - 1),
                grid.last
            );
        }
        Findings { panels: vec![panel], claims }
    }

    /// For each curve the time of the common grid at which the error of its coarsest step is
    /// largest, from the difference between that step and a quarter of it on paths of their own,
    /// so that the times do not depend on the errors that are measured there.
    fn worst_times(&self, conditions: &Conditions, curves: &[Curve<'_>]) -> Vec<u64> {
        let problem = &curves[0].setup.problem;
        let runs = curves
            .iter()
            .flat_map(|curve| [2, 0].map(|level| Run::new(curve.setup.scheme.clone(), level)));
        let steps = (problem.t_end * 2f64.powi(FIRST as i32 + 2)).round() as u64;
        let (key, runs) = (conditions.key(WORST_TIMES), runs.collect());
        let ladder = valid(Ladder::new(problem, steps, 2, self.truncation, key, runs));
        let pairs: Vec<_> = (0..curves.len()).map(|s| [2 * s, 2 * s + 1]).collect();
        let new = || WorstTimes::new(pairs.clone(), ladder.coarse_steps());
        ladder.run(PILOT_PATHS, new, &|_| ()).statistic.times()
    }

    /// The order of a scheme whose errors are taken at the time `when`. A single noise commutes
    /// with itself.
    fn claim(
        &self,
        method: BuiltIn,
        one_noise: bool,
        when: &str,
        rate: Option<Rate>,
        wrong_limit: Option<f64>,
    ) -> Claim {
        let (id, order, bound) = match (method.properties().strong, one_noise) {
            (StrongOrder::Areas, _) => ("strong-one-levy", 1.0, ""),
            (StrongOrder::Commuting, true) => ("strong-one", 1.0, "C τ for one noise (k ≥ 2)"),
            (_, true) => ("strong-one", 0.5, ""),
            (_, false) => ("strong-half", 0.5, "C τ^½ for several noises (k ≥ 1)"),
        };
        let bounded = self.bound.filter(|_| method == BuiltIn::Sexp);
        let statement = match bounded {
            Some(_) => format!("sup over n of (E‖y_n − y(t_n)‖²)^½ ≤ {bound} ({when})"),
            None => format!("{} has strong order {order} ({when})", method.id()),
        };
        let measured = Evidence::Order { order, one_sided: bounded.is_some(), rate, wrong_limit };
        Claim::new(id, statement, measured).proven(bounded == Some(true))
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

/// Sizes of the quick mode.
const QUICK: Grid = Grid { last: 10, samples: 512 };

/// The schemes of the paper, and the further ones that are wanted, with a claim for each curve:
/// step sizes down to 2^−last and so many paths at the paper's sizes, and whether the paper proves
/// the order of `sexp` here.
///
/// Schemes with areas have the first of them at a finer step as reference. Drawing areas costs as
/// many normals as the square root of the step count, so their steps end three levels before those
/// of the others.
pub fn compare(
    conditions: &Conditions,
    words: Words,
    (last, samples): (u32, u64),
    proven: bool,
    compiled: &Compiled<'_>,
) -> Findings {
    let measure = |fewer: u32, curves: &[Curve<'_>]| {
        let grid = conditions.choose(Grid { last: last - fewer, samples }, QUICK);
        let bound = Some(proven);
        StrongPanel { bound, ..StrongPanel::new(words, grid) }.measure(conditions, curves)
    };
    let mut findings = measure(0, &conditions.curves(compiled));
    let mut areas = conditions.further.to_vec();
    areas.retain(|scheme| scheme.is_for_areas());
    let areas = compiled.curves(&areas);
    if !areas.is_empty() {
        let Findings { panels, claims } = measure(3, &areas);
        findings.claims.extend(claims);
        for (panel, areas) in findings.panels.iter_mut().zip(panels) {
            panel.reference += &format!("; with areas: {}", areas.reference);
            panel.failures.extend(areas.failures);
            panel.series.extend(areas.series);
        }
    }
    findings
}
