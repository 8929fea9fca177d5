//! Strong convergence: root-mean-square errors of several schemes at many step sizes, on one noise.

use analysis::{Exact, squared_distance, wrong_limit};
use mc::Measured;
use schemes::StrongOrder;
use stats::{fit_strong, root_mean_squares};

use crate::*;

/// Coarsest step size 2⁻⁵.
const FIRST: u32 = 5;
/// Part number of an experiment's noise that finds the times of the largest errors.
const WORST_TIMES: u64 = streams::PARTS - 1;
/// Number of paths that find the times of the largest errors.
const PILOT_PATHS: u64 = 512;

/// Settings of a strong panel: step sizes 2⁻⁵ … 2^−last with a reference at 2^−(last + 2).
pub struct StrongPanel<'a> {
    pub words: Words,
    pub last: u32,
    /// Number of paths.
    pub samples: u64,
    /// Truncation of increments.
    pub truncation: Truncation,
    /// Truncation of increments, in words.
    pub truncated: &'static str,
    /// The exact solution, which is known at the final time only.
    pub exact: Option<Exact<'a>>,
    /// Whether the paper proves its bound for `sexp` here; `None` if `sexp` is not held to it.
    pub bound: Option<bool>,
}

impl StrongPanel<'_> {
    /// Creates settings with the truncation of the reproduction and without an exact solution.
    pub fn new(words: Words, (last, samples): (u32, u64)) -> Self {
        let (truncation, truncated) = (truncation(), TRUNCATED);
        Self { words, last, samples, truncation, truncated, exact: None, bound: None }
    }

    /// Measures a panel with a claim for each curve. Its series are the errors at the final time of
    /// each curve, then, unless the solution is exact, those at the worst time of the common grid.
    ///
    /// The curve with areas, or else the first, runs at the finest step, too; the errors are
    /// differences from that unless the solution is exact.
    pub fn measure<'a>(&self, conditions: &Conditions, curves: &[Curve<'a>]) -> Findings {
        let (id, problem) = (conditions.id, &curves[0].setup.problem);
        let finest = curves.iter().find(|curve| curve.method.is_for_areas()).unwrap_or(&curves[0]);
        // Step sizes, coarsest first, and their levels above the reference.
        let taus: Vec<f64> = (FIRST..=self.last).map(power_of_half).collect();
        let (sizes, levels) = (taus.len(), (2..taus.len() + 2).rev());
        let run = |curve: &Curve<'a>, level| Run::new(curve.setup.scheme.clone(), level);
        let mut runs = vec![run(finest, 0)];
        for curve in curves {
            runs.extend(levels.clone().map(|level| run(curve, level)));
        }
        let (steps, key) = (finest_steps(self.last, problem.t_end), conditions.key(0));
        let mut ladder = valid(Ladder::new(problem, steps, sizes + 1, self.truncation, key, runs));
        let last = ladder.coarse_steps();
        // What is measured when: the first run and the number of runs of a curve; of an exact
        // solution, the error of the reference; else all curves again, at times of their own.
        let at = |(s, time): (usize, u64)| (time, 1 + s * sizes, sizes);
        let mut when: Vec<_> = (0..curves.len()).map(|s| at((s, last))).collect();
        if let Some(exact) = &self.exact {
            ladder = ladder.with_time_change(exact.time_change);
            when.push((last, 0, 1));
        } else {
            when.extend(self.worst_times(conditions, curves).into_iter().enumerate().map(at));
        }
        let squares: Vec<_> = when.iter().map(|when| self.squares(when.1, when.2)).collect();
        let statistic = || -> Vec<_> {
            let each = when.iter().zip(&squares);
            each.map(|(&(time, _, runs), squares)| FinalMoments::new(time, 3 * runs - 1, squares))
                .collect()
        };
        let measured = ladder.run(self.samples, statistic);

        let at_finest = format!("{} at τ = 2^-{}", finest.method.id(), self.last + 2);
        let steps = format!("τ = 2^-{FIRST} … 2^-{}, {}", self.last, self.truncated);
        let mut panel = Panel {
            samples: self.samples,
            reference: format!("{at_finest} on the same noise"),
            failures: describe_failures(&measured),
            ..panel(self.words, id, Kind::Strong, problem, &steps)
        };
        let mut claims = Vec::new();
        for (n, (found, &(_, _, runs))) in measured.statistic.iter().zip(&when).enumerate() {
            let (squares, at_end) = (&found.moments, n < curves.len());
            if runs < sizes {
                panel.reference = "the exact solution by a change of time, path by path".into();
                let own = squares.mean(0).sqrt();
                panel.paper += &format!(
                    " {at_finest}, the kind of reference that the paper takes, is itself {own:.1e} \
                     (root mean square) away from the exact solution, {:.0} % of the error of sexp \
                     at τ = 2^-{}",
                    100.0 * own / measured.statistic[0].moments.mean(sizes - 1).sqrt(),
                    self.last
                );
                break;
            }
            let Curve { name, method, setup } = &curves[n % curves.len()];
            let (quantity, when) = match at_end {
                true => ("y(T)", "at the final time"),
                false => ("sup y", "largest over the common time grid"),
            };
            let errors = squares.part(0..sizes);
            let differences = squares.part(sizes..2 * sizes - 1);
            let rate = fit_strong(&taus[..sizes - 1], &differences);
            // A single noise commutes with itself.
            let (claim_id, order, bound) = match (method.properties().strong, problem.noises == 1) {
                (StrongOrder::Areas, _) => ("strong-one-levy", 1.0, ""),
                (StrongOrder::Commuting, true) => ("strong-one", 1.0, "C τ for one noise (k ≥ 2)"),
                (_, true) => ("strong-one", 0.5, ""),
                (_, false) => ("strong-half", 0.5, "C τ^½ for several noises (k ≥ 1)"),
            };
            let bounded = self.bound.filter(|_| *method == BuiltIn::Sexp);
            let statement = match bounded {
                Some(_) => format!("sup over n of (E‖y_n − y(t_n)‖²)^½ ≤ {bound} ({when})"),
                None => format!("{} has strong order {order} ({when})", method.id()),
            };
            let (one_sided, wrong_limit) = (bounded.is_some(), wrong_limit(&errors, &differences));
            let evidence = Evidence::Order { order, one_sided, rate: rate.clone(), wrong_limit };
            let claim = Claim::new(claim_id, statement, evidence).about(id, method.id());
            claims.push(claim.proven(bounded == Some(true)));
            panel.series.push(Series {
                scheme: name.to_string(),
                quantity: quantity.into(),
                points: root_mean_squares(&taus, &errors),
                rate,
                ..Series::default()
            });
            if !(at_end && setup.scheme.about().clips_increments) {
                continue;
            }
            for (r, (&tau, level)) in taus.iter().zip(levels.clone()).enumerate() {
                let (all, clipped) = (squares.mean(r), squares.mean(2 * sizes - 1 + r));
                let (scheme, increments) = (name.to_string(), measured.clipped[level]);
                let share = if all > 0.0 { clipped / all } else { 0.0 };
                if increments > 0 {
                    panel.clipped.push(Clipped { scheme, tau, increments, share });
                }
            }
        }
        Findings { panels: vec![panel], claims }
    }

    /// Writes the squared errors |y − y_ref|² of the given runs, the squares of the differences of
    /// each run except the last from the next one, and the errors again where an increment was
    /// clipped, zero elsewhere. y_ref is the exact solution at the random time of a path, or run 0.
    fn squares(&self, first: usize, runs: usize) -> impl Fn(&View<'_>, &mut [Row]) {
        move |view, rows| {
            let finest = view.state(0);
            let solution = self.exact.as_ref().map(|exact| exact.rows(view, finest.len()));
            let reference = solution.as_deref().unwrap_or(finest);
            let distance = |run, from| squared_distance(view.state(run), from, view.live);
            for (r, run) in (first..first + runs).enumerate() {
                rows[r] = distance(run, reference);
                let clips = |p| if view.clipped[run].contains(p) { rows[r][p] } else { 0.0 };
                rows[2 * runs - 1 + r] = std::array::from_fn(clips);
                if r + 1 < runs {
                    rows[runs + r] = distance(run, view.state(run + 1));
                }
            }
        }
    }

    /// Times of the common grid, one for each curve, at which the error of its coarsest step is
    /// largest, from the difference between that step and a quarter of it on paths of their own,
    /// so that the times do not depend on the errors that are measured there.
    fn worst_times(&self, conditions: &Conditions, curves: &[Curve<'_>]) -> Vec<u64> {
        let problem = &curves[0].setup.problem;
        let schemes = curves.iter().map(|curve| &curve.setup.scheme);
        let runs = schemes.flat_map(|scheme| [2, 0].map(|level| Run::new(scheme.clone(), level)));
        let (steps, key) = (finest_steps(FIRST, problem.t_end), conditions.key(WORST_TIMES));
        let ladder = valid(Ladder::new(problem, steps, 2, self.truncation, key, runs.collect()));
        let differences = |view: &View<'_>, rows: &mut [Row]| {
            for (s, row) in rows.iter_mut().enumerate() {
                *row = squared_distance(view.state(2 * s), view.state(2 * s + 1), view.live);
            }
        };
        let at = |time| FinalMoments::new(time, curves.len(), &differences);
        let new = || (1..=ladder.coarse_steps()).map(at).collect::<Vec<_>>();
        let found = ladder.run(PILOT_PATHS, new).statistic;
        let worst = (0..curves.len()).map(|s| {
            // Sums: a path that failed counts no more.
            let sums = found.iter().map(|f| f.moments.mean(s) * f.moments.count() as f64);
            (1..).zip(sums).max_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |(time, _)| time)
        });
        worst.collect()
    }
}

