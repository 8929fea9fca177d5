//! Strong and weak errors of one-noise systems against their exact solution, beside the paper's
//! kind of reference.

use mc::{Ladder, Observable, Reference, Run, StrongErrors};
use schemes::Sexp;
use stats::{fit_strong, root_mean_squares};
use systems::paper::{INERTIA, LOTKA_VOLTERRA_START, rigid_body_start, valid};
use systems::{Damping, IntegerExponents, LotkaVolterra, Problem, RigidBodyEnergy, Sine};
use verify::exact::{RandomTime, expectation, solution};
use verify::results::{Claim, Kind, Panel, Series};
use verify::{DEVIATIONS, Exact, StepSizes, claim, decide, order_verdict, weak_order};

use crate::experiment::{Context, Yield, truncation};
use crate::kernels::Compiled;
use crate::panels::rate_evidence;
use crate::strong::{describe_failures, schemes_of_the_paper};

pub(super) fn lotka_volterra(context: &Context<'_>) -> Yield {
    let system = valid(LotkaVolterra::<IntegerExponents<1, 1>>::integer(1.0));
    let problem =
        valid(Problem::new(system, valid(Sine::new(1.0, 1.0)), LOTKA_VOLTERRA_START, 1.0));
    let title = "Lotka–Volterra against its exact solution: strong convergence";
    against_exact(
        context,
        "lotka-volterra-exact",
        title,
        "Lotka–Volterra, a = −1, b = −1, c = 1",
        &problem,
    )
}

pub(super) fn rigid_body(context: &Context<'_>) -> Yield {
    let body = valid(RigidBodyEnergy::new(INERTIA, 1.0));
    let problem = valid(Problem::new(body, valid(Sine::new(1.0, 1.0)), rigid_body_start(), 1.0));
    let title = "Rigid body with noise H₀ against its exact solution: strong convergence";
    against_exact(
        context,
        "rigid-body-energy-exact",
        title,
        "rigid body, one noise H₀, I = (2, 1, 2/3)",
        &problem,
    )
}

/// Both systems have a vector field of degree 2 and noise of size 1.
const DEGREE: f64 = 2.0;
const NOISE: f64 = 1.0;
/// Coarsest step 2⁻⁵.
const FIRST: u32 = 5;
fn against_exact<S, G>(
    context: &Context<'_>,
    id: &str,
    title: &str,
    description: &str,
    problem: &Problem<S, G, 3>,
) -> Yield
where
    S: Compiled<3, 1>,
    G: Damping,
{
    let last: u32 = context.choose(12, 10);
    let reference_level = last + 2;
    let samples = context.choose(500, 200);
    let schemes = schemes_of_the_paper::<S, 3, 1>();
    // Series 0 is the run that the paper would take as the reference.
    let mut runs: Vec<Run<'_, S, 3, 1>> = vec![Run::new(schemes[0].as_ref(), 0)];
    let mut series = vec![vec![0]];
    for scheme in &schemes {
        let first = runs.len();
        runs.extend(
            (FIRST..=last)
                .map(|exponent| Run::new(scheme.as_ref(), (reference_level - exponent) as usize)),
        );
        series.push((first..runs.len()).collect());
    }
    let finest_steps = 1u64 << reference_level;
    let time =
        RandomTime::new(&problem.damping, DEGREE, NOISE, problem.t_end / finest_steps as f64);
    let exact = |s: f64| solution(problem, s);
    let levels = (reference_level - FIRST) as usize;
    let ladder = Ladder::new(problem, finest_steps, levels, truncation(), context.key(0), runs)
        .unwrap_or_else(|error| unreachable!("the set-up is valid: {error}"))
        .with_clock(&time);
    context.progress.begin(id, ladder.steps_per_path() * samples);
    let statistic = || StrongErrors::new(Reference::Exact(&exact), &series, ladder.coarse_steps());
    let outcome = ladder.run(samples, statistic, &|work| context.progress.advance(work));
    context.progress.end();

    let taus: Vec<f64> = (FIRST..=last).map(|exponent| 0.5f64.powi(exponent as i32)).collect();
    let curves: Vec<Series> = schemes
        .iter()
        .enumerate()
        .map(|(s, scheme)| {
            let squares = outcome.statistic.at_end(s + 1);
            Series {
                scheme: scheme.id().to_owned(),
                quantity: "y(T)".to_owned(),
                points: root_mean_squares(&taus, squares),
                rate: fit_strong(&taus, None, squares),
                max_relative_defect: None,
            }
        })
        .collect();
    let own_error = outcome.statistic.at_end(0).mean(0).sqrt();
    let finest_error = outcome.statistic.at_end(1).mean(taus.len() - 1).sqrt();
    let agreement = format!(
        "sexp at τ = 2^-{reference_level}, the kind of reference that the paper takes, is itself {own_error:.1e} (root mean \
         square) away from the exact solution, {:.0} % of the error of sexp at τ = 2^-{last}",
        100.0 * own_error / finest_error
    );
    let mut claims: Vec<Claim> = curves
        .iter()
        .map(|curve| {
            let expected = if curve.scheme == "em" { 0.5 } else { 1.0 };
            let statement =
                format!("{} has strong order {expected} against the exact solution", curve.scheme);
            let evidence = format!("{}; {agreement}", rate_evidence(curve.rate.as_ref()));
            Claim {
                panel: id.to_owned(),
                scheme: curve.scheme.clone(),
                proven: false,
                ..claim(
                    "strong-one",
                    &statement,
                    order_verdict(curve.rate.as_ref(), expected),
                    evidence,
                )
            }
        })
        .collect();
    claims.extend(weak_claims(context, id, problem));
    let panel = Panel {
        id: id.to_owned(),
        kind: Kind::Strong,
        title: title.to_owned(),
        setup: format!(
            "{description}, {}, T = {}, τ = 2^-{FIRST} … 2^-{last}",
            problem.damping.describe(),
            problem.t_end
        ),
        paper: format!("Not in the paper. {agreement}"),
        samples,
        reference: "the exact solution by a change of time, path by path".to_owned(),
        failures: describe_failures(outcome.failed, &outcome.failures),
        clipped: Vec::new(),
        differences: Vec::new(),
        series: curves,
    };
    Yield { panels: vec![panel], claims }
}

