//! E[φ(y(T))] of the rigid body with three noises by `expectation::Expect` on Sobol points and on
//! random points, against the Kolmogorov equation, and the cost of an accuracy.

use expectation::{Estimate, Expect, ExpectSettings, Expectation};
use mc::Observe;
use stats::{CONFIDENCE, two_sided};

use crate::*;

/// The values of the twelve observables by the Kolmogorov equation of y/|y| on the sphere, whose
/// moments of spherical harmonics obey a linear equation: `tests/known_answers/kolmogorov.rs`
/// computes them. Degrees 96 to 160 agree to 4e-15; Fourier collocation in latitude and longitude
/// on 96 × 96 points to 1.2e-10.
pub const KOLMOGOROV: [f64; 12] = [
    0.308_620_463_445_558_77,
    -0.233_428_857_078_511_2,
    0.640_708_528_251_050_2,
    0.105_887_422_320_291_15,
    0.108_838_912_251_907_84,
    0.419_944_545_588_162_1,
    0.947_654_279_520_736_4,
    0.946_539_300_600_389,
    COS_Y3,
    0.302_294_381_877_425_86,
    -0.226_157_774_971_460_14,
    0.595_235_773_057_582_8,
];
const COS_Y3: f64 = 0.797_719_935_281_683_3;

/// Names of the curves: methods to compute expectations.
const RANDOM: &str = "random points";
const SOBOL: &str = "Sobol points";
const CHOSEN: &str = "Expect";

/// Expectations with the noise of part number `part`: by `sexp` on random or Sobol points, or by
/// `nv` on Sobol points, as `expectation::Expect` chooses them.
fn expectation(
    conditions: &Conditions,
    way: &str,
    part: u64,
    observables: &[Observable<3>],
    accuracy: f64,
) -> Expectation {
    let problem = rigid_body_three_noises(1.0);
    let (mut expect, key) = (Expect::by_parts(&problem), conditions.key(part));
    let mut settings = ExpectSettings { key, random_points: way == RANDOM, ..Default::default() };
    if way != CHOSEN {
        expect = Expect::with_scheme(Compiled::of(&problem).sexp());
        (settings.truncation, settings.max_cost) = (truncation(), 1 << 40);
    }
    let observables: Vec<&dyn Observe> = observables.iter().map(|phi| phi as _).collect();
    valid(expect.with(settings).run(&observables, accuracy))
}

/// Compares E[φ] of `estimate` with its value by the Kolmogorov equation. Where the interval has
/// Student's quantile the standard error is that of a normal law with the same interval.
fn claim(estimate: &Estimate, of: &Expectation, expected: f64, statement: String) -> Claim {
    let measured = Evidence::Deviation {
        quantity: format!("E[{}]", estimate.name),
        value: estimate.value,
        standard_error: estimate.standard_error * estimate.quantile / two_sided(CONFIDENCE, None),
        bias: estimate.bias_bound + estimate.missed,
        expected,
        path_steps: Some(of.cost),
        warnings: of.warnings.iter().map(ToString::to_string).collect(),
    };
    Claim::new("expectation", statement, measured).proven(false)
}

/// The weak panels' twelve expectations, E of y_j, y_j², cos y_j and sin y_j at T = 1, by
/// `expectation::Expect` against the Kolmogorov equation.
pub fn measure(conditions: &Conditions) -> Findings {
    let (accuracy, observables) = (conditions.choose(2e-5, 2e-4), weak_observables());
    let measured = expectation(conditions, CHOSEN, 0, &observables, accuracy);
    Findings::of(measured.estimates.iter().zip(KOLMOGOROV).map(|(estimate, exact)| {
        let name = &estimate.name;
        let statement = format!("E[{name}] of the rigid body with three noises at T = 1");
        claim(estimate, &measured, exact, statement).about("", "nv")
    }))
}

const WORDS: Words = [
    "E[cos y_3] of the rigid body with three noises: cost against accuracy",
    BODY_3,
    "Not in the paper, which takes single paths. With weak order 1 they cost ε⁻³; on antithetic \
     levels random points cost ε⁻², since the variance of a level falls like τ²; scrambled Sobol \
     points take fewer. Expect takes nv, of weak order 2, on Sobol points.",
];

/// Measures path-steps for E[cos y₃] at several accuracies: the contributions of points and scheme.
pub fn cost(conditions: &Conditions) -> Findings {
    let observables = [phi("cos y3", |y| elementary::cos(y[2]))];
    let accuracies = conditions
        .choose([1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 3e-5], [1e-2, 5e-3, 2e-3, 1e-3, 5e-4, 2e-4]);
    let (mut series, mut claims) = (Vec::new(), Vec::new());
    // A part of the streams for each accuracy. On Sobol points a coarser one costs what the pilot
    // costs.
    let ways: [(_, _, &[u64]); 3] = [
        (RANDOM, "sexp", &[2, 4, 1, 3, 5, 7]),
        (SOBOL, "sexp", &[9, 11, 13, 15]),
        (CHOSEN, "nv", &[8, 10, 12, 14]),
    ];
    for (way, scheme, parts) in ways {
        let mut points = Vec::new();
        let finest = &accuracies[accuracies.len() - parts.len()..];
        for (&part, &accuracy) in parts.iter().zip(finest) {
            let result = expectation(conditions, way, part, &observables, accuracy);
            points.push(Point::Cost { accuracy, path_steps: result.cost });
            let statement = format!("E[cos y3] to ± {accuracy:.0e} by {way}");
            let claim = claim(&result.estimates[0], &result, COS_Y3, statement);
            claims.push(claim.about(conditions.id, scheme));
        }
        let (scheme, quantity) = (way.into(), "cos y3".into());
        series.push(Series { scheme, quantity, points, ..Series::default() });
    }
    let problem = rigid_body_three_noises(1.0);
    let steps = "random and Sobol points: sexp, on random ones with antithetic differences; all \
                 pilots are part of the cost";
    let panel = Panel {
        reference: "half-width ε of the 95 % interval, bias included".into(),
        series,
        ..panel(WORDS, conditions.id, Kind::Cost, &mc::Problem::of(&problem), steps)
    };
    Findings { panels: vec![panel], claims }
}
