//! The 14 panels of the paper as data (paper, §5).

use mc::Observable;
use schemes::SexpLevy;
use stats::Rate;
use systems::paper::{
    INERTIA, LOTKA_VOLTERRA_START, NOISE_INERTIA, half_cosine, rigid_body_start, valid,
};
use systems::{
    Constant, Cosine, Damping, IntegerExponents, Linear, LotkaVolterra, MaxwellBloch, Pendulum,
    Poisson3, Problem, RigidBody, RigidBodyEnergy, Sine,
};
use verify::results::{Claim, Panel};
use verify::{bound_verdict, claim, order_verdict};

use crate::experiment::{Context, Experiment, TRUNCATION_ORDER, Yield, truncation};
use crate::invariant::{InvariantSetup, invariant_yield};
use crate::kernels::Compiled;
use crate::strong::{Curve, StrongSetup, strong_curves, strong_panel};
use crate::supplement::levy::order_claim;
use crate::weak::{WeakPanel, WeakSetup, weak_panels};

/// Everything that makes a panel, in the order of the paper.
pub const EXPERIMENTS: &[Experiment] = &[
    Experiment { panels: &["pendulum-strong"], run: pendulum_strong },
    Experiment { panels: &["rigid-body-casimir"], run: rigid_body_casimir },
    Experiment { panels: &["rigid-body-strong-3"], run: rigid_body_strong_3 },
    Experiment { panels: &["rigid-body-strong-1"], run: rigid_body_strong_1 },
    Experiment {
        panels: &[
            "rigid-body-weak-y",
            "rigid-body-weak-y2",
            "rigid-body-weak-cos",
            "rigid-body-weak-sin",
        ],
        run: rigid_body_weak,
    },
    Experiment { panels: &["rigid-body-energy"], run: rigid_body_energy },
    Experiment { panels: &["lotka-volterra-energy"], run: lotka_volterra_energy },
    Experiment { panels: &["lotka-volterra-strong"], run: lotka_volterra_strong },
    Experiment { panels: &["maxwell-bloch-casimir"], run: maxwell_bloch_casimir },
    Experiment { panels: &["poisson3-casimir"], run: poisson3_casimir },
    Experiment { panels: &["poisson3-strong"], run: poisson3_strong },
];

/// "γ = …, y₀ = …, T = …", the part of a set-up that all panels share.
fn describe<S, G: Damping, const D: usize>(
    system: &str,
    problem: &Problem<S, G, D>,
    rest: &str,
) -> String {
    let start: Vec<String> = problem
        .y0
        .iter()
        .map(|y| format!("{y:.4}").trim_end_matches('0').trim_end_matches('.').to_owned())
        .collect();
    format!(
        "{system}, {}, y₀ = ({}), T = {}, {rest}, increments truncated with k = {TRUNCATION_ORDER}",
        problem.damping.describe(),
        start.join(", "),
        problem.t_end
    )
}

fn steps(first: u32, last: u32) -> String {
    format!("τ = 2^-{first} … 2^-{last}")
}

fn pendulum_strong(context: &Context<'_>) -> Yield {
    let problem =
        valid(Problem::new(valid(Pendulum::new(1.0)), valid(Constant::new(2.0)), [0.2, 1.0], 1.0));
    let (last, reference) = context.choose((12, 14), (10, 12));
    let setup = StrongSetup {
        id: "pendulum-strong",
        title: "Damped stochastic pendulum: strong convergence",
        paper: "sexp and midpoint have strong order 1, Euler–Maruyama has 1/2.",
        setup: describe("pendulum, c = 1", &problem, &steps(5, last)),
        first: 5,
        last,
        reference,
        samples: context.choose(500, 512),
    };
    strong_yield(strong_panel(context, &setup, &problem), "strong-one", STRONG_ONE, 1.0)
}

fn rigid_body_strong_3(context: &Context<'_>) -> Yield {
    let body = valid(RigidBody::three_noises(INERTIA, NOISE_INERTIA));
    let problem = valid(Problem::new(body, half_cosine(), rigid_body_start(), 1.0));
    let (last, reference) = context.choose((14, 16), (10, 12));
    let setup = StrongSetup {
        id: "rigid-body-strong-3",
        title: "Damped stochastic rigid body, three noises: strong convergence",
        paper: "With several noises all three schemes have strong order 1/2.",
        setup: describe("rigid body, I = (2, 1, 2/3), Î = (1, 2, 3)", &problem, &steps(5, last)),
        first: 5,
        last,
        reference,
        samples: context.choose(1000, 512),
    };
    let mut result =
        strong_yield(strong_panel(context, &setup, &problem), "strong-half", STRONG_HALF, 0.5);
    add_levy_series(context, &setup, &problem, &mut result);
    result
}

