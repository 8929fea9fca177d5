//! Strong convergence: root-mean-square errors of several schemes at many step sizes, on one noise.

use std::ops::RangeInclusive;

use analysis::{Exact, FinalMoments, squared_distance, wrong_limit};
use mc::{Ladder, Measured, Run, View};
use noise::Truncation;
use real::Row;
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
        let solution = self.exact.as_ref().map(|exact| &*exact.solution);
        if solution.is_some() {
            series.push(vec![0]);
        }
        let (steps, key) = (grid.finest_steps(problem.t_end), conditions.key(0));
        let coarsest = grid.level(FIRST);
        let mut ladder = valid(Ladder::new(problem, steps, coarsest, self.truncation, key, runs));
        if let Some(exact) = &self.exact {
            ladder = ladder.with_time_change(exact.time_change);
        }
        let over_time = self.exact.is_none();
        // All series at the final time, then those with a time of their own.
        let last = ladder.coarse_steps();
        let mut when: Vec<_> = series.iter().map(|runs| (last, runs)).collect();
        if over_time {
            when.extend(self.worst_times(conditions, curves).into_iter().zip(&series));
        }
        let squares = when.iter().map(|&(_, runs)| {
            move |view: &View<'_>, rows: &mut [Row]| write_squares(runs, solution, view, rows)
        });
        let squares: Vec<_> = squares.collect();
        let statistic = || {
            let moments = when.iter().zip(&squares).map(|(&(time, runs), squares)| {
                FinalMoments::new(time, 3 * runs.len() - 1, squares)
            });
            moments.collect::<Vec<_>>()
        };
        conditions.progress.begin(id, ladder.steps_per_path() * grid.samples);
        let advance = |work| conditions.progress.advance(work);
        let measured = ladder.run(grid.samples, statistic, &advance);
        conditions.progress.end();

        let taus: Vec<f64> = grid.exponents().map(power_of_half).collect();
        let more = conditions.times_in_words();
        let runs = taus.len();
        let moments = |n: usize| &measured.statistic[n].moments;
        let (mut series, mut claims, mut clipped) = (Vec::new(), Vec::new(), Vec::new());
        for at_end in [true, false].into_iter().filter(|at_end| *at_end || over_time) {
            for (s, curve) in curves.iter().enumerate() {
                let (quantity, when, squares) = match at_end {
                    true => ("y(T)", "at the final time", moments(s)),
                    false => {
                        ("sup y", "largest over the common time grid", moments(curves.len() + s))
                    }
                };
                let errors = squares.part(0..runs);
                let differences = squares.part(runs..2 * runs - 1);
                let rate = fit_strong(&taus[..runs - 1], &differences);
                let elsewhere = wrong_limit(&errors, &differences);
                let when = format!("{when}{more}");
                let one_noise = problem.noises == 1;
                let claim = self.claim(curve.method, one_noise, &when, rate.clone(), elsewhere);
                claims.push(claim.about(id, curve.method.id()));
                series.push(Series {
                    scheme: curve.name.into(),
                    quantity: quantity.into(),
                    points: root_mean_squares(&taus, &errors),
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
                    let [all, clipped_paths] =
                        [r, 2 * runs - 1 + r].map(|number| moments(s).mean(number));
                    let share = if all > 0.0 { clipped_paths / all } else { 0.0 };
                    let tau = taus[r];
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
            let error = |series: usize, level| moments(series).mean(level).sqrt();
            let own = error(curves.len(), 0);
            panel.paper += &format!(
                " {at_finest}, the kind of reference that the paper takes, is itself {own:.1e} \
                 (root mean square) away from the exact solution, {:.0} % of the error of sexp at \
                 τ = 2^-{}",
                100.0 * own / error(0, runs - 1),
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
        let differences = |view: &View<'_>, rows: &mut [Row]| {
            for (s, row) in rows.iter_mut().enumerate() {
                *row = squared_distance(view.state(2 * s), view.state(2 * s + 1), view.live);
            }
        };
        let at = |time| FinalMoments::new(time, curves.len(), &differences);
        let new = || (1..=ladder.coarse_steps()).map(at).collect::<Vec<_>>();
        let found = ladder.run(PILOT_PATHS, new, &|_| ()).statistic;
        let worst = |s: usize| {
            // Sums: a path that failed counts no more.
            let square =
                |found: &FinalMoments<'_>| found.moments.mean(s) * found.moments.count() as f64;
            let squares = (1..).zip(found.iter().map(square));
            squares.max_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |(time, _)| time)
        };
        (0..curves.len()).map(worst).collect()
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

/// The squared errors |y − y_ref|² of these runs, the squares of the differences of each run but
/// the last from the next one, and the errors again where an increment was clipped, zero elsewhere.
/// y_ref is the exact solution at the random time of a path, or run 0.
fn write_squares(
    runs: &[usize],
    solution: Option<&(dyn Fn(f64) -> Vec<f64> + Sync)>,
    view: &View<'_>,
    rows: &mut [Row],
) {
    let mut reference = view.state(0).to_vec();
    if let Some(solution) = solution {
        for p in view.live.paths() {
            let exact = solution(view.random_time[p]);
            reference.iter_mut().zip(exact).for_each(|(row, x)| row[p] = x);
        }
    }
    let (errors, rest) = rows.split_at_mut(runs.len());
    let (differences, clipped) = rest.split_at_mut(runs.len() - 1);
    for (r, &run) in runs.iter().enumerate() {
        errors[r] = squared_distance(view.state(run), &reference, view.live);
        let clips = |p| if view.clipped[run].contains(p) { errors[r][p] } else { 0.0 };
        clipped[r] = std::array::from_fn(clips);
    }
    for (difference, pair) in differences.iter_mut().zip(runs.windows(2)) {
        *difference = squared_distance(view.state(pair[0]), view.state(pair[1]), view.live);
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