/// Weak errors of `sexp` against the exact solution path by path, and the mean of the exact
/// solution over the paths against the Gaussian integral.
fn weak_claims<S, G>(context: &Context<'_>, id: &str, problem: &Problem<S, G, 3>) -> Vec<Claim>
where
    S: Compiled<3, 1>,
    G: Damping,
{
    let observables: [Observable<3>; 2] = [
        Observable { name: "y2", function: |y| y[1] },
        Observable { name: "cos y3", function: |y| real::elementary::cos(y[2]) },
    ];
    let sizes = StepSizes {
        coarsest_steps: 8,
        levels: 5,
        refinement: 0,
        samples: context.choose(16_000, 400),
        truncation: truncation(),
        key: context.key(1),
    };
    let finest_steps = sizes.coarsest_steps << (sizes.levels - 1);
    let time =
        RandomTime::new(&problem.damping, DEGREE, NOISE, problem.t_end / finest_steps as f64);
    let exact = |s: f64| solution(problem, s);
    let mut claims = Vec::new();
    for observable in observables {
        let reference = Exact { clock: &time, solution: &exact };
        let order = weak_order(&Sexp::default(), problem, observable, &sizes, Some(reference))
            .unwrap_or_else(|error| unreachable!("the set-up is valid: {error}"));
        claims.push(Claim {
            panel: id.to_owned(),
            scheme: "sexp".to_owned(),
            proven: false,
            ..claim(
                "weak-one",
                &format!(
                    "sexp has weak order 1 against the exact solution for φ = {}",
                    observable.name
                ),
                order_verdict(order.rate.as_ref(), 1.0),
                rate_evidence(order.rate.as_ref()),
            )
        });
        claims.push(expectation_claim(context, id, problem, observable, &time, finest_steps));
    }
    claims
}

/// E φ(y(T)) from sampled random times against the one-dimensional integral: two ways to the same
/// number, of which one uses the noise of this project and the other a quadrature.
fn expectation_claim<S, G>(
    context: &Context<'_>,
    id: &str,
    problem: &Problem<S, G, 3>,
    observable: Observable<3>,
    time: &RandomTime<'_, G>,
    steps: u64,
) -> Claim
where
    S: Compiled<3, 1>,
    G: Damping,
{
    let expected = expectation(problem, time, steps, observable.function);
    let sizes = StepSizes {
        coarsest_steps: steps / 2,
        levels: 2,
        refinement: 0,
        samples: context.choose(20_000, 1_000),
        truncation: truncation(),
        key: context.key(2),
    };
    let exact = |s: f64| solution(problem, s);
    let (sampled, se) =
        verify::exact_mean(problem, observable, &sizes, Exact { clock: time, solution: &exact })
            .unwrap_or_else(|error| unreachable!("the set-ups of this crate are valid: {error}"));
    let deviations = (sampled - expected) / se;
    Claim {
        panel: id.to_owned(),
        proven: false,
        ..claim(
            "exact-expectation",
            &format!(
                "E[{}] over sampled exact solutions is the Gaussian integral over the random time",
                observable.name
            ),
            decide(deviations.abs() <= DEVIATIONS),
            format!(
                "{sampled:.6} ± {se:.6} against {expected:.12}, {deviations:+.1} standard errors"
            ),
        )
    }
}
