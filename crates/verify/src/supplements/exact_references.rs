//! Strong and weak errors of one-noise systems against their exact solution, beside the paper's
//! kind of reference.

use analysis::{Exact, FinalMoments, ReferenceSolution, StepSizes, weak_order};
use mc::{Ladder, Observable, Setup, View};
use real::Row;
use schemes::Sexp;
use systems::{
    Damping, Problem,
    paper::{self, valid},
};

use crate::{
    Conditions, Findings, Method, PaperSystem, Words, compiled,
    exact::{RandomTime, expectation, solution},
    in_words,
    panels::{
        curves::curves,
        strong::{Grid, StrongRuns},
    },
    results::{Claim, Evidence},
    truncation,
};

pub fn lotka_volterra(conditions: &Conditions) -> Findings {
    let title = "Lotka–Volterra against its exact solution: strong convergence";
    compare(conditions, title, in_words::VOLTERRA, &paper::lotka_volterra_1_1())
}

pub fn rigid_body(conditions: &Conditions) -> Findings {
    let title = "Rigid body with noise H₀ against its exact solution: strong convergence";
    compare(conditions, title, in_words::BODY_ENERGY, &paper::rigid_body_energy(1.0))
}

/// The random time whose flow is the exact solution, on finest steps of T/`finest_steps`. Both
/// systems have a vector field of degree 2 and noise of size 1.
fn random_time<S, G: Damping>(problem: &Problem<S, G, 3>, finest_steps: u64) -> RandomTime<'_, G> {
    RandomTime::new(problem.damping(), 2.0, 1.0, problem.t_end() / finest_steps as f64)
}

fn compare<S: PaperSystem<3, 1>, G: Damping>(
    conditions: &Conditions,
    title: &'static str,
    system: &'static str,
    problem: &Problem<S, G, 3>,
) -> Findings {
    let grid = conditions.choose(Grid { last: 12, samples: 500 }, Grid { last: 10, samples: 200 });
    let curves = curves(conditions, problem);
    let time = random_time(problem, grid.finest_steps(problem.t_end()));
    let solution = |s: f64| solution(problem, s);
    let exact = Some(Exact::new(&time, solution));
    let words = Words { title, system, paper: "Not in the paper." };
    let runs = StrongRuns::new(words, problem, grid, &curves);
    let mut findings = StrongRuns { exact, ..runs }.measure(conditions);
    findings.claims.extend(weak_claims(conditions, problem));
    findings
}

/// Weak errors of `sexp` against the exact solution path by path, and the mean of the exact
/// solution over the paths against the Gaussian integral.
fn weak_claims<S: PaperSystem<3, 1>, G: Damping>(
    conditions: &Conditions,
    problem: &Problem<S, G, 3>,
) -> Vec<Claim> {
    let observables: [Observable<3>; 2] = [
        Observable { name: "y2", function: |y| y[1] },
        Observable { name: "cos y3", function: |y| real::elementary::cos(y[2]) },
    ];
    let sizes = StepSizes {
        levels: 5,
        refinement: 0,
        samples: conditions.choose(16_000, 400),
        ..StepSizes::new(8, truncation(), conditions.key(1))
    };
    let steps = sizes.coarsest_steps << (sizes.levels - 1);
    let time = random_time(problem, steps);
    let solution = |s: f64| solution(problem, s);
    let exact = || Exact::new(&time, solution);
    let sexp = compiled(Sexp);
    let claims = observables.map(|observable| {
        let (name, reference) = (observable.name, &ReferenceSolution::Exact(exact()));
        let order =
            valid(weak_order(&Setup::of(problem, sexp.as_ref()), &observable, &sizes, reference));
        let statement = format!("sexp has weak order 1 against the exact solution for φ = {name}");
        let measured = Evidence::of_order(order, 1.0);
        let weak = Claim::new("weak-one", statement, measured)
            .about(conditions.id(), Method::Sexp.id())
            .proven(false);

        // Two ways to the same number, of which one uses the noise of this project and the
        // other a quadrature.
        let (on, key) = (mc::Problem::of(problem), conditions.key(2));
        let ladder = valid(Ladder::new(&on, steps, 1, truncation(), key, Vec::new()));
        let ladder = ladder.with_time_change(&time);
        let values = |view: &View<'_>, rows: &mut [Row]| {
            for p in view.live.paths() {
                rows[0][p] = (observable.function)(solution(view.random_time[p]));
            }
        };
        let new = || FinalMoments::new(ladder.coarse_steps(), 1, &values);
        let measured = ladder.run(conditions.choose(20_000, 1_000), new, &|_| ());
        let moments = measured.statistic.moments;
        let measured = Evidence::Deviation {
            quantity: format!("E[{name}]"),
            value: moments.mean(0),
            standard_error: moments.covariance_of_means(0, 0).sqrt(),
            bias: 0.0,
            expected: expectation(problem, &time, steps, observable.function),
            path_steps: None,
            warnings: Vec::new(),
        };
        let statement = format!(
            "E[{name}] over sampled exact solutions is the Gaussian integral over the random \
             time"
        );
        let mean = Claim::new("exact-expectation", statement, measured);
        [weak, mean.about(conditions.id(), "").proven(false)]
    });
    claims.concat()
}
