//! E[φ(y(T))] of the rigid body with three noises by multilevel Monte Carlo, against the Kolmogorov
//! equation, and what an accuracy costs.

use mc::Observable;
use mc::multilevel::{Coupling, Estimate, Expectation, Settings, expectation, expectation_plain};
use schemes::Sexp;
use stats::Point;
use systems::paper::{INERTIA, NOISE_INERTIA, half_cosine, rigid_body_start, valid};
use systems::{Cosine, Problem, RigidBody};
use verify::results::{Claim, Kind, Panel, Series};
use verify::{DEVIATIONS, Progress, claim, decide, rigid_body_expectations};

use crate::experiment::{Context, Yield, truncation};
use crate::kernels::Compiled;
use crate::panels::weak_observables;

/// Steps on [0, 1] of the coarsest level: with two, the first difference has already the variance
/// of order τ².
const COARSEST_STEPS: u64 = 2;
/// Degree of the spherical harmonics: the twelve values agree to 4e-15 from 96 to 160, and 64 is
/// 8e-13 away.
fn degree(context: &Context<'_>) -> usize {
    context.choose(96, 64)
}

fn body() -> Problem<RigidBody<3>, Cosine, 3> {
    let body = valid(RigidBody::three_noises(INERTIA, NOISE_INERTIA));
    valid(Problem::new(body, half_cosine(), rigid_body_start(), 1.0))
}

fn settings(context: &Context<'_>, part: u64) -> Settings {
    let settings =
        Settings::new(context.key(part), truncation(), COARSEST_STEPS, Coupling::Antithetic);
    Settings { max_cost: 1 << 40, ..settings }
}

/// The claims that the weak panels' twelve expectations, each to the half-width `accuracy`, agree
/// with the Kolmogorov equation.
fn twelve(context: &Context<'_>, accuracy: f64) -> Vec<Claim> {
    let problem = body();
    let observables: Vec<Observable<3>> =
        weak_observables().into_iter().flat_map(|panel| panel.observables).collect();
    let exact = rigid_body_expectations(&problem, degree(context), &observables);
    let sexp = RigidBody::<3>::sexp(Sexp::default());
    let measured = expectation(
        sexp.as_ref(),
        &problem,
        &observables,
        accuracy,
        &settings(context, 0),
        &|work| {
            context.progress.advance(work);
        },
    )
    .unwrap_or_else(|error| unreachable!("the set-up is valid: {error}"));
    let warnings: String =
        measured.warnings.iter().map(|warning| format!("; warning: {warning}")).collect();
    measured
        .estimates
        .iter()
        .zip(exact)
        .map(|(estimate, exact)| Claim {
            scheme: "sexp".to_owned(),
            proven: false,
            ..claim(
                "expectation",
                &format!("E[{}] of the rigid body with three noises at T = 1", estimate.name),
                decide(agrees(estimate, exact)),
                format!(
                    "{:.6} ± {:.1e} (95 %, bias included) by multilevel Monte Carlo, {exact:.9} by the Kolmogorov \
                     equation{warnings}",
                    estimate.value,
                    estimate.half_width()
                ),
            )
        })
        .collect()
}

/// A false alarm once in 1e5 for each: the bound on the bias comes on top.
fn agrees(estimate: &Estimate, exact: f64) -> bool {
    (estimate.value - exact).abs() <= DEVIATIONS * estimate.standard_error + estimate.bias_bound
}

/// Number of the experiment behind [`expectation_claims`].
const EXPERIMENT: u64 = 4000;

/// The twelve expectations of the weak panels, E of y_j, y_j², cos y_j and sin y_j at T = 1, each
/// to the half-width `accuracy` of its 95 % interval, against the Kolmogorov equation. The cost
/// grows like accuracy⁻²: 2e-4 takes seconds, 2e-5 minutes.
#[must_use]
pub fn expectation_claims(
    settings: verify::Settings,
    accuracy: f64,
    progress: &dyn Progress,
) -> Vec<Claim> {
    twelve(&Context { settings, experiment: EXPERIMENT, wanted: &[], progress }, accuracy)
}

