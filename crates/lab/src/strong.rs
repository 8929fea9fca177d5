//! Strong convergence: root-mean-square errors of three schemes at many step sizes, on one noise.

use mc::{Ladder, Reference, Run, StrongErrors};
use noise::Truncation;
use schemes::{Midpoint, Scheme, Sexp};
use stats::{fit_strong, root_mean_squares};
use systems::{Damping, PoissonSystem, Problem};
use verify::results::{Clipped, Kind, Panel, Series};

use crate::experiment::Context;
use crate::kernels::Compiled;

/// What a strong experiment is made of; step sizes are powers of two.
pub(crate) struct StrongSetup {
    pub id: &'static str,
    pub title: &'static str,
    pub paper: &'static str,
    /// What is special about the set-up, in words.
    pub setup: String,
    /// Step sizes 2^−first … 2^−last.
    pub first: u32,
    pub last: u32,
    /// Step size of the reference, 2^−reference.
    pub reference: u32,
    pub samples: u64,
}

impl StrongSetup {
    /// The step sizes, coarsest first.
    fn taus(&self) -> Vec<f64> {
        (self.first..=self.last).map(|exponent| 0.5f64.powi(exponent as i32)).collect()
    }

    fn level(&self, exponent: u32) -> usize {
        (self.reference - exponent) as usize
    }
}

/// A scheme with the name that its curve goes by.
pub(crate) struct Curve<'a, S, const D: usize, const M: usize> {
    pub name: String,
    pub scheme: &'a dyn Scheme<S, D, M>,
}

/// `sexp`, `em` and `midpoint`, in the order of the paper's legends.
pub(crate) fn schemes_of_the_paper<S: Compiled<D, M>, const D: usize, const M: usize>()
-> [Box<dyn Scheme<S, D, M>>; 3] {
    [S::sexp(Sexp::default()), S::euler_maruyama(), S::midpoint(Midpoint::default())]
}

/// The panel with the paper's three schemes.
pub(crate) fn strong_panel<S, G, const D: usize, const M: usize>(
    context: &Context<'_>,
    setup: &StrongSetup,
    problem: &Problem<S, G, D>,
) -> Panel
where
    S: Compiled<D, M>,
    G: Damping,
{
    let schemes = schemes_of_the_paper::<S, D, M>();
    let curves: Vec<Curve<'_, S, D, M>> = schemes
        .iter()
        .map(|scheme| Curve { name: scheme.id().to_owned(), scheme: scheme.as_ref() })
        .collect();
    strong_curves(
        context,
        setup,
        problem,
        crate::experiment::truncation(),
        schemes[0].as_ref(),
        &curves,
    )
}

/// One curve for each scheme given; the reference is a scheme at the finest step with the same
/// truncation rule.
pub(crate) fn strong_curves<S, G, const D: usize, const M: usize>(
    context: &Context<'_>,
    setup: &StrongSetup,
    problem: &Problem<S, G, D>,
    truncation: Truncation,
    reference: &dyn Scheme<S, D, M>,
    curves: &[Curve<'_, S, D, M>],
) -> Panel
where
    S: PoissonSystem<D, M>,
    G: Damping,
{
    let mut runs: Vec<Run<'_, S, D, M>> = vec![Run::new(reference, 0)];
    let mut series = Vec::new();
    for curve in curves {
        let first = runs.len();
        runs.extend(
            (setup.first..=setup.last)
                .map(|exponent| Run::new(curve.scheme, setup.level(exponent))),
        );
        series.push((first..runs.len()).collect::<Vec<_>>());
    }
    let finest_steps = (problem.t_end * 2f64.powi(setup.reference as i32)).round() as u64;
    let ladder = Ladder::new(
        problem,
        finest_steps,
        setup.level(setup.first),
        truncation,
        context.key(0),
        runs,
    )
    .unwrap_or_else(|error| unreachable!("the set-ups of the paper are valid: {error}"));
    context.progress.begin(setup.id, ladder.steps_per_path() * setup.samples);
    let outcome = ladder.run(
        setup.samples,
        || StrongErrors::new(Reference::Run(0), &series, ladder.coarse_steps()),
        &|work| {
            context.progress.advance(work);
        },
    );
    context.progress.end();

    let taus = setup.taus();
    let reference_tau = 0.5f64.powi(setup.reference as i32);
    let mut curves_out = Vec::new();
    for (s, curve) in curves.iter().enumerate() {
        let squares = outcome.statistic.at_end(s);
        curves_out.push(Series {
            scheme: curve.name.clone(),
            quantity: "y(T)".to_owned(),
            points: root_mean_squares(&taus, squares),
            rate: fit_strong(&taus, Some(reference_tau), squares),
            max_relative_defect: None,
        });
    }
    for (s, curve) in curves.iter().enumerate() {
        let squares = outcome.statistic.at_worst_time(s);
        curves_out.push(Series {
            scheme: curve.name.clone(),
            quantity: "sup y".to_owned(),
            points: root_mean_squares(&taus, squares),
            rate: fit_strong(&taus, Some(reference_tau), squares),
            max_relative_defect: None,
        });
    }
    let mut clipped = Vec::new();
    for (s, curve) in curves.iter().enumerate() {
        for (r, exponent) in (setup.first..=setup.last).enumerate() {
            let increments = outcome.clipped[setup.level(exponent)];
            if increments > 0 {
                let share = outcome.statistic.clipped_share(s, r);
                clipped.push(Clipped {
                    scheme: curve.name.clone(),
                    tau: taus[r],
                    increments,
                    share,
                });
            }
        }
    }
    Panel {
        id: setup.id.to_owned(),
        kind: Kind::Strong,
        title: setup.title.to_owned(),
        setup: setup.setup.clone(),
        paper: setup.paper.to_owned(),
        samples: setup.samples,
        reference: format!("{} at τ = 2^-{} on the same noise", reference.id(), setup.reference),
        failures: describe_failures(outcome.failed, &outcome.failures),
        clipped,
        differences: Vec::new(),
        series: curves_out,
    }
}

/// Paths that were left out: how many, and the first few.
pub(crate) fn describe_failures(failed: u64, failures: &[mc::PathFailure]) -> Vec<String> {
    let mut lines: Vec<String> = failures.iter().map(ToString::to_string).collect();
    if failed > failures.len() as u64 {
        lines.push(format!("… {failed} paths in all"));
    }
    lines
}
