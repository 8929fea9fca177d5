//! Strong convergence: root-mean-square errors of several schemes at many step sizes, on one noise.

use mc::{Ladder, Reference, Run, StrongErrors};
use noise::Truncation;
use schemes::{EulerMaruyama, Midpoint, Scheme, Sexp, SexpLevy};
use stats::{CrossMoments, fit_strong, root_mean_squares};
use systems::paper::valid;
use systems::{Damping, PoissonSystem, Problem};
use verify::Exact;
use verify::results::{Claim, Clipped, Evidence, Kind, Panel, Series};

use crate::experiment::{Conditions, Experiment, Findings, TRUNCATION_ORDER, describe, truncation};
use crate::kernels::{Compiled, PaperSystem, compiled};
use crate::method::Method;

/// Coarsest step size 2⁻⁵.
const FIRST: u32 = 5;
/// The reference has a quarter of the finest step.
const REFERENCE: u32 = 2;

/// Step sizes 2⁻⁵ … 2^−last with a reference at 2^−(last + 2), and the number of paths.
#[derive(Clone, Copy)]
pub(crate) struct Grid {
    pub last: u32,
    pub samples: u64,
}

impl Grid {
    /// Exponents of the step sizes, coarsest first.
    fn exponents(self) -> std::ops::RangeInclusive<u32> {
        FIRST..=self.last
    }

    /// The exponent of the reference's step size.
    pub fn reference(self) -> u32 {
        self.last + REFERENCE
    }

    /// The level of a step size above that of the reference.
    fn level(self, exponent: u32) -> usize {
        (self.reference() - exponent) as usize
    }

    /// Steps of the reference on [0, T].
    pub fn finest_steps(self, t_end: f64) -> u64 {
        (t_end * 2f64.powi(self.reference() as i32)).round() as u64
    }

    /// The step sizes in words.
    pub fn words(self) -> String {
        format!("τ = 2^-{FIRST} … 2^-{}", self.last)
    }
}

/// A scheme with the name of its curve.
pub(crate) struct Curve<S, const D: usize, const M: usize> {
    pub name: &'static str,
    pub method: Method,
    pub scheme: Box<dyn Scheme<S, D, M>>,
}

impl<S, const D: usize, const M: usize> Curve<S, D, M> {
    pub fn new(method: Method, scheme: Box<dyn Scheme<S, D, M>>) -> Self {
        Self { name: method.id(), method, scheme }
    }
}

/// The curves of the paper, in the order of [`Method::PAPER`].
pub(crate) fn curves_of_the_paper<S: PaperSystem<D, M>, const D: usize, const M: usize>()
-> Vec<Curve<S, D, M>> {
    let scheme = |method| match method {
        Method::EulerMaruyama => compiled(EulerMaruyama),
        Method::Midpoint => compiled(Midpoint::default()),
        Method::Sexp | Method::SexpLevy => compiled(Sexp::default()),
    };
    Method::PAPER.map(|method| Curve::new(method, scheme(method))).into()
}

/// What is run to draw the curves of a strong panel.
pub(crate) struct StrongRuns<'a, S, G, const D: usize, const M: usize> {
    /// What progress is reported under.
    pub id: &'a str,
    pub problem: &'a Problem<S, G, D>,
    pub grid: Grid,
    pub truncation: Truncation,
    /// Runs at the finest step; the errors are differences from it unless `exact` is given.
    pub reference: &'a dyn Scheme<S, D, M>,
    /// The exact solution, which is known at the final time only.
    pub exact: Option<Exact<'a, D, M>>,
    pub curves: &'a [Curve<S, D, M>],
}

/// When an error is taken.
#[derive(Clone, Copy)]
pub(crate) enum When {
    /// At the final time.
    End,
    /// At the time of the common coarse grid where that of the coarsest step is largest.
    Worst,
}

impl When {
    fn quantity(self) -> &'static str {
        match self {
            Self::End => "y(T)",
            Self::Worst => "sup y",
        }
    }

    fn words(self) -> &'static str {
        match self {
            Self::End => "at the final time",
            Self::Worst => "largest over the common time grid",
        }
    }
}

/// A measured curve.
pub(crate) struct StrongCurve {
    pub method: Method,
    pub when: When,
    pub series: Series,
}

/// What the runs of a strong panel gave.
pub(crate) struct StrongErrorCurves {
    /// The errors at the final time of each curve, then, unless the solution is exact, those at the
    /// worst time.
    pub curves: Vec<StrongCurve>,
    pub clipped: Vec<Clipped>,
    pub failures: Vec<String>,
    /// Root-mean-square error of the reference itself against the exact solution.
    pub reference_error: Option<f64>,
}

