//! E[φ(y(T))] of the rigid body with three noises by `mc::Expect` and by multilevel Monte Carlo,
//! against the Kolmogorov equation, and what an accuracy costs.

use mc::{
    Expect, Observable, Observe, Setup,
    multilevel::{Coupling, Estimate, Estimator, Expectation, ExpectationSettings, expectation},
};
use schemes::Sexp;
use stats::{CONFIDENCE, Point, two_sided};
use systems::paper::{rigid_body_three_noises, valid};

use crate::{
    Conditions, Findings, Method, Words, compiled, in_words,
    panels::weak_observables,
    results::{Claim, Evidence, Kind, Panel, Series},
    sphere::rigid_body_expectations,
    truncation,
};

/// Steps on [0, 1] of the coarsest level: with two, the first difference has already the variance
/// of order τ².
const COARSEST_STEPS: u64 = 2;

/// Degree of the spherical harmonics: the twelve values agree to 4e-15 from 96 to 160, and 64 is
/// 8e-13 away.
fn degree(conditions: &Conditions) -> usize {
    conditions.choose(96, 64)
}

fn settings(conditions: &Conditions, part: u64) -> ExpectationSettings {
    let key = conditions.key(part);
    ExpectationSettings {
        max_cost: 1 << 40,
        ..ExpectationSettings::new(key, truncation(), COARSEST_STEPS, Coupling::Antithetic)
    }
}

/// E[cos y₃] by this estimator on the streams of part number `part`.
fn cosine(conditions: &Conditions, estimator: Estimator, part: u64, accuracy: f64) -> Expectation {
    let (problem, sexp) = (rigid_body_three_noises(1.0), compiled(Sexp));
    let settings = ExpectationSettings { estimator, ..settings(conditions, part) };
    let advance = |work| conditions.progress.advance(work);
    let setup = Setup::of(&problem, sexp.as_ref());
    valid(expectation(&setup, &COS_Y3, accuracy, &settings, &advance))
}

/// Expectations with everything chosen, on the points of part number `part`.
fn chosen(
    conditions: &Conditions,
    part: u64,
    observables: &[Observable<3>],
    accuracy: f64,
) -> Expectation {
    let problem = rigid_body_three_noises(1.0);
    let expect = Expect::by_parts(&problem).with_key(conditions.key(part));
    let observables: Vec<&dyn Observe> = observables.iter().map(|phi| phi as _).collect();
    let advance = |work| conditions.progress.advance(work);
    valid(expect.run(&observables, accuracy, &advance))
}

/// E[φ] of `estimate` against its value by the Kolmogorov equation. Where the interval has Student's
/// quantile the standard error is that of a normal law with the same interval.
fn claim(estimate: &Estimate, of: &Expectation, exact: f64, statement: String) -> Claim {
    let measured = Evidence::Deviation {
        quantity: format!("E[{}]", estimate.name),
        value: estimate.value,
        standard_error: estimate.standard_error * estimate.quantile / two_sided(CONFIDENCE, None),
        bias: estimate.bias_bound + estimate.missed,
        expected: exact,
        path_steps: Some(of.cost),
        warnings: of.warnings.iter().map(ToString::to_string).collect(),
    };
    Claim::new("expectation", statement, measured).proven(false)
}

/// The weak panels' twelve expectations, E of y_j, y_j², cos y_j and sin y_j at T = 1, by
/// `mc::Expect` against the Kolmogorov equation.
pub fn measure(conditions: &Conditions) -> Findings {
    let (accuracy, observables) = (conditions.choose(2e-5, 2e-4), weak_observables());
    let measured = chosen(conditions, 0, &observables, accuracy);
    let problem = rigid_body_three_noises(1.0);
    let exact = rigid_body_expectations(&problem, degree(conditions), &observables);
    let claims = measured.estimates.iter().zip(exact).map(|(estimate, exact)| {
        let name = &estimate.name;
        let statement = format!("E[{name}] of the rigid body with three noises at T = 1");
        claim(estimate, &measured, exact, statement).about("", Method::Nv.id())
    });
    claims.collect::<Vec<_>>().into()
}

const COS_Y3: [Observable<3>; 1] =
    [Observable { name: "cos y3", function: |y| real::elementary::cos(y[2]) }];

const COST: Words = Words {
    title: "E[cos y_3] of the rigid body with three noises: cost against accuracy",
    system: in_words::BODY_3,
    paper: "Not in the paper, which takes single paths. With weak order 1 they cost ε⁻³; the \
            antithetic multilevel method costs ε⁻², since the variance of a level falls like τ². \
            Expect takes nv, of weak order 2, and scrambled Sobol points on its levels.",
};

/// The first part of the streams, and what computes an expectation on a part to an accuracy.
type Compute<'a> = (u64, &'a dyn Fn(u64, f64) -> Expectation);

/// Path-steps for E[cos y₃] at several accuracies, by multilevel Monte Carlo, by single paths and by
/// `mc::Expect`.
pub fn cost(conditions: &Conditions) -> Findings {
    let problem = rigid_body_three_noises(1.0);
    let accuracies = conditions.choose([1e-2, 3e-3, 1e-3, 3e-4], [1e-2, 5e-3, 3e-3, 2e-3]);
    // Single paths at the next accuracy would take twenty times as long as all of these.
    let finer = conditions.choose([1e-4, 3e-5], [1e-3, 5e-4]);
    // A coarser one costs what the pilot costs.
    let finest = conditions.choose([1e-3, 3e-4, 1e-4, 3e-5], [2e-3, 1e-3, 5e-4, 2e-4]);
    let exact = rigid_body_expectations(&problem, degree(conditions), &COS_Y3)[0];
    let (mut series, mut claims) = (Vec::new(), Vec::new());
    let by = |estimator| move |part, accuracy| cosine(conditions, estimator, part, accuracy);
    let (by_multilevel, by_paths) = (by(Estimator::Multilevel), by(Estimator::SinglePaths));
    let by_choice = |part, accuracy| chosen(conditions, part, &COS_Y3, accuracy);
    // Accuracy number n has the streams 2n + 1, 2n, and 2n + 8, which single paths leave.
    let all = [&accuracies[..], &finer].concat();
    let ways: [(_, _, &[f64], Compute<'_>); 3] = [
        ("multilevel", Method::Sexp, &all, (1, &by_multilevel)),
        ("single paths", Method::Sexp, &accuracies, (0, &by_paths)),
        ("Expect", Method::Nv, &finest, (8, &by_choice)),
    ];
    for (name, method, accuracies, (first, compute)) in ways {
        let mut points = Vec::new();
        for (n, &accuracy) in (0..).zip(accuracies) {
            let result = compute(first + 2 * n, accuracy);
            points.push(Point::Cost { accuracy, path_steps: result.cost });
            let statement = format!("E[cos y3] to ± {accuracy:.0e} by {name}");
            let claim = claim(&result.estimates[0], &result, exact, statement);
            claims.push(claim.about(conditions.id(), method.id()));
        }
        let quantity = "cos y3".into();
        series.push(Series { scheme: name.into(), quantity, points, ..Series::default() });
    }
    let reference = "half-width ε of the 95 % interval, bias included".into();
    let steps = "multilevel and single paths: sexp, antithetic differences from τ = 1/2 on; all \
                 pilots are part of the cost";
    let panel =
        Panel { reference, series, ..COST.panel(conditions.id(), Kind::Cost, &problem, steps) };
    Findings { panels: vec![panel], claims }
}