/// A fourth series, not in the paper: `sexp-levy` against itself at a finer step. Drawing areas
/// costs as many normals as the square root of the step count, so its steps end three levels before
/// those of the others.
fn add_levy_series(
    context: &Context<'_>,
    setup: &StrongSetup,
    problem: &Problem<RigidBody<3>, Cosine, 3>,
    result: &mut Yield,
) {
    let levy = RigidBody::sexp_levy(SexpLevy::new(&problem.system, problem.y0));
    let curves = [Curve { name: "sexp-levy".to_owned(), scheme: levy.as_ref() }];
    let (last, reference) = context.choose((11, 13), (setup.last, setup.reference));
    let setup = StrongSetup { last, reference, setup: setup.setup.clone(), ..*setup };
    let with_areas = strong_curves(context, &setup, problem, truncation(), levy.as_ref(), &curves);
    for panel in &mut result.panels {
        panel.reference = format!("{}; sexp-levy: {}", panel.reference, with_areas.reference);
        panel.failures.extend(with_areas.failures.iter().cloned());
    }
    result
        .claims
        .extend(with_areas.series.iter().map(|series| order_claim(&with_areas.id, series)));
    for panel in &mut result.panels {
        panel.series.extend(with_areas.series.iter().cloned());
    }
}

fn rigid_body_strong_1(context: &Context<'_>) -> Yield {
    let body = valid(RigidBody::one_noise(INERTIA, NOISE_INERTIA[0]));
    let problem = valid(Problem::new(body, half_cosine(), rigid_body_start(), 1.0));
    let (last, reference) = context.choose((14, 16), (10, 12));
    let setup = StrongSetup {
        id: "rigid-body-strong-1",
        title: "Damped stochastic rigid body, only W₁: strong convergence",
        paper: "With one noise sexp and midpoint have strong order 1, Euler–Maruyama 1/2.",
        setup: describe("rigid body, only W₁, I = (2, 1, 2/3), Î₁ = 1", &problem, &steps(5, last)),
        first: 5,
        last,
        reference,
        samples: context.choose(1000, 512),
    };
    strong_yield(strong_panel(context, &setup, &problem), "strong-one", STRONG_ONE, 1.0)
}

fn lotka_volterra_strong(context: &Context<'_>) -> Yield {
    let system = valid(LotkaVolterra::<IntegerExponents<1, 1>>::integer(1.0));
    let problem =
        valid(Problem::new(system, valid(Sine::new(1.0, 1.0)), LOTKA_VOLTERRA_START, 1.0));
    let (last, reference) = context.choose((12, 14), (10, 12));
    let setup = StrongSetup {
        id: "lotka-volterra-strong",
        title: "Damped stochastic Lotka–Volterra system: strong convergence",
        paper: "sexp has strong order 1; m(H) = 0, so the theorems do not apply. (The paper's reference has the \
                finest step of the figure, where the error is then zero by construction; here it is finer.)",
        setup: describe("Lotka–Volterra, a = −1, b = −1, c = 1", &problem, &steps(5, last)),
        first: 5,
        last,
        reference,
        samples: context.choose(500, 512),
    };
    let mut result =
        strong_yield(strong_panel(context, &setup, &problem), "strong-one", STRONG_ONE, 1.0);
    for claim in &mut result.claims {
        // m(H) = 0: reported by the paper, not proved.
        claim.proven = false;
    }
    result
}

fn poisson3_strong(context: &Context<'_>) -> Yield {
    let problem =
        valid(Problem::new(valid(Poisson3::new(1.0)), half_cosine(), [1.0, 2.0, 3.0], 0.5));
    let (last, reference) = context.choose((12, 14), (10, 12));
    let setup = StrongSetup {
        id: "poisson3-strong",
        title: "Damped three-dimensional Poisson system: strong convergence",
        paper: "sexp and midpoint have strong order 1, Euler–Maruyama has 1/2.",
        setup: describe("three-dimensional Poisson system, c = 1", &problem, &steps(5, last)),
        first: 5,
        last,
        reference,
        samples: context.choose(400, 512),
    };
    strong_yield(strong_panel(context, &setup, &problem), "strong-one", STRONG_ONE, 1.0)
}