impl<S, G, const D: usize, const M: usize> StrongRuns<'_, S, G, D, M>
where
    S: PoissonSystem<D, M>,
    G: Damping,
{
    pub fn measure(&self, conditions: &Conditions<'_>) -> StrongErrorCurves {
        let Self { problem, grid, curves, .. } = *self;
        let mut runs = vec![Run::new(self.reference, 0)];
        let mut series = Vec::new();
        for curve in curves {
            let first = runs.len();
            let run = |exponent| Run::new(curve.scheme.as_ref(), grid.level(exponent));
            runs.extend(grid.exponents().map(run));
            series.push((first..runs.len()).collect::<Vec<_>>());
        }
        let reference = match self.exact {
            Some(exact) => {
                series.push(vec![0]);
                Reference::Exact(exact.solution)
            }
            None => Reference::Run(0),
        };
        let mut ladder = valid(Ladder::new(
            problem,
            grid.finest_steps(problem.t_end),
            grid.level(FIRST),
            self.truncation,
            conditions.key(0),
            runs,
        ));
        if let Some(exact) = self.exact {
            ladder = ladder.with_time_change(exact.time_change);
        }
        conditions.progress.begin(self.id, ladder.steps_per_path() * grid.samples);
        let statistic = || StrongErrors::new(reference, &series, ladder.coarse_steps());
        let advance = |work| conditions.progress.advance(work);
        let measured = ladder.run(grid.samples, statistic, &advance);
        conditions.progress.end();

        let taus: Vec<f64> = grid.exponents().map(power_of_half).collect();
        let reference_tau = self.exact.is_none().then(|| power_of_half(grid.reference()));
        let drawn = |when: When, curve: &Curve<S, D, M>, squares: &CrossMoments| StrongCurve {
            method: curve.method,
            when,
            series: Series {
                scheme: curve.name.to_owned(),
                quantity: when.quantity().to_owned(),
                points: root_mean_squares(&taus, squares),
                rate: fit_strong(&taus, reference_tau, squares),
                ..Series::default()
            },
        };
        let errors = &measured.statistic;
        let numbered = || curves.iter().enumerate();
        let mut drawn_curves: Vec<StrongCurve> =
            numbered().map(|(s, curve)| drawn(When::End, curve, errors.at_end(s))).collect();
        if self.exact.is_none() {
            let worst = |(s, curve)| drawn(When::Worst, curve, errors.at_worst_time(s));
            drawn_curves.extend(numbered().map(worst));
        }
        let mut clipped = Vec::new();
        for (s, curve) in numbered() {
            for (r, exponent) in grid.exponents().enumerate() {
                let increments = measured.clipped[grid.level(exponent)];
                if increments > 0 {
                    let share = errors.clipped_share(s, r);
                    let scheme = curve.name.to_owned();
                    clipped.push(Clipped { scheme, tau: taus[r], increments, share });
                }
            }
        }
        StrongErrorCurves {
            curves: drawn_curves,
            clipped,
            failures: describe_failures(measured.failed, &measured.failures),
            reference_error: self.exact.map(|_| errors.at_end(curves.len()).mean(0).sqrt()),
        }
    }
}

pub(crate) fn power_of_half(exponent: u32) -> f64 {
    0.5f64.powi(exponent as i32)
}

/// Paths that were left out: the first few, and how many.
pub(crate) fn describe_failures(failed: u64, failures: &[mc::PathFailure]) -> Vec<String> {
    let mut lines: Vec<String> = failures.iter().map(ToString::to_string).collect();
    if failed > failures.len() as u64 {
        lines.push(format!("… {failed} paths in all"));
    }
    lines
}

/// A panel of strong errors.
pub(crate) struct StrongPanel {
    pub id: &'static str,
    pub title: &'static str,
    pub paper: &'static str,
    /// The system in words.
    pub system: &'static str,
    /// Exponent of the finest step size at the paper's sizes.
    pub last: u32,
    /// Paths at the paper's sizes.
    pub samples: u64,
    /// Whether the noises commute, as a single one does.
    pub commuting: bool,
    /// Whether the paper proves the order of `sexp` here.
    pub proven: bool,
    /// Calls [`StrongPanel::compare`] with the problem.
    pub compare: fn(&Self, &Conditions<'_>) -> Findings,
}

impl Experiment for StrongPanel {
    fn ids(&self) -> Vec<&'static str> {
        vec![self.id]
    }

    fn run(&self, conditions: &Conditions<'_>) -> Findings {
        (self.compare)(self, conditions)
    }
}

/// Sizes of the quick mode.
const QUICK: Grid = Grid { last: 10, samples: 512 };