/// Number of steps of 2^−(last + 2) on [0, T].
pub fn finest_steps(last: u32, t_end: f64) -> u64 {
    (t_end * 2f64.powi(last as i32 + 2)).round() as u64
}

pub fn power_of_half(exponent: u32) -> f64 {
    0.5f64.powi(exponent as i32)
}

/// Describes the paths that were left out: the first few, and their number.
pub fn describe_failures<T>(Measured { failed, failures, .. }: &Measured<T>) -> Vec<String> {
    let mut lines: Vec<String> = failures.iter().map(ToString::to_string).collect();
    if *failed > failures.len() as u64 {
        lines.push(format!("… {failed} paths in all"));
    }
    lines
}

/// Compares the schemes of the paper, and `sexp-levy` where noises do not commute, with a claim for
/// each curve. Given are the exponent `last` of the finest step size 2^−last and the number of
/// paths, both at the paper's sizes, and whether the paper proves the order of `sexp` here.
///
/// `sexp-levy` has itself at a finer step as reference. Drawing areas costs a number of normals
/// equal to the square root of the step count, so its steps end three levels before those of the
/// others.
pub fn compare<S: Tuned<D, M>, G: Damping, const D: usize, const M: usize>(
    conditions: &Conditions,
    words: Words,
    (last, samples): (u32, u64),
    proven: bool,
    problem: &Problem<S, G, D>,
) -> Findings {
    let compiled = Compiled::of(problem);
    let measure = |fewer: u32, curves: &[Curve<'_>]| {
        let sizes = conditions.choose((last - fewer, samples), (10, 512));
        let panel = StrongPanel { bound: Some(proven), ..StrongPanel::new(words, sizes) };
        panel.measure(conditions, curves)
    };
    let mut findings = measure(0, &of_paper(&compiled));
    let areas = compiled.curves(&[BuiltIn::SexpLevy]);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{altered, results::Verdict};

    /// A method with half of the noise has the order of its differences, and another limit, by far:
    /// none of 299 other seeds has another answer.
    #[test]
    fn another_limit_refutes_an_order() {
        let problem = systems::paper::pendulum();
        let compiled = Compiled::of(&problem);
        let half = altered(compiled.sexp(), false, |_, noise| {
            noise.increments.iter_mut().flatten().for_each(|dw| *dw *= 0.5);
        });
        let curves = [("sexp", compiled.sexp()), ("half", half)];
        let curves = curves.map(|(name, setup)| Curve { name, method: BuiltIn::Sexp, setup });
        let conditions = Conditions { seed: 1, quick: true, experiment: 1, id: "half" };
        let found = StrongPanel::new(["half"; 3], (8, 512)).measure(&conditions, &curves);
        let refuted = found.claims.iter().map(|claim| claim.verdict == Verdict::Refuted);
        // At the end, and at the worst time.
        assert_eq!(refuted.collect::<Vec<_>>(), [false, true, false, true]);
    }
}