const STRONG_HALF: &str = "sup over n of (E‖y_n − y(t_n)‖²)^½ ≤ C τ^½ for several noises (k ≥ 1)";
const STRONG_ONE: &str = "sup over n of (E‖y_n − y(t_n)‖²)^½ ≤ C τ for one noise (k ≥ 2)";

/// The panel with a claim for each scheme: `sexp` as the paper proves it, the others as it reports
/// them.
fn strong_yield(panel: Panel, id: &str, statement: &str, order: f64) -> Yield {
    let claims = panel
        .series
        .iter()
        .map(|series| {
            let at = if series.quantity == "y(T)" {
                "at the final time"
            } else {
                "largest over the common time grid"
            };
            let (statement, verdict) = match series.scheme.as_str() {
                "sexp" => (statement.to_owned(), bound_verdict(series.rate.as_ref(), order)),
                "em" => (
                    "Euler–Maruyama has strong order 1/2".to_owned(),
                    order_verdict(series.rate.as_ref(), 0.5),
                ),
                other => (
                    format!("{other} has the same strong order as sexp, {order}"),
                    order_verdict(series.rate.as_ref(), order),
                ),
            };
            Claim {
                panel: panel.id.clone(),
                scheme: series.scheme.clone(),
                proven: series.scheme == "sexp",
                ..claim(
                    id,
                    &format!("{statement} ({at})"),
                    verdict,
                    rate_evidence(series.rate.as_ref()),
                )
            }
        })
        .collect();
    Yield { panels: vec![panel], claims }
}

pub(crate) fn rate_evidence(rate: Option<&Rate>) -> String {
    match rate {
        None => "no order can be named: the error is inside the noise, or there are too few paths"
            .to_owned(),
        Some(rate) => format!(
            "order {:.3}, {:.0} % interval [{:.3}, {:.3}]; {}",
            rate.estimate,
            100.0 * rate.confidence,
            rate.lo,
            rate.hi,
            rate.warning.iter().fold(rate.method.clone(), |method, warning| format!(
                "{method}; warning: {warning}"
            ))
        ),
    }
}

fn rigid_body_weak(context: &Context<'_>) -> Yield {
    let body = valid(RigidBody::three_noises(INERTIA, NOISE_INERTIA));
    let problem = valid(Problem::new(body, half_cosine(), rigid_body_start(), 1.0));
    let last = context.choose(12, 9);
    let setup = WeakSetup {
        paper: "sexp has weak order 1 for every test function.",
        setup: describe(
            "rigid body, three noises, I = (2, 1, 2/3), Î = (1, 2, 3)",
            &problem,
            &steps(6, last),
        ),
        first: 6,
        last,
        samples: context.choose(500_000, 65_536),
    };
    let panels: Vec<WeakPanel<3>> =
        weak_observables().into_iter().filter(|panel| context.wants(panel.id)).collect();
    let panels = weak_panels(context, &setup, &problem, &panels);
    let claims = panels
        .iter()
        .flat_map(|panel| panel.series.iter().map(move |series| (panel, series)))
        .map(|(panel, series)| Claim {
            panel: panel.id.clone(),
            scheme: series.scheme.clone(),
            ..claim(
                "weak-one",
                &format!("|E φ(y_N) − E φ(y(T))| ≤ C τ for φ = {} (k ≥ 2)", series.quantity),
                bound_verdict(series.rate.as_ref(), 1.0),
                rate_evidence(series.rate.as_ref()),
            )
        })
        .collect();
    Yield { panels, claims }
}

pub(crate) fn weak_observables() -> [WeakPanel<3>; 4] {
    let observable = |name, function| Observable { name, function };
    [
        WeakPanel {
            id: "rigid-body-weak-y",
            title: "Rigid body, three noises: weak error of E[y_j]",
            observables: vec![
                observable("y1", |y| y[0]),
                observable("y2", |y| y[1]),
                observable("y3", |y| y[2]),
            ],
        },
        WeakPanel {
            id: "rigid-body-weak-y2",
            title: "Rigid body, three noises: weak error of E[y_j²]",
            observables: vec![
                observable("y1^2", |y| y[0] * y[0]),
                observable("y2^2", |y| y[1] * y[1]),
                observable("y3^2", |y| y[2] * y[2]),
            ],
        },
        WeakPanel {
            id: "rigid-body-weak-cos",
            title: "Rigid body, three noises: weak error of E[cos y_j]",
            observables: vec![
                observable("cos y1", |y| real::elementary::cos(y[0])),
                observable("cos y2", |y| real::elementary::cos(y[1])),
                observable("cos y3", |y| real::elementary::cos(y[2])),
            ],
        },
        WeakPanel {
            id: "rigid-body-weak-sin",
            title: "Rigid body, three noises: weak error of E[sin y_j]",
            observables: vec![
                observable("sin y1", |y| real::elementary::sin(y[0])),
                observable("sin y2", |y| real::elementary::sin(y[1])),
                observable("sin y3", |y| real::elementary::sin(y[2])),
            ],
        },
    ]
}