impl StrongPanel {
    /// The three schemes of the paper against `sexp` at the finest step, with a claim for each
    /// curve.
    pub fn compare<S, G, const D: usize, const M: usize>(
        &self,
        conditions: &Conditions<'_>,
        problem: &Problem<S, G, D>,
    ) -> Findings
    where
        S: PaperSystem<D, M>,
        G: Damping,
    {
        let grid = conditions.choose(Grid { last: self.last, samples: self.samples }, QUICK);
        let curves = curves_of_the_paper::<S, D, M>();
        let reference = curves[0].scheme.as_ref();
        let (id, exact, truncation) = (self.id, None, truncation());
        let runs = StrongRuns { id, problem, grid, truncation, reference, exact, curves: &curves };
        let StrongErrorCurves { curves, clipped, failures, .. } = runs.measure(conditions);
        let steps = format!("{}, increments truncated with k = {TRUNCATION_ORDER}", grid.words());
        Findings {
            claims: curves.iter().map(|curve| self.claim(curve)).collect(),
            panels: vec![Panel {
                id: self.id.to_owned(),
                kind: Kind::Strong,
                title: self.title.to_owned(),
                setup: describe(self.system, problem, &steps),
                paper: self.paper.to_owned(),
                samples: grid.samples,
                reference: reference_words(reference.id(), grid),
                failures,
                series: curves.into_iter().map(|curve| curve.series).collect(),
                clipped,
                ..Panel::default()
            }],
        }
    }

    /// The order of `sexp` as the paper proves it, that of the others as it reports it.
    fn claim(&self, curve: &StrongCurve) -> Claim {
        let StrongCurve { method, when, series } = curve;
        let order = method.strong_order(self.commuting);
        let (id, bound) = if self.commuting {
            ("strong-one", "sup over n of (E‖y_n − y(t_n)‖²)^½ ≤ C τ for one noise (k ≥ 2)")
        } else {
            ("strong-half", "sup over n of (E‖y_n − y(t_n)‖²)^½ ≤ C τ^½ for several noises (k ≥ 1)")
        };
        let one_sided = *method == Method::Sexp;
        let statement = match one_sided {
            true => bound.to_owned(),
            false => format!("{} has strong order {order}", method.id()),
        };
        let statement = format!("{statement} ({})", when.words());
        let measured = Evidence::Order { order, one_sided, rate: series.rate.clone() };
        let proven = self.proven && one_sided;
        Claim::new(id, statement, measured).about(self.id, &series.scheme).proven(proven)
    }

    /// [`compare`](Self::compare) with a fourth curve, which is not in the paper: `sexp-levy`
    /// against itself at a finer step. Drawing areas costs as many normals as the square root of
    /// the step count, so its steps end three levels before those of the others.
    pub fn compare_with_areas<S, G, const D: usize>(
        &self,
        conditions: &Conditions<'_>,
        problem: &Problem<S, G, D>,
    ) -> Findings
    where
        S: PaperSystem<D, 3> + Compiled<SexpLevy, D, 3>,
        G: Damping,
    {
        let mut findings = self.compare(conditions, problem);
        let levy = || compiled(SexpLevy::new(&problem.system, problem.y0));
        let grid = Grid { last: self.last - 3, samples: self.samples };
        let grid = conditions.choose(grid, QUICK);
        let curves = [Curve::new(Method::SexpLevy, levy())];
        let (reference, truncation) = (levy(), truncation());
        let runs = StrongRuns {
            id: self.id,
            problem,
            grid,
            truncation,
            reference: reference.as_ref(),
            exact: None,
            curves: &curves,
        };
        let areas = runs.measure(conditions);
        findings.claims.extend(areas.curves.iter().map(|curve| claim_with_areas(self.id, curve)));
        for panel in &mut findings.panels {
            let words = reference_words(reference.id(), grid);
            panel.reference = format!("{}; sexp-levy: {words}", panel.reference);
            panel.failures.extend(areas.failures.iter().cloned());
            panel.series.extend(areas.curves.iter().map(|curve| curve.series.clone()));
        }
        findings
    }
}

/// The reference of strong errors in words.
pub(crate) fn reference_words(scheme: &str, grid: Grid) -> String {
    format!("{scheme} at τ = 2^-{} on the same noise", grid.reference())
}

/// The strong order of a curve on noises that do not commute.
pub(crate) fn claim_with_areas(panel: &str, curve: &StrongCurve) -> Claim {
    let StrongCurve { method, when, series } = curve;
    let order = method.strong_order(false);
    let id = if *method == Method::SexpLevy { "strong-one-levy" } else { "strong-half" };
    let statement = format!(
        "{} has strong order {order} for noises that do not commute ({})",
        method.id(),
        when.words()
    );
    let measured = Evidence::Order { order, one_sided: false, rate: series.rate.clone() };
    Claim::new(id, statement, measured).about(panel, method.id()).proven(false)
}
