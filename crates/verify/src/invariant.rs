//! Invariants along one path, beside their conformal law.

use mc::trajectory;
use schemes::{EulerMaruyama, Midpoint, Scheme, Sexp};
use systems::{Damping, PoissonSystem, Problem};

use crate::experiment::{Context, truncation};
use crate::results::{Kind, Panel, Point, Series};
use crate::statement::worse;

/// What an invariant panel is made of.
pub(crate) struct InvariantSetup {
    pub id: &'static str,
    pub title: &'static str,
    pub paper: &'static str,
    pub setup: String,
    pub steps: u64,
    /// Names of the invariants to show, the one of the paper first.
    pub invariants: &'static [&'static str],
}

/// One path of each scheme on the same noise.
pub(crate) fn invariant_panel<S, G, const D: usize, const M: usize>(
    context: &Context<'_>,
    setup: &InvariantSetup,
    problem: &Problem<S, G, D>,
) -> Panel
where
    S: PoissonSystem<D, M>,
    G: Damping,
{
    let (sexp, em, midpoint) = (Sexp::default(), EulerMaruyama, Midpoint::default());
    let schemes: [&dyn Scheme<S, D, M>; 3] = [&sexp, &em, &midpoint];
    context.progress.begin(setup.id, setup.steps * schemes.len() as u64);
    let mut failures = Vec::new();
    let paths: Vec<_> = schemes
        .iter()
        .map(|&scheme| {
            let path = trajectory(problem, scheme, setup.steps, truncation(), context.key(0), 0)
                .unwrap_or_else(|error| unreachable!("the set-ups of the paper are valid: {error}"));
            failures.extend(path.failure.map(|failure| failure.to_string()));
            context.progress.advance(setup.steps);
            path
        })
        .collect();
    context.progress.end();

    let known = problem.system.invariants();
    let mut series = Vec::new();
    for &name in setup.invariants {
        let index = known
            .iter()
            .position(|invariant| invariant.name == name)
            .unwrap_or_else(|| unreachable!("{} has no invariant {name}", problem.system.name()));
        for (scheme, path) in schemes.iter().zip(&paths) {
            let initial = problem.system.invariant(index, problem.y0);
            let points: Vec<(f64, f64, f64)> = path
                .times
                .iter()
                .zip(&path.states)
                .map(|(&t, &y)| {
                    let decay = (-known[index].degree * problem.damping.integral(0.0, t)).exp();
                    (t, problem.system.invariant(index, y), decay * initial)
                })
                .collect();
            let defect = points.iter().map(|(_, value, exact)| ((value - exact) / exact).abs()).fold(0.0, worse);
            series.push(Series {
                scheme: scheme.id().to_owned(),
                quantity: name.to_owned(),
                points: points.into_iter().map(|(t, value, exact)| Point::Value { t, value, exact }).collect(),
                rate: None,
                max_relative_defect: Some(defect),
            });
        }
    }
    Panel {
        id: setup.id.to_owned(),
        kind: Kind::Invariant,
        title: setup.title.to_owned(),
        setup: setup.setup.clone(),
        paper: setup.paper.to_owned(),
        samples: 1,
        reference: "the conformal law exp(−p ∫γ) F(y₀)".to_owned(),
        failures,
        clipped: Vec::new(),
        differences: Vec::new(),
        series,
    }
}
