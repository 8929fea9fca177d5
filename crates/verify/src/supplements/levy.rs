//! `spin-pair-levy`: `sexp-levy` beyond three dimensions and over long paths.

use analysis::worse;
use schemes::{Sexp, SexpLevy};
use systems::{
    Damping, Problem,
    paper::{half_cosine, rigid_body_three_noises},
};

use crate::{
    Compiled, Conditions, Findings, Method, Words, compiled,
    conformal_law::{along, largest_defect},
    panels::{
        curves::Curve,
        strong::{Grid, StrongRuns},
    },
    results::{Claim, Evidence},
    setups::spin_pair,
};

const WORDS: Words = Words {
    title: "Two spins in a fluctuating field: strong convergence with and without Lévy areas",
    system: "Heisenberg pair, J = 1, K = 0.5, σ = 0.8, D = 6, three noises",
    paper: "Not in the paper, whose scheme has strong order 1/2 for noises that do not commute.",
};

pub fn measure(conditions: &Conditions) -> Findings {
    let problem = spin_pair(half_cosine());
    let levy = compiled(SexpLevy::new(problem.system(), problem.y0()));
    let curves = [Curve::new(Method::Sexp, compiled(Sexp)), Curve::new(Method::SexpLevy, levy)];
    let grid = conditions.choose(Grid { last: 11, samples: 500 }, Grid { last: 9, samples: 256 });
    let mut findings = StrongRuns::new(WORDS, &problem, grid, &curves).measure(conditions);
    findings.claims.extend([
        obeys_law(conditions, conditions.id(), &problem),
        obeys_law(conditions, "rigid-body-strong-3", &rigid_body_three_noises(1.0)),
    ]);
    findings
}

/// Largest relative defect of a Casimir that counts as round-off on a path of 1024 steps of 2⁻¹⁰:
/// sixteen ε a step, of random sign, are √1024·16 ε = 1.1e-13.
const ROUND_OFF: f64 = 1e-13;
const STEPS: u64 = 1024;
const PATHS: u64 = 32;

/// Every Casimir on its conformal law, at every step of many paths.
fn obeys_law<S: Compiled<SexpLevy, D, 3>, G: Damping, const D: usize>(
    conditions: &Conditions,
    panel: &str,
    problem: &Problem<S, G, D>,
) -> Claim {
    let levy = compiled(SexpLevy::new(problem.system(), problem.y0()));
    let mut largest = 0.0;
    for path in 0..PATHS {
        let path = conditions.path(3, problem, levy.as_ref(), STEPS, path);
        for index in 0..problem.system().invariants().len() {
            largest = worse(largest, largest_defect(&along(problem, index, &path)));
        }
        if path.failure.is_some() {
            largest = f64::NAN;
        }
    }
    let measured = Evidence::Defect {
        invariant: "every Casimir".into(),
        paths: PATHS,
        steps: STEPS,
        largest,
        tolerance: ROUND_OFF,
        obeys: true,
    };
    let statement = "every Casimir obeys the conformal law at every step, Lévy areas included";
    Claim::new("conformal-casimir", statement, measured)
        .about(panel, Method::SexpLevy.id())
        .proven(false)
}