/// Twelve expectations, to the accuracy of the mode.
pub(super) fn expectations(context: &Context<'_>) -> Yield {
    context.progress.begin("rigid-body-expectations", 0);
    let claims = twelve(context, context.choose(2e-4, 1e-3));
    context.progress.end();
    Yield { panels: Vec::new(), claims }
}

const COS_Y3: [Observable<3>; 1] =
    [Observable { name: "cos y3", function: |y| real::elementary::cos(y[2]) }];

/// Path-steps for E[cos y₃] at several accuracies, by multilevel Monte Carlo and by single paths.
pub(super) fn cost(context: &Context<'_>) -> Yield {
    let id = "expectation-cost";
    let problem = body();
    let sexp = RigidBody::<3>::sexp(Sexp::default());
    let accuracies = context.choose([1e-2, 3e-3, 1e-3, 3e-4], [1e-2, 5e-3, 3e-3, 2e-3]);
    // Single paths at the next accuracy would take twenty times as long as all of these.
    let finer = context.choose([1e-4, 3e-5], [1e-3, 5e-4]);
    context.progress.begin(id, 0);
    let run = |part: u64, accuracy: f64, multilevel: bool| -> Expectation {
        let method = if multilevel { expectation } else { expectation_plain };
        let settings = settings(context, part);
        method(sexp.as_ref(), &problem, &COS_Y3, accuracy, &settings, &|work| {
            context.progress.advance(work)
        })
        .unwrap_or_else(|error| unreachable!("the set-up is valid: {error}"))
    };
    let exact = rigid_body_expectations(&problem, degree(context), &COS_Y3)[0];
    let mut series = Vec::new();
    let mut claims = Vec::new();
    for (scheme, multilevel) in [("multilevel", true), ("single paths", false)] {
        let all = accuracies.iter().chain(finer.iter().filter(|_| multilevel));
        let mut points = Vec::new();
        for (part, &accuracy) in all.enumerate() {
            let result = run(2 * part as u64 + u64::from(multilevel), accuracy, multilevel);
            points.push(Point::Cost { accuracy, path_steps: result.cost });
            let estimate = &result.estimates[0];
            claims.push(Claim {
                panel: id.to_owned(),
                scheme: "sexp".to_owned(),
                proven: false,
                ..claim(
                    "expectation",
                    &format!("E[cos y3] to ± {accuracy:.0e} by {scheme}"),
                    decide(agrees(estimate, exact)),
                    format!(
                        "{:.6} ± {:.1e} against {exact:.9}, {} path-steps",
                        estimate.value,
                        estimate.half_width(),
                        result.cost
                    ),
                )
            });
        }
        series.push(Series {
            scheme: scheme.to_owned(),
            quantity: "cos y3".to_owned(),
            points,
            rate: None,
            max_relative_defect: None,
        });
    }
    context.progress.end();
    let panel = Panel {
        id: id.to_owned(),
        kind: Kind::Cost,
        title: "E[cos y_3] of the rigid body with three noises: cost against accuracy".to_owned(),
        setup: "rigid body, three noises, I = (2, 1, 2/3), Î = (1, 2, 3), γ = 0.5 cos 2 t, T = 1; sexp, antithetic \
                differences from τ = 1/2 on; a pilot of 1024 paths a level is part of the cost"
            .to_owned(),
        paper:
            "Not in the paper, which takes single paths. With weak order 1 they cost ε⁻³; the antithetic multilevel \
                method costs ε⁻², since the variance of a level falls like τ²."
                .to_owned(),
        samples: 0,
        reference: "half-width ε of the 95 % interval, bias included".to_owned(),
        failures: Vec::new(),
        clipped: Vec::new(),
        differences: Vec::new(),
        series,
    };
    Yield { panels: vec![panel], claims }
}
