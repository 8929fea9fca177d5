//! Strong and weak errors of one-noise systems against their exact solution, beside the paper's
//! kind of reference.

use analysis::{Exact, StepSizes, weak_order};

use crate::{
    exact::{RandomTime, expectation, solution},
    panels::{strong::finest_steps, weak::moments_of},
    *,
};

/// Strong errors, weak errors of `sexp` against the exact solution path by path, and the mean of
/// the exact solution over the paths against the Gaussian integral.
pub fn compare<S: Tuned<3, 1>, G: Damping>(
    conditions: &Conditions,
    [title, system]: [&'static str; 2],
    problem: &Problem<S, G, 3>,
) -> Findings {
    // The random time whose flow is the exact solution. Both systems have a vector field of degree
    // 2 and noise of size 1.
    let time = |finest_steps: u64| {
        RandomTime::new(problem.damping(), 2.0, 1.0, problem.t_end() / finest_steps as f64)
    };
    let solution = |s: f64| solution(problem, s);
    let compiled = Compiled::of(problem);
    let words = [title, system, "Not in the paper."];
    let panel = StrongPanel::new(words, conditions.choose((12, 500), (10, 200)));
    let finest = time(finest_steps(panel.last, problem.t_end()));
    let panel = StrongPanel { exact: Some(Exact::new(&finest, solution)), ..panel };
    let mut findings = panel.measure(conditions, &of_paper(&compiled));

    let sizes = StepSizes {
        levels: 5,
        refinement: 0,
        samples: conditions.choose(16_000, 400),
        ..StepSizes::new(8, truncation(), conditions.key(1))
    };
    let steps = sizes.coarsest_steps << (sizes.levels - 1);
    let time = time(steps);
    let exact = Exact::new(&time, solution);
    for observable in [phi("y2", |y| y[1]), phi("cos y3", |y| elementary::cos(y[2]))] {
        let name = observable.name;
        let order = valid(weak_order(&compiled.sexp(), &observable, &sizes, Some(&exact)));
        let statement = format!("sexp has weak order 1 against the exact solution for φ = {name}");
        let weak = Claim::new("weak-one", statement, Evidence::of_order(order, 1.0));

        // Two ways to the same number, of which one uses the noise of this project and the
        // other a quadrature.
        let (on, key) = (&compiled.problem, conditions.key(2));
        let ladder =
            valid(Ladder::new(on, steps, 1, truncation(), key, Vec::new())).with_time_change(&time);
        let samples = conditions.choose(20_000, 1_000);
        let (moments, _) = moments_of(&ladder, samples, 1, |view, p, _| {
            (observable.function)(solution(view.random_time[p]))
        });
        let (value, error) = (moments.mean(0), moments.standard_error(0));
        let expected = expectation(problem, &time, steps, observable.function);
        let statement = format!(
            "E[{name}] over sampled exact solutions is the Gaussian integral over the random time"
        );
        let measured = Evidence::mean(format!("E[{name}]"), value, error, expected);
        let mean = Claim::new("exact-expectation", statement, measured);
        let both = [weak.about(conditions.id, "sexp"), mean.about(conditions.id, "")];
        findings.claims.extend(both.map(|claim| claim.proven(false)));
    }
    findings
}