fn rigid_body_casimir(context: &Context<'_>) -> Yield {
    let body = valid(RigidBody::three_noises(INERTIA, NOISE_INERTIA));
    let problem = valid(Problem::new(body, half_cosine(), rigid_body_start(), 10.0));
    let setup = InvariantSetup {
        id: "rigid-body-casimir",
        title: "Damped stochastic rigid body: the Casimir ½|y|² along one path",
        paper: "sexp follows the conformal law of the Casimir; Euler–Maruyama does not.",
        setup: describe(
            "rigid body, three noises, I = (2, 1, 2/3), Î = (1, 2, 3)",
            &problem,
            "τ = 0.1",
        ),
        steps: 100,
        invariants: &["C"],
    };
    invariant_yield(context, &setup, &problem)
}

fn rigid_body_energy(context: &Context<'_>) -> Yield {
    let body = valid(RigidBodyEnergy::new(INERTIA, 1.0));
    let problem = valid(Problem::new(body, valid(Sine::new(1.0, 1.0)), rigid_body_start(), 10.0));
    let setup = InvariantSetup {
        id: "rigid-body-energy",
        title: "Damped stochastic rigid body, noise H₀: the energy along one path",
        paper: "sexp follows the conformal law of the energy.",
        setup: describe("rigid body, one noise H₀, I = (2, 1, 2/3)", &problem, "τ = 0.1"),
        steps: 100,
        invariants: &["H", "C"],
    };
    invariant_yield(context, &setup, &problem)
}

fn lotka_volterra_energy(context: &Context<'_>) -> Yield {
    let system = valid(LotkaVolterra::<IntegerExponents<2, 2>>::integer(1.0));
    let problem =
        valid(Problem::new(system, valid(Sine::new(1.0, 1.0)), LOTKA_VOLTERRA_START, 10.0));
    let setup = InvariantSetup {
        id: "lotka-volterra-energy",
        title: "Damped stochastic Lotka–Volterra system: the energy along one path",
        paper: "sexp follows the conformal law of the energy, a Hamiltonian that is not quadratic.",
        setup: describe("Lotka–Volterra, a = −1, b = −2, c = 1", &problem, "τ = 0.1"),
        steps: 100,
        invariants: &["H", "C"],
    };
    invariant_yield(context, &setup, &problem)
}

fn maxwell_bloch_casimir(context: &Context<'_>) -> Yield {
    let problem = valid(Problem::new(MaxwellBloch, half_cosine(), [1.0, 2.0, 3.0], 5.0));
    let setup = InvariantSetup {
        id: "maxwell-bloch-casimir",
        title: "Damped stochastic Maxwell–Bloch system: the Casimir ½(y₂² + y₃²) along one path",
        paper: "sexp follows the conformal law of the Casimir.",
        setup: describe("Maxwell–Bloch", &problem, "τ = 1/100"),
        steps: 500,
        invariants: &["C"],
    };
    invariant_yield(context, &setup, &problem)
}

fn poisson3_casimir(context: &Context<'_>) -> Yield {
    let problem = valid(Problem::new(
        valid(Poisson3::new(1.0)),
        valid(Linear::new(1.0)),
        [1.0, 2.0, 3.0],
        2.0,
    ));
    let setup = InvariantSetup {
        id: "poisson3-casimir",
        title: "Damped three-dimensional Poisson system: the Casimir ½(y₁+y₂+y₃)² along one path",
        paper: "sexp follows the conformal law of the Casimir; Euler–Maruyama slightly less well, midpoint well.",
        setup: describe("three-dimensional Poisson system, c = 1", &problem, "τ = 0.02"),
        steps: 100,
        invariants: &["C", "S"],
    };
    invariant_yield(context, &setup, &problem)
}
